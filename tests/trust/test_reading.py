"""How wmrgen's own source reads: documented arguments, explained constants, no nested comprehensions."""

from __future__ import annotations

import ast
import tokenize
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "wmrgen"
SOURCES = {p.relative_to(PACKAGE).with_suffix("").as_posix(): p for p in sorted(PACKAGE.rglob("*.py"))}
COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
DOCUMENTED_FROM = 3  # parameters, without self and cls
MOST_CONSTANTS = 420  # module constants that are numbers, in the whole package: it may fall


def trees() -> Iterator[tuple[str, ast.Module]]:
    for name, path in SOURCES.items():
        yield name, ast.parse(path.read_text(encoding="utf-8"))


def is_command(function: ast.FunctionDef) -> bool:
    """Whether it is a command, whose parameters have their help beside them: it is decorated with ``@verb(…)``."""
    return any(ast.unparse(decorator).startswith("verb(") for decorator in function.decorator_list)


def parameters(function: ast.FunctionDef) -> list[str]:
    """Names of the parameters, without self and cls."""
    named = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    return [a.arg for a in named if a.arg not in ("self", "cls")]


def public_functions(tree: ast.Module) -> Iterator[ast.FunctionDef]:
    """Functions of a module and methods of its public classes whose names have no underscore in front."""
    for node in tree.body:
        members = node.body if isinstance(node, ast.ClassDef) and node.name[0] != "_" else [node]
        for member in members:
            if isinstance(member, ast.FunctionDef) and not member.name.startswith("_"):
                yield member


def is_number(node: ast.expr) -> bool:
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    if isinstance(node, ast.UnaryOp):
        return is_number(node.operand)
    return isinstance(node, ast.BinOp) and is_number(node.left) and is_number(node.right)


def constants(tree: ast.Module) -> Iterator[tuple[str, int, int]]:
    """Names of the numeric constants of a module, with their first and last lines."""
    for node in tree.body:
        value = getattr(node, "value", None)
        if not isinstance(node, ast.Assign | ast.AnnAssign) or value is None:
            continue
        values = value.elts if isinstance(value, ast.Tuple) else [value]
        if values and all(is_number(v) for v in values):
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            yield ast.unparse(target), node.lineno, node.end_lineno or node.lineno


def comment_lines(path: Path) -> set[int]:
    with path.open("rb") as file:
        return {t.start[0] for t in tokenize.tokenize(file.readline) if t.type == tokenize.COMMENT}


def test_public_functions_document_their_arguments() -> None:
    missing = [
        f"{name}:{function.lineno} {function.name}"
        for name, tree in trees()
        for function in public_functions(tree)
        if len(parameters(function)) >= DOCUMENTED_FROM
        and not is_command(function)
        and "Args:" not in (ast.get_docstring(function) or "")
    ]
    assert missing == []


def test_constants_have_a_comment() -> None:
    """The unit or the reason, in the same line or in the line above."""
    bare = []
    for name, tree in trees():
        commented = comment_lines(SOURCES[name])
        for constant, first, last in constants(tree):
            if not commented & {first - 1, *range(first, last + 1)}:
                bare.append(f"{name}:{first} {constant}")
    assert bare == []


def test_no_more_constants() -> None:
    every = [
        c for path in PACKAGE.rglob("*.py") for c in constants(ast.parse(path.read_text(encoding="utf-8")))
    ]
    assert len(every) <= MOST_CONSTANTS


def nested(outer: ast.expr) -> bool:
    """Whether a comprehension has another one inside, except a matrix: a row for each i of an element for each j."""
    row = getattr(outer, "elt", None)
    inner = [node for node in ast.walk(outer) if isinstance(node, COMPREHENSIONS) and node is not outer]
    return bool(inner) and inner != [row]


def test_no_comprehension_is_inside_another() -> None:
    found = []
    for name, tree in trees():
        for node in ast.walk(tree):
            if isinstance(node, COMPREHENSIONS) and nested(node):
                found.append(f"{name}:{node.lineno}")
    assert found == []


def test_one_walrus_in_an_expression() -> None:
    crowded = [
        f"{name}:{node.lineno}"
        for name, tree in trees()
        for node in ast.walk(tree)
        if isinstance(node, (ast.BoolOp, ast.IfExp, ast.Call, ast.Tuple, *COMPREHENSIONS))
        and sum(isinstance(inner, ast.NamedExpr) for inner in ast.walk(node)) > 1
    ]
    assert crowded == []
