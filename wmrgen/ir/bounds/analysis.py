"""The analysis of a function over ranges of its inputs: one box where that is enough, else parts of the angles.

A function whose results another one computes by the same operations has its claims (`Outcomes`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from wmrgen.geometry.exact.interval import GROW, Array, Interval, magnitude
from wmrgen.ir.bounds.assumptions import SINGLE, Library, Range
from wmrgen.ir.bounds.shapes import terms_below_root
from wmrgen.ir.bounds.walk import Walk
from wmrgen.ir.nodes import Function, Node, Op, Role

# Parts of each of so many angles; of more, a grid that one can afford is too coarse to help.
PARTS = {1: 128, 2: 36}
_TURN = 3.1416  # half a turn and a little [rad]


class Claim(NamedTuple):
    """A result lies in [low, high] and is off by at most error + over / h where h >= `SMALL_ANGLE` rho.

    ``singular``: a divisor on which it depends comes close to zero, so that these numbers mean nothing.
    """

    low: float
    high: float
    error: float
    over: float
    rho: float
    singular: bool = False


class Outcome(NamedTuple):
    """Of a function: a claim per result, and what is not shown (node, what)."""

    claims: tuple[Claim, ...]
    alarms: tuple[tuple[int, str], ...]


def analysed(function: Function, ranges: Mapping[str, Range], library: Library) -> Outcome:
    """The analysis of a function in float over ``ranges``."""
    angles = _angles(function, ranges)
    boxes = boxed(ranges, [], 1)
    if len(angles) in PARTS and any(n.op is Op.DIV for n in function.nodes):
        boxes = boxed(_within_a_turn(function, ranges, angles, library), angles, PARTS[len(angles)])
    upper = {}
    if any(len(lo) > 1 for lo, _ in boxes.values()):
        upper = errors_one_by_one(function, boxes, library)
    walk = Walk(function, boxes, SINGLE, library, upper).run()
    errors = walk.errors(function.results)
    claims = []
    for row, k in enumerate(function.results):
        low, high = walk.ranges[k]
        over = sum(float(v[row].max()) for v in errors.over.values())
        error, divisions = float(errors.plain[row].max()), errors.divisions[row]
        rho = max((walk.lengths[j].rho for j in divisions - walk.singular), default=0.0)
        singular = not divisions.isdisjoint(walk.singular) or not np.isfinite(error + over + rho)
        claims.append(Claim(float(low.min()), float(high.max()), error, over, rho, singular))
    return Outcome(tuple(claims), tuple(dict.fromkeys((i, what) for i, what, _ in walk.alarms)))


def _angles(function: Function, ranges: Mapping[str, Range]) -> list[str]:
    """Inputs of sines."""
    waves = {n.args[0] for n in function.nodes if n.op in (Op.SIN, Op.COS)}
    names = dict.fromkeys(function.nodes[k].name for k in sorted(waves) if function.nodes[k].op is Op.INPUT)
    return [name for name in names if name is not None and name in ranges]


def _within_a_turn(
    function: Function, ranges: Mapping[str, Range], angles: list[str], library: Library
) -> dict[str, Range]:
    """``ranges``; one turn for an angle that has more and of which only sine and cosine are taken."""
    turned = dict(ranges)
    for name in angles:
        users = {n.op for n in function.nodes if any(function.nodes[k].name == name for k in n.args)}
        lo, hi = ranges[name]
        if users <= {Op.SIN, Op.COS} and hi - lo > 2 * _TURN and max(-lo, hi) <= library.reach:
            turned[name] = -_TURN, _TURN
    return turned


def boxed(ranges: Mapping[str, Range], split: list[str], parts: int) -> dict[str, Interval]:
    """A grid over the inputs in ``split``, the whole range of the others."""
    boxes = parts ** len(split)
    grid: dict[str, Interval] = {}
    for name, (lo, hi) in ranges.items():
        if name in split:
            edges = np.linspace(lo, hi, parts + 1)
            place = np.asarray((np.arange(boxes) // parts ** split.index(name)) % parts)
            grid[name] = edges[place], edges[place + 1]
        else:
            grid[name] = np.full(boxes, lo), np.full(boxes, hi)
    return grid


# ---- functions that are linear in some inputs, in spins and rates say: one such input at a time
#
# Lemma. Let every value be free of the rates x or linear in them. Given the roundings of the values that are free of
# them, the float program is linear in x and in its other roundings, and those are at most u |v| <= sum_k u |v_k|, where
# v_k is the value with x_k alone. So results are off by at most the sum over k of what they are off with x_k alone,
# which is largest where x_k is: at a number, where what cancels in a derivative is seen to cancel.

_FREE, _LINEAR, _OTHER = 0, 1, 2


def errors_one_by_one(
    function: Function, inputs: Mapping[str, Interval], library: Library
) -> dict[int, Array]:
    """How far results and what they are the length of may be off, by node; nothing where the lemma does not hold."""
    nodes, rates = function.nodes, _rates(function)
    degrees = _degrees(nodes, rates)
    roots = {k for k in function.results if degrees[k] == _LINEAR}
    for k in function.results:
        if degrees[k] == _OTHER:
            terms = terms_below_root(nodes, nodes[k].args[0]) if nodes[k].op is Op.SQRT else ()
            roots |= {t.base for t in terms if t.squared}
            if not terms or not all(t.squared for t in terms):
                return {}
    if not rates or not roots or any(degrees[k] != _LINEAR for k in roots):
        return {}
    count, boxes = len(rates), max(len(lo) for lo, _ in inputs.values())
    alone: dict[str, Interval] = {}
    for name, (lo, hi) in inputs.items():
        alone[name] = np.tile(lo, count), np.tile(hi, count)
        if name in rates:
            values = np.zeros((count, boxes))
            values[rates.index(name)] = magnitude((lo, hi))
            alone[name] = values.ravel(), values.ravel()
    walk = Walk(function, alone, SINGLE._replace(relative=True), library).run(max(roots) + 1)
    if walk.lengths:
        return {}
    ordered = sorted(roots)
    plain = walk.errors(ordered).plain.reshape(len(ordered), count, boxes).sum(axis=1) * GROW
    return dict(zip(ordered, plain, strict=True))


def _rates(function: Function) -> list[str]:
    """Inputs of which no sine or cosine is taken and which are no geometry."""
    angles = {k for n in function.nodes if n.op in (Op.SIN, Op.COS) for k in n.args}
    used = {n.name for i, n in enumerate(function.nodes) if n.op is Op.INPUT and i not in angles}
    return [
        p.name for p in function.inputs if p.name in used and p.role not in (Role.GEOMETRY, Role.PREPARED)
    ]


def _degrees(nodes: tuple[Node, ...], rates: Collection[str]) -> list[int]:
    degrees: list[int] = []
    for node in nodes:
        args = [degrees[k] for k in node.args]
        if node.op is Op.INPUT:
            degrees.append(_LINEAR if node.name in rates else _FREE)
        elif max(args, default=_FREE) == _FREE:
            degrees.append(_FREE)
        else:
            degrees.append(_LINEAR if _is_linear(nodes, node, args) else _OTHER)
    return degrees


def _is_linear(nodes: tuple[Node, ...], node: Node, args: list[int]) -> bool:
    """Whether a node with linear arguments is linear."""
    if node.op in (Op.ADD, Op.SUB, Op.COMPENSATED, Op.NEG):
        return all(d == _LINEAR for d in args)
    if node.op in (Op.MUL, Op.DIV):
        return sorted(args) == [_FREE, _LINEAR] and (node.op is Op.MUL or args[1] == _FREE)
    if node.op is Op.SELECT:
        sides = (d == _LINEAR or nodes[k].value == 0 for d, k in zip(args[2:], node.args[2:], strict=True))
        return args[:2] == [_FREE, _FREE] and all(sides)
    return False


# ---- the functions of a robot


class Outcomes:
    """The outcomes of functions over ranges of inputs that are the same for all of them."""

    def __init__(self, functions: Sequence[Function], library: Library) -> None:
        self.library = library
        self.numbers: dict[tuple[object, ...], int] = {}
        self.keys = {f.name: self._numbered(f) for f in functions}
        self.larger = {
            f.name: g
            for f in functions
            for g in functions
            if g is not f and set(self.keys[f.name]) < set(self.keys[g.name])
        }
        self.outcomes: dict[str, Outcome] = {}

    def of(self, function: Function, ranges: Mapping[str, Range]) -> Outcome:
        """The outcome of ``function``: from a function that computes more, if nothing is amiss there."""
        larger = self.larger.get(function.name)
        if larger is not None and all(p.name in ranges for p in larger.inputs):
            outcome = self._analysed(larger, ranges)
            if not outcome.alarms:
                claims = dict(zip(self.keys[larger.name], outcome.claims, strict=True))
                return Outcome(tuple(claims[k] for k in self.keys[function.name]), ())
        return self._analysed(function, ranges)

    def _analysed(self, function: Function, ranges: Mapping[str, Range]) -> Outcome:
        if function.name not in self.outcomes:
            self.outcomes[function.name] = analysed(function, ranges, self.library)
        return self.outcomes[function.name]

    def _numbered(self, function: Function) -> list[int]:
        """A number per result; equal for equal operations on equal inputs."""
        keys: list[int] = []
        for node in function.nodes:
            key = node.op, tuple(map(keys.__getitem__, node.args)), node.value, node.name
            keys.append(self.numbers.setdefault(key, len(self.numbers)))
        return [keys[k] for k in function.results]
