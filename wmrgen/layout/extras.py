"""Trailers, virtual wheels, centre of gravity and gains: quantities of the robot file in their three views."""

from __future__ import annotations

from collections.abc import Mapping

from wmrgen.errors import RobotFileError
from wmrgen.exact.evaluate import fix, number
from wmrgen.exact.poly import Poly
from wmrgen.layout.expressions import to_poly
from wmrgen.layout.records import Length, Point, Trailer, Virtual, Wheel
from wmrgen.spec.records import Quantity, RobotSpec, VirtualSpec

Values = Mapping[str, Poly]


class Extras:
    """Reads what a robot file says beyond its wheels. ``values``: nominal; ``known``: those not tunable."""

    def __init__(self, spec: RobotSpec, values: Values, known: Values) -> None:
        self.spec, self.values, self.known = spec, values, known

    def trailers(self) -> tuple[Trailer, ...]:
        """The trailers. RobotFileError for a length that is not positive."""
        found = []
        for t in self.spec.trailers:
            length = self._views(t.length)
            if length.nominal.sign <= 0:
                raise RobotFileError(
                    f"{t.name}: trailer length = {t.length.text} is not positive", t.length.mark,
                    "A trailer turns about its axle by the lever arm `length`; without one it cannot follow.",
                    "Write the distance from the trailer's coupling back to its axle.",
                )  # fmt: skip
            hitch = self._of(Poly({})) if t.hitch is None else self._views(t.hitch)
            found.append(Trailer(t.name, length, hitch, t.mark))
        return tuple(found)

    def virtual(self, wheels: tuple[Wheel, ...]) -> tuple[Virtual, ...]:
        """The virtual wheels, in the middle of the real ones where no place is given."""
        return tuple(
            Virtual(
                v.name, v.role, v.wheels, self._place(v, "x", wheels), self._place(v, "y", wheels), v.mark
            )
            for v in self.spec.virtual
        )

    def _place(self, v: VirtualSpec, axis: str, wheels: tuple[Wheel, ...]) -> Length:
        given: Quantity | None = getattr(v, axis)
        if given is not None:
            return self._views(given)
        members = [w for w in wheels if w.name in v.wheels]
        total = Poly.sum(getattr(w.symbolic, axis) for w in members)
        return self._of(total * Poly.of(len(members)).inverse())

    def point(self) -> Point | None:
        """The centre of gravity."""
        cg = self.spec.cg
        return None if cg is None else Point(self._views(cg.x), self._views(cg.y), self._views(cg.z))

    def gains(self) -> dict[str, Length]:
        """Gain -> value."""
        return {name: self._views(quantity) for name, quantity in self.spec.gains}

    def _views(self, quantity: Quantity) -> Length:
        return self._of(to_poly(quantity, self.values))

    def _of(self, symbolic: Poly) -> Length:
        return Length(symbolic, fix(symbolic, self.known), number(symbolic, self.values))
