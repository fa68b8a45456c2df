"""The mobility argument in words."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from wmrgen.layout.records import Wheel
from wmrgen.mobility.coupled import coupled_sets
from wmrgen.mobility.findings import SAME, Findings, axle, axle_lines, listed
from wmrgen.mobility.generic import coincidences
from wmrgen.mobility.ranks import null_basis, numeric_rank, unit_rows


def reasons(f: Findings) -> tuple[str, ...]:
    """Why the degrees are what they are, one sentence each."""
    return (
        *_fixed(f), *_couplings(f), *_steered(f), *_free_wheels(f), *_degrees(f), *_verdict(f), *_doubts(f),
        *coincidences(f.robot, f.unit),
    )  # fmt: skip


def _free_wheels(f: Findings) -> list[str]:
    free = [w for w in f.robot.wheels if not w.kind.constrains]
    if not free:
        return []
    kinds = "; ".join(dict.fromkeys(w.kind.words.free for w in free))
    return [
        f"{listed([w.name for w in free])} impose{'s' if len(free) == 1 else ''} no sliding constraint: {kinds}."
    ]


def _fixed(f: Findings) -> list[str]:
    fixed = [w for w in f.robot.wheels if w.kind.fixed_axle]
    if not fixed:
        return []
    lines = axle_lines(fixed)
    said = [
        f"{listed([w.name for w in line])} share an axle line, so {_further(len(line))} no constraint."
        for line in lines if len(line) > 1
    ]  # fmt: skip
    if f.rank_fixed.value == 1:
        noun = fixed[0].kind.noun if len({w.type for w in fixed}) == 1 else "fixed wheel"
        wheels, verb = (f"{noun}s", "forbid") if len(fixed) > 1 else (noun, "forbids")
        return [
            *said,
            f"The {wheels} {listed([w.name for w in fixed])} {verb} motion along the axle: rank C1f = 1.",
        ]
    return [*said, _axles_meet(f, [line[0] for line in lines])]


def _axles_meet(f: Findings, wheels: list[Wheel]) -> str:
    """Where several axle lines meet, if anywhere."""
    rows = unit_rows(np.array([axle(w) for w in wheels]))
    if f.rank_fixed.value == 3:
        triple = next(t for t in combinations(range(len(wheels)), 3) if numeric_rank(rows[list(t)])[0] == 3)
        names = listed([wheels[i].name for i in triple])
        return f"The axles of {names} meet in no common point: nothing can move (rank C1f = 3)."
    names = listed([w.name for w in wheels])
    null = null_basis(rows)[0]
    if abs(null[2]) < SAME:
        where, what = "are parallel and distinct", "straight motion along the wheels"
    else:
        vx, vy, omega = f.unit.twists(null)
        x, y = (round(float(v), 12) + 0.0 for v in (-vy / omega, vx / omega))
        where, what = f"meet in ({x:.4g}, {y:.4g})", "rotation about that point"
    return f"The axles of {names} {where}: only {what} slides no wheel (rank C1f = 2)."


def _further(n: int) -> str:
    return "the second adds" if n == 2 else "the others add"


def _couplings(f: Findings) -> list[str]:
    said = []
    for joint, names in f.robot.couplings:
        said.append(
            f"{listed(list(names))} are coupled: their {joint} angles are equal."
            if joint == "steer"
            else f"{listed(list(names))} are coupled: they turn at one speed."
        )
    if f.admissible.normal is not None:
        values = [p.constant for p in f.admissible.normal]
        if values[0] == 0 and values[1] == 0:
            said.append("With equal steering the axles stay parallel: only translation remains, omega = 0.")
        else:
            said.append("The coupled steering admits a plane of twists only.")
    elif not f.admissible.linear:
        said.append("The coupled steering admits a cone of twists only.")
    if coupled_sets(f.robot) and len(f.admissible.chosen) > f.rank_fixed.value:
        said.append("Eliminating the coupled joint rates leaves a further constraint on the body.")
    return said


def _steered(f: Findings) -> list[str]:
    steered = [w for w in f.robot.wheels if w.kind.steers]
    if not steered or not f.mobility:
        return []
    lead = [w.name for w in f.basis_wheels][: f.steerability]
    rest = [w.name for w in steered if w.name not in lead]
    if not f.steerability:
        names = listed([w.name for w in steered])
        return [
            f"{names} can be steered, but one direction alone lets every wheel roll: no freedom of steering is left."
        ]
    said = f"Steering {listed(lead)} chooses the ICR (delta_s = {f.steerability})"
    if rest and f.admissible.normal is not None:
        said += f"; {listed(rest)} must point the same way round"
    elif rest:
        axles = "its axle" if len(rest) == 1 else "their axles"
        said += f"; {listed(rest)} must follow, {axles} through the same point"
    return [said + "."]


def _degrees(f: Findings) -> list[str]:
    m, s = f.mobility, f.steerability
    return [f"delta_m = 3 - rank C1 = 3 - {3 - m} = {m}; delta_M = {m} + {s} = {m + s}."]


def _verdict(f: Findings) -> list[str]:
    pair = (f.mobility, f.steerability)
    if not f.degenerate:
        return []
    fixed = [w for w in f.robot.wheels if w.kind.fixed_axle]
    lines = axle_lines(fixed)
    if f.mobility == 0:
        why = "no motion is free of sliding"
    elif len(lines) > 1 and any(w.actuated for w in fixed) and _skid(lines):
        why = (
            "its fixed axles are several parallel lines: it turns only by skidding (skid-steer); "
            "kinematics are least squares and report the residual"
        )
    elif len(lines) > 1:
        why = "its fixed axles are not one line, which leaves a single motion"
    else:
        why = "couplings or parallel steering leave fewer freedoms than any useful robot has"
    return [f"Degenerate: ({pair[0]}, {pair[1]}) is none of Campion's five types, because {why}."]


def _skid(lines: list[list[Wheel]]) -> bool:
    """Parallel axles with wheels side by side: left and right can be driven apart."""
    rows = np.array([axle(line[0]) for line in lines])
    if np.abs(rows[:, 0] * rows[0, 1] - rows[:, 1] * rows[0, 0]).max() > SAME:
        return False
    across = [
        float(w.nominal.x) * rows[0, 0] + float(w.nominal.y) * rows[0, 1] for line in lines for w in line
    ]
    return bool(max(across) - min(across) > SAME)


def _doubts(f: Findings) -> list[str]:
    said = []
    for name, rank in (("C1f", f.rank_fixed), ("C1", f.rank)):
        if rank.disagrees:
            values = ", ".join(f"{s:.3g}" for s in rank.singular_values)
            said.append(
                f"rank {name} is {rank.exact} in exact arithmetic but {rank.value} at the tolerance 1e-9, which rules: "
                f"singular values {values}. Decimals in the file are likely rounded."
            )
        elif rank.value and rank.margin < 1e3:
            said.append(f"rank {name} = {rank.value} is a close call: {rank.margin:.3g} times the tolerance.")
    return said
