"""What each operation does to range, slope and rounding error (see `wmrgen.bounds.analysis` for the model)."""

from __future__ import annotations

from functools import reduce

import numpy as np

from wmrgen.bounds import interval as iv
from wmrgen.bounds import slopes as sl
from wmrgen.bounds.analysis import Pass, Rule
from wmrgen.bounds.gram import cauchy
from wmrgen.bounds.interval import Array, Interval
from wmrgen.bounds.leaning import left, turned_by
from wmrgen.bounds.norms import length, lengths
from wmrgen.bounds.patterns import (
    Term,
    extremum,
    inverted,
    nearest_turn,
    parity,
    sinc_argument,
    size_of,
    terms_below_root,
)
from wmrgen.bounds.pieces import turns
from wmrgen.bounds.precision import constant
from wmrgen.bounds.records import Value
from wmrgen.ir.nodes import Node, Op

_SINC_LEAST, _SINC_SLOPE = -0.2173, 0.4363  # of sin(x)/x: its minimum, its greatest slope


def _const(p: Pass, i: int, node: Node) -> Value:
    assert node.value is not None
    lo, hi, error, _ = constant(node.value, p.form.name)
    value = np.full(p.boxes, lo), np.full(p.boxes, hi)
    return Value(value, noise=np.full(p.boxes, error) if error else None)


def _input(p: Pass, i: int, node: Node) -> Value:
    return Value(p.inputs[node.name or ""])


def _sum(p: Pass, i: int, node: Node) -> Value:
    a, b = node.args
    sign = 1 if node.op is Op.ADD else -1
    if parity(p.nodes, node):
        return Value((np.full(p.boxes, -1.0), np.full(p.boxes, 1.0)))
    value = p.cut((iv.plus if sign > 0 else iv.minus)(p.range(a), p.range(b)), node.op, a, b)
    slope = p.sum_slope(a, b, sign)
    rest = left(p, node, value)
    if rest is not None:
        value, slope = rest
    squares = terms_below_root(p.nodes, i) if sign > 0 else ()
    if len(squares) > 1 and all(t.squared for t in squares):
        size = lengths(p, [(float(t.factor), t.base) for t in squares])
        if size is not None:
            room = (max(t.roundings for t in squares) + 2) * p.form.unit
            low, high = size[0] ** 2 * (1 - room), size[1] ** 2 * (1 + room)
            value = iv.meet(value, iv.widened((low, high), np.full(p.boxes, 2 * len(squares) * p.form.tiny)))
    inside = p.circles.around(node) if i in p.divisors else None
    value = value if inside is None else iv.meet(value, inside)
    turn = nearest_turn(p.nodes, node)
    if turn is not None:
        step, x, present, steps = turn
        half = float(step) * (0.5 + p.error(steps)) + 1e-8 * (1 + iv.magnitude(p.range(x)))
        value = iv.meet(value, iv.widened(p.range(present), half))
    return Value(value, slope, p.rounding(value) * (2.0 if i in p.twice else 1.0))


def _power_of_two(p: Pass, k: int) -> bool:
    value = p.nodes[k].value
    if value is None:
        return False
    _, _, error, power = constant(value, p.form.name)
    return power and not error


def _mul(p: Pass, i: int, node: Node) -> Value:
    a, b = node.args
    angle = sinc_argument(p.nodes, node)
    if angle is not None:
        return _sinc(p, angle)
    quotient = _by_inverse(p, node)
    if quotient is not None:
        return quotient
    x, y = p.range(a), p.range(b)
    if a == b:
        value = iv.square(x)
        slope = sl.times(p.slope(a), (2 * x[0], 2 * x[1]))
    else:
        value = iv.times(x, y)
        slope = p.product_slope(a, b)
    value = turned_by(p, i, value)
    value = p.cut(value, Op.MUL, a, b)
    noise = np.full(p.boxes, p.form.tiny)
    if not any(_power_of_two(p, k) or _small_whole(p, k) for k in node.args):
        noise = noise + p.rounding(value)
    return Value(value, slope, noise, p.away(a) * p.away(b) * (1 - 1e-15))


