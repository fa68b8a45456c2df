"""Analyse the mobility of a layout: degrees, ranks and reasons, and in symbols the states at which it is singular."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from wmrgen.analysis.mobility.admissible import along, geared
from wmrgen.analysis.mobility.basis import basis, deciding, led, null_columns, primitive, scaled
from wmrgen.analysis.mobility.configure import Configuration, configuration, in_metres, steering_for
from wmrgen.analysis.mobility.filtration import growth_vector
from wmrgen.analysis.mobility.ranks import null_basis, numeric_rank, to_array, unit_rows
from wmrgen.analysis.mobility.reasons import apart, reasons, skids, verdict
from wmrgen.analysis.mobility.records import Array, Balance, Mobility, Singularity
from wmrgen.geometry.constraints import View, heading, nominal_view, rolling_row, symbolic_view, working_view
from wmrgen.geometry.exact.evaluate import fix
from wmrgen.geometry.exact.linalg import determinant
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly, Row, dot, each
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.layout.skid import driven, parallel
from wmrgen.geometry.notation import in_backticks, plain

SAME_ANGLE = (
    1e-9  # distance of points of the unit circle: above the rounding of doubles, as in `layout.skid.parallel`
)
MOST_WHEELS = 8  # wheels whose minors become conditions: 56 of them; more would not be readable


def analyse(robot: Robot) -> Mobility:
    """Return degrees, ranks, reachable dimensions and the reasons for them."""
    at = configuration(robot)
    rows = basis(robot, at)
    named = tuple(row.row(symbolic_view) for row in rows)
    symbolic = null_columns(named) if at.mobility else ()
    columns = tuple(fixed(column, robot) for column in symbolic)
    per_eta = scaled(symbolic, deciding(rows), robot)
    acting = driven(robot)
    leaders = (robot.wheels[robot.steer_group[w.index]].name for w in deciding(rows))
    return Mobility(
        degree_of_mobility=at.mobility, degree_of_steerability=at.steerability,
        rank_C1f=at.rank_fixed, rank_C1=at.rank,
        explanation=reasons(at, deciding(rows)), actuation=_actuation(at),
        apart=apart(at), skids=skids(at), verdict=plain(verdict(at)),
        growth_vector=growth_vector(at),
        singularities=singularities(at, deciding(rows), columns),
        admissible=in_metres(at.admissible, at.unit),
        basis_rows=tuple(row.row(working_view) for row in rows), basis_rows_symbolic=named,
        basis_wheels=tuple(dict.fromkeys(leaders)),
        null_space=columns, null_space_symbolic=symbolic,
        scaled=tuple(fixed(column, robot) for column in per_eta), scaled_symbolic=per_eta,
        driven=None if acting is robot else (acting, analyse(acting)),
    )  # fmt: skip


def _actuation(at: Configuration) -> tuple[Balance, ...]:
    """Compare motors with degrees of freedom, for driving and, if the robot steers, for steering."""
    robot = at.robot
    spins = [w for w in robot.wheels if "spin" in w.actuated]
    swivelled = [w for w in robot.wheels if w.kind.swivels and "steer" in w.actuated]
    free = null_basis(unit_rows(at.C1)) if at.C1.size else np.eye(3)
    rows = [_driving_row(w, at) for w in spins] + [_swivelling_row(w) for w in swivelled]
    independent = 0
    if rows and len(free):
        independent = int(np.linalg.matrix_rank(unit_rows(np.array(rows)) @ free.T, tol=1e-9))
    motors = len(robot.together("spin", spins)) + len(robot.together("steer", swivelled))
    steering = {robot.steer_group[w.index] for w in robot.wheels if w.kind.steers and "steer" in w.actuated}
    driving = Balance("spin", motors, independent, at.mobility)
    if not (at.steerability or steering):
        return (driving,)
    commanded = min(len(steering), at.steerability)
    return driving, Balance("steer", len(steering), commanded, at.steerability)


def _driving_row(w: Wheel, at: Configuration) -> Array:
    """Return the row of the rim speed at the sample configuration, with castors at angle zero.

    It is `constraints.driving_row` in numbers.
    """
    g = w.nominal
    heading = steering_for(w, at.admissible.sample) if w.kind.steers else w.zero_heading
    row: Array = along(w, heading * complex(float(g.cg), float(g.sg))) - np.array([0.0, 0.0, float(g.o)])
    return row - float(g.steer_arm) * _swivelling_row(w) if w.kind.swivels else row


def _swivelling_row(w: Wheel) -> Array:
    """Return the row of a castor's steering rate on the twist, at angle zero."""
    d = float(w.nominal.d)
    row: Array = -(along(w, 1j * w.zero_heading) + np.array([0.0, 0.0, d])) / d
    return row


