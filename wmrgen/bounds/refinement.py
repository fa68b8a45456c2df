"""Errors over a grid of the angles whose worst boxes are halved, round by round."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wmrgen.bounds.adjoint import Adjoint
from wmrgen.bounds.boxes import boxed
from wmrgen.bounds.domain import Range
from wmrgen.bounds.interval import Array, Interval
from wmrgen.bounds.precision import Format, Library
from wmrgen.bounds.records import Claim, Outcome
from wmrgen.ir.nodes import Function, Op

PARTS = {1: 192, 2: 24}  # of each of so many angles, before the worst are divided
ROUNDS = {1: 0, 2: 1}  # in which the worst are divided
MORE = 4  # rounds while something is not shown
MOST = 160  # boxes divided in one round
NEAR = 0.4  # boxes whose error is more than this share of the largest are divided
GAIN = 0.8  # another round follows where the last one brought an error below this share of what it was
_TURN = 3.1416  # half a turn and a little [rad]

Boxes = dict[str, Interval]


@dataclass(slots=True)
class _Leaves:
    """Boxes and what is known on them: of each result (rows) its least and largest value and its error; alarms."""

    boxes: Boxes
    low: Array
    high: Array
    error: Array
    bad: NDArray[np.bool_]

    def taken(self, pick: NDArray[np.bool_]) -> _Leaves:
        """Those of ``pick``."""
        boxes = {name: (lo[pick], hi[pick]) for name, (lo, hi) in self.boxes.items()}
        return _Leaves(boxes, self.low[:, pick], self.high[:, pick], self.error[:, pick], self.bad[pick])

    def joined(self, other: _Leaves) -> _Leaves:
        both = np.concatenate
        boxes = {
            name: (both([lo, other.boxes[name][0]]), both([hi, other.boxes[name][1]]))
            for name, (lo, hi) in self.boxes.items()
        }
        return _Leaves(
            boxes, both([self.low, other.low], axis=1), both([self.high, other.high], axis=1),
            both([self.error, other.error], axis=1), both([self.bad, other.bad]),
        )  # fmt: skip


def refined(
    function: Function,
    ranges: Mapping[str, Range],
    angles: list[str],
    form: Format,
    library: Library,
    twice: Collection[int],
) -> Outcome:
    """What `Adjoint` finds over ``ranges``, divided along ``angles``."""
    grid = boxed(_within_a_turn(function, ranges, angles, library), angles, PARTS[len(angles)])

    def looked(boxes: Boxes) -> tuple[_Leaves, tuple[tuple[int, str], ...]]:
        walk = Adjoint(function, boxes, form, library, twice)
        found = walk.run()
        low, high = (np.stack([found.ranges[k][end] for k in function.results]) for end in (0, 1))
        bad = np.zeros(found.boxes, dtype=bool)
        for _, _, where in found.alarms:
            bad |= where
        alarms = tuple((i, what) for i, what, _ in found.alarms)
        return _Leaves(boxes, low, high, walk.errors(function.results), bad), alarms

    with np.errstate(all="ignore"):
        leaves, _ = looked(grid)
        for done in range(MORE):
            if done >= ROUNDS[len(angles)] and not leaves.bad.any():
                break
            before = leaves.error.max(axis=1)
            pick = _worst(leaves)
            children, _ = looked(_halved(leaves.taken(pick).boxes, angles))
            leaves = leaves.taken(~pick).joined(children)
            if not leaves.bad.any() and np.all(leaves.error.max(axis=1) > GAIN * before):
                break
    alarms = looked(leaves.taken(leaves.bad).boxes)[1] if leaves.bad.any() else ()
    claims = (
        Claim(float(lo.min()), float(hi.max()), float(e.max()), 0.0, 0.0)
        for lo, hi, e in zip(leaves.low, leaves.high, leaves.error, strict=True)
    )
    return Outcome(tuple(claims), alarms)


def _worst(leaves: _Leaves) -> NDArray[np.bool_]:
    """The boxes to divide next: those with alarms, and those with the largest errors."""
    most = leaves.error.max(axis=1, keepdims=True)
    share = np.nan_to_num(leaves.error / np.maximum(most, 1e-300), nan=1.0).max(axis=0)
    share = np.where(leaves.bad, np.inf, share)
    least = np.sort(share)[-MOST] if len(share) > MOST else 0.0
    return np.asarray(share >= max(least, NEAR))


def _halved(boxes: Boxes, angles: list[str]) -> Boxes:
    """Every box halved along every angle."""
    for name in angles:
        middle = (boxes[name][0] + boxes[name][1]) / 2
        halves = {n: (np.concatenate([lo, lo]), np.concatenate([hi, hi])) for n, (lo, hi) in boxes.items()}
        lo, hi = boxes[name]
        halves[name] = np.concatenate([lo, middle]), np.concatenate([middle, hi])
        boxes = halves
    return boxes


def _within_a_turn(
    function: Function, ranges: Mapping[str, Range], angles: list[str], library: Library
) -> dict[str, Range]:
    """``ranges``; one turn for an angle that has more and of which only sine and cosine are taken."""
    found = dict(ranges)
    for name in angles:
        users = {n.op for n in function.nodes if any(function.nodes[k].name == name for k in n.args)}
        lo, hi = ranges[name]
        if users <= {Op.SIN, Op.COS} and hi - lo > 2 * _TURN and max(-lo, hi) <= library.reach:
            found[name] = -_TURN, _TURN
    return found