def _by_inverse(p: Pass, node: Node) -> Value | None:
    """N (1/D) as a quotient: the slope of D counts times N/D, which is often far less than N times 1/D."""
    for above, inverse in (node.args, node.args[::-1]):
        below = inverted(p.nodes, inverse)
        if below is not None and not p.shared(above, inverse):
            value = iv.times(p.range(above), p.range(inverse))
            most = cauchy(p, above, below)
            if most is not None:
                value = iv.meet(value, (-most, most))
            value = p.cut(value, Op.DIV, above, below, p.range(inverse))
            slope = sl.plus(p.slope(above), sl.times(p.slope(below), value), -1)
            own = p.rounding(value) + iv.magnitude(value) * p.form.unit * (1 + 1e-6)
            return Value(value, sl.times(slope, p.range(inverse)), own + 2 * p.form.tiny)
    return None


def _small_whole(p: Pass, k: int) -> bool:
    """Whether node ``k`` is a whole number of at most two."""
    return p.nodes[k].op.value == "rint" and bool(np.all(iv.magnitude(p.range(k)) <= 2.0))


def _sinc(p: Pass, angle: int) -> Value:
    """sin(x) (1/x): three relative errors, and a slope of at most 0.4363 in x."""
    steep = np.full(p.boxes, _SINC_SLOPE)
    value = np.full(p.boxes, _SINC_LEAST), np.ones(p.boxes)
    relative = (2 * max(p.library.sin, p.library.sine) + 2.0) * p.form.unit * (1 + 1e-6)
    noise = np.full(p.boxes, relative + p.form.tiny)
    return Value(value, sl.times(p.slope(angle), (-steep, steep)), noise)


def _div(p: Pass, i: int, node: Node) -> Value:
    a, b = node.args
    if i in p.quotients:
        # The shape shows that the divisor is no smaller than the length, or than ``least``; neither is zero.
        direction = p.quotients[i]
        reach = iv.magnitude(p.range(a)) / (direction.least or 1.0)
        if direction.size is not None:
            reach = np.full(p.boxes, direction.reach)
        return Value((-reach, reach))
    angle = sinc_argument(p.nodes, node)
    away, below = p.away(b), p.range(b)
    holds = (below[0] <= 0) & (below[1] >= 0)
    p.alarm(i, "the divisor may be zero", holds & (away <= 0))
    if angle is not None:
        return _sinc(p, angle)
    inverse, most = iv.reciprocal(below), np.nextafter(1.0 / away, np.inf)
    inverse = np.where(holds, -most, inverse[0]), np.where(holds, most, inverse[1])
    value = iv.times(p.range(a), inverse)
    most_of_all = cauchy(p, a, b)
    if most_of_all is not None:
        value = iv.meet(value, (-most_of_all, most_of_all))
    value = p.cut(value, Op.DIV, a, b, inverse)
    slope = sl.times(sl.plus(p.slope(a), sl.times(p.slope(b), value), -1), inverse)
    return Value(value, slope, p.rounding(value) + p.form.tiny)


def _neg(p: Pass, i: int, node: Node) -> Value:
    a = node.args[0]
    return Value(iv.negative(p.range(a)), sl.negative(p.slope(a)), away=p.away(a))


def _abs(p: Pass, i: int, node: Node) -> Value:
    a = node.args[0]
    x, away = p.range(a), p.away(a)
    sign = np.where(x[0] >= 0, 1.0, -1.0), np.where(x[1] <= 0, -1.0, 1.0)
    least, most = iv.absolute(x)
    return Value((np.maximum(least, away), most), sl.times(p.slope(a), sign), away=away)


def _extremum(p: Pass, i: int, node: Node) -> Value:
    found = extremum(p.nodes, node)
    assert found is not None
    op, a, b = found
    x, y = p.range(a), p.range(b)
    choose = np.minimum if op is Op.MIN else np.maximum
    small, large = (x, y) if op is Op.MIN else (y, x)  # a is chosen where small < large
    value = choose(x[0], y[0]), choose(x[1], y[1])
    away = np.minimum(p.away(a), p.away(b))
    direction = p.directions.get(i)
    if direction is not None and direction.quotient is not None:
        noise = np.full(p.boxes, direction.roundings * p.form.unit * (1 + 1e-6) + p.form.tiny)
        p.result.decisions.append(i)
        return Value(value, p.turned(i, direction), noise, away)
    slope = sl.choice(small, large, p.slope(a), p.slope(b))
    return Value(value, slope, away=away)


