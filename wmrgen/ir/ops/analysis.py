"""What analyses hand to the rules of an operation, and what these give back.

Two analyses ask: `wmrgen.ir.selftest`, at many points at once (`Bounded`); `wmrgen.ir.bounds`, over boxes of inputs
(`Value`).
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
    """``value`` per point; ``error``: two rows, of code in the target's arithmetic and of ``value`` itself.

    ``outcome``: for choices, +1 and -1 where the outcome is sure, else 0, in the rows of ``error``.
    """

    value: Array
    error: Array
    outcome: Array | None = None


def rounded(value: Array, error: Array, unit: Array) -> Bounded:
    """One rounding on top of ``error``; none where exact operands give a number that every type holds."""
    exact = (error == 0) & (value.astype(np.float32) == value)
    return Bounded(value, np.where(exact, 0.0, error + unit * (np.abs(value) + error)))


# ---- lemmas: boxes of inputs


class Partial(NamedTuple):
    """The derivative of a node in its argument ``arg``: within ``by``; 1 or -1 of sums.

    ``like``: it is ``times`` node ``like``. ``steep``: it is at most this over the length of node ``length``.
    """

    arg: int
    by: Interval | int
    like: int | None = None
    times: float = 1.0
    length: int | None = None
    steep: Array | None = None


@dataclass(frozen=True, slots=True)
class Noise:
    """The rounding of a node: at most ``size`` plus, by length, ``over`` / h.

    ``divisions``: see `wmrgen.ir.bounds.walk.Errors`.
    """

    size: Array
    over: Mapping[int, Array] = field(default_factory=dict)
    divisions: frozenset[int] = frozenset()


class Value(NamedTuple):
    """What a lemma says of a result, for arguments anywhere in their ranges.

    ``range``: where the exact result lies; ``partials``: how much it moves with each argument; ``noise``: how far the
    float result is from the exact one of the same arguments; ``away``: a lower bound of its absolute value.
    ``widen``: whether the noise is a rounding that ``range`` does not hold yet. ``decided``: how far the exact argument
    may be from that by which the float program decides.
    """

    range: Interval
    partials: tuple[Partial, ...] = ()
    noise: Noise | None = None
    away: Array | None = None
    widen: bool = True
    decided: Array | float = 0.0


class Walk(Protocol):
    """What lemmas ask of a walk over boxes (`wmrgen.ir.bounds.walk.Walk`), of node ``i`` and those before it.

    ``behind``: the lengths by which each node, or what it depends on, is divided. ``share(j, i)``: s where |node i| is
    at most s times the length of ``j``. ``effective``: how far nodes count.
    """

    @property
    def nodes(self) -> Sequence[Any]: ...
    @property
    def inputs(self) -> Mapping[str, Interval]: ...
    @property
    def boxes(self) -> int: ...
    @property
    def form(self) -> Any: ...
    @property
    def library(self) -> Any: ...
    @property
    def ranges(self) -> Sequence[Interval]: ...
    @property
    def away(self) -> Sequence[Array]: ...
    @property
    def noisy(self) -> Sequence[bool]: ...
    @property
    def lengths(self) -> Collection[int]: ...
    @property
    def behind(self) -> Sequence[frozenset[int]]: ...
    @property
    def effective(self) -> Mapping[int, tuple[float, float]]: ...

    def alarm(self, i: int, what: str, where: Any) -> None: ...
    def rounded(self, value: Interval, i: int) -> Noise: ...
    def library_noise(self, op: Any, value: Interval) -> Noise: ...
    def errors(self, roots: Sequence[int]) -> Any: ...
    def constant(self, value: Exact) -> tuple[float, float, float, bool]: ...
    def decided(self, k: int) -> Array: ...
    def cancelled(self, a: int, b: int, sign: int, value: Interval) -> Interval: ...
    def near_zero(self, i: int, divisor: int) -> None: ...
    def vanishes(self, i: int, divisor: int) -> bool: ...
    def counting(self, k: int) -> Interval: ...
    def quotient_by_length(self, i: int, a: int, b: int) -> Value: ...
    def direction(self, i: int) -> Array: ...
    def measured(self, j: int) -> Any: ...
    def share(self, j: int, i: int) -> float | None: ...
    def root_of_squares(self, i: int, a: int) -> Value | None: ...
    def branch(self, small: int, large: int, value: int) -> tuple[Array, Array, Array]: ...


# ---- what follows from intervals and derivatives


def by_slopes(op: Any) -> Callable[..., Value]:
    """The lemma of an operation that is smooth enough: derivatives in intervals, one rounding."""

    def lemma(w: Walk, i: int, *args: int) -> Value:
        ranges = [w.ranges[k] for k in args]
        value = op.interval(*ranges)
        partials = (Partial(k, slope) for k, slope in zip(args, op.slopes(*ranges), strict=True))
        noise = w.rounded(value, i) if op.rounds and not op.ulps else None
        return Value(value, tuple(partials), w.library_noise(op, value) if op.ulps else noise)

    return lemma


def from_slopes(op: Any) -> Callable[..., Bounded]:
    """The running error of such an operation, by the mean value theorem."""

    def running(unit: Array, *args: Bounded) -> Bounded:
        value = op.many(*(a.value for a in args))
        slopes = op.slopes(*(iv.outward(a.value - a.error, a.value + a.error) for a in args))
        moved = (iv.magnitude(s) * a.error for s, a in zip(slopes, args, strict=True))
        error = np.sum(list(moved), axis=0)
        if op.ulps:
            return Bounded(value, error + 2 * op.ulps * unit * np.abs(value))
        return rounded(value, error, unit) if op.rounds else Bounded(value, error)

    return running
