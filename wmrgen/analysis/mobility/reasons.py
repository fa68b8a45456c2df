"""Explain the degrees of a robot in sentences, each with a key."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import combinations

import numpy as np

from wmrgen.analysis.mobility.admissible import along, coupled_sets
from wmrgen.analysis.mobility.configure import Configuration
from wmrgen.analysis.mobility.ranks import null_basis, numeric_rank, to_array, unit_rows
from wmrgen.analysis.mobility.records import TOLERANCE, Array, Reason
from wmrgen.geometry.constraints import Constraints, constrain, nominal_view
from wmrgen.geometry.exact.evaluate import fix
from wmrgen.geometry.exact.poly import Poly, Row
from wmrgen.geometry.layout.records import Geometry, Robot, Wheel
from wmrgen.geometry.layout.skid import no_track, parallel
from wmrgen.geometry.notation import in_backticks, steering, turning

# Thousandths by which parameters are changed for general values. A root such as sqrt(2 - b) has no value above b = 2,
# so that several signs and sizes are tried.
_STEPS = (37, -37, 3, -3)
SAME = 1e-9  # axle lines and distances in the robot's unit of length: smaller differences are rounding errors


def reasons(at: Configuration, deciding: tuple[Wheel, ...]) -> tuple[Reason, ...]:
    """Return the sentences that explain the degrees of a robot.

    ``deciding`` are the steered wheels that give a row of C1.
    """
    return (
        *_fixed_axles(at), *_aligned_axles(at), *_couplings(at), *_effect_of_couplings(at), *_steering(at, deciding),
        *_unconstrained_wheels(at), *_degrees(at), *_degeneration(at), *_doubts(at), *_coincidences(at),
    )  # fmt: skip


def _names(wheels: Iterable[Wheel]) -> str:
    return in_backticks(w.name for w in wheels)


def _axle(w: Wheel) -> Array:
    """Return the sliding row of a fixed wheel, which describes its axle line."""
    return along(w, 1j * w.zero_heading)


def _axle_lines(wheels: list[Wheel]) -> list[list[Wheel]]:
    """Return fixed wheels in groups that share an axle line."""
    lines: list[list[Wheel]] = []
    for w in wheels:
        line = next((line for line in lines if _one_line(_axle(w), _axle(line[0]))), None)
        if line is None:
            lines.append([w])
        else:
            line.append(w)
    return lines


def _one_line(a: Array, b: Array) -> bool:
    return bool(min(np.abs(a - b).max(), np.abs(a + b).max()) < SAME)


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


def _aligned_axles(at: Configuration) -> list[Reason]:
    """Return a sentence for each set of axles that were aligned within the tolerance."""
    aligned = [near for near in at.robot.near if near.moves]
    return [Reason("aligned", _sentence(near.sentence(at.robot.tolerance)), argues=False) for near in aligned]


def _fixed_axles(at: Configuration) -> list[Reason]:
    """Return the sentences about the axles of fixed wheels."""
    fixed = [w for w in at.robot.wheels if w.kind.fixed_axle]
    if not fixed:
        return []
    lines = _axle_lines(fixed)
    found = []
    for line in lines:
        if len(line) > 1:
            others = "the second adds" if len(line) == 2 else "the others add"
            text = f"{_names(line)} share an axle line, so {others} no constraint."
            found.append(Reason("shared_axle_line", text))
    if at.rank_fixed.value == 1:
        noun = fixed[0].kind.noun if len({w.type for w in fixed}) == 1 else "wheel"
        wheels, verb = (f"{noun}s", "forbid") if len(fixed) > 1 else (noun, "forbids")
        text = f"The {wheels} {_names(fixed)} {verb} motion along the axle: rank C1f = 1."
        return [*found, Reason("fixed_axle", text)]
    return [*found, _several_axles(at, [line[0] for line in lines])]


def apart(at: Configuration) -> tuple[str, ...]:
    """Return three fixed wheels whose axles meet in no common point, or () if rank C1f is less than 3."""
    if at.rank_fixed.value < 3:
        return ()
    fixed = [w for w in at.robot.wheels if w.kind.fixed_axle]
    wheels = [line[0] for line in _axle_lines(fixed)]
    rows = unit_rows(np.array([_axle(w) for w in wheels]))
    three = next(t for t in combinations(range(len(wheels)), 3) if numeric_rank(rows[list(t)])[0] == 3)
    return tuple(wheels[i].name for i in three)


def _several_axles(at: Configuration, wheels: list[Wheel]) -> Reason:
    """Return the sentence about several axle lines: where they meet, and what motion remains."""
    three = apart(at)
    if three:
        text = f"The axles of {in_backticks(three)} meet in no common point: nothing can move (rank C1f = 3)."
        return Reason("no_common_point", text)
    (null,) = null_basis(unit_rows(np.array([_axle(w) for w in wheels])))
    if abs(null[2]) < SAME:
        key, where, what = "parallel_axles", "are parallel and distinct", "straight motion along the wheels"
    else:
        vx, vy, omega = at.unit.twists(null)
        x, y = (round(float(v), 12) + 0.0 for v in (-vy / omega, vx / omega))
        key, where, what = "common_point", f"meet in ({x:.4g}, {y:.4g})", "rotation about that point"
    return Reason(key, f"The axles of {_names(wheels)} {where}: only {what} slides no wheel (rank C1f = 2).")


def _couplings(at: Configuration) -> list[Reason]:
    """Return a sentence for each coupling."""
    found = []
    for joint, names in at.robot.couplings:
        ratios = at.robot.ratios(joint, names)
        if joint == "spin":
            what = f"they {turning(ratios)}"
        else:
            what = f"they {steering(ratios)}" if ratios else "their steering angles are equal"
        found.append(Reason("coupled", f"{in_backticks(names)} are coupled: {what}.", argues=False))
    return found


def _effect_of_couplings(at: Configuration) -> list[Reason]:
    """Return the sentences about the motions that couplings permit."""
    found = []
    normal, joints = at.admissible.normal, {joint for joint, _ in at.robot.couplings}
    which = {"steer": "the coupled steering", "spin": "the coupled spins"}
    cause = which[min(joints)] if len(joints) == 1 else "the couplings"
    if normal is not None:
        if normal[0] or normal[1]:
            text = f"Because of {cause}, the admissible twists form a plane."
            found.append(Reason("admissible_plane", text))
        elif "steer" in joints and all(w.steer_sign > 0 for w in at.robot.wheels):
            text = "With equal steering the axles stay parallel: only translation remains, omega = 0."
            found.append(Reason("only_translation", text))
        else:
            text = f"Because of {cause}, only translation is admissible: omega = 0."
            found.append(Reason("only_translation", text))
    elif not at.admissible.linear:
        found.append(Reason("admissible_cone", f"Because of {cause}, the admissible twists form a cone."))
    if coupled_sets(at.robot) and len(at.constant) > at.rank_fixed.value:
        text = "Eliminating the coupled joint rates leaves a further constraint on the body."
        found.append(Reason("coupling_constraint", text))
    return found


def _steering(at: Configuration, deciding: tuple[Wheel, ...]) -> list[Reason]:
    """Return the sentence about the effect of steering, if there are steered wheels."""
    steered = [w.name for w in at.robot.wheels if w.kind.steers]
    if not steered or not at.mobility:
        return []
    if not at.steerability:
        text = (
            f"{in_backticks(steered)} can be steered, but every wheel rolls in one direction only: no degree of "
            "freedom of steering is left."
        )
        return [Reason("steering_without_effect", text)]
    leaders = [at.robot.wheels[at.robot.steer_group[w.index]].name for w in deciding]
    lead = list(dict.fromkeys(leaders))[: at.steerability]
    rest = [name for name in steered if name not in lead]
    turns = np.abs(at.admissible.basis[:, 2]).max() > TOLERANCE
    if not turns:
        key, does = "steers_direction", "chooses the direction of motion"
    elif at.mobility > 1:
        key, does = "steers_axle", "turns the axle on which the ICR lies"
    else:
        key, does = "steers_icr", "chooses the ICR"
    text = f"Steering {in_backticks(lead)} {does} (delta_s = {at.steerability})"
    if rest and not turns:
        text += f"; {in_backticks(rest)} must point the same way"
    elif rest:
        axles = "its axle" if len(rest) == 1 else "their axles"
        where = "through the same point" if at.mobility == 1 else "on the same line"
        text += f"; {in_backticks(rest)} must follow, {axles} {where}"
    return [Reason(key, f"{text}.")]


def _unconstrained_wheels(at: Configuration) -> list[Reason]:
    """Return the sentence about wheels without a sliding constraint."""
    bound: list[Wheel] = []  # castors that one motor turns together do constrain the robot
    for wheels in at.robot.together("steer", (w for w in at.robot.wheels if w.kind.swivels)):
        if len(wheels) > 1:
            bound += wheels
    free = [w for w in at.robot.wheels if not w.kind.constrains and w not in bound]
    if not free:
        return []
    kinds = "; ".join(dict.fromkeys(w.kind.words.free for w in free))
    text = f"{_names(free)} impose{'s' if len(free) == 1 else ''} no sliding constraint: {kinds}."
    return [Reason("no_sliding_constraint", text)]


def _degrees(at: Configuration) -> list[Reason]:
    """Return the sentence with the degrees, Siegwart (3.40) to (3.42)."""
    m, s = at.mobility, at.steerability
    text = f"delta_m = 3 - rank C1 = 3 - {3 - m} = {m}; delta_M = {m} + {s} = {m + s}."
    return [Reason("degrees", text, argues=False)]


def _degeneration(at: Configuration) -> list[Reason]:
    """Return the sentence that explains why the robot is degenerate, if it is."""
    if not at.degenerate:
        return []
    if at.mobility == 0:
        key, why = "immobile", "no motion is free of sliding"
    elif skids(at):
        key = "skid_steer"
        why = (
            "its fixed axles are parallel but not on one line, so it turns only by skidding (skid-steer); its "
            f"kinematics are {_kinematics_of_skidding(at.robot)}"
        )
    elif at.rank_fixed.value > 1:
        key, why = "single_motion", "its fixed axles are not one line, which leaves a single motion"
    else:
        key = "no_choice"
        why = (
            "only one motion is left, and steering cannot choose another: delta_M = 1, but each of the five types has "
            "2 or 3"
        )
    text = f"Degenerate: ({at.mobility}, {at.steerability}) is none of Campion's five types, because {why}."
    remedies = []
    for near in at.robot.near:
        if not near.moves:
            remedies.append(f"{_sentence(near.sentence(at.robot.tolerance))} {near.remedies}")
    return [Reason(key, " ".join((text, *remedies)))]


def _kinematics_of_skidding(robot: Robot) -> str:
    """Return the clause that says how the kinematics of a skid-steer robot are solved."""
    if robot.effective_track is not None:
        if any(w.kind.steers for w in robot.wheels):
            return "those of a robot whose fixed wheels are on one axle, the effective track apart"
        return "those of a differential drive of its effective track"
    solved = "least squares and report the residual"
    if not any(no_track(robot.wheels)):
        solved += "; give `effective_track` in the robot file to model how far it turns"
    return solved


def verdict(at: Configuration) -> str:
    """Return the sentence that explains why the robot is degenerate; "" if it is not."""
    return "".join(reason.text for reason in _degeneration(at))


def skids(at: Configuration) -> bool:
    """Return whether a robot is degenerate and turns by skidding.

    Its fixed axles are then parallel but not on one line, some of its fixed wheels are driven, and it has wheels on the
    left and on the right.
    """
    fixed = [w for w in at.robot.wheels if w.kind.fixed_axle]
    lines = _axle_lines(fixed)
    if not (at.degenerate and at.mobility and len(lines) > 1 and any(w.actuated for w in fixed)):
        return False
    if not parallel([line[0].zero_heading for line in lines]):
        return False
    axle = lines[0][0].zero_heading * 1j
    across = [(w.pivot.conjugate() * axle).real for line in lines for w in line]
    return max(across) - min(across) > SAME


def _doubts(at: Configuration) -> list[Reason]:
    """Return a sentence for each rank that depends on the tolerance."""
    found = []
    for name, rank in (("C1f", at.rank_fixed), ("C1", at.rank)):
        if rank.disagrees:
            values = ", ".join(f"{s:.3g}" for s in rank.singular_values)
            text = (
                f"rank {name} is {rank.exact} in exact arithmetic but {rank.value} at the tolerance 1e-9, which is "
                f"used: singular values {values}. Decimals in the file are probably rounded."
            )
            found.append(Reason("rank_differs", text))
        elif rank.value and rank.margin < 1e3:
            text = (
                f"rank {name} = {rank.value} is uncertain: the smallest singular value is only {rank.margin:.3g} times "
                "the tolerance."
            )
            found.append(Reason("rank_uncertain", text))
    return found


def _coincidences(at: Configuration) -> list[Reason]:
    """Return a sentence for each matrix whose rank is lower at the nominal values than at general parameter values.

    A mecanum base whose rollers form an X has rank 3 in general and rank 2 when its two half-lengths are equal.
    """
    parameters = at.robot.parameters
    if not parameters:
        return []
    general = None
    for step in _STEPS:
        general = general or _general(at.robot, step)
    if general is None:
        return []
    at_nominal = constrain(at.robot, nominal_view)
    at_general = constrain(at.robot, at.unit.view(lambda w: general[w.index]))
    nominal = ", ".join(f"{p.name} = {float(p.nominal):.6g}" for p in parameters)
    found = []
    for name, rows_of in (("C1f", _rows_of_C1f), ("J1", _rows_of_J1)):
        own, usual = _rank(rows_of(at_nominal)), _rank(rows_of(at_general))
        if own < usual:
            text = (
                f"The rank of {name} is {own} at the given values ({nominal}) and {usual} for general ones."
            )
            found.append(Reason("coincidence", text))
    return found


def _rows_of_C1f(c: Constraints) -> list[Row]:
    return [r.row for r in c.sliding_fixed]


def _rows_of_J1(c: Constraints) -> list[Row]:
    """Return the rolling rows that do not depend on joint angles."""
    return [r.row for r in c.rolling if not r.wheel.turns]


def _general(robot: Robot, step: int) -> list[Geometry[Poly]] | None:
    """Return the geometry of all wheels with the k-th parameter changed by k ``step`` thousandths.

    Return None if a wheel has no geometry for these values, such as for a root of a negative number.
    """
    values = {}
    for k, p in enumerate(robot.parameters, 1):
        values[p.name] = Poly.of(p.nominal * Fraction(1000 + step * k, 1000))
    try:
        return [w.symbolic.mapped(lambda constant: fix(constant, values)) for w in robot.wheels]
    except (ValueError, ZeroDivisionError):
        return None


def _rank(rows: list[Row]) -> int:
    """Return the rank of those rows that are numbers."""
    numbers = []
    for row in rows:
        constants = [p.constant for p in row]
        values = [value for value in constants if value is not None]
        if len(values) == 3:
            numbers.append(values)
    return numeric_rank(unit_rows(to_array(numbers)))[0]
