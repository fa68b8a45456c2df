"""Virtual wheels: one angle or one speed that represents several wheels (Tzafestas fig. 2.9, Siegwart 3.3.2).

The angle psi of a virtual centre wheel determines where the ICR is. The axles of the real wheels point to the ICR,
which is the Ackermann condition. A virtual drive is the speed of a point of the axle: the speed that a differential
gear distributes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wmrgen.analysis.kinematics.records import Formula, joint_port, tunable_ports
from wmrgen.analysis.mobility.admissible import along
from wmrgen.analysis.mobility.analyse import fixed
from wmrgen.analysis.mobility.configure import pivot_velocity
from wmrgen.analysis.mobility.ranks import generic, nominal_at, numeric_rank, straight, unit_rows
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.frame import Frame, constant_rows, frame, steering_direction
from wmrgen.functions.registry import Reason, UnderivableError, function, underivable
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly, has_angles
from wmrgen.geometry.layout.records import Geometry, Robot, T, Virtual, Wheel
from wmrgen.geometry.notation import plain
from wmrgen.geometry.ports import Role
from wmrgen.geometry.symbolic import angle_of, expression

_SMALL = 1e-9  # m, or relative: a smaller distance or cross product is treated as 0


def as_wheel(robot: Robot, virtual: Virtual) -> Wheel:
    """Return the virtual wheel as a wheel at its place, parallel to its first wheel, with its limits and radius 1."""
    lead = robot.wheel(virtual.wheels[0])

    def at(view: str, one: T, zero: T) -> Geometry[T]:
        g: Geometry[T] = getattr(lead, view)
        x, y = getattr(virtual.x, view), getattr(virtual.y, view)
        return replace(g.mapped(lambda _: zero), x=x, y=y, ch=g.ch, sh=g.sh, cg=one, r=one)

    one, zero = Poly.of(1), Poly({})
    return Wheel(
        index=-1, name=virtual.name, type=lead.type, symbolic=at("symbolic", one, zero),
        working=at("working", one, zero), nominal=at("nominal", Exact(1), Exact(0)),
        l=0.0, alpha=0.0, beta=0.0, gamma=0.0, heading=lead.heading,
        actuated=("spin", "steer") if lead.turns else ("spin",), sensed=(), limits=lead.limits,
    )  # fmt: skip


def steering(robot: Robot) -> tuple[Virtual, ...]:
    """Return the virtual wheels that steer."""
    return tuple(v for v in robot.virtual if v.role == "steers")


def driving(robot: Robot) -> tuple[Virtual, ...]:
    """Return the virtual wheels that drive."""
    return tuple(v for v in robot.virtual if v.role == "drives")


def steering_frame(robot: Robot, mobility: Mobility, symbolic: bool = False) -> Frame:
    """Return the null space in the robot's steering coordinates: virtual wheels if the file has them.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.
    """
    check_virtual(robot, mobility)
    wheels = tuple(as_wheel(robot, v) for v in steering(robot))
    return frame(robot, mobility, symbolic, wheels[: mobility.degree_of_steerability])


def check_virtual(robot: Robot, mobility: Mobility) -> None:
    """Raise NotDerivableError, naming the condition, for virtual wheels that cannot represent their wheels."""
    for v in robot.virtual:
        _check_parallel(robot, v)
    wheels = steering(robot)
    if wheels:
        _check_steerability(robot, mobility, wheels)
        for v in wheels:
            _check_axle(robot, mobility, v)
        _check_rank(robot, mobility, wheels[: mobility.degree_of_steerability])
    for v in driving(robot):
        _check_drive(robot, v)


def _check_parallel(robot: Robot, v: Virtual) -> None:
    """Require that all wheels of one virtual wheel are parallel at their zeros, and of one kind."""
    first, *others = (robot.wheel(name) for name in v.wheels)
    for w in others:
        cross = float(first.nominal.ch * w.nominal.sh - first.nominal.sh * w.nominal.ch)
        if abs(cross) > _SMALL:
            raise UnderivableError(
                f"{v.name} {v.role} {first.name} and {w.name}, whose rolling directions at zero are not parallel "
                f"({first.heading:.6g} and {w.heading:.6g} rad): if {v.name} is straight, both must be straight.\n"
                f"  Give {w.name} the heading of {first.name}; heading is the rolling direction at steering angle 0.",
                Reason.NOT_PARALLEL,
                v.mark,
            )
        if w.type != first.type:
            raise UnderivableError(
                f"{v.name} {v.role} {first.name} ({first.type}) and {w.name} ({w.type}), which share no heading.",
                Reason.NOT_PARALLEL,
                v.mark,
            )


def _check_steerability(robot: Robot, mobility: Mobility, wheels: tuple[Virtual, ...]) -> None:
    """Require enough virtual angles to determine the ICR."""
    need = mobility.degree_of_steerability
    if len(wheels) >= need > 0:
        return
    names = ", ".join(v.name for v in wheels)
    members = ", ".join(dict.fromkeys(name for v in wheels for name in v.wheels))
    near = [axles for axles in robot.near if not axles.moves]
    if not need:
        cause = plain(near[0].sentence(robot.tolerance)) if near else mobility.deciding.partition("\n")[0]
        why = "the degree of steerability is 0, so no steering angle can change while the wheels roll. "
        why += cause[:1].upper() + cause[1:]
        instead = (
            near[0].remedies if near else f"Correct the wheels, so that they can steer, or delete {names}."
        )
    else:
        why = (
            f"the degree of steerability is {need}, so {len(wheels)} virtual angle{'s' if len(wheels) > 1 else ''} "
            "cannot determine the ICR: the Ackermann condition needs a fixed axle, on whose line the ICR is"
        )
        instead = f"Name {need} virtual wheels, or steer the wheels one by one."
    raise UnderivableError(
        f"{robot.name}: the virtual steering {names} of {members} violates the Ackermann condition: "
        f"{why.rstrip('.')}.\n  {instead}",
        Reason.ACKERMANN,
        wheels[0].mark,
    )


def _check_axle(robot: Robot, mobility: Mobility, v: Virtual) -> None:
    """Require that neither the virtual wheel nor a wheel it steers is on the line of the fixed axle."""
    rows = constant_rows(robot, mobility)
    if len(rows) != 1 or has_angles(rows[0]):
        return
    nx, ny, k = (nominal_at(p, robot, straight) for p in rows[0])
    size = float(np.hypot(nx, ny))
    if size < _SMALL:
        return
    for w in (as_wheel(robot, v), *(robot.wheel(name) for name in v.wheels)):
        x, y = float(w.nominal.x), float(w.nominal.y)
        # The axle passes through (x, y) if the row's velocity component n . v_A does not depend on omega.
        if abs((k - (x * ny - y * nx)) / size) < _SMALL:
            raise UnderivableError(
                f"{v.name} steers {', '.join(v.wheels)}, but {w.name} is at ({x:.6g}, {y:.6g}), on the axle line of "
                "the fixed wheels: the ICR is on that line, so by the Ackermann condition the angle never changes.\n"
                "  Place it off the axle (x, y).",
                Reason.ACKERMANN,
                v.mark,
            )


def _check_rank(robot: Robot, mobility: Mobility, wheels: tuple[Virtual, ...]) -> None:
    """Require that the virtual axles and the constant rows determine the motion as C1 does."""
    matrix = [
        [nominal_at(p, robot, generic(robot)) for p in fixed(row, robot)]
        for row in constant_rows(robot, mobility)
    ]
    for v in wheels:
        w = as_wheel(robot, v)
        matrix.append(list(along(w, 1j * pivot_velocity(w, mobility.admissible.sample))))
    rank = numeric_rank(unit_rows(np.array(matrix)))[0]
    if rank != 3 - mobility.degree_of_mobility:
        names = ", ".join(v.name for v in wheels)
        raise UnderivableError(
            f"{robot.name}: the virtual steering {names} violates the Ackermann condition: its angle does not "
            f"determine the ICR (rank {rank}, the wheels themselves have {3 - mobility.degree_of_mobility}).",
            Reason.ACKERMANN,
            wheels[0].mark,
        )


def _check_drive(robot: Robot, v: Virtual) -> None:
    """Require that a virtual drive has a driven wheel."""
    idle = [name for name in v.wheels if "spin" not in robot.wheel(name).actuated]
    if len(idle) == len(v.wheels):
        raise UnderivableError(
            f"{v.name} drives {', '.join(v.wheels)}, none of which is driven.\n"
            f"  Write actuated: [spin] for {idle[0]}, or delete the virtual wheel.",
            Reason.NOT_DRIVEN,
            v.mark,
        )


@function("Tzafestas (2.49)-(2.51); Kelly 4.2.1.2, Ackermann")
def virtual_steering(robot: Robot, mobility: Mobility) -> Formula:
    """Return the steering angles of the real wheels for virtual angles (Ackermann condition)."""
    wheels = steering(robot)
    if not wheels:
        raise underivable(
            robot,
            "virtual steering",
            "its file names no virtual wheel that steers.\n"
            "  Write virtual: [{name: front, steers: [front_left, front_right]}].",
            Reason.NO_VIRTUAL_WHEEL,
        )
    coordinates = steering_frame(robot, mobility)
    followers = [w for w in robot.wheels if w.kind.steers]
    followers += [as_wheel(robot, v) for v in wheels[mobility.degree_of_steerability :]]
    return _angles(
        "virtual_steering",
        coordinates,
        followers,
        robot,
        "angles of the virtual wheels to the angles of the real wheels",
    )


@function("Tzafestas (2.49)-(2.51); Kelly 4.2.1.2, Ackermann")
def virtual_angle(robot: Robot, mobility: Mobility) -> Formula:
    """Return the angles of the virtual wheels for the steering angles of the real wheels that determine the ICR."""
    virtual_steering(robot, mobility)
    coordinates = frame(robot, mobility, False)
    followers = [as_wheel(robot, v) for v in steering(robot)]
    return _angles(
        "virtual_angle",
        coordinates,
        followers,
        robot,
        "steering angles of the real wheels to the angles of the virtual wheels",
    )


def _angles(name: str, coordinates: Frame, followers: list[Wheel], robot: Robot, text: str) -> Formula:
    """Return a function whose steering angles are the directions of travel of the pivots."""
    outputs = []
    for w in followers:
        along, across = steering_direction(coordinates, w)
        outputs.append(
            (joint_port(w, "steer", Role.COMMAND), angle_of(expression(across), expression(along)))
        )
    inputs = (*(joint_port(w, "steer", Role.STATE) for w in coordinates.wheels), *tunable_ports(robot))
    return Formula(name, inputs, (), tuple(outputs), text)
