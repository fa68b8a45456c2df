"""What the values of a robot file must be, so that its geometry exists: roots of nothing negative, no divisor, radius
or castor offset that is 0."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any, NamedTuple

from wmrgen.robotfile.records import Binary, Call, Expr, Num, Quantity, RobotSpec, WheelSpec, children
from wmrgen.robotfile.wheel_types import WHEEL_TYPES


class Demand(NamedTuple):
    """``value`` must not be 0 (``strict``) or not be negative; with ``other`` the two must not both be 0.

    ``problem``: what is wrong where it does not hold. ``quantity``: where that stands in the robot file.
    """

    value: Expr
    strict: bool
    problem: str
    quantity: Quantity
    other: Expr | None = None

    @property
    def values(self) -> tuple[Expr, ...]:
        """The one value, or both."""
        return (self.value,) if self.other is None else (self.value, self.other)


def demands(spec: RobotSpec) -> Iterator[Demand]:
    """Every demand, those of parts of an expression before those of the whole; parameters before what uses them."""
    for quantity in _quantities((spec.parameters, *(getattr(spec, f.name) for f in fields(spec)))):
        yield from _of_expression(quantity.expr, quantity)
    for wheel in spec.wheels:
        yield from _of_wheel(wheel)
    for trailer in spec.trailers:
        yield Demand(
            trailer.length.expr, True, f"the length of {trailer.name} is not positive", trailer.length
        )
    if spec.effective_track is not None:
        track = spec.effective_track
        yield Demand(track.expr, True, "effective_track is not positive", track)


def _quantities(part: Any) -> Iterator[Quantity]:
    """The quantities in a record of the robot file, in the order of its fields."""
    if isinstance(part, Quantity):
        yield part
    elif isinstance(part, tuple):
        for item in part:
            yield from _quantities(item)
    elif is_dataclass(part):
        for field in fields(part):
            yield from _quantities(getattr(part, field.name))


def _of_expression(expr: Expr, quantity: Quantity) -> Iterator[Demand]:
    for child in children(expr):
        yield from _of_expression(child, quantity)
    match expr:
        case Call("sqrt", (arg,)):
            yield Demand(arg, False, "square root of a negative number", quantity)
        case Call("tan", (arg,)):
            yield Demand(Call("cos", (arg,)), True, "the tangent of a quarter turn has no value", quantity)
        case Call("atan2", (y, x)):
            yield Demand(y, True, "atan2(0, 0) has no value", quantity, x)
        case Binary("/", _, below):
            yield Demand(below, True, "division by zero", quantity)
        case Binary("**", base, Num(power)) if power < 0:
            yield Demand(base, True, "division by zero", quantity)


def _of_wheel(w: WheelSpec) -> Iterator[Demand]:
    kind = WHEEL_TYPES[w.type]
    what = f"the {kind.noun} {w.name}"
    if w.r is not None and "r" in kind.required:
        yield Demand(w.r.expr, True, f"the radius of {what} is not positive", w.r)
    if w.d is not None and kind.swivels:
        yield Demand(w.d.expr, True, f"the offset d of {what} is 0 or has changed its sign", w.d)
    for check in kind.checks:
        quantity = getattr(w, check.key)
        if quantity is not None and check.keeps_sign:
            value = Call("cos", (quantity.expr,)) if check.keeps_sign == "cosine" else quantity.expr
            problem = f"{check.key} of {what} is {'a quarter turn' if value is not quantity.expr else 'not positive'}"
            yield Demand(value, True, problem, quantity)
    if w.x is not None and w.y is not None and w.beta is not None:
        problem = f"{what} stands in the origin, where beta has no direction"
        yield Demand(w.y.expr, True, problem, w.y, w.x.expr)
