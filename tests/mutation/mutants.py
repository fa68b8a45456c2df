"""Mutants of generated C: one small fault each, in the text that derive writes.

Every mutant of a file is compiled at once: a statement computes what the number ``mutant`` says. Faults: another
operator, operands or branches the other way round, a term dropped, a sign, a constant off by a thousandth, another
wheel's member, another temporary.
"""

from __future__ import annotations

import ast
import copy
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

OFF = 1e-3  # relative change of a constant
_STATEMENT = re.compile(r"^    (const (?:float|double) (\w+)|\*?[\w.>-]+) = ([^;]+);$")
_CHOICE = re.compile(r"^\((.+) < (.+)\) \? (.+) : (.+)$")
_FUNCTION = re.compile(r"^void (\w+)\(")
LITERAL = re.compile(r"\b(\d+\.?\d*(?:e[-+]?\d+)?)f\b")
_MEMBER = re.compile(r"\b\w+->[\w.]+")
_OTHER = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
_SIGN = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}


@dataclass(frozen=True)
class Mutant:
    """``number`` from 1; where it is, what it does, and the text it puts in place of ``before``."""

    number: int
    function: str
    kind: str
    before: str
    after: str

    def __str__(self) -> str:
        return f"{self.number} {self.function} [{self.kind}]: {self.before}  =>  {self.after}"


def unfolded(source: str) -> str:
    """The C with every statement on one line."""
    return re.sub(r"(?<=,)\n {8,}|\n {8,}(?=[?:+*/-] )", " ", re.sub(r"(?<=\()\n {8,}", "", source))


def mutate(source: str) -> tuple[str, list[Mutant]]:
    """The file with all its mutants in it, and what they are. 0 is the file as it was."""
    lines: list[str] = []
    found: list[Mutant] = []
    names: list[str] = []
    function = body = ""
    source = re.sub(r"; /\*.*\*/$", ";", unfolded(source), flags=re.M)
    for line in source.splitlines():
        begun = _FUNCTION.match(line)
        if begun:
            function, names = begun[1], []
            if function.endswith(
                "_joints_from_counters"
            ):  # tests/codegen/processor/test_counters.py has its tests
                function = ""
            body = source[source.index(line) :].partition("\n}")[0]
        statement = _STATEMENT.match(line)
        if not statement or not function:
            lines.append(line)
            continue
        target, own, text = statement.groups()
        text = text.strip()
        chain = ""
        seen = {text}
        for kind, after in _variants(text, names, _members(body, text)):
            if after not in seen:
                seen.add(after)
                found.append(Mutant(len(found) + 1, function, kind, f"{target} = {text}", after))
                chain += f"(mutant == {found[-1].number}) ? ({after}) : "
        lines.append(f"    {target} = {chain}({text});")
        if own:
            names.append(own)
    first = next(k for k, line in enumerate(lines) if _FUNCTION.match(line))
    lines.insert(first, "extern int mutant;\nint mutant = 0;")
    return "\n".join(lines) + "\n", found


def _members(body: str, text: str) -> dict[str, str]:
    """Input read in ``text`` -> another input of its kind: the same member of the next wheel, else the next one."""
    found: dict[str, str] = {}
    every = list(dict.fromkeys(_MEMBER.findall(body)))
    for read in _MEMBER.findall(text):
        base, member = read.split("->")
        peers = [r for r in every if r.startswith(base) and r.split(".")[1:] == member.split(".")[1:]]
        if len(peers) > 1 and read in peers:
            found[read] = peers[(peers.index(read) + 1) % len(peers)]
    return found


def _variants(text: str, names: list[str], members: dict[str, str]) -> Iterator[tuple[str, str]]:
    choice = _CHOICE.match(text)
    if not choice:
        for kind, tree in _of_tree(_parsed(text), names):
            yield kind, _printed(tree)
    else:
        a, b, x, y = choice.groups()
        yield "condition turned", f"({b} < {a}) ? {x} : {y}"
        yield "always the first", x
        yield "always the second", y
        for place, part in enumerate((a, b, x, y)):
            for kind, tree in _of_tree(_parsed(part), names):
                parts = [a, b, x, y]
                parts[place] = _printed(tree)
                yield f"{kind} in a choice", "({} < {}) ? {} : {}".format(*parts)
    for read, other in members.items():
        yield "another member", re.sub(re.escape(read) + r"(?![\w.])", other, text)


