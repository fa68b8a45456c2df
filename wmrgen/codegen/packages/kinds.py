"""Packages: folders that the tools of an ecosystem accept, around the finished C of a robot. One record for each kind.

The C stands in ``src/`` as `derive` writes it, its self-test in ``src/test/``; what the ecosystem asks for beside it is
printed by the templates in ``templates/package/<kind>/``.
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
    """A file that a package adds: its ``path``, with ``{robot}`` in place, which its template is called after, and how
    its language writes a text that may hold anything."""

    path: str
    quote: Callable[[str], str] = str

    def template(self, kind: str) -> str:
        return f"package/{kind}/{PurePosixPath(self.path).name.format(robot='robot')}.j2"


class Package(NamedTuple):
    """A kind of package: its word on the command line, the files that it adds, and those parts of the C that it must
    not hold: ``without`` are folders of them. ``backend``: it is what that backend writes, and has no C. ``context``:
    what its templates print of a robot and its scalar type, beside what all kinds do."""

    kind: str
    files: tuple[File, ...]
    without: tuple[str, ...] = ()
    backend: str = ""
    context: Callable[[Module, str], Mapping[str, object]] = lambda _, __: {}

    @property
    def folder(self) -> str:
        """Where packages of this kind stand side by side; no robot can be called so."""
        return f"package-{self.kind}"


def _of_arduino(module: Module, scalar: str) -> Mapping[str, object]:
    """``types`` and ``functions`` for the editor; ``variables`` and statements of the loop, without covariances, which
    nobody reads there."""
    steps = loop(module, scalar, covariances=False)
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
        # Its tools compile every file below src/.
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
            (File("CMakeLists.txt"), File("package.xml", escape), File("node/{robot}_node.cpp"), _README),
            context=ros2.context,
        ),
        Package("rust", (), backend="rust"),
        Package("javascript", (), backend="javascript"),
    )
}


def of_kinds(words: Sequence[str]) -> list[Package]:
    """The kinds that ``words`` name, each once. UsageError for others."""
    for word in words:
        if word not in PACKAGES:
            raise UsageError(f"there is no package for {word!r}. Kinds: {', '.join(PACKAGES)}.")
    return [PACKAGES[word] for word in dict.fromkeys(words)]


def packaged(package: Package, module: Module, facts: Facts, files: Mapping[str, bytes]) -> dict[str, bytes]:
    """File name -> content of the package of a robot; ``files``: all that its backends wrote."""
    robot = module.name
    c = {
        name: content
        for name, content in files.items()
        if name.endswith(_C) and name.split("/")[0] not in package.without
    }
    top = [name for name in c if "/" not in name]
    scalar = str(facts.options["scalar"])
    context = {
        **package.context(module, scalar),
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
    added = {
        file.path.format(robot=robot): render(
            file.template(package.kind), description=file.quote(text), **context
        )
        for file in package.files
    }
    return {
        **{f"{SOURCES}/{name}": content for name, content in c.items()},
        f"{SOURCES}/{robot}.hpp": header(module, scalar).encode("ascii"),
        **{name: text.encode() for name, text in added.items()},
    }


def _version(text: str) -> str:
    """Three numbers, as every ecosystem has them."""
    match = re.match(r"\d+\.\d+\.\d+", text)
    return match[0] if match else "0.0.0"
