"""What `prepare` computes so that code can tell whether tunable parameters give a geometry."""

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

_LOST = 1e-6  # of the largest a divisor may be: smaller ones are roundings of floats


def with_needs(module: Module, robot: Robot) -> Module:
    """``module`` whose `prepare` also gives its ``needs``: what the robot file demands of values that are computed from
    tunable parameters, and divisors of `prepare` for which no range shows that they are not 0.

    A parameter by itself has its range, which is enough for what it is multiplied by.
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
    """Whether a value is a number times powers of parameters, whose own ranges keep it from 0."""
    terms = [*need.value.terms]
    return len(terms) == 1 and all(gen.kind == "param" for gen, _ in terms[0])


def _demanded(robot: Robot, demanded: list[Need]) -> Function:
    """The values that the file demands, less what is too small to divide by."""
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
    """Of each divisor that may be 0 within the ranges of parameters: how far it is from being lost in rounding.

    ``y: a - 0.95`` and its opposite for two wheels give 2 a**2 - 3.8 a + 1.805, of which rounding leaves 1e-7 where it
    is 0.
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
    """Of every node, while parameters keep their ranges."""
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
