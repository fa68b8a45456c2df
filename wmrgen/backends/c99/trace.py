"""Which values of optimised code are quantities of the formula it came from.

Passes rewrite a formula beyond recognition, and leave its values: a node that has the value of a named intermediate
result at several unrelated points is that result. Constants and inputs are left out.

`quantity` gives the name that a comment calls such a result by, the report's. `places` says on which lines the C that
is printed computes them: for the report, which never sees the C itself.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from wmrgen.backends.registry import Place
from wmrgen.ir.calls import Kernels, defaults, nominal, with_places
from wmrgen.ir.calls import by_name as kernels_by_name
from wmrgen.ir.interpret import values_of
from wmrgen.ir.nodes import Function, Module, Op, contract
from wmrgen.ports import NO_SITE
from wmrgen.selftest.points import Grid

Array = Any
_POINTS = slice(20, 28)
_NEAR = 2e-4  # of float32 code without and with kernels; unrelated values do not agree at eight points
Names = Mapping[str, Array]  # name of an intermediate result -> its values at the points


def _inputs(function: Function) -> dict[str, Array]:
    """Generic values of the contract inputs; the same for every function with the same ports."""
    ports = contract(function)
    rows = Grid(ports, NO_SITE).rows[_POINTS] if ports else np.zeros((0, 0))
    return {port.name: rows[:, k].astype(np.float32) for k, port in enumerate(ports)}


@np.errstate(all="ignore")
def _tunables(module: Module, formulas: Sequence[Function]) -> dict[str, Array]:
    """Nominal values of the tunable parameters, of such as only formulas have too, and what prepare() makes of them."""
    defaults_of = (nominal(module), *map(defaults, formulas))
    values = {name: np.full(1, value) for each in defaults_of for name, value in each.items()}
    if module.prepare is not None:
        values |= module.prepare.outputs_of(
            list(map(np.atleast_1d, values_of(module.prepare, values, np.float64)))
        )
    return values


@np.errstate(all="ignore")
def _names(formula: Function, inputs: Mapping[str, Array]) -> Names:
    """The values of the intermediate results of a formula as it was lowered."""
    if not formula.named:
        return {}
    values = values_of(formula, inputs, np.float64)
    return {name: values[k] for name, k in formula.named}


@np.errstate(all="ignore")
def _labels(
    function: Function, names: Names, inputs: Mapping[str, Array], kernels: Kernels
) -> tuple[tuple[str, int], ...]:
    """Every name whose value a node has, with the first such node, a shared one before others."""
    named = [
        (name, v) for name, v in names.items() if np.ndim(v) == 1 and np.ptp(v) > 0 and np.isfinite(v).all()
    ]
    grouped = {node.args[0] for node in function.nodes if node.op is Op.RESULT}
    nodes = [
        k
        for k, node in enumerate(function.nodes)
        if node.value is None and node.op is not Op.INPUT and k not in grouped
    ]
    if not named or not nodes:
        return ()
    plain, place = with_places(function, kernels)
    run = values_of(plain, inputs, np.float32)
    shape = named[0][1].shape
    table = np.array([np.broadcast_to(np.asarray(run[place[k]], np.float64), shape) for k in nodes])
    uses = Counter(argument for node in function.nodes for argument in node.args)
    labels: list[tuple[str, int]] = []
    for name, value in named:
        tolerance = _NEAR * np.abs(value).max()
        near = np.flatnonzero(np.abs(table[:, 0] - value[0]) <= tolerance)
        same = [nodes[k] for k in near[(np.abs(table[near] - value) <= tolerance).all(axis=1)]]
        shared = [k for k in same if uses[k] > 1]
        labels += [(name, k) for k in (shared or same)[:1]]
    return tuple(labels)


def traced(module: Module, formulas: Sequence[Function]) -> Module:
    """``module`` with the intermediate results of ``formulas``, its kernels among them, named (all as lowered).

    Variants of a function have the names of that one.
    """
    tunables = _tunables(module, formulas) if formulas else {}
    kernels = kernels_by_name(module.kernels)
    origins = {f.variant_of or f.name for f in (*module.functions, *module.kernels)}
    inputs = {f.name: {**tunables, **_inputs(f)} for f in formulas if f.name in origins}
    names = {f.name: _names(f, inputs[f.name]) for f in formulas if f.name in origins}

    def named(function: Function) -> Function:
        origin = function.variant_of or function.name  # its inputs are among those of its origin
        if origin not in names:
            return function
        return replace(function, named=_labels(function, names[origin], inputs[origin], kernels))

    functions, called = (tuple(map(named, each)) for each in (module.functions, module.kernels))
    return replace(module, functions=functions, kernels=called)


_FUNCTION = re.compile(r"^void (\w+)\(")
_NAMED = re.compile(r"^    const \w+ \w+ = .*; /\* (.+) \*/$")
_STORED = re.compile(r"^    (?:\w+->|\*)([\w.]+) = ")


def places(files: Mapping[str, bytes]) -> tuple[Place, ...]:
    """Every function of ``<robot>.c``, among the files that `emit` gives."""
    file = min((name for name in files if name.endswith(".c")), key=len)  # the others have longer names
    return places_in(file, files[file].decode())


def places_in(file: str, source: str) -> tuple[Place, ...]:
    """Every function of a generated C file."""
    functions: list[Place] = []
    for number, line in enumerate(source.splitlines(), 1):
        begun, named = _FUNCTION.match(line), _NAMED.match(line) or _STORED.match(line)
        if begun:
            functions.append(Place(file, begun[1], number, ()))
        elif named and functions:
            last = functions[-1]
            functions[-1] = Place(file, last.function, last.line, (*last.quantities, (named[1], number)))
    return tuple(functions)


# The quantities of sections 6 to 8 of the report. A wheel's name may stand in front.
_OF_A_WHEEL = {
    "x": "a", "y": "b", "along": "u", "across": "w", "turn": "Delta",
    "size": "sqrt(a^2 + b^2)", "speed": "speed", "heading": "heading", "slope": "tan(heading / 2)",
    "p": "p", "q": "q", "tangent": "t", "rx": "row of H, vx", "ry": "row of H, vy", "rw": "row of H, omega",
    "nearest": "nearer angle", "target": "angle inside the limits",
    "bx": "contact point, x", "by": "contact point, y", "wx": "its velocity, x", "wy": "its velocity, y",
    "bx0": "contact point from the mean, x", "by0": "contact point from the mean, y",
}  # fmt: skip
_ALONE = {
    "half_turn": "h", "h_squared": "h^2", "sinc_series": "series of sinc(h)", "h_size": "|h|",
    "h_safe": "|h| or 3/64",
    "chord": "dt sinc(h)", "middle": "theta + h", "vx_fit": "vx", "vy_fit": "vy", "omega_fit": "omega",
    "det": "det(HtH)",
}  # fmt: skip
_ROW = {"b": "Htz", "p": "(adj(HtH) Htz)", "error_": "residual"}
_ENTRY = {"n": "HtH", "adj": "adj(HtH)"}


def quantity(name: str) -> str:
    """``front_left_along`` is u of front_left, ``half_turn`` is h; others are called what the program calls them."""
    if name in _ALONE:
        return _ALONE[name]
    entry = re.fullmatch(r"(n|adj)([0-2])([0-2])", name)
    if entry:
        return f"{_ENTRY[entry[1]]}[{entry[2]}][{entry[3]}]"
    row = re.fullmatch(r"(b|p|error_)(\d+)", name)
    if row:
        return f"{_ROW[row[1]]} {row[2]}" if row[1] == "error_" else f"{_ROW[row[1]]}[{row[2]}]"
    wheel, _, last = name.rpartition("_")
    if wheel and last in _OF_A_WHEEL:
        return f"{wheel}: {_OF_A_WHEEL[last]}"
    return name.replace("_", " ")
