"""What wmrgen's own source may contain, by reading it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE, TEXTBOOK = ROOT / "wmrgen", ROOT / "textbook"
SOURCES = {p.relative_to(PACKAGE).with_suffix("").as_posix(): p for p in sorted(PACKAGE.rglob("*.py"))} | {
    p.relative_to(ROOT).with_suffix("").as_posix(): p
    for p in sorted(TEXTBOOK.rglob("*.py"))
    if "tests" not in p.relative_to(TEXTBOOK).parts
}

FORBIDDEN_CALLS = {
    "eval", "exec", "compile", "__import__", "sympify", "S", "parse_expr", "parse_latex", "parse_mathematica",
    "symbols", "var", "lambdify", "nsimplify", "breakpoint", "input",
}  # fmt: skip
FORBIDDEN_ATTRIBUTES = {
    "sympify", "parse_expr", "parse_latex", "parse_mathematica", "symbols", "lambdify", "nsimplify",
    "unsafe_load", "full_load", "load_all",
}  # fmt: skip
FORBIDDEN_MODULES = {
    "pickle",
    "marshal",
    "shelve",
    "random",
    "locale",
    "socket",
    "urllib",
    "http",
    "datetime",
}

# What lives in one module each. compiler.py also writes, but only C sources into its own temporary folder.
HOMES = {
    "casadi": {"backends/casadi"},
    "jinja2": {"render"},
    "yaml": {"spec/reader"},
    "subprocess": {"compiler"},
    "rich": {"cli/console"},
    "typer": {"cli/app"},
}
WRITERS = {"artifacts", "compiler"}
WRITING = {
    "write_text",
    "write_bytes",
    "mkdir",
    "unlink",
    "rename",
    "replace_file",
    "symlink_to",
    "rmdir",
    "touch",
}


@cache
def tree(module: str) -> ast.Module:
    return ast.parse(SOURCES[module].read_text(encoding="utf-8"))


def calls(root: ast.AST) -> Iterator[ast.Call]:
    return (node for node in ast.walk(root) if isinstance(node, ast.Call))


def imported(root: ast.AST) -> Iterator[str]:
    for node in ast.walk(root):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative imports hide where a module stands"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def name_of(function: ast.expr) -> str:
    return function.id if isinstance(function, ast.Name) else ""


@pytest.mark.parametrize("module", SOURCES)
def test_nothing_turns_text_into_code(module: str) -> None:
    for node in ast.walk(tree(module)):
        if isinstance(node, ast.Call):
            assert name_of(node.func) not in FORBIDDEN_CALLS, f"{module}:{node.lineno}"
        if isinstance(node, ast.Attribute):
            assert node.attr not in FORBIDDEN_ATTRIBUTES, f"{module}:{node.lineno}: {node.attr}"
            of_yaml = isinstance(node.value, ast.Name) and node.value.id == "yaml"
            assert not (of_yaml and node.attr in ("load", "safe_load", "Loader", "CLoader")), (
                f"{module}:{node.lineno}"
            )
    for name in imported(tree(module)):
        assert name.split(".")[0] not in FORBIDDEN_MODULES, f"{module} imports {name}"
        assert name.rsplit(".", 1)[-1] not in FORBIDDEN_CALLS, f"{module} imports {name}"


@pytest.mark.parametrize("module", SOURCES)
def test_no_text_is_given_to_sympy(module: str) -> None:
    """Only Symbol and Function take a name; every other sympy call takes no literal text at all."""
    for call in calls(tree(module)):
        if isinstance(call.func, ast.Attribute) and name_of(call.func.value) in ("sympy", "sp"):
            if call.func.attr in ("Symbol", "Dummy", "Function"):
                continue
            texts = [a for a in call.args if isinstance(a, ast.JoinedStr | ast.Constant)]
            assert not any(isinstance(t, ast.JoinedStr) or isinstance(t.value, str) for t in texts), (
                f"{module}:{call.lineno}"
            )


@pytest.mark.parametrize("library", HOMES)
def test_one_module_each(library: str) -> None:
    users = {m for m in SOURCES if any(name.split(".")[0] == library for name in imported(tree(m)))}
    homes = HOMES[library]
    strangers = {u for u in users if u not in homes and not any(u.startswith(f"{h}/") for h in homes)}
    assert not strangers


@pytest.mark.parametrize("module", SOURCES)
def test_only_artifacts_writes_and_only_the_console_prints(module: str) -> None:
    for call in calls(tree(module)):
        place = f"{module}:{call.lineno}"
        if module not in WRITERS:
            assert name_of(call.func) != "open" or not _for_writing(call), place
            if isinstance(call.func, ast.Attribute):
                assert call.func.attr not in WRITING, place
                assert call.func.attr != "open" or not _for_writing(call), place
        assert name_of(call.func) != "print", place
    if module != "cli/console":
        for node in ast.walk(tree(module)):
            if isinstance(node, ast.Attribute) and name_of(node.value) == "sys":
                assert node.attr not in ("stdout", "stderr"), f"{module}:{node.lineno}"


def _for_writing(call: ast.Call) -> bool:
    texts = [*call.args, *(k.value for k in call.keywords)]
    modes = [t.value for t in texts if isinstance(t, ast.Constant) and isinstance(t.value, str)]
    return any(set(mode) & set("wax+") and len(mode) <= 3 for mode in modes)