def _root(p: Pass, i: int, node: Node) -> Value:
    """A square root; of a sum of squares the norm of a vector, whose slope is at most that of the vector."""
    a = node.args[0]
    below = p.range(a)
    value = iv.root(below)
    terms = terms_below_root(p.nodes, a)
    if any(np.any(p.range(t.base)[0] < 0) for t in terms if not t.squared):
        p.alarm(i, "the root's argument may be negative", below[0] < 0)
        terms = (Term.whole(a),)
    elif all(t.squared for t in terms):
        most = length(p, [(float(t.factor), t.base) for t in terms]) * (1 + 1e-5) + p.form.tiny**0.5
        value = iv.meet(value, (np.zeros(p.boxes), most))
    inverse = iv.reciprocal((2 * value[0], 2 * value[1]))
    squares = [t for t in terms if t.squared]
    if len(squares) == len(terms):
        slope, from_parts = p.lengthened(squares)
    else:
        slope, from_parts = sl.norm([(float(t.factor), p.slope(t.base)) for t in squares]), np.zeros(p.boxes)
    for t in terms:
        if not t.squared:
            factor = float(t.factor)
            slope = sl.plus(slope, sl.times(p.slope(t.base), (inverse[0] * factor, inverse[1] * factor)))
    # A term passes this many roundings on its way into the sum, each a relative error of the sum at most.
    most = max(t.roundings for t in terms)
    own = most * p.form.unit / 2 * (1 + 1e-5) * value[1]
    lost = np.sqrt(2 * len(terms) * p.form.tiny) if squares else 0.0
    noise = p.rounding(value) + own + lost + from_parts
    # The root of a float is no float below 0: the range is not widened beyond.
    return Value((np.maximum(value[0], noise), value[1]), slope, noise)


def _within(p: Pass, i: int, x: Interval, most: float, unit: str) -> None:
    """An alarm where a library function is not known to be right."""
    p.alarm(i, f"its argument may exceed {most:g} {unit}".rstrip(), iv.magnitude(x) > most)


def _wave(p: Pass, i: int, node: Node) -> Value:
    a = node.args[0]
    x = p.range(a)
    _within(p, i, x, p.library.reach, "rad")
    sine, cosine = _sine_and_cosine(p, a, x)
    value = sine if node.op is Op.SIN else cosine
    slope = sl.times(p.slope(a), cosine if node.op is Op.SIN else iv.negative(sine))
    return Value(value, slope, p.library_noise(node.op, value))


def _sine_and_cosine(p: Pass, a: int, x: Interval) -> tuple[Interval, Interval]:
    """Ranges of sine and cosine of node ``a``, which lies in ``x``; of each piece apart where it lies in some."""
    pieces = turns(p, a)
    if pieces is None:
        return iv.sine(x), iv.cosine(x)
    wide = [iv.widened(piece, p.error(a)) for piece in pieces]  # as computed, and as the formula has it
    return reduce(iv.hull, map(iv.sine, wide)), reduce(iv.hull, map(iv.cosine, wide))


def _atan2(p: Pass, i: int, node: Node) -> Value:
    """The error of the vector turns it; rounding makes another error."""
    y, x = (p.range(k) for k in node.args)
    value = iv.arctangent(y, x)
    noise = p.library_noise(Op.ATAN2, value)
    wraps = x[0] < 0 if p.nodes[node.args[1]].op is Op.ABS else x[0] <= 0  # a zero that is no size may be -0
    if np.any(wraps):  # a full turn off is no error of the angle, but one of the number
        value = iv.hull(value, (np.full(p.boxes, -np.pi - 1e-9), np.full(p.boxes, np.pi + 1e-9)))
        noise = noise + 2 * np.pi
    return Value(value, p.turned(i, p.directions[i]), noise)


