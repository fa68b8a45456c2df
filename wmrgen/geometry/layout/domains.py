"""Check that the geometry exists for every value that tunable parameters may have.

The conditions are: no root of a negative number, and no divisor, radius or castor offset that is 0. Each condition is
about an expression in the parameters, which `wmrgen.geometry.layout.boxes` examines over the box of their ranges. A
file is rejected if a point violates a condition. If a condition is neither proved nor refuted the file is accepted,
because `prepare_checked` tests the values at run time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from wmrgen.errors import ErrorCollector, Mark, RobotFileError
from wmrgen.geometry.exact.evaluate import fix, number, substituted
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.boxes import HOLDS, Box, Point, Search, Verdict, apart
from wmrgen.geometry.layout.expressions import Scope, to_poly
from wmrgen.geometry.layout.records import Need, Parameter
from wmrgen.robotfile.records import (
    Binary,
    Call,
    Expr,
    Neg,
    Num,
    Param,
    ParameterSpec,
    Quantity,
    RobotSpec,
    WheelSpec,
    children,
    parameters_in,
)
from wmrgen.robotfile.wheel_types import WHEEL_TYPES

_SHRUNK = (2, 5, 10, 20, 50, 100)  # a message proposes a range divided by the first of these that works
_ROUNDS = 14  # halvings of boxes: 4,096 of them in two dimensions have sides of 1/64
_WORK = 20_000  # limit of rounds times nodes times slopes over all conditions of a file: a few seconds
_PROPOSED = 40  # conditions: with more, no narrower ranges are searched, which would take too long
_HALVINGS = 24  # bisection steps, more than the six digits of a message need


class Condition(NamedTuple):
    """A condition on an expression of the robot file, without which the robot has no geometry."""

    value: Expr  # must keep its sign (if `strict`), or must not be negative
    strict: bool
    problem: str  # what is wrong if the condition does not hold
    quantity: Quantity  # where the expression is in the robot file
    other: Expr | None = None  # if given, `value` and `other` must not both be 0, and their signs are free

    @property
    def values(self) -> tuple[Expr, ...]:
        """The value, or both values."""
        return (self.value,) if self.other is None else (self.value, self.other)


def conditions(spec: RobotSpec) -> Iterator[Condition]:
    """Yield every condition of a file: parts of an expression first, then the whole; parameters before their users."""
    for quantity in _quantities((spec.parameters, *(getattr(spec, f.name) for f in fields(spec)))):
        yield from _conditions_of_expression(quantity.expr, quantity)
    for wheel in spec.wheels:
        yield from _conditions_of_wheel(wheel)
    for trailer in spec.trailers:
        yield Condition(
            trailer.length.expr, True, f"the length of {trailer.name} is not positive", trailer.length
        )
    if spec.effective_track is not None:
        track = spec.effective_track
        yield Condition(track.expr, True, "effective_track is not positive", track)


def _quantities(part: Any) -> Iterator[Quantity]:
    """Yield the quantities in a record of the robot file, in the order of its fields."""
    if isinstance(part, Quantity):
        yield part
    elif isinstance(part, tuple):
        for item in part:
            yield from _quantities(item)
    elif is_dataclass(part):
        for field in fields(part):
            yield from _quantities(getattr(part, field.name))


def _conditions_of_expression(expr: Expr, quantity: Quantity) -> Iterator[Condition]:
    for child in children(expr):
        yield from _conditions_of_expression(child, quantity)
    match expr:
        case Call("sqrt", (arg,)):
            yield Condition(arg, False, "square root of a negative number", quantity)
        case Call("tan", (arg,)):
            yield Condition(Call("cos", (arg,)), True, "the tangent of a quarter turn has no value", quantity)
        case Call("atan2", (y, x)):
            yield Condition(y, True, "atan2(0, 0) has no value", quantity, x)
        case Binary("/", _, below):
            yield Condition(below, True, "division by zero", quantity)
        case Binary("**", base, Num(power)) if power < 0:
            yield Condition(base, True, "division by zero", quantity)


def _conditions_of_wheel(w: WheelSpec) -> Iterator[Condition]:
    kind = WHEEL_TYPES[w.type]
    what = f"the {kind.noun} {w.name}"
    if w.r is not None and "r" in kind.required:
        yield Condition(w.r.expr, True, f"the radius of {what} is not positive", w.r)
    if w.d is not None and kind.swivels:
        yield Condition(w.d.expr, True, f"the offset d of {what} is 0 or has changed its sign", w.d)
    for check in kind.checks:
        quantity = getattr(w, check.key)
        if quantity is not None and check.keeps_sign:
            value = Call("cos", (quantity.expr,)) if check.keeps_sign == "cosine" else quantity.expr
            problem = f"{check.key} of {what} is {'a quarter turn' if value is not quantity.expr else 'not positive'}"
            yield Condition(value, True, problem, quantity)
    if w.x is not None and w.y is not None and w.beta is not None:
        problem = f"{what} is in the origin, where beta has no direction"
        yield Condition(w.y.expr, True, problem, w.y, w.x.expr)


class _Parameters(NamedTuple):
    """The parameters of a file, which decide whether conditions hold."""

    spec: RobotSpec
    parameters: Mapping[str, Parameter]
    trees: Mapping[str, Expr]  # the expressions of parameters that are not tunable
    total: int = 1  # number of conditions of the file, which share the computing time

    @staticmethod
    def of(spec: RobotSpec, parameters: Iterable[Parameter]) -> _Parameters:
        """Return the parameters of a file in which all have values."""
        trees = {p.name: p.value.expr for p in spec.parameters if not p.tunable}
        return _Parameters(spec, {p.name: p for p in parameters}, trees)

    def tunables_in(self, *exprs: Expr) -> tuple[str, ...]:
        """Return the tunable parameters that expressions depend on, in the order of the file."""
        found, waiting = set[str](), list(exprs)
        while waiting:
            for name in parameters_in(waiting.pop()) - found:
                found.add(name)
                waiting += [self.trees[name]] if name in self.trees else []
        return tuple(name for name, p in self.parameters.items() if name in found and p.tunable)

    def box(self, names: Iterable[str]) -> dict[str, tuple[Exact, Exact]]:
        """Return the ranges of parameters."""
        return {name: (self.parameters[name].low, self.parameters[name].high) for name in names}

    def value(self, expr: Expr, point: Point, mark: Mark) -> Exact | None:
        """Return the exact value of an expression at a point, or None if it has no value there.

        Args:
            expr: The expression.
            point: Values of tunable parameters; the others are nominal.
            mark: The place of the expression in the robot file.

        Returns:
            The value, or None for example for a division by zero.
        """
        values: dict[str, Poly] = {}
        try:
            for p in self.spec.parameters:
                values[p.name] = self._own(p, point, values)
            return number(to_poly(Quantity(expr, "", mark), values), values)
        except (RobotFileError, ZeroDivisionError):
            return None

    def _own(self, p: ParameterSpec, point: Point, values: Mapping[str, Poly]) -> Poly:
        if p.name in point:
            return Poly.of(point[p.name])
        return self.parameters[p.name].value if p.tunable else substituted(to_poly(p.value, values), values)

    def verdict(self, condition: Condition, box: Box | None = None) -> Verdict:
        """Return whether a condition holds on a box, by default the box of the ranges."""
        if condition.other is not None:
            return self._either(condition, box)
        return self._of_one(condition.value, condition.strict, condition.quantity.mark, box)

    def _of_one(self, value: Expr, strict: bool, mark: Mark, box: Box | None) -> Verdict:
        for expr, strictly in self._factors(value, strict):
            names = self.tunables_in(expr)
            verdict = self._keeps_sign(expr, strictly, mark, box or self.box(names))
            if not verdict.proved:
                return verdict
        return HOLDS

    def _factors(self, expr: Expr, strict: bool) -> Iterator[tuple[Expr, bool]]:
        """Yield expressions that imply the condition on ``expr``, each with its strictness.

        An expression must not be 0 (``strict``) if none of its factors is. Otherwise it is checked as a whole.
        """
        match expr:
            case _ if not self.tunables_in(expr):
                return
            case Param(name) if name in self.trees:
                yield from self._factors(self.trees[name], strict)
            case _ if not strict:
                yield expr, False
            case Neg(arg) | Call("sqrt", (arg,)) | Binary("/", arg, _):
                yield from self._factors(arg, True)
            case Binary("**", base, Num(power)):
                yield from self._factors(base, True) if power > 0 else ()
            case Binary("*", left, right):
                yield from self._factors(left, True)
                yield from self._factors(right, True)
            case _:
                yield expr, True

    def _keeps_sign(self, expr: Expr, strict: bool, mark: Mark, box: Box) -> Verdict:
        nominal = self.value(expr, {}, mark)
        sign = -1 if strict and nominal is not None and nominal.sign < 0 else 1

        def wrong(point: Point) -> bool:
            value = self.value(expr, point, mark)
            return value is not None and (value.sign * sign < 0 or (strict and not value))

        names = [name for name in self.tunables_in(expr) if name in box]
        if isinstance(expr, Param) and strict:  # the most frequent case, such as a radius
            fine = all(end.sign == sign for end in box[expr.name])
            return HOLDS if fine else Verdict(False, {expr.name: ZERO})
        rounds = self.rounds(expr)
        with np.errstate(all="ignore"):
            verdict = Search(expr, sign, strict, wrong, names, box, self.trees).run(rounds)
        if strict and verdict.point is not None:
            verdict = Verdict(False, self._boundary(verdict.point, wrong))
        return verdict

    def _boundary(self, point: Point, wrong: Callable[[Point], bool]) -> Point:
        """Return a wrong point near the boundary, by bisection between the nominal parameters and a wrong ``point``."""
        right = {name: self.parameters[name].nominal for name in point}
        for _ in range(_HALVINGS):
            middle = {name: (right[name] + end) / 2 for name, end in point.items()}
            if wrong(middle):
                point = middle
            else:
                right = middle
        return point

    def _either(self, condition: Condition, box: Box | None) -> Verdict:
        """Return whether at least one of two values is not 0 at each point of a box."""
        one, other = condition.value, condition.other
        assert other is not None
        mark = condition.quantity.mark
        pair = [(expr, self.tunables_in(expr)) for expr in (one, other)]
        names = self.tunables_in(one, other)
        whole = {name: (box or self.box(names))[name] for name in names}
        verdicts = []
        for expr, own in pair:
            nominal = self.value(expr, {}, mark)
            if not own or not nominal:
                verdicts.append(HOLDS if nominal else Verdict(False, {}))
            else:
                verdicts.append(self._of_one(expr, True, mark, box))
            if verdicts[-1].proved:
                return HOLDS
        (_, mine), (_, its) = pair
        if set(mine).isdisjoint(its) and all(v.point is not None for v in verdicts):
            return Verdict(False, {**(verdicts[0].point or {}), **(verdicts[1].point or {})})
        with np.errstate(all="ignore"):
            return apart(one, other, whole, self.trees, self.rounds(one, other))

    def rounds(self, *exprs: Expr) -> int:
        """Return the number of halvings for a condition, which is smaller in files with many or large expressions."""
        size = sum(self._size(expr) for expr in exprs) * (1 + len(self.tunables_in(*exprs)))
        return max(1, min(_ROUNDS, _WORK // (size * max(1, self.total))))

    def _size(self, expr: Expr) -> int:
        """Return the number of nodes of an expression, with its parameters written out."""
        size, waiting = 0, [expr]
        while waiting:
            node = waiting.pop()
            size += 1
            waiting += [self.trees[node.name]] if isinstance(node, Param) and node.name in self.trees else []
            waiting += children(node)
        return size


# ---- errors, and conditions for run time


def needs(
    spec: RobotSpec, parameters: tuple[Parameter, ...], scope: Scope, collector: ErrorCollector
) -> tuple[Need, ...]:
    """Return the conditions that tunable parameters must satisfy, as polynomials in them.

    Args:
        spec: The robot file.
        parameters: The parameters of the file, each after those it uses.
        scope: The values of the parameters.
        collector: Collects a RobotFileError for each condition that a point of the ranges violates.

    Returns:
        One record for each condition that depends on a tunable parameter.
    """
    known = _Parameters.of(spec, parameters)
    found: dict[object, Need] = {}
    verdicts: dict[object, Verdict] = {}
    narrower: dict[tuple[str, ...], str] = {}
    every = [d for d in conditions(spec) if known.tunables_in(*d.values)]
    known = known._replace(total=len({(d.values, d.strict) for d in every}))
    for condition in every:
        if any(error.mark == condition.quantity.mark for error in collector.errors):
            continue  # an error in a part of a value implies an error in the whole
        with collector:
            key = condition.values, condition.strict
            verdict = verdicts[key] = verdicts.get(key) or known.verdict(condition)
            if verdict.point is not None:
                names = known.tunables_in(*condition.values)
                narrower[names] = narrower.get(names) or _narrower_ranges(known, names, every)
                raise _violated(known, condition, verdict.point, narrower[names])
        identity = condition.values, condition.strict, condition.problem
        if identity not in found:
            found[identity] = _need(condition, scope)
    return tuple(found.values())


def _need(condition: Condition, scope: Scope) -> Need:
    """Return a condition as a polynomial in the tunable parameters."""

    def poly(expr: Expr) -> Poly:
        return fix(scope.poly(replace(condition.quantity, expr=expr)), scope.constants)

    value = poly(condition.value)
    if condition.other is not None:
        other = poly(condition.other)
        value = value * value + other * other
    elif condition.strict and scope.number(value).sign < 0:
        value = -value
    return Need(value, condition.strict, condition.problem, condition.quantity.mark)


def _violated(known: _Parameters, condition: Condition, point: Point, instead: str) -> RobotFileError:
    """Return the error for a condition that does not hold at a point of the ranges."""
    own = [known.parameters[name] for name in known.tunables_in(*condition.values)]
    if condition.other is None:
        values = " and ".join(f"{name} = {float(value):.6g}" for name, value in point.items())
        where = f" if {values}"
    else:
        where = f" for some {' and '.join(p.name for p in own)}"
    ranges = ", ".join(f"{p.name} from {float(p.low):.6g} to {float(p.high):.6g}" for p in own)
    why = f"Calibration may change {ranges}, and the generated code accepts all of these values."
    return RobotFileError(f"{condition.problem}{where}", condition.quantity.mark, why, instead)


def _narrower_ranges(known: _Parameters, names: Sequence[str], every: Sequence[Condition]) -> str:
    """Return a remedy: ranges for the parameters ``names`` in which every condition holds, if such are found."""
    texts = {p.name: p.value.text for p in known.spec.parameters}
    own = [known.parameters[name] for name in names]
    concerned = {(d.values, d.strict): d for d in every if set(names) & {*known.tunables_in(*d.values)}}
    for box in _candidates(own) if len(concerned) <= _PROPOSED else ():
        whole = known.box(known.parameters) | box
        if all(known.verdict(d, whole).proved for d in concerned.values()):
            written = []
            for name, ends in box.items():
                low, high = (f"{float(end):.6g}" for end in ends)
                written.append(f"{name}: {{value: {texts[name]}, tunable: [{low}, {high}]}}")
            return f"Narrow the range, for example {', '.join(written)}."
    return f"Narrow the range of {' or '.join(names)}: tunable: [low, high]."


def _candidates(own: Sequence[Parameter]) -> Iterator[dict[str, tuple[Exact, Exact]]]:
    """Yield boxes around the nominal values, each smaller than the one before, then ranges on one side of a value."""

    def end(p: Parameter, side: Exact, part: Fraction) -> Exact:
        """Return a point between the value and one end of its range, rounded to six digits."""
        return Exact(Fraction(f"{float(p.nominal + (side - p.nominal) * part):.6g}"))

    parts = [Fraction(1, part) for part in _SHRUNK]
    for part in parts:
        box = {p.name: (end(p, p.low, part), end(p, p.high, part)) for p in own}
        ends = zip(own, box.values(), strict=True)
        if all(low <= p.nominal <= high and low < high for p, (low, high) in ends):
            yield box
    for part in (Fraction(1), *parts):
        for p in own:
            for low, high in ((end(p, p.low, part), p.nominal), (p.nominal, end(p, p.high, part))):
                if low < high:
                    yield {p.name: (low, high)}
