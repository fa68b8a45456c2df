"""What the sensed joint rates say about the twist: velocities of contact points, and single rows.

A wheel with a sliding row tells it, and a wheel whose spin is sensed its rolling row. Both together measure the
velocity of the contact point B: v_B = (r spin + o steer_rate) e - d steer_rate n. One row measures one component.
"""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.constraints import heading, rolling_row, sliding_row, working_view
from wmrgen.exact.poly import Poly, Row, has_angles
from wmrgen.kinematics.records import signal_poly
from wmrgen.layout.records import Robot, Wheel

Measured = tuple[Row, Poly]  # row . xi = value


@dataclass(frozen=True, slots=True)
class Contact:
    """A measured contact velocity: v + omega z x (bx, by) = (wx, wy), robot frame."""

    wheel: Wheel
    bx: Poly
    by: Poly
    wx: Poly
    wy: Poly


@dataclass(frozen=True, slots=True)
class Component:
    """A measured component: row . xi = value [m/s]."""

    wheel: Wheel
    row: Row
    value: Poly


@dataclass(frozen=True, slots=True)
class Measurements:
    """All that the sensed joints of a robot measure."""

    contacts: tuple[Contact, ...]
    components: tuple[Component, ...]

    @property
    def wheels(self) -> tuple[Wheel, ...]:
        """Those that measure something."""
        return (*(c.wheel for c in self.contacts), *(c.wheel for c in self.components))

    @property
    def rows(self) -> list[Measured]:
        """Every measured row over the twist, with its value [m/s]."""
        rows = [row for c in self.contacts for row in contact_rows(c.bx, c.by, c.wx, c.wy)]
        return rows + [(c.row, c.value) for c in self.components]

    @property
    def constant_normal(self) -> bool:
        """Whether the normal matrix depends on no joint angle."""
        return not any(has_angles(row) for row, _ in self.rows)


def contact_rows(bx: Poly, by: Poly, wx: Poly, wy: Poly) -> list[Measured]:
    """The velocity (wx, wy) of a point B, a row for each component."""
    one, zero = Poly.of(1), Poly({})
    return [((one, zero, -by), wx), ((zero, one, bx), wy)]


def sensed_joints(w: Wheel) -> tuple[str, ...]:
    """The joints of a wheel that are inputs of ``forward``."""
    joints: list[str] = [j for j in ("spin", "steer") if j in w.sensed]
    if "steer" in joints and (w.kind.swivels or w.nominal.o):
        joints.append("steer_rate")
    return tuple(joints)


def measurements(robot: Robot) -> Measurements:
    """What the sensed joints measure of the twist. Passive castors and spheres measure nothing."""
    contacts: list[Contact] = []
    components: list[Component] = []
    for w in robot.wheels:
        g = working_view(w)
        joints = sensed_joints(w)
        if w.turns and "steer" not in joints:
            continue
        rate = signal_poly(f"{w.name}.steer_rate") if "steer_rate" in joints else Poly({})
        spin = signal_poly(f"{w.name}.spin") if "spin" in joints else None
        if spin is not None and w.kind.sliding_row:
            contacts.append(_contact(w, spin, rate))
        elif spin is not None:
            components.append(Component(w, rolling_row(w, g).row, g.rolling_radius * spin + g.o * rate))
        elif w.kind.sliding_row:
            components.append(Component(w, sliding_row(w, g).row, -(g.d * rate)))
    return Measurements(tuple(contacts), tuple(components))


def _contact(w: Wheel, spin: Poly, rate: Poly) -> Contact:
    """Both rows of a wheel, solved for the velocity of its contact point."""
    g = working_view(w)
    c, s = heading(w, g)
    along, across = g.r * spin + g.o * rate, -(g.d * rate)
    return Contact(
        w,
        g.x + g.d * c - g.o * s,
        g.y + g.d * s + g.o * c,
        along * c - across * s,
        along * s + across * c,
    )
