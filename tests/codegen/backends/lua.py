"""A backend for Lua, written outside the package: one module, registered by one entry."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

from wmrgen.codegen.expression import Style, body
from wmrgen.codegen.registry import Entry, Facts, Files, Place, Request
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.calls import complete, self_contained
from wmrgen.ir.nodes import Function, Module
from wmrgen.ir.ops import Conditional, Op
from wmrgen.ir.rounding import to_float64
from wmrgen.robotfile.reserved_words import reserved

RESERVED = reserved(
    "and break do else elseif end false for function goto if in local nil not or repeat return then true"
    " until while math choose",
    "Lua keeps that word for itself.",
)
ENTRY = Entry(
    "lua",
    __name__,
    "module",
    "lua",
    files=(Files(("{robot}.lua",), "the functions for Lua"),),
    options=("scalar",),
)
_LINE = re.compile(r"  local (\w+) = (.*)")


def _literal(value: Exact) -> str:
    text = repr(to_float64(value))
    return f"({text})" if text.startswith("-") else text


FORMS = {
    Op.ABS: "math.abs({0})",
    Op.SQRT: "math.sqrt({0})",
    Op.SIN: "math.sin({0})",
    Op.COS: "math.cos({0})",
    Op.ATAN: "math.atan({0})",
    Op.ATAN2: "math.atan({0}, {1})",
    Op.RINT: "math.floor({0} + 0.5)",
    Op.MIN: "math.min({0}, {1})",
    Op.MAX: "math.max({0}, {1})",
    Op.SELECT: Conditional("choose({0} < {1}, {2}, {3})"),
    Op.FLIP: Conditional("choose(({1}) % 2 == 1, -({0}), {0})"),
    Op.CLAMP: "math.max(-({1}), math.min({1}, {0}))",
    Op.AT_LEAST: Conditional("choose(math.abs({0}) < {1}, choose({0} < 0, -({1}), {1}), {0})"),
    Op.WITH_SIGN_OF: Conditional("choose({1} < 0, -({0}), {0})"),
    Op.ROUNDING_ERROR: "(({0} - (({0} + {1}) - (({0} + {1}) - {0}))) + ({1} - (({0} + {1}) - {0})))",
}
STYLE = Style(
    literal=_literal,
    form=FORMS.__getitem__,
    declare="  local {0} = {1}",
    temporary="t{0}",
)  # fmt: skip


def _name(port: str) -> str:
    return "in_" + port.replace(".", "_")


def _lines(function: Function) -> list[str]:
    code = body(function, _name, STYLE)
    results = ", ".join(
        f'["{p.name}"] = {text}' for p, text in zip(function.outputs, code.results, strict=True)
    )
    arguments = ", ".join(_name(p.name) for p in function.inputs)
    return [
        f"function robot.{function.name}({arguments})",
        *code.statements,
        f"  return {{{results}}}",
        "end",
    ]


def emit(module: Module, facts: Facts) -> dict[str, bytes]:
    """``<robot>.lua``."""
    lines = [f"-- wmrgen {facts.wmrgen_version}, {facts.options['scalar']}, {facts.model_hash}"]
    lines += ["local robot = {}", "local function choose(c, x, y) if c then return x end return y end"]
    for function in self_contained(module):
        lines += _lines(function)
    return {f"{module.name}.lua": "\n".join([*lines, "return robot", ""]).encode()}


def places(files: Mapping[str, bytes]) -> tuple[Place, ...]:
    """Return the lines on which functions begin."""
    ((name, content),) = files.items()
    return tuple(
        Place(name, line.split(".")[1].split("(")[0], number, ())
        for number, line in enumerate(content.decode().splitlines(), 1)
        if line.startswith("function ")
    )


class _Math:
    """Lua's library; `math.atan` takes one argument or two."""

    abs, sqrt, sin, cos, floor, min, max = abs, math.sqrt, math.sin, math.cos, math.floor, min, max

    @staticmethod
    def atan(y: float, x: float = 1.0) -> float:
        return math.atan2(y, x)


def evaluate(module: Module, requests: Sequence[Request], scalar: str = "float") -> list[dict[str, float]]:
    """Run the printed text with Python, which has the same operators."""
    assert scalar in ("float", "double")  # the option of the entry is passed on
    functions = {function.name: function for function in self_contained(module)}
    outputs = []
    for function, case in requests:
        wanted = functions[function]
        lines = _lines(wanted)
        table = lines[-2].removeprefix("  return ").replace('["', '"').replace('"] = ', '": ')
        names: dict[str, object] = {"math": _Math, "choose": lambda c, x, y: x if c else y}
        names |= {_name(p.name): v for p, v in zip(wanted.inputs, complete(wanted, case), strict=True)}
        for line in lines[1:-2]:
            declared = _LINE.fullmatch(line)
            assert declared, line
            names[declared[1]] = eval(declared[2], {"__builtins__": {}}, names)
        outputs.append({k: float(v) for k, v in eval(table, {"__builtins__": {}}, names).items()})
    return outputs
