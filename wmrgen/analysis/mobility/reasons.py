"""The mobility argument in words: why the degrees are what they are."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import combinations

import numpy as np

from wmrgen.analysis.mobility.admissible import along, coupled_sets
from wmrgen.analysis.mobility.configure import Configuration
from wmrgen.analysis.mobility.ranks import null_basis, numeric_rank, to_array, unit_rows
from wmrgen.analysis.mobility.records import TOLERANCE, Array
from wmrgen.geometry.constraints import constrain, nominal_view
from wmrgen.geometry.exact.evaluate import fix
from wmrgen.geometry.exact.poly import Poly, Row
from wmrgen.geometry.layout.records import Geometry, Robot, Wheel
from wmrgen.geometry.layout.skid import no_track, parallel
from wmrgen.geometry.notation import in_code, steering, turning

_STEPS = (37, -37, 3, -3)  # thousandths of parameters: sqrt(2 - b) has no value beyond b = 2
SAME = 1e-9


def reasons(at: Configuration, deciding: tuple[Wheel, ...]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Why the degrees are what they are, one sentence each, names of wheels in backticks; and of these sentences those
    that argue, without what the layout or a definition says: axles taken for one, couplings, (3.40) to (3.42).

    ``deciding``: the steered wheels that give a row of C1.
    """
    axles = _fixed(at)
    wheels = (*_coupled(at), *_steered(at, deciding), *_free_wheels(at))
    remarks = (*filter(None, [verdict(at)]), *_doubts(at), *_coincidences(at))
    every = (*axles, *_taken_for_one(at), *_couplings(at), *wheels, *_degrees(at), *remarks)
    return every, (*axles, *wheels, *remarks)


def _names(wheels: Iterable[Wheel]) -> str:
    return in_code(w.name for w in wheels)


def _axle(w: Wheel) -> Array:
    """The sliding row of a fixed wheel: its axle line, unit direction."""
    return along(w, 1j * w.zero_heading)


def _axle_lines(wheels: list[Wheel]) -> list[list[Wheel]]:
    """Fixed wheels grouped by axle line."""
    lines: list[list[Wheel]] = []
    for w in wheels:
        same = (line for line in lines if _one_line(_axle(w), _axle(line[0])))
        line = next(same, None)
        if line is None:
            lines.append([w])
        else:
            line.append(w)
    return lines


def _one_line(a: Array, b: Array) -> bool:
    return bool(min(np.abs(a - b).max(), np.abs(a + b).max()) < SAME)


def _taken_for_one(at: Configuration) -> list[str]:
    return [_sentence(near.sentence(at.robot.tolerance)) for near in at.robot.near if near.moves]


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


def _fixed(at: Configuration) -> list[str]:
    fixed = [w for w in at.robot.wheels if w.kind.fixed_axle]
    if not fixed:
        return []
    lines = _axle_lines(fixed)
    sentences = [
        f"{_names(line)} share an axle line, so "
        f"{'the second adds' if len(line) == 2 else 'the others add'} no constraint."
        for line in lines
        if len(line) > 1
    ]
    if at.rank_fixed.value == 1:
        noun = fixed[0].kind.noun if len({w.type for w in fixed}) == 1 else "wheel"
        wheels, verb = (f"{noun}s", "forbid") if len(fixed) > 1 else (noun, "forbids")
        return [
            *sentences,
            f"The {wheels} {_names(fixed)} {verb} motion along the axle: rank C1f = 1.",
        ]
    return [*sentences, _axles_meet(at, [line[0] for line in lines])]


def apart(at: Configuration) -> tuple[str, ...]:
    """Three fixed wheels whose axles meet in no common point, where rank C1f is 3."""
    if at.rank_fixed.value < 3:
        return ()
    wheels = [line[0] for line in _axle_lines([w for w in at.robot.wheels if w.kind.fixed_axle])]
    rows = unit_rows(np.array([_axle(w) for w in wheels]))
    triple = next(t for t in combinations(range(len(wheels)), 3) if numeric_rank(rows[list(t)])[0] == 3)
    return tuple(wheels[i].name for i in triple)


