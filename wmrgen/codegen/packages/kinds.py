"""Packages: folders with the C of a robot that the tools of an ecosystem accept. There is a record for each kind.

The C is in ``src/`` as `derive` writes it, and its self-test in ``src/test/``. The templates in
``templates/package/<kind>/`` print the other files that the ecosystem requires.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import PurePosixPath
from typing import NamedTuple
from xml.sax.saxutils import escape

from wmrgen.codegen.packages import ros2
from wmrgen.codegen.packages.cpp import header, loop
from wmrgen.codegen.registry import Facts
from wmrgen.codegen.render import render
from wmrgen.codegen.signature import members
from wmrgen.errors import UsageError
from wmrgen.geometry.ports import GYRO
from wmrgen.ir.nodes import Module

SOURCES = "src"
_C = (".c", ".h")


class File(NamedTuple):
    """A file that a package adds to the C."""

    path: str  # with {robot} for the name of the robot
    quote: Callable[[str], str] = str  # writes the description of the robot in the language of the file
    needs: str = ""  # variable of the templates without which there is no such file

    def template(self, kind: str) -> str:
        """Return the name of the template for a package of this kind."""
        return f"package/{kind}/{PurePosixPath(self.path).name.format(robot='robot')}.j2"


class Package(NamedTuple):
    """A kind of package."""

    kind: str  # word on the command line
    files: tuple[File, ...]  # that it adds to the C
    without: tuple[str, ...] = ()  # folders of C files that it must not contain
    backend: str = ""  # the backend that writes it, if it has no C
    # Further variables of its templates.
    context: Callable[[Module, Facts], Mapping[str, object]] = lambda _, __: {}

    @property
    def folder(self) -> str:
        """The folder of all packages of this kind; no robot can have this name."""
        return f"package-{self.kind}"


def _of_arduino(module: Module, facts: Facts) -> Mapping[str, object]:
    """Return the variables of Arduino's templates: names for the editor, and the statements of a control loop.

    The loop has no covariances, because the sketch does not use them.
    """
    steps = loop(module, str(facts.options["scalar"]), covariances=False)
    return {
        "types": [f"{module.name}_{kind}" for kind in members(module)],
        "functions": [f"{module.name}_{f.name}" for f in module.functions if f.outputs],
        "variables": list(steps.variables.items()),
        "gyro": GYRO.name in steps.variables,
        "prepare": [f"{call.text()};" for call in steps.prepare],
        "sense": [f"{call.text()};" for call in steps.sense],
        "act": [*steps.keep, *(f"{call.text()};" for call in steps.act)],
        "swivel": steps.swivel,
        "twist": steps.twist,
    }


_README = File("README.md")
PACKAGES = {
    package.kind: package
    for package in (
        Package("cmake", (File("CMakeLists.txt"), _README)),
        # Arduino compiles every file below src/, so the example must not be there.
        Package(
            "arduino",
            (
                File("library.properties"),
                File("keywords.txt"),
                File("examples/{robot}_loop/{robot}_loop.ino"),
                File("examples/{robot}_selftest/{robot}_selftest.ino"),
                _README,
            ),
            without=("example",),
            context=_of_arduino,
        ),
        Package("platformio", (File("library.json", json.dumps), _README)),
        Package("esp-idf", (File("CMakeLists.txt"), File("idf_component.yml", json.dumps), _README)),
        Package(
            "zephyr",
            (File("zephyr/module.yml"), File("zephyr/CMakeLists.txt"), File("zephyr/Kconfig"), _README),
        ),
        Package(
            "ros2",
            (
                File("CMakeLists.txt"),
                File("package.xml", escape),
                File("node/{robot}_bridge.h"),
                File("node/{robot}_bridge.c"),
                File("node/{robot}_core.py"),
                File("node/{robot}_node.py"),
                File("controller/{robot}_core.hpp"),
                File("controller/{robot}_controller.hpp"),
                File("controller/{robot}_controller.cpp"),
                File("{robot}_controller.xml", escape),
                File("config/{robot}_controllers.yaml"),
                File("nav2/{robot}_motion_model.hpp", needs="motion_model"),
                File("nav2/{robot}_motion_model.cpp", needs="motion_model"),
                File("{robot}_motion_model.xml", escape, needs="motion_model"),
                _README,
            ),
            context=ros2.context,
        ),
        Package("rust", (), backend="rust"),
        Package("javascript", (), backend="javascript"),
    )
}


def of_kinds(words: Sequence[str]) -> list[Package]:
    """Return the packages with these words, each once. Raise UsageError for an unknown word."""
    for word in words:
        if word not in PACKAGES:
            raise UsageError(f"there is no kind of package {word!r}. There are: {', '.join(PACKAGES)}.")
    return [PACKAGES[word] for word in dict.fromkeys(words)]


def packaged(package: Package, module: Module, facts: Facts, files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the files of a package by name.

    Args:
        package: Kind of package.
        module: The functions of the robot.
        facts: Facts about the robot, with the options of the C.
        files: All files that the backends wrote, by name.
    """
    robot = module.name
    c = {
        name: content
        for name, content in files.items()
        if name.endswith(_C) and name.split("/")[0] not in package.without
    }
    top = [name for name in c if "/" not in name]
    scalar = str(facts.options["scalar"])
    context = {
        **package.context(module, facts),
        "robot": robot,
        "upper": robot.upper(),
        "version": _version(facts.wmrgen_version),
        "generator": f"wmrgen {facts.wmrgen_version}",
        "options": facts.options,
        "scalar": scalar,
        "sources": [f"{SOURCES}/{name}" for name in top if name.endswith(".c")],
        "examples": [f"{SOURCES}/{name}" for name in c if name.startswith("example/")],
        "headers": [f"{SOURCES}/{name}" for name in (*top, f"{robot}.hpp") if not name.endswith(".c")],
    }
    text = " ".join(facts.description.split()) or f"The wheeled robot {robot}"
    written = {f"{SOURCES}/{name}": content for name, content in c.items()}
    written[f"{SOURCES}/{robot}.hpp"] = header(module, scalar).encode("ascii")
    for file in package.files:
        if file.needs and not context[file.needs]:
            continue
        rendered = render(file.template(package.kind), description=file.quote(text), **context)
        written[file.path.format(robot=robot)] = rendered.encode()
    return written


def _version(text: str) -> str:
    """Return a version of three numbers, which every ecosystem accepts."""
    match = re.match(r"\d+\.\d+\.\d+", text)
    return match[0] if match else "0.0.0"
