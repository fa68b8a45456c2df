"""Which driven joints are the inputs of a model, and the twist that each of them gives.

A driven joint measures the null-space coordinates: r spin + o steer_rate = e(beta) . eta. As many independent joints
as the degree of mobility form the matrix E, and xi = N E^-1 (r spin + o steer_rate). The inputs of a model are these
joints and the steering rates. If too few joints are driven, the null-space coordinates eta replace the joints.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from wmrgen.analysis.kinematics.pose import unit_of_eta
from wmrgen.analysis.kinematics.records import joint_port
from wmrgen.analysis.mobility.analyse import fixed
from wmrgen.analysis.mobility.basis import scaled
from wmrgen.analysis.mobility.ranks import generic, nominal_at, numeric_rank
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.errors import NotDerivableError
from wmrgen.functions.models.frame import (
    ZERO,
    Frame,
    castor_row,
    frame,
    has_coordinate,
    rim_row,
    steering_rates,
)
from wmrgen.functions.models.polynomials import (
    angles_in,
    divided,
    domain_of,
    row_without_rounding,
    zero_condition,
)
from wmrgen.functions.models.tied import where_motions_meet
from wmrgen.functions.models.virtual import as_wheel, driving, steering_frame
from wmrgen.functions.system import Domain
from wmrgen.geometry.exact.linalg import adjugate, determinant
from wmrgen.geometry.exact.poly import Poly, Row, sum_of_rows
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.notation import in_backticks
from wmrgen.geometry.ports import Port, Role, output

Eta = tuple[Poly, ...]  # coordinates of a twist along the columns of N


class UnderactuatedError(NotDerivableError):
    """Fewer independent driven joints than degrees of mobility."""

    def __init__(
        self, what: str, driven: Sequence[str], dependent: Sequence[str], free: Sequence[str]
    ) -> None:
        super().__init__(what)
        self.driven = tuple(driven)  # independent driven joints
        self.dependent = tuple(dependent)  # driven joints that depend on the others
        self.free = tuple(free)  # joints without a motor


class Drive(NamedTuple):
    """A driven joint: scale * input + sum of offsets[name] * (rate of coordinate ``name``) = row . eta."""

    port: Port
    row: Eta  # coefficients of eta
    scale: Poly
    offsets: dict[str, Poly]  # by steering coordinate


class Motion(NamedTuple):
    """The twists that the inputs of a model cause. The model holds if ``divisor`` is not zero."""

    frame: Frame
    inputs: tuple[Port, ...]
    # ``etas[k] / divisor``: coordinates along the columns of N per unit of ``inputs[k]``
    etas: tuple[Eta, ...]
    divisor: Poly
    twists: tuple[Row, ...]  # ``twists[k]``: twist of P per unit of ``inputs[k]``, robot frame
    text: str
    followers: tuple[str, ...] = ()  # other driven joints, which must agree with the inputs

    @property
    def robot(self) -> Robot:
        """Return the layout."""
        return self.frame.robot

    @property
    def swivels(self) -> tuple[Wheel, ...]:
        """Return castors whose angle the motion depends on: they are states of the posture model."""
        seen = angles_in(tuple(p for twist in self.twists for p in twist))
        return tuple(w for w in self.robot.wheels if w.kind.swivels and w.name in seen)

    @property
    def domain(self) -> tuple[Domain, ...]:
        """Return the conditions under which the inputs no longer determine the motion."""
        one = len(self.frame.columns) == 1
        if self.divisor.constant is not None and one:
            condition = Poly.sum(p * p for p in self.frame.columns[0])
            text = "all entries of the null space vanish: axles fall into one line and rank C1 drops"
        else:
            condition = zero_condition(self.divisor)
            rates = {f"{w.name}.steer_rate" for w in self.frame.wheels}
            drives = in_backticks(p.name for p in self.inputs if p.name not in rates)
            text = f"G is unbounded: {drives} no longer determine{'s' * one} the motion"
        columns = self.frame.columns
        own = domain_of(condition, text, self.robot)
        lost = () if one else self.lost
        return (*own, *lost, *where_motions_meet(self.robot, self.frame.view, columns))

    @property
    def lost(self) -> tuple[Domain, ...]:
        """Return where the angles of coupled castors make a column of the null space vanish, and an input with it."""
        castors = {w.name for w in self.robot.wheels if w.kind.swivels}
        column = next((c for c in self.frame.columns if castors & angles_in(c)), None)
        if column is None:
            return ()
        turning = in_backticks(sorted(castors & angles_in(column)))
        text = f"the angles of {turning} make a column of the null space vanish, although the robot can move"
        return domain_of(Poly.sum(p * p for p in column), text, self.robot)


def posture_motion(robot: Robot, mobility: Mobility, symbolic: bool = False) -> Motion:
    """Return the motion in driven speeds and steering rates.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.

    Raises:
        UnderactuatedError: If too few joints are driven.
    """
    frame = steering_frame(robot, mobility, symbolic)
    drives, idle = _choose(frame)
    etas, determinant = _solve(drives, tuple(w.name for w in frame.wheels))
    inputs = (*(d.port for d in drives), *_rate_ports(frame))
    note = f"; {', '.join(idle)} must follow" if idle else ""
    text = f"posture model in {', '.join(p.name for p in inputs)}{note}"
    return _motion(frame, inputs, etas, determinant, text, tuple(idle))


def eta_motion(robot: Robot, mobility: Mobility, symbolic: bool = False, virtual: bool = False) -> Motion:
    """Return the motion in null-space coordinates, as ``dynamics`` has it.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.
        virtual: Whether angles of virtual wheels are the steering coordinates.
    """
    build = steering_frame if virtual else frame
    cleared = build(robot, mobility, True)
    per_eta = scaled(cleared.columns, cleared.wheels, robot)
    columns = per_eta if symbolic else tuple(row_without_rounding(fixed(column, robot)) for column in per_eta)
    coordinates = (cleared if symbolic else build(robot, mobility, False))._replace(columns=columns)
    size = range(len(columns))
    ports = tuple(
        output(f"eta{k}", unit_of_eta(column), f"speed along column {k} of the null space")
        for k, column in enumerate(columns, 1)
    )
    inputs = (*ports, *_rate_ports(coordinates))
    etas: list[Eta] = []
    for k in range(len(inputs)):
        etas.append(tuple(Poly.of(int(i == k)) for i in size))
    return _motion(coordinates, inputs, etas, Poly.of(1), "posture model in null-space coordinates")


def best_motion(robot: Robot, mobility: Mobility, symbolic: bool = False) -> Motion:
    """Return the motion in driven speeds if enough joints are driven, else in null-space coordinates.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.
    """
    try:
        return posture_motion(robot, mobility, symbolic)
    except UnderactuatedError as error:
        motion = eta_motion(robot, mobility, symbolic, virtual=True)
        return motion._replace(text=f"{motion.text}: {error.what}")


def _rate_ports(frame: Frame) -> tuple[Port, ...]:
    """Return the steering rates of the coordinates as inputs."""
    return tuple(joint_port(w, "steer_rate", Role.COMMAND) for w in frame.wheels)


def _motion(
    frame: Frame,
    inputs: tuple[Port, ...],
    etas: list[Eta],
    divisor: Poly,
    text: str,
    followers: tuple[str, ...] = (),
) -> Motion:
    """Return the motion of inputs with the given coordinates."""
    twists = []
    for eta in etas:
        scaled_columns = [[p * e for p in column] for column, e in zip(frame.columns, eta, strict=True)]
        twists.append(divided(sum_of_rows(scaled_columns), divisor))
    return Motion(frame, inputs, tuple(etas), divisor, tuple(twists), text, followers)


def _solve(drives: list[Drive], rates: tuple[str, ...]) -> tuple[list[Eta], Poly]:
    """Return adj(E) times each input (drives, then steering rates), and det E: eta is the quotient."""
    matrix = [d.row for d in drives]
    inverse, size = adjugate(matrix), range(len(matrix))
    inputs = [[d.scale if i == k else ZERO for i in size] for k, d in enumerate(drives)]
    inputs += [[d.offsets.get(name, ZERO) for d in drives] for name in rates]
    etas = []
    for u in inputs:
        driven = [k for k in size if u[k]]
        eta = []
        for row in inverse:
            eta.append(Poly.sum(row[k] * u[k] for k in driven))
        etas.append(tuple(eta))
    return etas, determinant(matrix)


def _choose(frame: Frame) -> tuple[list[Drive], list[str]]:
    """Return the first independent joints, as many as N has columns, and the names of the others.

    Raise UnderactuatedError if there are too few.
    """
    drives: list[Drive] = []
    rows: list[list[float]] = []
    idle = []
    angles = generic(frame.robot)
    for name, drive_of in _candidates(frame):
        if len(drives) < len(frame.columns):
            drive = drive_of()
            row = [nominal_at(p, frame.robot, angles) for p in drive.row]
            row += [0.0] * (3 - len(row))
            if _independent([*rows, row]):
                drives.append(drive)
                rows.append(row)
                continue
        idle.append(name)
    if len(drives) < len(frame.columns):
        raise _underactuated(frame, drives, idle)
    return drives, idle


def _candidates(frame: Frame) -> Iterator[tuple[str, Callable[[], Drive]]]:
    """Yield virtual drives, then driven joints in the order of the file, with their names; coupled spins once."""
    robot = frame.robot
    for v in driving(robot):
        yield f"{v.name}.speed", partial(_virtual, frame, as_wheel(robot, v))
    geared = {robot.spin_group[robot.wheel(name).index] for v in driving(robot) for name in v.wheels}
    for w in robot.wheels:
        if "spin" in w.actuated and robot.spin_group[w.index] not in geared:
            geared.add(robot.spin_group[w.index])
            if has_coordinate(frame, w) or len(frame.columns) == 1:
                yield f"{w.name}.spin", partial(_spin, frame, w)
        if w.kind.swivels and "steer" in w.actuated:
            yield f"{w.name}.steer_rate", partial(_swivel, frame, w)


def _spin(frame: Frame, w: Wheel) -> Drive:
    """Return the spin of a wheel as a drive."""
    g = frame.view(w)
    offsets = {}
    if w.kind.steers and g.steer_arm:
        offsets = {name: g.steer_arm * rate for name, rate in steering_rates(frame, w).items()}
    return Drive(joint_port(w, "spin", Role.COMMAND), rim_row(frame, w), g.rolling_radius, offsets)


def _swivel(frame: Frame, w: Wheel) -> Drive:
    """Return the steering rate of a castor as a drive."""
    return Drive(joint_port(w, "steer_rate", Role.COMMAND), castor_row(frame, w), Poly.of(1), {})


def _virtual(frame: Frame, w: Wheel) -> Drive:
    """Return the speed of a virtual wheel along the travel of its wheels [m/s] as a drive."""
    text = f"speed of the virtual wheel {w.name}, positive forward"
    port = output(f"{w.name}.speed", "m/s", text)
    return Drive(port, rim_row(frame, _coincident(frame, w)), Poly.of(1), {})


def _coincident(frame: Frame, w: Wheel) -> Wheel:
    """Return the steering coordinate at the same place, whose speed has no root; else the wheel."""
    standing = (w.nominal.x, w.nominal.y, w.nominal.ch, w.nominal.sh)
    for c in frame.wheels if w.turns else ():
        if (c.nominal.x, c.nominal.y, c.nominal.ch, c.nominal.sh) == standing and not c.nominal.o:
            return c
    return w


def _independent(rows: list[list[float]]) -> bool:
    """Return whether rows are independent."""
    sizes = [max(map(abs, row)) for row in rows]
    if min(sizes) < 1e-12:
        return False
    scaled = np.array([[v / size for v in row] for row, size in zip(rows, sizes, strict=True)])
    return numeric_rank(scaled)[0] == len(rows)


def _underactuated(frame: Frame, drives: list[Drive], idle: list[str]) -> UnderactuatedError:
    """Return the error: how many freedoms are driven, and which joints to actuate."""
    robot, need = frame.robot, len(frame.columns)
    have = ", ".join(d.port.name for d in drives) or "nothing"
    are = "is" if len(idle) == 1 else "are"
    dependent = f"; {', '.join(idle)} {are} not independent" if idle else ""
    free = [f"{w.name}.spin" for w in robot.wheels if w.has_spin and "spin" not in w.actuated]
    free += [f"{w.name}.steer_rate" for w in robot.wheels if w.kind.swivels and "steer" not in w.actuated]
    missing = need - len(drives)
    advice = (
        f"actuate {missing} more of {', '.join(free)}"
        if free
        else f"{missing} more driven wheel{'s' if missing > 1 else ''} would be needed"
    )
    what = f"the driven joints move {len(drives)} of {need} freedoms ({have}{dependent}). Missing actuation: {advice}"
    return UnderactuatedError(what, [d.port.name for d in drives], idle, free)
