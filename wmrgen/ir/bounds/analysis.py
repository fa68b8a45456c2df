"""The analysis of a function over ranges of its inputs.

Most functions need one box. A function that divides and takes sines of one or two inputs is analysed over a grid of
these angles. If another function of the robot computes the same results by the same operations, its claims are used
(`Outcomes`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from wmrgen.geometry.exact.interval import GROW, Array, Interval, magnitude
from wmrgen.ir.bounds.assumptions import SINGLE, Library, Range
from wmrgen.ir.bounds.patterns import terms_below_root
from wmrgen.ir.bounds.walk import Walk
from wmrgen.ir.nodes import Function, Node, Op, Role

# Parts of each angle, by the number of angles. For three angles or more, a grid that takes seconds is too coarse to
# bound a divisor away from zero.
PARTS = {1: 128, 2: 36}
_HALF_TURN = 3.1416  # pi rounded up, so that a whole turn is covered [rad]


class Claim(NamedTuple):
    """What is claimed of a result: its range, and its error where the shortest length h is long enough."""

    low: float
    high: float
    # Where h >= SMALL_ANGLE * length_error, the error is at most error + per_length / h.
    error: float
    per_length: float
    length_error: float  # how far h may be off; 0 if the result depends on no length
    singular: bool = False  # a divisor comes close to zero: the errors are not to be used


class Outcome(NamedTuple):
    """The result of the analysis of a function."""

    claims: tuple[Claim, ...]  # by result
    alarms: tuple[tuple[int, str], ...]  # (node, what is not shown)


def analysed(function: Function, ranges: Mapping[str, Range], library: Library) -> Outcome:
    """Analyse a function in float32.

    Args:
        function: the function, without calls.
        ranges: (low, high) by input name, in the input's unit.
        library: the errors of sines and arctangents.

    Returns:
        A claim for each result, and the operations that were not shown to be defined.
    """
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
        error = float(errors.plain[row].max())
        per_length = sum(float(bound[row].max()) for bound in errors.per_length.values())
        divisions = errors.divisions[row]
        length_error = max((walk.lengths[j].error for j in divisions - walk.singular), default=0.0)
        bounded = bool(np.isfinite(error + per_length + length_error))
        singular = not bounded or not divisions.isdisjoint(walk.singular)
        claims.append(Claim(float(low.min()), float(high.max()), error, per_length, length_error, singular))
    return Outcome(tuple(claims), tuple(dict.fromkeys((i, what) for i, what, _ in walk.alarms)))


def _angles(function: Function, ranges: Mapping[str, Range]) -> list[str]:
    """Return the inputs of which a sine or cosine is taken."""
    waves = {n.args[0] for n in function.nodes if n.op in (Op.SIN, Op.COS)}
    names = dict.fromkeys(function.nodes[k].name for k in sorted(waves) if function.nodes[k].op is Op.INPUT)
    return [name for name in names if name is not None and name in ranges]


def _within_a_turn(
    function: Function, ranges: Mapping[str, Range], angles: list[str], library: Library
) -> dict[str, Range]:
    """Return ``ranges``, cut to one turn for angles that have more and of which only sine and cosine are taken."""
    turned = dict(ranges)
    for name in angles:
        at = {k for k, n in enumerate(function.nodes) if n.name == name}
        users = {n.op for n in function.nodes if not at.isdisjoint(n.args)}
        lo, hi = ranges[name]
        if users <= {Op.SIN, Op.COS} and hi - lo > 2 * _HALF_TURN and max(-lo, hi) <= library.reach:
            turned[name] = -_HALF_TURN, _HALF_TURN
    return turned


def boxed(ranges: Mapping[str, Range], split: list[str], parts: int) -> dict[str, Interval]:
    """Return boxes: a grid over some inputs, with the whole range of the others.

    Args:
        ranges: (low, high) by input name.
        split: the inputs that are divided.
        parts: into how many equal parts each of them is divided.

    Returns:
        (low, high) by input name, one entry per box.
    """
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


# ---- functions that are linear in some inputs, such as spins and rates: one of these inputs at a time
#
# Lemma. Let every value be independent of the rates x, or linear in them. Fix the roundings of the values that are
# independent of x. Then the float program is linear in x and in its other roundings, which are at most
# u |v| <= sum_k u |v_k|, where v_k is the value for x_k alone. So the error of a result is at most the sum over k of
# its error for x_k alone. That error is largest where |x_k| is. There x_k is a number, and terms that cancel in a
# derivative are seen to cancel.

_FREE, _LINEAR, _OTHER = 0, 1, 2  # how a value depends on the rates


def errors_one_by_one(
    function: Function, inputs: Mapping[str, Interval], library: Library
) -> dict[int, Array]:
    """Bound the errors of results that are linear in the rates, and of the components of lengths.

    Args:
        function: the function, without calls.
        inputs: (low, high) by input name, one entry per box.
        library: the errors of sines and arctangents.

    Returns:
        The bounds by node, one entry per box; empty if the lemma does not apply.
    """
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
    """Return the inputs that are no geometry and of which no sine or cosine is taken."""
    angles = {k for n in function.nodes if n.op in (Op.SIN, Op.COS) for k in n.args}
    used = {n.name for i, n in enumerate(function.nodes) if n.op is Op.INPUT and i not in angles}
    return [
        p.name for p in function.inputs if p.name in used and p.role not in (Role.GEOMETRY, Role.PREPARED)
    ]


def _degrees(nodes: tuple[Node, ...], rates: Collection[str]) -> list[int]:
    """Return by node how it depends on the rates."""
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
    """Return whether a node, some of whose arguments are linear in the rates (``args``), is linear in them."""
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
    """The outcomes of several functions, whose inputs have the same ranges in each of them."""

    def __init__(self, functions: Sequence[Function], library: Library) -> None:
        """Find for each function another one that computes all its results, and more, by the same operations."""
        self.library = library
        self._numbers: dict[tuple[object, ...], int] = {}
        self._keys = {f.name: self._numbered(f) for f in functions}
        self._larger: dict[str, Function] = {}
        for f in functions:
            for g in functions:
                if g is not f and set(self._keys[f.name]) < set(self._keys[g.name]):
                    self._larger[f.name] = g
        self._outcomes: dict[str, Outcome] = {}

    def of(self, function: Function, ranges: Mapping[str, Range]) -> Outcome:
        """Return the outcome of ``function``, from the larger function if that raises no alarm."""
        larger = self._larger.get(function.name)
        if larger is not None and all(p.name in ranges for p in larger.inputs):
            outcome = self._analysed(larger, ranges)
            if not outcome.alarms:
                claims = dict(zip(self._keys[larger.name], outcome.claims, strict=True))
                return Outcome(tuple(claims[k] for k in self._keys[function.name]), ())
        return self._analysed(function, ranges)

    def _analysed(self, function: Function, ranges: Mapping[str, Range]) -> Outcome:
        if function.name not in self._outcomes:
            self._outcomes[function.name] = analysed(function, ranges, self.library)
        return self._outcomes[function.name]

    def _numbered(self, function: Function) -> list[int]:
        """Return a number for each result; results of equal operations on equal inputs have equal numbers."""
        keys: list[int] = []
        for node in function.nodes:
            key = node.op, tuple(map(keys.__getitem__, node.args)), node.value, node.name
            keys.append(self._numbers.setdefault(key, len(self._numbers)))
        return [keys[k] for k in function.results]