def driving(robot: Robot, mobility: Mobility) -> tuple[Robot, Mobility]:
    """Return the layout from which kinematics are derived (`layout.skid.driven`), and its mobility."""
    return mobility.driven or (robot, mobility)


def fixed(row: Row, robot: Robot) -> Row:
    """Return a row with the parameters that are not tunable replaced by their values."""
    return each(row, lambda p: fix(p, robot.constants))


def singularities(
    at: Configuration, wheels: tuple[Wheel, ...], columns: tuple[Row, ...]
) -> tuple[Singularity, ...]:
    """Return all singular sets of the layout.

    Args:
        at: A generic configuration of the robot.
        wheels: The steered wheels that give a row of C1.
        columns: The columns of the null space of C1, working view.

    Returns:
        One record for each set, with the conditions that vanish there.
    """
    pivots = [_icr_on_pivot(w) for w in at.robot.wheels if w.kind.steers]
    return (*pivots, *_shared_axles(at, wheels), *_drive(at, wheels, columns), *_rolling_rank(at))


def _icr_on_pivot(w: Wheel) -> Singularity:
    """Return the singularity of a steered wheel whose pivot is the ICR, so that it rolls at any heading."""
    g, one, zero = working_view(w), Poly.of(1), Poly({})
    text = f"the ICR is on the pivot of `{w.name}`: its heading is undefined, and inverse keeps the present angle"
    return Singularity("icr_on_pivot", ((one, zero, -g.y), (zero, one, g.x)), text, (w.name,))


def _shared_axles(at: Configuration, wheels: tuple[Wheel, ...]) -> list[Singularity]:
    """Return the singularity at which the axles of the two steered wheels that give rows of C1 are on one line.

    There is none if a fixed wheel gives a row. Nor is there one if both wheels steer together and are never on one
    line, because the angle between their axles is constant.
    """
    if at.mobility != 1 or len(wheels) != 2:
        return []
    a, b = wheels
    lead = at.robot.steer_group
    if lead[a.index] == lead[b.index] and not _turned_into([a, b], 1j * (b.pivot - a.pivot)):
        return []
    conditions = (
        led(at.robot, towards(a, b, symbolic_view)),
        led(at.robot, towards(b, a, symbolic_view)),
    )
    what = ": these two no longer determine the motion; another steered wheel does"
    if _may_be_one_line(at.robot):
        what = ", and rank C1 falls from 2 to 1: the robot can turn about any point of that line"
        if geared(at.robot):
            what = ": these two no longer determine the motion; the coupled spins do"
    text = f"the axles of `{a.name}` and `{b.name}` lie on one line{what}"
    return [Singularity("shared_axle", conditions, text, (a.name, b.name))]


def _turned_into(wheels: list[Wheel], direction: complex) -> bool:
    """Return whether one common steering angle points all ``wheels`` along ``direction``, forwards or backwards."""
    if not direction:
        return parallel([w.zero_heading for w in wheels])
    angles = [(w.zero_heading.conjugate() * direction / abs(direction)) ** (2 * w.steer_sign) for w in wheels]
    return all(abs(a - angles[0]) < SAME_ANGLE for a in angles)


