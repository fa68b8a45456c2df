"""One lemma per operation: its range, its derivatives, and the rounding error of its result.

Each says, for arguments anywhere in their ranges, where the exact result lies, how much it moves with each argument
(`Partial`) and how far the float result is from the exact one of the same arguments (`Noise`).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from wmrgen.bounds import interval as iv
from wmrgen.bounds.forms import combined
from wmrgen.bounds.interval import Array, Interval
from wmrgen.bounds.lengths import MOVED, facts, lost, share
from wmrgen.bounds.precision import constant
from wmrgen.bounds.shapes import extremum, size_of, terms_below_root
from wmrgen.bounds.slopes import Partial
from wmrgen.bounds.walk import Lemma, Noise, Value, Walk
from wmrgen.ir.nodes import Node, Op

_SINGULAR = 1e-6  # of its largest value: a divisor below that may as well be zero
_ROOM = 1.1  # of a quotient by a length that underflow may shorten, on the way from no rounding to all


def _const(w: Walk, i: int, node: Node) -> Value:
    """A constant is off by its own rounding."""
    assert node.value is not None
    lo, hi, error, _ = constant(node.value, w.form.name)
    value = np.full(w.boxes, lo), np.full(w.boxes, hi)
    return Value(value, noise=Noise(np.full(w.boxes, error)) if error else None)


def _input(w: Walk, i: int, node: Node) -> Value:
    return Value(w.inputs[node.name or ""])


def _sum(w: Walk, i: int, node: Node) -> Value:
    """d(a + b) = da + db, one rounding; terms that both have count together."""
    a, b = node.args
    sign = 1 if node.op is Op.ADD else -1
    value = (iv.plus if sign > 0 else iv.minus)(w.ranges[a], w.ranges[b])
    if w.forms.overlap(a, b):
        form = combined(w.forms.list[a], w.forms.list[b], sign)
        value = value if form is None else iv.meet(value, w.forms.range(form, w.ranges))
    return Value(value, (Partial(a, 1), Partial(b, sign)), w.rounded(value, i, 2.0 if i in w.twice else 1.0))


def _mul(w: Walk, i: int, node: Node) -> Value:
    """d(a b) = b da + a db, one rounding; none where one is a power of two."""
    a, b = node.args
    x, y = w.ranges[a], w.ranges[b]
    partials: tuple[Partial, ...] = (Partial(a, y, like=b), Partial(b, x, like=a))
    if a == b:
        partials = (Partial(a, (2 * x[0], 2 * x[1]), like=a, times=2.0),)
    value = iv.square(x) if a == b else iv.times(x, y)
    noise = w.rounded(value, i)
    if any(_exact_factor(w, k) for k in node.args):
        noise = Noise(np.zeros(w.boxes))
    noise = Noise(noise.size + w.form.tiny)
    return Value(value, partials, noise, w.away[a] * w.away[b] * (1 - 1e-15))


def _exact_factor(w: Walk, k: int) -> bool:
    """Whether products with node ``k`` are exact: a power of two, a whole number of at most two."""
    value = w.nodes[k].value
    if value is not None:
        _, _, error, power = constant(value, w.form.name)
        return power and not error
    return w.nodes[k].op is Op.RINT and bool(np.all(iv.magnitude(w.ranges[k]) <= 2.0))


def _div(w: Walk, i: int, node: Node) -> Value:
    """d(a / b) = (da - (a / b) db) / b, one rounding."""
    if i in w.lengths:
        return _div_by_length(w, i, node)
    a, b = node.args
    away, below = w.away[b], w.ranges[b]
    holds = (below[0] <= 0) & (below[1] >= 0)
    w.alarm(i, "the divisor may be zero", holds & (away <= 0))
    if np.any(away < _SINGULAR * iv.magnitude(below).max()):
        w.singular.add(i)
    inverse, most = iv.reciprocal(below), np.nextafter(1.0 / away, np.inf)
    inverse = np.where(holds, -most, inverse[0]), np.where(holds, most, inverse[1])
    value = iv.times(w.ranges[a], inverse)
    partials = Partial(a, inverse), Partial(b, iv.negative(iv.times(value, inverse)))
    noise = w.rounded(value, i)
    return Value(value, partials, Noise(noise.size + w.form.tiny))


def _div_by_length(w: Walk, i: int, node: Node) -> Value:
    """n / d with d no smaller than the length h of a vector: d(n / d) is at most (|dn| + |n / d| |dd|) / h."""
    a, b = node.args
    length, below = w.measured(i), w.ranges[b]
    least = below[0]
    reach = iv.magnitude(w.ranges[a]) / least
    ratio = share(w, length, a)
    if ratio is not None:
        reach = np.minimum(reach, (ratio[0] + (ratio[0] * lost(length.parts) + ratio[1]) / least) * _ROOM)
    value = -reach, reach
    ends = w.effective.get(i, (-np.inf, np.inf))
    most = np.minimum(reach, max(map(abs, ends)))
    if len(length.parts) == 1 and np.isfinite(most).all():
        # Where a limit that the quotient meets does not take its place, |n| is no larger than the limit times h.
        limit = float(most.max()) * length.parts[0][0] * (1 + 1e-5)
        length.facts += [fact for k in _alike(w, a) for fact in facts(w.nodes, k, limit)]
        length.shares.clear()
    partials = (
        Partial(a, value, length=i, steep=np.full(w.boxes, MOVED)),
        Partial(b, value, length=i, steep=most * MOVED),
    )
    noise = w.rounded(value, i)
    return Value(value, partials, Noise(noise.size + w.form.tiny))


def _alike(w: Walk, k: int) -> list[int]:
    """Node ``k``, and those of which it is one or the other where they are opposite."""
    node = w.nodes[k]
    if node.op is Op.SELECT:
        x, y = node.args[2:]
        if w.forms.list[x].proportional(w.forms.list[y]) == -1:
            return [k, x, y]
    return [k]


def _neg(w: Walk, i: int, node: Node) -> Value:
    a = node.args[0]
    return Value(iv.negative(w.ranges[a]), (Partial(a, -1),), away=w.away[a])


def _abs(w: Walk, i: int, node: Node) -> Value:
    a = node.args[0]
    x, away = w.ranges[a], w.away[a]
    sign = np.where(x[0] >= 0, 1.0, -1.0), np.where(x[1] <= 0, -1.0, 1.0)
    least, most = iv.absolute(x)
    return Value((np.maximum(least, away), most), (Partial(a, sign),), away=away)


def _extremum(w: Walk, i: int, node: Node) -> Value:
    """The smaller or the larger moves with one of the two, and no further than it."""
    limit = extremum(w.nodes, node)
    assert limit is not None
    op, a, b = limit
    x, y = w.ranges[a], w.ranges[b]
    choose = np.minimum if op is Op.MIN else np.maximum
    value = choose(x[0], y[0]), choose(x[1], y[1])
    first, second = (x, y) if op is Op.MIN else (y, x)  # a where first < second
    away = np.minimum(w.away[a], w.away[b])
    return _chosen(w, value, away, {a: _taken(first, second), b: _taken(second, first)})


def _chosen(w: Walk, value: Interval, away: Array, taken_by: Mapping[int, Interval]) -> Value:
    """One of two values is off by no more than the one that is off more. ``taken_by``: derivatives, by value."""
    counting = [k for k, (_, most) in taken_by.items() if np.any(most) and w.noisy[k]]
    if len(counting) < 2:
        return Value(value, tuple(Partial(k, taken_by[k]) for k in counting), away=away)
    errors = w.errors(counting)
    taken = np.array([taken_by[k][1] for k in counting])
    over = {j: (o * taken).max(axis=0) for j, o in errors.over.items()}
    noise = Noise((errors.plain * taken).max(axis=0), over, frozenset[int]().union(*errors.divisions))
    return Value(value, (), noise, away, widen=False)


def _taken(small: Interval, large: Interval) -> Interval:
    """The derivative in what is chosen where small < large."""
    always, never = small[1] < large[0], small[0] > large[1]
    return np.where(always, 1.0, 0.0), np.where(never, 0.0, 1.0)


def _root(w: Walk, i: int, node: Node) -> Value:
    """The root of a sum of squares moves by no more than the length of the errors of what is squared."""
    a = node.args[0]
    below = w.ranges[a]
    value = iv.root(below)
    terms = terms_below_root(w.nodes, a)
    if not all(t.squared for t in terms):
        w.alarm(i, "the root's argument may be negative", below[0] < 0)
        steep = iv.reciprocal((2 * value[0], 2 * value[1]))
        noise = w.rounded(value, i)
        return Value(value, (Partial(a, (np.maximum(steep[0], 0.0), steep[1])),), noise)
    factors = np.array([[float(t.factor)] for t in terms])
    bases = [t.base for t in terms]
    longest = np.sqrt(sum(f * iv.magnitude(w.ranges[k]) ** 2 for f, k in zip(factors, bases, strict=True)))
    value = iv.meet(value, (np.zeros(w.boxes), longest * (1 + 1e-5) + w.form.tiny**0.5))
    errors = w.errors(bases)
    moved = np.sqrt((factors * errors.plain**2).sum(axis=0)) * iv.GROW
    over = {j: np.sqrt((factors * o**2).sum(axis=0)) * iv.GROW for j, o in errors.over.items()}
    # A term passes this many roundings on its way into the sum, each a relative error of the sum at most.
    own = max(t.roundings for t in terms) * w.form.unit / 2 * (1 + 1e-5) * value[1]
    rounded = w.rounded(value, i).size + own + np.sqrt(2 * len(terms) * w.form.tiny)
    noise = Noise(rounded + moved, over, frozenset[int]().union(*errors.divisions))
    widened = iv.widened(value, rounded)
    return Value((np.maximum(widened[0], 0.0), widened[1]), (), noise, widen=False)


def _within(w: Walk, i: int, x: Interval, most: float, unit: str) -> None:
    """An alarm where a library function is not known to be right."""
    w.alarm(i, f"its argument may exceed {most:g} {unit}".rstrip(), iv.magnitude(x) > most)


def _wave(w: Walk, i: int, node: Node) -> Value:
    """d sin x = cos x dx, d cos x = -sin x dx."""
    a = node.args[0]
    x = w.ranges[a]
    _within(w, i, x, w.library.reach, "rad")
    sine, cosine = iv.sine(x), iv.cosine(x)
    value, steep = (sine, cosine) if node.op is Op.SIN else (cosine, iv.negative(sine))
    return Value(value, (Partial(a, steep),), w.library_noise(node.op, value))


def _atan2(w: Walk, i: int, node: Node) -> Value:
    """The error of a vector of length h turns it by at most that over h."""
    w.measured(i)
    y, x = (w.ranges[k] for k in node.args)
    value = iv.arctangent(y, x)
    noise = w.library_noise(Op.ATAN2, value)
    wraps = x[0] < 0 if w.nodes[node.args[1]].op is Op.ABS else x[0] <= 0  # a zero that is no size may be -0
    if np.any(wraps):  # a full turn off is no error of the angle, but one of the number
        value = iv.hull(value, (np.full(w.boxes, -np.pi - 1e-9), np.full(w.boxes, np.pi + 1e-9)))
        noise = Noise(noise.size + 2 * np.pi)
    steep = np.full(w.boxes, MOVED)
    return Value(value, tuple(Partial(k, value, length=i, steep=steep) for k in node.args), noise)


def _atan(w: Walk, i: int, node: Node) -> Value:
    """d atan x = dx / (1 + x x)."""
    a = node.args[0]
    x = w.ranges[a]
    if a not in w.lengths:  # the slope of a line is at most 1
        _within(w, i, x, w.library.slope, "")
    value = iv.widened((np.arctan(x[0]), np.arctan(x[1])), np.full(w.boxes, 1e-15))
    square = iv.square(x)
    steep = iv.reciprocal((1 + square[0], 1 + square[1]))
    return Value(value, (Partial(a, steep),), w.library_noise(node.op, value))


def _rint(w: Walk, i: int, node: Node) -> Value:
    """A whole number, decided as the float program decides it."""
    x = w.ranges[node.args[0]]
    w.alarm(i, "too large to be rounded to a whole number", iv.magnitude(x) > 2.0 ** (w.form.bits - 2))
    return Value((np.rint(x[0]), np.rint(x[1])), decided=w.claimed(w.errors(node.args))[0])


def _flip(w: Walk, i: int, node: Node) -> Value:
    """flip(a, n): a or -a, decided by the whole number n."""
    a = node.args[0]
    one = np.ones(w.boxes)
    return Value(iv.hull(w.ranges[a], iv.negative(w.ranges[a])), (Partial(a, (-one, one)),), away=w.away[a])


def _select(w: Walk, i: int, node: Node) -> Value:
    """One value or the other, as the float program decides; on either side the comparison is known to hold."""
    if extremum(w.nodes, node) is not None:
        return _extremum(w, i, node)
    a, b, x, y = node.args
    small, large = w.ranges[a], w.ranges[b]
    first, second = _branch(w, i, a, b, x), _branch(w, i, b, a, y)
    always, never = small[1] < large[0], small[0] > large[1]
    lo, hi, away = (
        np.where(always, p, np.where(never, q, choose(p, q)))
        for p, q, choose in zip(first, second, (np.minimum, np.maximum, np.minimum), strict=True)
    )
    taken = (
        {x: _taken(small, large), y: _taken(large, small)}
        if x != y
        else {x: (np.ones(w.boxes), np.ones(w.boxes))}
    )
    return _chosen(w, (lo, hi), away, taken)


def _branch(w: Walk, i: int, small: int, large: int, value: int) -> tuple[Array, Array, Array]:
    """(low, high, distance from zero) of a branch of node ``i``, given small <= large there up to their errors."""
    interval, away = w.ranges[value], w.away[value]
    far = np.full(w.boxes, np.inf)
    if value in (small, large):
        slack = w.errors([small, large]).total.sum(axis=0)
        if value == large:
            interval = iv.meet(interval, (w.ranges[small][0] - slack, far))
        else:
            interval = iv.meet(interval, (-far, w.ranges[large][1] + slack))
    size = size_of(w.nodes, large, value)
    if size is not None:
        scale, squared = size
        # At most sixteen roundings separate the size from the value that it is the size of.
        least = np.maximum(w.ranges[small][0] - 16 * w.form.tiny, 0.0) / scale
        least = (np.sqrt(least) if squared else least) * (1 - 32 * w.form.unit)
        exact = least - 2 * w.errors([value]).total[0]
        if np.any((exact < least / 2) & (away < least)):
            # What the guard keeps from zero in floats may be zero without rounding: the formula is singular there.
            w.singular.add(i)
            exact = least
        away = np.maximum(away, exact)
    return interval[0], interval[1], np.maximum(away, iv.smallest(interval))


LEMMAS: dict[Op, Lemma] = {
    Op.CONST: _const, Op.INPUT: _input, Op.ADD: _sum, Op.SUB: _sum, Op.MUL: _mul, Op.DIV: _div, Op.NEG: _neg,
    Op.ABS: _abs, Op.MIN: _extremum, Op.MAX: _extremum, Op.SQRT: _root, Op.SIN: _wave, Op.COS: _wave,
    Op.ATAN: _atan, Op.ATAN2: _atan2, Op.SELECT: _select, Op.RINT: _rint, Op.FLIP: _flip,
}  # fmt: skip