def _axles_meet(at: Configuration, wheels: list[Wheel]) -> str:
    """Where several axle lines meet, if anywhere."""
    if three := apart(at):
        return f"The axles of {in_code(three)} meet in no common point: nothing can move (rank C1f = 3)."
    (null,) = null_basis(unit_rows(np.array([_axle(w) for w in wheels])))
    if abs(null[2]) < SAME:
        where, what = "are parallel and distinct", "straight motion along the wheels"
    else:
        vx, vy, omega = at.unit.twists(null)
        x, y = (round(float(v), 12) + 0.0 for v in (-vy / omega, vx / omega))
        where, what = f"meet in ({x:.4g}, {y:.4g})", "rotation about that point"
    return f"The axles of {_names(wheels)} {where}: only {what} slides no wheel (rank C1f = 2)."


def _couplings(at: Configuration) -> list[str]:
    sentences = []
    for joint, names in at.robot.couplings:
        ratios = at.robot.ratios(joint, names)
        equal = "their steering angles are equal"
        what = (
            f"they {turning(ratios)}" if joint == "spin" else f"they {steering(ratios)}" if ratios else equal
        )
        sentences.append(f"{in_code(names)} are coupled: {what}.")
    return sentences


def _coupled(at: Configuration) -> list[str]:
    """What couplings leave of the motion."""
    sentences = []
    normal, joints = at.admissible.normal, {joint for joint, _ in at.robot.couplings}
    admit = {"steer": "The coupled steering admits", "spin": "The coupled spins admit"}
    who = admit[min(joints)] if len(joints) == 1 else "The couplings admit"
    if normal is not None:
        if normal[0] or normal[1]:
            sentences.append(f"{who} a plane of twists only.")
        elif "steer" in joints and all(w.steer_sign > 0 for w in at.robot.wheels):
            sentences.append(
                "With equal steering the axles stay parallel: only translation remains, omega = 0."
            )
        else:
            sentences.append(f"{who} translation only, omega = 0.")
    elif not at.admissible.linear:
        sentences.append(f"{who} a cone of twists only.")
    if coupled_sets(at.robot) and len(at.constant) > at.rank_fixed.value:
        sentences.append("Eliminating the coupled joint rates leaves a further constraint on the body.")
    return sentences


def _steered(at: Configuration, deciding: tuple[Wheel, ...]) -> list[str]:
    steered = [w.name for w in at.robot.wheels if w.kind.steers]
    if not steered or not at.mobility:
        return []
    if not at.steerability:
        return [
            f"{in_code(steered)} can be steered, but one direction alone lets every wheel roll: "
            "no degree of freedom of steering is left."
        ]
    leaders = [at.robot.wheels[at.robot.steer_group[w.index]].name for w in deciding]
    lead = list(dict.fromkeys(leaders))[: at.steerability]
    rest = [name for name in steered if name not in lead]
    chosen = "ICR" if np.abs(at.admissible.basis[:, 2]).max() > TOLERANCE else "direction of motion"
    does = f"chooses the {chosen}"
    if chosen == "ICR" and at.mobility > 1:
        does = "turns the axle on which the ICR lies"
    sentence = f"Steering {in_code(lead)} {does} (delta_s = {at.steerability})"
    if rest and chosen != "ICR":
        sentence += f"; {in_code(rest)} must point the same way"
    elif rest:
        axles = "its axle" if len(rest) == 1 else "their axles"
        where = "through the same point" if at.mobility == 1 else "on the same line"
        sentence += f"; {in_code(rest)} must follow, {axles} {where}"
    return [sentence + "."]


def _free_wheels(at: Configuration) -> list[str]:
    together = at.robot.together("steer", (w for w in at.robot.wheels if w.kind.swivels))
    bound = [w for wheels in together if len(wheels) > 1 for w in wheels]  # castors of one motor do constrain
    free = [w for w in at.robot.wheels if not w.kind.constrains and w not in bound]
    if not free:
        return []
    kinds = "; ".join(dict.fromkeys(w.kind.words.free for w in free))
    return [f"{_names(free)} impose{'s' if len(free) == 1 else ''} no sliding constraint: {kinds}."]


def _degrees(at: Configuration) -> list[str]:
    m, s = at.mobility, at.steerability
    return [f"delta_m = 3 - rank C1 = 3 - {3 - m} = {m}; delta_M = {m} + {s} = {m + s}."]


