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
YAML_LOADERS = {"load", "safe_load", "Loader", "CLoader"}
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
    "casadi": {"codegen/casadi"},
    "jinja2": {"codegen/render"},
    "yaml": {"robotfile/reader"},
    "subprocess": {"codegen/compiler"},
    "markdown_it": {"report/pages/document"},
    "webbrowser": {"cli/view"},
    "rich": {"cli/console"},
    "typer": {"cli/commands", "cli/declare"},
    "defusedxml": {"tools/importing/read"},
    "xacro": {"tools/importing/xacro"},
}
WRITERS = {"derivation/artifacts", "codegen/compiler"}  # the last one in temporary folders of its own
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


@cache
def calls(root: ast.AST) -> tuple[ast.Call, ...]:
    return tuple(node for node in ast.walk(root) if isinstance(node, ast.Call))


@cache
def imported(root: ast.AST) -> tuple[str, ...]:
    names: list[str] = []
    for node in ast.walk(root):
        if isinstance(node, ast.Import):
            names += (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative imports hide where a module stands"
            names += (f"{node.module}.{alias.name}" for alias in node.names)
    return tuple(names)


def name_of(function: ast.expr) -> str:
    return function.id if isinstance(function, ast.Name) else ""


@pytest.mark.slow
def test_nothing_turns_text_into_code() -> None:
    assert not [place for module in SOURCES for place in _text_as_code(module)]


def _text_as_code(module: str) -> Iterator[str]:
    for node in ast.walk(tree(module)):
        place = f"{module}:{getattr(node, 'lineno', 0)}"
        if isinstance(node, ast.Call) and name_of(node.func) in FORBIDDEN_CALLS:
            yield f"{place}: {name_of(node.func)}"
        if isinstance(node, ast.Attribute):
            loads = isinstance(node.value, ast.Name) and node.value.id == "yaml"
            if node.attr in FORBIDDEN_ATTRIBUTES or (loads and node.attr in YAML_LOADERS):
                yield f"{place}: {node.attr}"
    for name in imported(tree(module)):
        if name.split(".")[0] in FORBIDDEN_MODULES or name.rsplit(".", 1)[-1] in FORBIDDEN_CALLS:
            yield f"{module} imports {name}"


def test_no_text_is_given_to_sympy() -> None:
    """Only Symbol and Function take a name; every other sympy call takes no literal text at all."""
    assert not [place for module in SOURCES for place in _text_for_sympy(module)]


def _text_for_sympy(module: str) -> Iterator[str]:
    for call in calls(tree(module)):
        if isinstance(call.func, ast.Attribute) and name_of(call.func.value) in ("sympy", "sp"):
            if call.func.attr in ("Symbol", "Dummy", "Function"):
                continue
            texts = [a for a in call.args if isinstance(a, ast.JoinedStr | ast.Constant)]
            if any(isinstance(t, ast.JoinedStr) or isinstance(t.value, str) for t in texts):
                yield f"{module}:{call.lineno}"


@pytest.mark.parametrize("library", HOMES)
def test_one_module_each(library: str) -> None:
    users = {m for m in SOURCES if any(name.split(".")[0] == library for name in imported(tree(m)))}
    homes = HOMES[library]
    strangers = {u for u in users if u not in homes and not any(u.startswith(f"{h}/") for h in homes)}
    assert not strangers


def test_only_artifacts_writes_and_only_the_console_prints() -> None:
    assert not [place for module in SOURCES for place in _writes_or_prints(module)]


def _writes_or_prints(module: str) -> Iterator[str]:
    for call in calls(tree(module)):
        writes = isinstance(call.func, ast.Attribute) and call.func.attr in WRITING
        opens = name_of(call.func) == "open" or (
            isinstance(call.func, ast.Attribute) and call.func.attr == "open"
        )
        if module not in WRITERS and (writes or (opens and _for_writing(call))):
            yield f"{module}:{call.lineno} writes"
        if name_of(call.func) == "print":
            yield f"{module}:{call.lineno} prints"
    for node in ast.walk(tree(module)):
        streams = isinstance(node, ast.Attribute) and name_of(node.value) == "sys"
        if streams and module != "cli/console" and node.attr in ("stdout", "stderr"):
            yield f"{module}:{node.lineno}: sys.{node.attr}"


# What is filled while something is worked out; every other record is a value.
FILLED = {
    "ir/bounds/assumptions:Domain", "ir/bounds/patterns:Length", "ir/linear_forms:_Plan",
    "ir/linear_program:Graph", "report/figures/paper:Paper", "robotfile/typesetting:_Line",
}  # fmt: skip


def test_records_are_values() -> None:
    """Dataclasses are frozen and have slots: none changes after it was made, or gets a member that it has not."""
    changeable = {place for module in SOURCES for place in _changeable(module)}
    assert changeable == {f"{record} can change" for record in FILLED}


def _changeable(module: str) -> Iterator[str]:
    for record in (node for node in ast.walk(tree(module)) if isinstance(node, ast.ClassDef)):
        for decorator in record.decorator_list:
            options = decorator.keywords if isinstance(decorator, ast.Call) else []
            if name_of(decorator.func if isinstance(decorator, ast.Call) else decorator) == "dataclass":
                chosen = {k.arg for k in options if isinstance(k.value, ast.Constant) and k.value.value}
                for option, what in (("frozen", "can change"), ("slots", "has no slots")):
                    if option not in chosen:
                        yield f"{module}:{record.name} {what}"


def test_what_is_walked_together_has_one_length() -> None:
    """``zip`` is strict: where one side is longer, its first part is taken in words, and nothing is dropped unseen."""
    assert not [place for module in SOURCES for place in _lax(module)]


def _lax(module: str) -> Iterator[str]:
    for call in calls(tree(module)):
        if name_of(call.func) == "zip" and not any(
            k.arg == "strict" and isinstance(k.value, ast.Constant) and k.value.value for k in call.keywords
        ):
            yield f"{module}:{call.lineno}"


PLANTED = """\
import pickle
from sympy import sympify
import sympy, sys, yaml
eval("1")
x.lambdify
yaml.safe_load(y)
sympy.cos("x")
path.write_text("")
open("f", "w")
print(sys.stdout)
@dataclass
class A: pass
@dataclass(frozen=False, slots=True)
class B: pass
@dataclass(frozen=True, slots=True)
class C: pass
zip(a, b)
zip(a, b, strict=False)
"""


def test_each_rule_finds_what_is_planted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SOURCES, "planted", Path("planted.py"))
    planted = ast.parse(PLANTED)
    monkeypatch.setitem(globals(), "tree", lambda module: planted)
    assert sorted(_text_as_code("planted")) == [
        "planted imports pickle", "planted imports sympy.sympify", "planted:4: eval", "planted:5: lambdify",
        "planted:6: safe_load",
    ]  # fmt: skip
    assert list(_text_for_sympy("planted")) == ["planted:7"]
    assert sorted(_writes_or_prints("planted")) == [
        "planted:10 prints", "planted:10: sys.stdout", "planted:8 writes", "planted:9 writes",
    ]  # fmt: skip
    assert sorted(_changeable("planted")) == [
        "planted:A can change", "planted:A has no slots", "planted:B can change",
    ]  # fmt: skip
    assert list(_lax("planted")) == ["planted:17", "planted:18"]


def _for_writing(call: ast.Call) -> bool:
    """Whether it opens a file to write; one that leaves its handle open is a standard stream."""
    if any(k.arg == "closefd" for k in call.keywords):
        return False
    texts = [*call.args, *(k.value for k in call.keywords)]
    modes = [t.value for t in texts if isinstance(t, ast.Constant) and isinstance(t.value, str)]
    return any(set(mode) & set("wax+") and len(mode) <= 3 for mode in modes)
