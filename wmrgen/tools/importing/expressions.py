"""What an expression of a xacro file may do: compute, in little time and memory.

The package xacro hands it to Python. Here it loses what reaches the insides of Python, and its operators and functions
lose what makes a large value of a small one.
"""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Callable
from functools import lru_cache
from typing import Any

from wmrgen.robotfile.text import quoted
from wmrgen.tools.importing.read import refuse

_INSIDES = re.compile(
    "_|(gi|cr|ag|tb|co|f|func)_|(format|format_map|mro|[lr]just|center|zfill|expandtabs|to_bytes)$"
)
_REFUSED = (
    ast.Lambda, ast.GeneratorExp, ast.Await, ast.NamedExpr, ast.JoinedStr, ast.Yield, ast.YieldFrom, ast.LShift,
)  # fmt: skip
_OPERATORS: dict[type[ast.operator], str] = {
    ast.Mult: "guarded_times",
    ast.Pow: "guarded_power",
    ast.Mod: "guarded_rest",
}
# By type and vars all of Python is reached; the others compute for ever.
_SHUT = frozenset("type vars factorial comb perm".split())
_CHARACTERS = 2_000  # of an expression
_SIZED = (str, bytes, dict, list, tuple, set, frozenset)
_LARGEST, _BITS, _STEPS = 50_000, 4_096, 20_000  # steps: a PR2 takes 16,258


@lru_cache(1_000)
def checked(text: str) -> str:
    """An expression that only computes, with guarded functions in the place of operators. RobotFileError otherwise."""
    if len(text) > _CHARACTERS:
        raise refuse(f"an expression of {len(text)} characters")
    try:
        tree = _Guarded().visit(ast.parse(text.strip(), mode="eval"))
        guarded = ast.unparse(tree)
    except (SyntaxError, ValueError):
        raise refuse(f"{quoted(text)} is not an expression") from None
    except (RecursionError, MemoryError):
        raise refuse(f"the expression {quoted(text)} is nested too deeply") from None
    loops = 0
    for node in ast.walk(tree):
        name = node.attr if isinstance(node, ast.Attribute) else ""
        name = node.id if isinstance(node, ast.Name) and node.id.startswith("__") else name
        loops += isinstance(node, ast.comprehension)
        if isinstance(node, _REFUSED) or _INSIDES.match(name) or loops > 1:
            raise refuse(f"the expression {quoted(text)} is refused: it may do more than compute")
    return guarded


class _Guarded(ast.NodeTransformer):
    """Operators that can make much of little as calls of functions that do not."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.expr:
        self.generic_visit(node)
        name = _OPERATORS.get(type(node.op))
        return node if name is None else ast.Call(ast.Name(name, ast.Load()), [node.left, node.right], [])


def offered(names: dict[str, Any]) -> dict[str, Any]:
    """The names that the package gives to expressions, without those that do more than compute."""
    for each in (names, *(value for value in names.values() if isinstance(value, dict))):
        for name in _SHUT & each.keys():
            dict.__delitem__(each, name)
        dict.update(each, {k: door(each[k]) for k, door in _DOORS.items() if k in each})
    return names | {"guarded_times": _times, "guarded_power": _power, "guarded_rest": _rest}


def counted(function: Callable[..., Any], count: itertools.count[int]) -> Callable[..., Any]:
    """A function of the package that is called a limited number of times, for values of limited size."""

    def call(*args: Any, **named: Any) -> Any:
        if next(count) > _STEPS:
            raise refuse(
                f"more than {_STEPS} elements and texts", "", "Look for macros that call each other."
            )
        return weighed(function(*args, **named))

    return call


def weighed(value: Any) -> Any:
    """A value that is no larger than those of robots."""
    parts, weight = [value], 0
    while parts:
        part = parts.pop()
        weight += 1 + (len(part) if isinstance(part, _SIZED) else 0)
        if weight > _LARGEST or (isinstance(part, int) and part.bit_length() > _BITS):
            raise refuse(
                f"an expression makes a value of more than {_LARGEST} parts, or a number of {_BITS} bits"
            )
        if isinstance(part, dict):
            parts += [*part, *part.values()]
        elif isinstance(part, list | tuple | set | frozenset):
            parts += part
    return value


def _times(a: Any, b: Any) -> Any:
    for value, times in ((a, b), (b, a)):
        if not isinstance(value, int | float) and isinstance(times, int):
            weighed([value] * min(max(times, 0), _LARGEST))
    return weighed(a * b)


def _power(base: Any, exponent: Any) -> Any:
    if isinstance(base, int) and abs(exponent) * base.bit_length() > _BITS:
        raise refuse(f"a power of more than {_BITS} bits")
    return base**exponent


def _rest(a: Any, b: Any) -> Any:
    if isinstance(a, str) and re.search(r"\*|\d{4}", a):
        raise refuse(f"the format {quoted(a)} is refused")
    return a % b


def _range(*args: Any) -> range:
    numbers = range(*args)
    if len(numbers) > _LARGEST:
        raise refuse(f"a range of more than {_LARGEST} numbers")
    return numbers


_DOORS: dict[str, Callable[[Any], Any]] = {
    "range": lambda _: _range,
    "load_yaml": lambda load: lambda file: weighed(load(file)),
}
