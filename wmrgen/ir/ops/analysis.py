"""What the two analyses of errors ask of an operation, and what its record answers.

`wmrgen.ir.selftest` follows many points at once: each operation has a rule ``running`` that returns `Bounded`.
`wmrgen.ir.bounds` follows boxes of inputs: each operation has a rule ``lemma`` that returns `Value`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

import numpy as np

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import Array, Interval
from wmrgen.geometry.exact.number import Exact

# ---- running error bounds: many points at once


class Bounded(NamedTuple):
    """The values of one node at many points, with bounds of their errors."""

    value: Array  # float64, per point
    # Two rows: how far code in the target's arithmetic may be from ``value``, and ``value`` from the exact formula.
    error: Array
    # For choices, in the rows of ``error``: +1 or -1 if the outcome is certain, 0 if rounding may change it.
    outcome: Array | None = None


def rounded(value: Array, error: Array, unit: Array) -> Bounded:
    """Add one rounding to ``error``, except where the operands are exact and the result is a float32.

    Args:
        value: results, per point.
        error: the errors that the operands cause, in the two rows of `Bounded.error`.
        unit: rounding units, in the same rows.

    Returns:
        The value with its complete error.
    """
    exact = (error == 0) & (value.astype(np.float32) == value)
    return Bounded(value, np.where(exact, 0.0, error + unit * (np.abs(value) + error)))


# ---- lemmas: boxes of inputs


class Partial(NamedTuple):
    """The derivative of a node in one of its arguments."""

    arg: int  # the argument
    by: Interval | int  # range of the derivative; 1 or -1 for the terms of a sum
    # If given, the derivative is ``times`` the value of node ``like``.
    like: int | None = None
    times: float = 1.0
    # If given, the derivative is at most ``steep`` / h, where h is the length by which node ``length`` divides.
    length: int | None = None
    steep: Array | None = None


@dataclass(frozen=True, slots=True)
class Noise:
    """A bound of the rounding error of a node: size + sum of per_length[j] / h_j."""

    size: Array
    per_length: Mapping[int, Array] = field(default_factory=dict)  # by the node that divides by h_j
    divisions: frozenset[int] = frozenset()  # see `wmrgen.ir.bounds.walk.Errors`


class Value(NamedTuple):
    """What a lemma says of the result of an operation, for arguments anywhere in their ranges."""

    range: Interval  # of the exact result
    partials: tuple[Partial, ...] = ()  # derivatives in the arguments that matter
    noise: Noise | None = None  # how far the float result is from the exact result of the same arguments
    away: Array | None = None  # a lower bound of the absolute value: the distance away from zero
    widen: bool = True  # whether ``range`` must be widened by the noise
    # How far the exact argument may be from the one by which the float program decides.
    decided: Array | float = 0.0


class Walk(Protocol):
    """The part of `wmrgen.ir.bounds.walk.Walk` that lemmas use. All lists are by node, up to the one in progress."""

    @property
    def nodes(self) -> Sequence[Any]: ...
    @property
    def inputs(self) -> Mapping[str, Interval]: ...  # by name
    @property
    def boxes(self) -> int: ...  # how many
    @property
    def form(self) -> Any: ...  # the floating-point format
    @property
    def library(self) -> Any: ...  # errors of sines and arctangents
    @property
    def ranges(self) -> Sequence[Interval]: ...
    @property
    def away(self) -> Sequence[Array]: ...  # lower bounds of absolute values
    @property
    def noisy(self) -> Sequence[bool]: ...  # whether the node, or one on which it depends, has noise
    @property
    def lengths(self) -> Collection[int]: ...  # the nodes that divide by the length of a vector

    def alarm(self, i: int, what: str, where: Any) -> None:
        """Record an operation that was not shown to be defined.

        Args:
            i: the node.
            what: what may happen.
            where: by box, whether it may happen there.
        """

    def rounded(self, value: Interval, i: int) -> Noise: ...
    def library_noise(self, op: Any, value: Interval) -> Noise: ...
    def errors(self, roots: Sequence[int]) -> Any: ...
    def constant(self, value: Exact) -> tuple[float, float, float, bool]: ...
    def decision_error(self, k: int) -> Array: ...
    def range_of_sum(self, a: int, b: int, sign: int, value: Interval) -> Interval:
        """Return the range of a sum or difference, which is smaller if terms cancel or share an angle.

        Args:
            a: the first node.
            b: the second node.
            sign: 1 for a + b, -1 for a - b.
            value: the sum or difference of the ranges.

        Returns:
            The range, by box.
        """

    def effective_range(self, k: int) -> Interval: ...
    def branch(self, small: int, large: int, value: int) -> tuple[Array, Array, Array]:
        """Bound a value in the branch that is taken because small < large.

        Args:
            small: the node on the left of the comparison.
            large: the node on the right.
            value: the node that is chosen.

        Returns:
            Lower end, upper end and a lower bound of the absolute value, by box.
        """

    def note_near_zero(self, i: int, divisor: int) -> None: ...
    def length_may_vanish(self, i: int, divisor: int) -> bool: ...
    def direction_slope(self, i: int) -> Array: ...
    def quotient_by_length(self, i: int, a: int, b: int) -> Value:
        """Bound a quotient n / d by the length h of a vector.

        Args:
            i: the node of the quotient.
            a: the node n.
            b: the node d, which is at least h.

        Returns:
            The lemma of the quotient.
        """

    def root_of_squares(self, i: int, a: int) -> Value | None: ...


# ---- rules made from an operation's interval and slopes


def by_slopes(op: Any) -> Callable[..., Value]:
    """Return the lemma of a differentiable operation: its derivatives as intervals, and one rounding."""

    def lemma(w: Walk, i: int, *args: int) -> Value:
        ranges = [w.ranges[k] for k in args]
        value = op.interval(*ranges)
        partials = (Partial(k, slope) for k, slope in zip(args, op.slopes(*ranges), strict=True))
        noise = w.rounded(value, i) if op.rounds and not op.ulps else None
        return Value(value, tuple(partials), w.library_noise(op, value) if op.ulps else noise)

    return lemma


def from_slopes(op: Any) -> Callable[..., Bounded]:
    """Return the running error of a differentiable operation, by the mean value theorem."""

    def running(unit: Array, *args: Bounded) -> Bounded:
        value = op.many(*(a.value for a in args))
        slopes = op.slopes(*(iv.outward(a.value - a.error, a.value + a.error) for a in args))
        moved = (iv.magnitude(s) * a.error for s, a in zip(slopes, args, strict=True))
        error = np.sum(list(moved), axis=0)
        if op.ulps:
            return Bounded(value, error + 2 * op.ulps * unit * np.abs(value))
        return rounded(value, error, unit) if op.rounds else Bounded(value, error)

    return running
