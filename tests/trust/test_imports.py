"""The import law: data flows one way, a module imports only what stands to its left, and nothing goes in a circle.

Every import statement counts: those for type checking and those inside functions too.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from tests.conftest import ROOT
from wmrgen.codegen.registry import BACKENDS

# The rooms of the house, from left to right. Everything below a room belongs to it.
ROOMS = (
    "errors robotfile geometry analysis functions ir codegen derivation __init__ report tools cli __main__"
).split()
HEAVY = {"sympy", "numpy", "casadi", "jinja2", "mpmath"}
MAY_IMPORT_SYMPY = ("ir/verify", "ir/lower")  # of robotfile, ir, codegen and cli


def sources(package: Path = ROOT / "wmrgen") -> dict[str, str]:
    """Module -> its text; modules as paths below the package: ``ir/nodes``, a package as ``ir``."""
    found = {}
    for path in sorted(package.rglob("*.py")):
        name = path.relative_to(package).with_suffix("").as_posix()
        found[name.removesuffix("/__init__")] = path.read_text(encoding="utf-8")
    return found


SOURCES = sources()


@cache
def statements(text: str) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Of every import statement of ``text`` the module behind ``from``, if there is one, and what is imported."""
    found = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            found.append(("", tuple(alias.name for alias in node.names)))
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, "imports are absolute"
            found.append((str(node.module), tuple(f"{node.module}.{alias.name}" for alias in node.names)))
    return tuple(found)


def imported(text: str) -> Iterator[str]:
    """Every module, and every name of a module, that an import statement of ``text`` names."""
    for base, names in statements(text):
        yield from (base, *names) if base else names


def graph(texts: Mapping[str, str]) -> dict[str, set[str]]:
    """Module -> the modules of ours that it imports. A package counts where nothing below it is meant."""
    edges: dict[str, set[str]] = {}
    for module, text in texts.items():
        edges[module] = set()
        for base, names in statements(text):
            owns = (_own(name, texts) or _own(base, texts) for name in names)
            edges[module] |= {own for own in owns if own and own != module}
    return edges


def _own(name: str, texts: Mapping[str, str]) -> str:
    """``wmrgen.ir.nodes`` as ``ir/nodes``, ``wmrgen`` as ``__init__``; empty for what is not ours."""
    first, _, rest = name.partition(".")
    path = rest.replace(".", "/") or "__init__"
    return path if first == "wmrgen" and path in texts else ""


def room(module: str) -> str:
    """The room of a module: the longest that it stands in."""
    parts = module.split("/")
    return next(r for k in range(len(parts), 0, -1) if (r := "/".join(parts[:k])) in ROOMS)


def against(edges: Mapping[str, set[str]]) -> list[str]:
    """Imports that point right."""
    return [
        f"{module} imports {name}"
        for module, names in edges.items()
        for name in sorted(names)
        if ROOMS.index(room(name)) > ROOMS.index(room(module))
    ]


def circle(edges: Mapping[str, set[str]]) -> list[str]:
    """A circle of imports, empty where there is none."""
    try:
        TopologicalSorter(edges).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def reachable(edges: Mapping[str, set[str]], start: str) -> set[str]:
    reached, waiting = set(), [start]
    while waiting:
        module = waiting.pop()
        if module not in reached:
            reached.add(module)
            waiting += edges[module]
    return reached


def test_every_module_has_a_room_and_every_room_a_module() -> None:
    assert {room(module) for module in SOURCES} == set(ROOMS)
    assert len(set(ROOMS)) == len(ROOMS)


def test_imports_point_left() -> None:
    assert against(graph(SOURCES)) == []


def test_no_circle() -> None:
    assert circle(graph(SOURCES)) == []


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("ir/nodes", "from wmrgen.derivation.facade import Derivation"),
        ("ir/nodes", "if TYPE_CHECKING:\n    from wmrgen.codegen.registry import Facts"),
        ("geometry/exact/number", "def late() -> None:\n    import wmrgen.ir.lower"),
        ("errors", "from wmrgen import __version__"),
        ("codegen/c/emit", "from wmrgen.derivation.program import Program"),
    ],
)
def test_an_import_that_points_right_is_seen(module: str, line: str) -> None:
    worse = {**SOURCES, module: f"{SOURCES[module]}\n{line}\n"}
    assert against(graph(worse)) != []


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("ir/nodes", "if TYPE_CHECKING:\n    from wmrgen.ir.build import Builder"),
        ("geometry/layout/records", "def late() -> None:\n    from wmrgen.geometry.layout import build"),
        ("analysis/kinematics/records", "from wmrgen.analysis.kinematics.inverse import inverse"),
    ],
)
def test_a_circle_inside_a_package_is_seen(module: str, line: str) -> None:
    worse = {**SOURCES, module: f"{SOURCES[module]}\n{line}\n"}
    assert module in circle(graph(worse))


def test_the_facade_imports_no_backend() -> None:
    """Nothing that the facade imports imports one: it finds them by name, through the registry."""
    homes = [entry.module.removeprefix("wmrgen.").replace(".", "/") for entry in BACKENDS.values()]
    reached = reachable(graph(SOURCES), "derivation/facade")
    assert not [m for m in reached for home in homes if m == home or m.startswith(f"{home}/")]


def test_backends_do_not_know_each_other() -> None:
    homes = {"/".join(entry.module.split(".")[1:3]) for entry in BACKENDS.values()}
    for module, names in graph(SOURCES).items():
        home = "/".join(module.split("/")[:2])
        if home in homes:
            assert not [n for n in names if "/".join(n.split("/")[:2]) in homes - {home}], module


def test_nothing_imports_the_textbook() -> None:
    """The textbook library stands outside: it imports wmrgen, wmrgen only looks whether it is there."""
    for module, text in SOURCES.items():
        assert not {n.split(".")[0] for n in imported(text)} & {"textbook", "tests", "benchmarks"}, module


def test_sympy_stays_in_the_derivation() -> None:
    for module, text in SOURCES.items():
        roots = {name.split(".")[0] for name in imported(text)}
        if module.split("/")[0] in ("robotfile", "ir", "codegen", "cli") and module not in MAY_IMPORT_SYMPY:
            assert "sympy" not in roots, module
        if module.split("/")[0] == "robotfile":
            assert not roots & HEAVY, module


@pytest.mark.parametrize(
    "code", ["import wmrgen", "import wmrgen.cli.commands", "import wmrgen.robotfile", "HELP"]
)
def test_what_must_be_instant_loads_nothing_heavy(code: str) -> None:
    if code == "HELP":
        code = "import contextlib, sys; sys.argv = ['wmrgen', '--help']\nfrom wmrgen.__main__ import main\n"
        code += "with contextlib.suppress(SystemExit): main()"
    probe = f"{code}\nimport sys; print('LOADED', *sorted({HEAVY!r} & sys.modules.keys()))"
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "LOADED"


@pytest.mark.slow
def test_a_swerve_is_derived_without_tensors() -> None:
    """The first sum that sympy evaluates loads its tensors and permutations: a fortieth of the derivation."""
    path = ROOT / "robots" / "wpilib_swervebot.yaml"
    probe = "import sys, wmrgen, wmrgen.derivation.emit as emit\n"
    probe += f"emit.artifacts(wmrgen.derive(wmrgen.load({str(path)!r})))\n"
    probe += "print('sympy' in sys.modules, 'sympy.tensor.tensor' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert done.stdout == "True False\n"