def towards(a: Wheel, b: Wheel, view: View) -> Poly:
    """Return e_a . (A_b - A_a), which is zero if the axle of a passes through the pivot of b.

    Args:
        a: The wheel with the axle.
        b: The wheel with the pivot.
        view: The view of the geometry.

    Returns:
        A polynomial in the steering angle of a [m].
    """
    ga, gb = view(a), view(b)
    ex, ey = heading(a, ga)
    return ex * (gb.x - ga.x) + ey * (gb.y - ga.y)


def _may_be_one_line(robot: Robot) -> bool:
    """Return whether all steered axles can be on one line.

    Their pivots must be on a line, and each set of coupled wheels must have an angle that turns its axles into it.
    """
    steered = [w for w in robot.wheels if w.kind.steers]
    first, *others = (w.pivot for w in steered)
    points = [[(p - first).real, (p - first).imag] for p in others]
    line = max((p - first for p in others), key=abs)
    return int(np.linalg.matrix_rank(np.array(points), tol=1e-9)) < 2 and all(
        _turned_into(group, 1j * line) for group in robot.together("steer", steered)
    )


def _drive(at: Configuration, wheels: tuple[Wheel, ...], columns: tuple[Row, ...]) -> list[Singularity]:
    """Return the singularity at which all rolling rows of driven wheels vanish on the null space."""
    driven = [w for w in at.robot.wheels if "spin" in w.actuated]
    if len(columns) != 1 or not driven or any(w.turns for w in driven):
        return []
    rates: list[Poly] = []
    for w in driven:
        rate = dot(rolling_row(w, working_view(w)).row, columns[0])
        rate = rate.scale(rate.ordered[0][1].inverse()) if rate else rate
        if rate and rate not in rates:
            rates.append(rate)
    if len(rates) > len(wheels) or any(r.constant is not None for r in rates):
        return []
    names = tuple(w.name for w in driven)
    if len(names) == 1:
        verb, pronoun = "does", "it"
    else:
        verb, pronoun = "do", "they"
    shown = in_backticks(names)
    text = (
        f"{shown} {verb} not turn when the robot moves: {pronoun} can neither drive nor measure that motion"
    )
    return [Singularity("drive", tuple(rates), text, names)]


def _rolling_rank(at: Configuration) -> list[Singularity]:
    """Return the singularity of a robot without sliding constraints whose rolling rows have rank 2 or less."""
    wheels = [w for w in at.robot.wheels if w.kind.rolls_across]
    if at.mobility != 3 or not wheels or any(w.kind.swivels and w.actuated for w in at.robot.wheels):
        return []
    rows = [[p.constant or Exact(0) for p in rolling_row(w, nominal_view(w)).row] for w in wheels]
    rank, _ = numeric_rank(unit_rows(to_array(rows)))
    if rank == 3:
        return []
    if rank == 2:
        motions = "one motion of the body turns no wheel, so the wheels cannot drive it"
    else:
        motions = "two independent motions of the body turn no wheel, so the wheels cannot drive them"
    text = f"the rolling rows of {in_backticks(w.name for w in wheels)} have rank {rank}: {motions}"
    if any(w.nominal.sg for w in wheels) and len(wheels) > 2:
        text += (
            ". Mecanum rollers at the ground must form an O (seen from above the roller lines form a diamond around "
            "the centre), not an X through one point"
        )
    return [Singularity("rolling_rank", _minors(wheels), text, tuple(w.name for w in wheels))]


def _minors(wheels: list[Wheel]) -> tuple[Poly, ...]:
    """Return the distinct 3x3 minors of the rolling rows, which vanish, as polynomials in the named parameters."""
    rows = [rolling_row(w, symbolic_view(w)).row for w in wheels[:MOST_WHEELS]]
    forms: list[Poly] = []
    for three in combinations(rows, 3):
        form = primitive((determinant(three), Poly({}), Poly({})))[0]
        if form and form.constant is None and form not in forms:
            forms.append(form)
    return tuple(forms)
