"""The mobility argument in words."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from wmrgen.constraints import Constraints
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.coupled import coupled_sets
from wmrgen.mobility.ranks import null_basis, numeric_rank, unit_rows
from wmrgen.mobility.records import Admissible, Array, Rank

_SAME = 1e-9


@dataclass(frozen=True, slots=True)
class Findings:
    """What the sentences are about. ``at``: rows of C1 at the sample configuration."""

    robot: Robot
    constraints: Constraints
    admissible: Admissible
    rank_fixed: Rank
    rank: Rank
    mobility: int
    steerability: int
    basis: tuple[int, ...]
    at: Array
    degenerate: bool

    @property
    def basis_wheels(self) -> tuple[Wheel, ...]:
        """The steered wheels among the independent rows."""
        return tuple(self.robot.wheels[i] for i in self.basis)


def listed(names: list[str]) -> str:
    """a, b and c"""
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


def reasons(f: Findings) -> tuple[str, ...]:
    """Why the degrees are what they are, one sentence each."""
    return (
        *_free_wheels(f), *_fixed(f), *_couplings(f), *_steered(f), *_degrees(f), *_verdict(f), *_doubts(f),
    )  # fmt: skip


def _free_wheels(f: Findings) -> list[str]:
    free = [w for w in f.robot.wheels if w.type not in ("fixed", "steered")]
    if not free:
        return []
    why = {
        "castor": "a castor swivels into any motion",
        "swedish": "the rollers of a Swedish wheel give way across the wheel",
        "spherical": "a sphere rolls any way",
    }
    kinds = "; ".join(why[t] for t in dict.fromkeys(w.type for w in free))
    return [f"{listed([w.name for w in free])} impose{'s' if len(free) == 1 else ''} no sliding constraint: {kinds}."]


def _axle(w: Wheel) -> Array:
    """The sliding row of a fixed wheel: its axle line, unit direction."""
    g = w.nominal
    c, s, x, y = float(g.ch), float(g.sh), float(g.x), float(g.y)
    return np.array([-s, c, x * c + y * s])


def axle_lines(wheels: list[Wheel]) -> list[list[Wheel]]:
    """Fixed wheels grouped by axle line."""
    lines: list[list[Wheel]] = []
    for w in wheels:
        row = _axle(w)
        for line in lines:
            first = _axle(line[0])
            if min(np.abs(row - first).max(), np.abs(row + first).max()) < _SAME:
                line.append(w)
                break
        else:
            lines.append([w])
    return lines


def _fixed(f: Findings) -> list[str]:
    fixed = [w for w in f.robot.wheels if w.type == "fixed"]
    if not fixed:
        return []
    lines = axle_lines(fixed)
    said = [
        f"{listed([w.name for w in line])} share an axle line, so {_further(len(line))} no constraint."
        for line in lines if len(line) > 1
    ]  # fmt: skip
    if len(lines) == 1:
        said.append(
            f"The fixed wheel{'s' if len(fixed) > 1 else ''} {listed([w.name for w in fixed])} forbid"
            f"{'s' if len(fixed) == 1 else ''} motion along the axle: rank C1f = 1."
        )
        return said
    names = [w.name for w in (line[0] for line in lines)]
    rows = unit_rows(np.array([_axle(line[0]) for line in lines]))
    if f.rank_fixed.value == 3:
        triple = next(t for t in combinations(range(len(lines)), 3) if numeric_rank(rows[list(t)])[0] == 3)
        return [*said, f"The axles of {listed([names[i] for i in triple])} meet in no common point: nothing can move (rank C1f = 3)."]
    null = null_basis(rows)[0]
    if abs(null[2]) < _SAME:
        return [*said, f"The axles of {listed(names)} are parallel and distinct: only straight motion along the wheels slides no wheel (rank C1f = 2)."]
    x, y = -null[1] / null[2], null[0] / null[2]
    return [*said, f"The axles of {listed(names)} meet in ({x:.4g}, {y:.4g}): only rotation about that point slides no wheel (rank C1f = 2)."]


def _further(n: int) -> str:
    return "the second adds" if n == 2 else "the others add"


def _couplings(f: Findings) -> list[str]:
    said = []
    for joint, names in f.robot.couplings:
        said.append(f"{listed(list(names))} are coupled: their {joint} angles are equal." if joint == "steer" else f"{listed(list(names))} are coupled: they turn at one speed.")
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
    steered = [w for w in f.robot.wheels if w.type == "steered"]
    if not steered or not f.mobility:
        return []
    lead = [w.name for w in f.basis_wheels][: f.steerability]
    rest = [w.name for w in steered if w.name not in lead]
    if not f.steerability:
        return [f"{listed([w.name for w in steered])} can be steered, but only one direction lets every wheel roll: no freedom of steering is left."]
    said = f"Steering {listed(lead)} chooses the ICR (delta_s = {f.steerability})" if lead else f"delta_s = {f.steerability}"
    if rest and lead:
        said += f"; {listed(rest)} must point the same way round" if f.admissible.normal is not None else f"; {listed(rest)} must follow, {'its axle' if len(rest) == 1 else 'their axles'} through the same point"
    return [said + "."]


def _degrees(f: Findings) -> list[str]:
    return [f"delta_m = 3 - rank C1 = 3 - {3 - f.mobility} = {f.mobility}; delta_M = {f.mobility} + {f.steerability} = {f.mobility + f.steerability}."]


def _verdict(f: Findings) -> list[str]:
    pair = (f.mobility, f.steerability)
    if not f.degenerate:
        return []
    fixed = [w for w in f.robot.wheels if w.type == "fixed"]
    lines = axle_lines(fixed)
    if f.mobility == 0:
        why = "no motion is free of sliding"
    elif len(lines) > 1 and any(w.actuated for w in fixed) and _skid(lines):
        why = "its fixed axles are several parallel lines: it turns only by skidding (skid-steer); kinematics are least squares and report the residual"
    elif len(lines) > 1:
        why = "its fixed axles are not one line, which leaves a single motion"
    else:
        why = "couplings or parallel steering leave fewer freedoms than any useful robot has"
    return [f"Degenerate: ({pair[0]}, {pair[1]}) is none of Campion's five types, because {why}."]


def _skid(lines: list[list[Wheel]]) -> bool:
    """Parallel axles with wheels side by side: left and right can be driven apart."""
    rows = np.array([_axle(line[0]) for line in lines])
    if np.abs(rows[:, 0] * rows[0, 1] - rows[:, 1] * rows[0, 0]).max() > _SAME:
        return False
    across = [float(w.nominal.x) * rows[0, 0] + float(w.nominal.y) * rows[0, 1] for line in lines for w in line]
    return max(across) - min(across) > _SAME


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


def actuation(f: Findings) -> tuple[str, ...]:
    """What is actuated beyond or short of need."""
    robot = f.robot
    spins = [w for w in robot.wheels if "spin" in w.actuated]
    free = null_basis(unit_rows(f.at)) if f.at.size else np.eye(3)
    rows = [_rate_row(w, f) for w in spins]
    rows += [_castor_row(w, f) for w in robot.wheels if w.type == "castor" and "steer" in w.actuated]
    grip = int(np.linalg.matrix_rank(np.array(rows) @ free.T, tol=1e-9)) if rows and len(free) else 0
    motors = len({robot.spin_group[w.index] for w in spins}) + sum(r.type == "castor" and "steer" in r.actuated for r in robot.wheels)
    steering = {robot.steer_group[w.index] for w in robot.wheels if w.type == "steered" and "steer" in w.actuated}
    said = [_balance("driving", motors, grip, f.mobility)]
    if f.steerability or steering:
        said.append(_balance("steering", len(steering), min(len(steering), f.steerability), f.steerability))
    return tuple(said)


def _balance(what: str, motors: int, grip: int, need: int) -> str:
    head = f"{what}: {motors} actuated joint{'s' if motors != 1 else ''} for {need} freedom{'s' if need != 1 else ''}"
    if grip < need:
        return f"{head}, short by {need - grip}"
    if motors > grip:
        extra = motors - grip
        return f"{head}, {extra} beyond need: {extra} relation{'s' if extra != 1 else ''} must hold between the rates"
    return f"{head}, exactly enough"


def _rate_row(w: Wheel, f: Findings) -> Array:
    """The twist row of a wheel's spin at the sample configuration (rates of castors at their zero angle)."""
    from wmrgen.mobility.configure import steering_for

    g = w.nominal
    c, s = steering_for(w, f.admissible.sample) if w.type == "steered" else (float(g.ch), float(g.sh))
    if w.type == "swedish":
        cg, sg = float(g.cg), float(g.sg)
        c, s = c * cg - s * sg, s * cg + c * sg
    x, y = float(g.x), float(g.y)
    row = np.array([c, s, x * s - y * c - float(g.o)])
    return row + float(g.o) / float(g.d) * _castor_slide(w) if w.type == "castor" else row


def _castor_slide(w: Wheel) -> Array:
    g = w.nominal
    c, s, x, y = float(g.ch), float(g.sh), float(g.x), float(g.y)
    return np.array([-s, c, x * c + y * s + float(g.d)])


def _castor_row(w: Wheel, f: Findings) -> Array:
    """The twist row of a castor's steering rate."""
    return -_castor_slide(w) / float(w.nominal.d)