def _atan(p: Pass, i: int, node: Node) -> Value:
    a = node.args[0]
    x = p.range(a)
    value = iv.widened((np.arctan(x[0]), np.arctan(x[1])), np.full(p.boxes, 1e-15))
    noise = p.library_noise(node.op, value)
    direction = p.directions.get(i)
    if direction is not None:
        # Half the angle of a vector is below pi/4, but where its length squared underflows: no error is claimed there.
        noise = p.library_noise(node.op, (-np.full(p.boxes, 0.7855), np.full(p.boxes, 0.7855)))
        own = direction.roundings * p.form.unit * (1 + 1e-5)
        return Value(value, p.turned(i, direction), noise + own)
    _within(p, i, x, p.library.slope, "")
    square = iv.square(x)
    steep = iv.reciprocal((1 + square[0], 1 + square[1]))
    return Value(value, sl.times(p.slope(a), steep), noise)


def _rint(p: Pass, i: int, node: Node) -> Value:
    """A whole number, decided as the float program decides it."""
    x = p.range(node.args[0])
    too_large = iv.magnitude(x) > 2.0 ** (p.form.bits - 2)
    p.alarm(i, "too large to be rounded to a whole number", too_large)
    p.result.decisions.append(i)
    return Value((np.rint(x[0]), np.rint(x[1])))


def _flip(p: Pass, i: int, node: Node) -> Value:
    """flip(a, n): a or -a, decided by the whole number n."""
    a = node.args[0]
    slope = p.slope(a)
    opposite = sl.negative(slope)
    if slope is not None and opposite is not None:
        slope = np.minimum(slope[0], opposite[0]), np.maximum(slope[1], opposite[1])
    return Value(iv.hull(p.range(a), iv.negative(p.range(a))), slope, away=p.away(a))


def _select(p: Pass, i: int, node: Node) -> Value:
    if extremum(p.nodes, node) is not None:
        return _extremum(p, i, node)
    a, b, x, y = node.args
    small, large = p.range(a), p.range(b)
    p.result.decisions.append(i)
    first, first_away = _branch(p, a, b, x)
    second, second_away = _branch(p, b, a, y)
    always, never = small[1] < large[0], small[0] > large[1]
    lo = sl.chosen(always, never, first[0], second[0], np.minimum(first[0], second[0]))
    hi = sl.chosen(always, never, first[1], second[1], np.maximum(first[1], second[1]))
    away = sl.chosen(always, never, first_away, second_away, np.minimum(first_away, second_away))
    return Value((lo, hi), sl.choice(small, large, p.slope(x), p.slope(y)), away=away)


def _branch(p: Pass, small: int, large: int, value: int) -> tuple[Interval, Array]:
    """Range of a branch and its distance from zero, given small <= large there up to their errors."""
    found, away = p.range(value), p.away(value)
    far = np.full(p.boxes, np.inf)
    slack = p.error(small) + p.error(large) if value in (small, large) else far
    if value == large:
        found = iv.meet(found, (p.range(small)[0] - slack, far))
    elif value == small:
        found = iv.meet(found, (-far, p.range(large)[1] + slack))
    size = size_of(p.nodes, large, value)
    if size is not None:
        scale, squared = size
        # At most sixteen roundings separate the size from the value that it is the size of.
        least = np.maximum(p.range(small)[0] - 16 * p.form.tiny, 0.0) / scale
        least = (np.sqrt(least) if squared else least) * (1 - 32 * p.form.unit)
        away = np.maximum(away, least - 2 * p.error(value))
    return found, np.maximum(away, iv.smallest(found))


RULES: dict[str, Rule] = {
    "const": _const, "input": _input, "add": _sum, "sub": _sum, "mul": _mul, "div": _div, "neg": _neg, "abs": _abs,
    "min": _extremum, "max": _extremum, "sqrt": _root, "sin": _wave, "cos": _wave, "atan": _atan, "atan2": _atan2,
    "select": _select, "rint": _rint, "flip": _flip,
}  # fmt: skip
