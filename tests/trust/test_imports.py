"""Data flows one way: a module imports only what stands to its left."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from wmrgen.backends.registry import BACKENDS

PACKAGE = Path(__file__).resolve().parents[2] / "wmrgen"
SOURCES = {p.relative_to(PACKAGE).with_suffix("").as_posix(): p for p in sorted(PACKAGE.rglob("*.py"))}

# From left to right. The IR stands beside the stages: it knows none of them, and `lower` hands over to it.
STAGES = (
    "spec layout constraints symbolic printing mobility kinematics functions program lower modules model robot"
).split()
TOOLS = {"errors", "exact", "notation", "ports", "wheels", "reading"}
MAY_IMPORT = {stage: {*TOOLS, *STAGES[:k]} for k, stage in enumerate(STAGES)} | {
    "errors": set(),
    "exact": {"errors"},
    "ports": {"exact"},
    "notation": set(),
    "wheels": set(),
    "reading": set(),
    "ir": set(TOOLS),
    "render": {"errors"},
    "compiler": {"errors"},
    "backends": {*TOOLS, "ir", "render", "compiler"},
    "artifacts": {"errors"},
}
MAY_IMPORT["bounds"] = {*TOOLS, "ir", "layout"}
MAY_IMPORT["program"] |= {"ir"}
MAY_IMPORT["lower"] |= {"ir"}
MAY_IMPORT["modules"] |= {"ir"}
MAY_IMPORT["model"] |= {"ir"}
MAY_IMPORT["robot"] |= {"ir", "backends", "bounds"}
MAY_IMPORT["model"] |= {"bounds"}
# Code comes from the IR alone; the report and the wheel table of the banners show the stages themselves.
SHOWS_STAGES = {"backends/report", "backends/wheels"}
MAY_IMPORT["emit"] = {*MAY_IMPORT["robot"], "robot", "backends"}
HEAVY = {"sympy", "numpy", "casadi", "jinja2", "mpmath"}


def imports(path: Path) -> set[str]:
    """Modules named by the import statements of a file, those for type checking only left out."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            node.body = []
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add(node.module or "")
    return found


@pytest.mark.parametrize(
    "module", [m for m in SOURCES if m.split("/")[0] not in ("cli", "__init__", "__main__")]
)
def test_imports_point_left(module: str) -> None:
    stage = module.split("/")[0]
    for name in imports(SOURCES[module]):
        parts = name.split(".")
        if parts[0] == "wmrgen" and len(parts) > 1 and parts[1] != stage:
            assert stage in MAY_IMPORT, f"say in this test where {stage} stands"
            shown = (*STAGES, "bounds") if "/".join(module.split("/")[:2]) in SHOWS_STAGES else ()
            assert parts[1] in {*MAY_IMPORT[stage], *shown}, f"wmrgen/{module}.py imports {name}"


def test_nothing_imports_the_textbook() -> None:
    """The textbook library stands outside: it imports wmrgen, wmrgen only looks whether it is there."""
    for module, path in SOURCES.items():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not [n for n in names if n.split(".")[0] in ("textbook", "tests", "benchmarks")], module


@pytest.mark.parametrize("module", [m for m in SOURCES if m.startswith("backends/")])
def test_backends_do_not_know_each_other(module: str) -> None:
    own = module.split("/")[1]
    others = {entry.module.split(".")[2] for entry in BACKENDS.values()} - {own}
    if own == "registry":
        return
    for name in imports(SOURCES[module]):
        if name.startswith("wmrgen.backends."):
            assert name.split(".")[2] not in others, f"wmrgen/{module}.py imports {name}"


@pytest.mark.parametrize(
    "module", [m for m in SOURCES if m.split("/")[0] in ("spec", "ir", "backends", "cli")]
)
def test_sympy_stays_in_the_derivation(module: str) -> None:
    if module in ("ir/verify", "backends/report/expr"):
        return
    roots = {name.split(".")[0] for name in imports(SOURCES[module])}
    assert "sympy" not in roots
    if module.startswith("spec"):
        assert not roots & HEAVY


@pytest.mark.parametrize("code", ["import wmrgen", "import wmrgen.cli.app", "import wmrgen.spec", "HELP"])
def test_what_must_be_instant_loads_nothing_heavy(code: str) -> None:
    if code == "HELP":
        code = "import contextlib, sys; sys.argv = ['wmrgen', '--help']\nfrom wmrgen.__main__ import main\n"
        code += "with contextlib.suppress(SystemExit): main()"
    probe = f"{code}\nimport sys; print('LOADED', *sorted({HEAVY!r} & sys.modules.keys()))"
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "LOADED"
