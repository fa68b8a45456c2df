"""Checks of tunable parameters: values that `prepare` computes, and that are negative if they give no geometry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import count

import numpy as np

from wmrgen.analysis.kinematics.records import Formula, tunable_ports
from wmrgen.geometry.exact.interval import Interval, magnitude, smallest
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.records import Need, Robot
from wmrgen.geometry.symbolic import expression, number
from wmrgen.ir.build import Builder
from wmrgen.ir.lower import TINY, lower
from wmrgen.ir.nodes import Function, Module, Op, Port, Role
from wmrgen.ir.pipeline import simplified
from wmrgen.ir.rounding import to_float64, tuned

_LOST = 1e-6  # ratio of a divisor to its largest value; a smaller divisor may be nothing but rounding errors of floats


def with_needs(module: Module, robot: Robot) -> Module:
    """Return a module whose `prepare` also computes its ``needs``: values that must not be negative.

    They stand for what the robot file requires of values computed from tunable parameters, and for the divisors of
    `prepare` that may be 0 within the ranges of the parameters. A product of parameters needs no check, because each
    parameter is kept in its range.
    """
    demanded = [need for need in robot.needs if not _is_product(need)]
    functions = [_demanded(robot, demanded)] if demanded else []
    before = module.prepare or Function("prepare", (), (), (), ())
    functions += _divisors(before)
    names = {port.name for f in module.every for port in (*f.inputs, *f.outputs)}
    free = (name for k in count() if (name := f"need{k}") not in names)
    if not functions:
        return module
    ports = list(before.outputs)
    results, builder = list[int](), Builder()
    inputs = {port.name: port for f in (before, *functions) for port in f.inputs}
    for f in (before, *functions):
        place = list[int]()
        for node in f.nodes:
            place.append(builder.again(node, [place[a] for a in node.args]))
        results += [place[r] for r in f.results]
        if f is not before:
            ports += [Port(next(free), Role.PREPARED, "", port.text) for port in f.outputs]
    prepare = builder.function("prepare", tuple(inputs.values()), tuple(ports), results, before.text)
    own = tuple(port.name for port in ports[len(before.outputs) :])
    return replace(module, prepare=simplified(prepare), needs=own)


def _is_product(need: Need) -> bool:
    """Return whether a value is a number times powers of parameters; their ranges do not contain 0."""
    terms = [*need.value.terms]
    return len(terms) == 1 and all(gen.kind == "param" for gen, _ in terms[0])


def _demanded(robot: Robot, demanded: list[Need]) -> Function:
    """Return the values that the file requires to be positive, less the smallest divisor."""
    ports = tunable_ports(robot)
    outputs = tuple(
        (
            Port(f"need{k}", Role.PREPARED, "", f"0 or more, or else: {need.problem}"),
            expression(need.value) - (number(TINY) if need.strict else 0),
        )
        for k, need in enumerate(demanded)
    )
    return lower(Formula("needs", ports, (), outputs, ""))


def _divisors(prepare: Function) -> Iterator[Function]:
    """Yield, for each divisor that may be 0 within the ranges of parameters, its size less that of rounding errors.

    Example: ``y: a - 0.95`` and its opposite for two wheels give the divisor 2 a**2 - 3.8 a + 1.805. Where it is 0,
    float arithmetic gives 1e-7.
    """
    ranges = _ranges(prepare)
    least = {
        i: max(to_float64(TINY), _LOST * float(magnitude(ranges[node.args[0]])[0]))
        for i, node in enumerate(prepare.nodes)
        if node.op is Op.AT_LEAST
    }
    apart = {prepare.nodes[i].args[0]: size for i, size in least.items()}
    for i, lost in apart.items():
        size = lost if np.isfinite(lost) else to_float64(TINY)
        if smallest(ranges[i])[0] > size:
            continue
        builder, place = Builder(), list[int]()
        for node in prepare.nodes[: i + 1]:
            place.append(builder.again(node, [place[a] for a in node.args]))
        result = builder.sub(
            builder.apply(Op.ABS, (place[i],)), builder.const(Exact(Fraction(f"{size:.1g}")))
        )
        port = Port("need", Role.PREPARED, "", "0 or more, or else: a divisor is 0")
        yield builder.function("needs", prepare.inputs, (port,), [result], "")


def _ranges(prepare: Function) -> list[Interval]:
    """Return the interval of every node for parameters within their ranges."""
    inputs = {port.name: tuned(port) for port in prepare.inputs}
    everything = np.array([-np.inf]), np.array([np.inf])
    values: list[Interval] = []
    with np.errstate(all="ignore"):
        for node in prepare.nodes:
            op, args = node.meaning
            if node.value is not None:
                value = np.array([to_float64(node.value)])
                values.append((np.nextafter(value, -np.inf), np.nextafter(value, np.inf)))
            elif node.op is Op.INPUT:
                low, high = inputs[node.name or ""]
                values.append((np.array([low]), np.array([high])))
            else:
                values.append(op.interval(*(values[a] for a in args)) if op.interval else everything)
    return values
