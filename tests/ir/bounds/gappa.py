"""The rounding error of a function as a problem for Gappa, which shares no code with `wmrgen.ir.bounds.analysis`.

The script has every operation twice: rounded, with rounded operands, and exact, with exact ones. A sine or cosine of an
input is an unknown number in [-1, 1]; its rounded twin is any float within the library's error. Functions with choices
or other angles are skipped.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction

import numpy as np

from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.bounds.assumptions import SINGLE, Library, Range
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.rounding import to_float32

FILE = "bounds.g"
_SIGN = {Op.ADD: "+", Op.SUB: "-", Op.MUL: "*", Op.DIV: "/"}


def script(function: Function, ranges: Mapping[str, Range], library: Library) -> str | None:
    """Return the Gappa script for all outputs of ``function``, or None if Gappa has no such operation."""
    lines = ["@rnd = float<ieee_32, ne>;"]
    known: list[str] = []
    for i, node in enumerate(function.nodes):
        if node.op is Op.INPUT:
            low, high = ranges[node.name or ""]
            lines.append(f"f{i} = rnd(x{i}); m{i} = f{i};")
            known.append(f"f{i} in [{_dyadic(low)}, {_dyadic(high)}]")
        elif node.value is not None:
            lines.append(f"f{i} = {_dyadic(to_float32(node.value))}; m{i} = {_rational(node.value)};")
        elif node.op in (Op.SIN, Op.COS) and function.nodes[node.args[0]].op is Op.INPUT:
            error = 2 * library.ulps(node.op) * float(SINGLE.half_ulp(np.array([1.0]))[0]) + SINGLE.tiny
            lines.append(f"f{i} = rnd(x{i}); m{i} = y{i};")
            known += [f"f{i} in [-1, 1]", f"m{i} in [-1, 1]", f"|f{i} - m{i}| <= {_dyadic(error)}"]
        else:
            made = _operation(i, node)
            if made is None:
                return None
            lines.append(made)
    goals = [f"|f{k} - m{k}| in ?" for k in dict.fromkeys(function.results)]
    left = " /\\\n  ".join(known)
    right = " /\\\n  ".join(goals)
    return "\n".join([*lines, f"{{ {left} ->\n  {right} }}" if known else f"{{ {right} }}", ""])


def _operation(i: int, node: Node) -> str | None:
    f, m = ([f"{letter}{k}" for k in node.args] for letter in "fm")
    if node.op in _SIGN:
        sign = _SIGN[node.op]
        return f"f{i} rnd= {f[0]} {sign} {f[1]}; m{i} = {m[0]} {sign} {m[1]};"
    if node.op is Op.SQRT:
        return f"f{i} rnd= sqrt({f[0]}); m{i} = sqrt({m[0]});"
    if node.op is Op.NEG:
        return f"f{i} = -{f[0]}; m{i} = -{m[0]};"
    if node.op is Op.ABS:
        return f"f{i} = |{f[0]}|; m{i} = |{m[0]}|;"
    return None


def found(output: str, function: Function) -> dict[str, float]:
    """Return the bound that Gappa found by output name; infinite if it found none."""
    bounds: dict[int, float] = {}
    for name, text in re.findall(r"\|[fm](\d+) - m\1\| in \[[^,]*, ([^\]]*)\]", output):
        bounds[int(name)] = _upper(text)
    ports = zip(function.outputs, function.results, strict=True)
    return {port.name: bounds.get(k, np.inf) for port, k in ports}


def _upper(text: str) -> float:
    """``123b-45 {1.2e-6, 2^(-19.5)}`` or a plain number."""
    dyadic = re.match(r"\s*(-?\d+)b(-?\d+)", text)
    if dyadic:
        return float(int(dyadic[1]) * 2.0 ** int(dyadic[2]))
    return float(text.split("{")[0])


def _dyadic(value: float) -> str:
    """Return a float as m b e, which means m 2**e."""
    if not value:
        return "0"
    numerator, denominator = Fraction(value).as_integer_ratio()
    return f"{numerator}b{-(denominator.bit_length() - 1)}"


def _rational(value: Exact) -> str:
    """Return a constant as a fraction; an irrational one to 60 digits, far below every rounding."""
    q = value.rational()
    return f"({q.numerator}/{q.denominator})" if q.denominator != 1 else f"{q.numerator}"