def _parsed(text: str) -> ast.expr:
    plain = _MEMBER.sub(lambda m: m[0].replace("->", "_TO_").replace(".", "_DOT_"), text)
    return ast.parse(LITERAL.sub(r"\1", plain).strip(), mode="eval").body


def _printed(node: ast.expr) -> str:
    if isinstance(node, ast.BinOp):
        return f"({_printed(node.left)} {_SIGN[type(node.op)]} {_printed(node.right)})"
    if isinstance(node, ast.UnaryOp):
        return f"(-{_printed(node.operand)})"
    if isinstance(node, ast.Call):
        return f"{node.func.id}({', '.join(_printed(a) for a in node.args)})"  # type: ignore[attr-defined]
    if isinstance(node, ast.Constant):
        return f"{float(node.value)!r}f"
    return ast.unparse(node).replace("_TO_", "->").replace("_DOT_", ".")


def _of_tree(tree: ast.expr, names: list[str]) -> Iterator[tuple[str, ast.expr]]:
    """Every fault of every node."""
    for place, node in enumerate(ast.walk(tree)):
        for kind, change in _faults(node, names):
            other = copy.deepcopy(tree)
            yield kind, _replaced(other, list(ast.walk(other))[place], change)


Change = Callable[[ast.expr], ast.expr]


def _faults(node: ast.AST, names: list[str]) -> Iterator[tuple[str, Change]]:
    if isinstance(node, ast.BinOp):
        swapped = _OTHER[type(node.op)]
        yield "operator", lambda n: ast.BinOp(n.left, swapped(), n.right)  # type: ignore[attr-defined]
        if isinstance(node.op, (ast.Sub, ast.Div)):
            yield "operands swapped", lambda n: ast.BinOp(n.right, n.op, n.left)  # type: ignore[attr-defined]
        yield "dropped", lambda n: n.left  # type: ignore[attr-defined]
        yield "dropped", lambda n: n.right  # type: ignore[attr-defined]
    elif isinstance(node, ast.Call) and len(node.args) == 2:
        yield "operands swapped", lambda n: ast.Call(n.func, n.args[::-1], [])  # type: ignore[attr-defined]
    elif isinstance(node, ast.Call) and len(node.args) == 3:  # wmr_fma
        yield "dropped", lambda n: n.args[2]  # type: ignore[attr-defined]
        yield "dropped", lambda n: ast.BinOp(n.args[0], ast.Mult(), n.args[1])  # type: ignore[attr-defined]
        yield "operator", lambda n: ast.Call(n.func, [*n.args[:2], ast.UnaryOp(ast.USub(), n.args[2])], [])  # type: ignore[attr-defined]
    elif isinstance(node, ast.Call):
        yield "call dropped", lambda n: n.args[0]  # type: ignore[attr-defined]
        other = {"sinf": "cosf", "cosf": "sinf"}.get(node.func.id)  # type: ignore[attr-defined]
        if other:
            yield "function", lambda n: ast.Call(ast.Name(other), n.args, [])  # type: ignore[attr-defined]
    elif isinstance(node, ast.UnaryOp):
        yield "sign dropped", lambda n: n.operand  # type: ignore[attr-defined]
    elif isinstance(node, ast.Constant):
        value = float(node.value)  # type: ignore[arg-type]
        yield "constant", lambda n: ast.Constant(value * (1 + OFF) if value else OFF)
        if value:
            yield "sign", lambda n: ast.UnaryOp(ast.USub(), n)
    elif isinstance(node, ast.Name) and (node.id in names or "_TO_" in node.id):
        yield "sign", lambda n: ast.UnaryOp(ast.USub(), n)
        if node.id in names and len(names) > 1:
            other = names[names.index(node.id) - 1]
            yield "another temporary", lambda n: ast.Name(other)


def _replaced(tree: ast.expr, node: ast.AST, change: Change) -> ast.expr:
    class Swap(ast.NodeTransformer):
        def visit(self, at: ast.AST) -> ast.AST:
            return change(at) if at is node else self.generic_visit(at)  # type: ignore[arg-type]

    return Swap().visit(tree)  # type: ignore[no-any-return]
