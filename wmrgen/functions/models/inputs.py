"""Which driven joints are the inputs of a model, and the twist that each of them gives.

A driven joint measures the null-space coordinates: r spin + o steer_rate = e(beta) . eta. As many independent
ones as the degree of mobility, put into E, give xi = N E^-1 (r spin + o steer_rate).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wmrgen.errors import NotDerivableError
from wmrgen.exact.linalg import adjugate, determinant
from wmrgen.exact.poly import Poly
from wmrgen.functions.models.followers import castor_rate, direct, rate_row, rim_row
from wmrgen.functions.models.frame import Frame, generic, nominal_at
from wmrgen.functions.models.virtual import as_wheel, driving
from wmrgen.kinematics.records import joint_port
from wmrgen.layout.records import Wheel
from wmrgen.mobility.ranks import numeric_rank
from wmrgen.ports import Port, Role

ZERO = Poly({})


class UnderactuatedError(NotDerivableError):
    """Fewer independent driven joints than degrees of mobility; the text says what is missing."""


@dataclass(frozen=True, slots=True)
class Drive:
    """A driven joint: scale * input + sum of offsets[name] * (rate of coordinate ``name``) = row . eta."""

    port: Port
    row: tuple[Poly, ...]
    scale: Poly
    offsets: dict[str, Poly]


@dataclass(frozen=True, slots=True)
class Chosen:
    """``drives``: independent, as many as there are columns of N. ``idle``: driven joints that must follow."""

    drives: tuple[Drive, ...]
    idle: tuple[str, ...]


def candidates(frame: Frame) -> list[Drive]:
    """Virtual drives, then driven joints in the order of the file; coupled spins once."""
    robot = frame.robot
    found = [_virtual(frame, as_wheel(robot, v)) for v in driving(robot)]
    taken = {robot.spin_group[robot.wheel(name).index] for v in driving(robot) for name in v.wheels}
    for w in robot.wheels:
        if "spin" in w.actuated and robot.spin_group[w.index] not in taken:
            taken.add(robot.spin_group[w.index])
            if direct(frame, w) or len(frame.columns) == 1:
                found.append(_spin(frame, w))
        if w.kind.swivels and "steer" in w.actuated:
            found.append(_swivel(frame, w))
    return found


def _spin(frame: Frame, w: Wheel) -> Drive:
    g = frame.view(w)
    radius = g.rolling_radius
    offsets = {}
    if w.kind.steers and g.o:
        offsets = {name: g.o * rate for name, rate in rate_row(frame, w).items()}
    return Drive(joint_port(w, "spin", Role.COMMAND), rim_row(frame, w), radius, offsets)


def _swivel(frame: Frame, w: Wheel) -> Drive:
    row = tuple(castor_rate(frame, w, column) for column in frame.columns)
    return Drive(joint_port(w, "steer_rate", Role.COMMAND), row, Poly.of(1), {})


def _virtual(frame: Frame, w: Wheel) -> Drive:
    """The speed of the virtual wheel's place along the travel of its wheels [m/s]."""
    row = rim_row(frame, _coincident(frame, w))
    port = Port(
        f"{w.name}.speed", Role.COMMAND, "m/s", f"speed of the virtual wheel {w.name}, positive forward"
    )
    return Drive(port, row, Poly.of(1), {})


def _coincident(frame: Frame, w: Wheel) -> Wheel:
    """The steering coordinate that stands in the same place, whose speed has no root; else the wheel."""
    here = (w.nominal.x, w.nominal.y, w.nominal.ch, w.nominal.sh)
    for c in frame.wheels if w.turns else ():
        if (c.nominal.x, c.nominal.y, c.nominal.ch, c.nominal.sh) == here and not c.nominal.o:
            return c
    return w


def choose(frame: Frame) -> Chosen:
    """The independent joints of lowest index. NotDerivableError, with what is missing, where there are too few."""
    found: list[Drive] = []
    table: list[list[float]] = []
    idle = []
    for drive in candidates(frame):
        line = [nominal_at(p, frame.robot, generic(frame.robot)) for p in drive.row]
        line += [0.0] * (3 - len(line))
        if len(found) < len(frame.columns) and _independent([*table, line]):
            found.append(drive)
            table.append(line)
        else:
            idle.append(drive.port.name)
    if len(found) < len(frame.columns):
        raise UnderactuatedError(_missing(frame, found, idle))
    return Chosen(tuple(found), tuple(idle))


def _independent(rows: list[list[float]]) -> bool:
    sizes = [max(abs(v) for v in row) for row in rows]
    if min(sizes) < 1e-12:
        return False
    scaled = np.array([[v / size for v in row] for row, size in zip(rows, sizes, strict=True)])
    return numeric_rank(scaled)[0] == len(rows)


def _missing(frame: Frame, found: list[Drive], idle: list[str]) -> str:
    robot, need = frame.robot, len(frame.columns)
    have = ", ".join(d.port.name for d in found) or "nothing"
    beside = f"; {', '.join(idle)} adds nothing that is independent" if idle else ""
    free = [f"{w.name}.spin" for w in robot.wheels if w.has_spin and "spin" not in w.actuated]
    free += [f"{w.name}.steer_rate" for w in robot.wheels if w.kind.swivels and "steer" not in w.actuated]
    missing = need - len(found)
    advice = (
        f"actuate {missing} more of {', '.join(free)}"
        if free
        else f"{missing} more driven wheel{'s' if missing > 1 else ''} would be needed"
    )
    return f"the driven joints move {len(found)} of {need} freedoms ({have}{beside}). Missing actuation: {advice}"


def etas(chosen: Chosen, rates: tuple[str, ...]) -> tuple[list[tuple[Poly, ...]], Poly]:
    """adj(E) times each input (drives, then steering rates): eta still to be divided by det E, and det E."""
    matrix = [d.row for d in chosen.drives]
    adj, det = adjugate(matrix), determinant(matrix)
    size = range(len(matrix))
    inputs = [[d.scale if i == k else ZERO for i in size] for k, d in enumerate(chosen.drives)]
    inputs += [[d.offsets.get(name, ZERO) for d in chosen.drives] for name in rates]
    found = [tuple(Poly.sum(adj[m][k] * u[k] for k in size if u[k]) for m in size) for u in inputs]
    return found, det