def verdict(at: Configuration) -> str:
    """Why the robot is degenerate; "" where it is not."""
    if not at.degenerate:
        return ""
    if at.mobility == 0:
        why = "no motion is free of sliding"
    elif skids(at):
        solved = "those of a differential drive of its effective track"
        if any(w.kind.steers for w in at.robot.wheels):
            solved = "those of a robot whose fixed wheels are on one axle, the effective track apart"
        if at.robot.effective_track is None:
            solved = "least squares and report the residual"
            if not any(no_track(at.robot.wheels)):
                solved += "; `effective_track` in the robot file would say how far it turns"
        why = (
            "its fixed axles are several parallel lines: it turns only by skidding (skid-steer); "
            f"kinematics are {solved}"
        )
    elif at.rank_fixed.value > 1:
        why = "its fixed axles are not one line, which leaves a single motion"
    else:
        why = "one motion is left, and steering chooses no other: delta_M = 1; each of the five has 2 or 3"
    text = f"Degenerate: ({at.mobility}, {at.steerability}) is none of Campion's five types, because {why}."
    missed = (near for near in at.robot.near if not near.moves)
    misses = (f"{_sentence(near.sentence(at.robot.tolerance))} {near.remedies}" for near in missed)
    return " ".join((text, *misses))


def skids(at: Configuration) -> bool:
    """Parallel axles with wheels side by side, so that left and right can be driven apart, and no other way to turn."""
    fixed = [w for w in at.robot.wheels if w.kind.fixed_axle]
    lines = _axle_lines(fixed)
    if not (at.degenerate and at.mobility and len(lines) > 1 and any(w.actuated for w in fixed)):
        return False
    if not parallel([line[0].zero_heading for line in lines]):
        return False
    axle = lines[0][0].zero_heading * 1j
    across = [(w.pivot.conjugate() * axle).real for line in lines for w in line]
    return max(across) - min(across) > SAME


def _doubts(at: Configuration) -> list[str]:
    sentences = []
    for name, rank in (("C1f", at.rank_fixed), ("C1", at.rank)):
        if rank.disagrees:
            values = ", ".join(f"{s:.3g}" for s in rank.singular_values)
            sentences.append(
                f"rank {name} is {rank.exact} in exact arithmetic but {rank.value} at the tolerance 1e-9, which rules: "
                f"singular values {values}. Decimals in the file are likely rounded."
            )
        elif rank.value and rank.margin < 1e3:
            sentences.append(
                f"rank {name} = {rank.value} is a close call: {rank.margin:.3g} times the tolerance."
            )
    return sentences


def _coincidences(at: Configuration) -> list[str]:
    """A sentence for each matrix whose rank is lower at the given values than at general ones of the parameters.

    A mecanum base whose rollers form an X has rank 3 in general and rank 2 when its two half-lengths are equal.
    """
    parameters = at.robot.parameters
    if not parameters:
        return []
    general = next((found for step in _STEPS if (found := _general(at.robot, step))), None)
    if general is None:
        return []
    at_nominal = constrain(at.robot, nominal_view)
    at_general = constrain(at.robot, at.unit.view(lambda w: general[w.index]))
    nominal = ", ".join(f"{p.name} = {float(p.nominal):.6g}" for p in parameters)
    sentences = []
    for name, ranks in (
        ("C1f", [_rank([r.row for r in c.sliding_fixed]) for c in (at_nominal, at_general)]),
        ("J1", [_rank([r.row for r in c.rolling if not r.wheel.turns]) for c in (at_nominal, at_general)]),
    ):
        if ranks[0] < ranks[1]:
            sentences.append(
                f"The rank of {name} is {ranks[0]} at the given values ({nominal}) and {ranks[1]} for general ones."
            )
    return sentences


def _general(robot: Robot, step: int) -> list[Geometry[Poly]] | None:
    """The wheels where each parameter is off by its own multiple of ``step`` thousandths; None where one has no place
    then, such as beyond the end of a root's domain."""
    values = {
        p.name: Poly.of(p.nominal * Fraction(1000 + step * (k + 1), 1000))
        for k, p in enumerate(robot.parameters)
    }
    try:
        return [w.symbolic.mapped(lambda constant: fix(constant, values)) for w in robot.wheels]
    except (ValueError, ZeroDivisionError):
        return None


def _rank(rows: list[Row]) -> int:
    """The rank of the rows that are numbers."""
    numbers = [[value for p in row if (value := p.constant) is not None] for row in rows]
    return numeric_rank(unit_rows(to_array([row for row in numbers if len(row) == 3])))[0]
