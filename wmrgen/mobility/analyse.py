"""Mobility, steerability, maneuverability: one rule for every layout."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from wmrgen.constraints import (
    Constraints,
    View,
    constrain,
    nominal_view,
    rolling_row,
    sliding_row,
    symbolic_view,
    working_view,
)
from wmrgen.exact.evaluate import fix
from wmrgen.exact.number import ZERO
from wmrgen.exact.poly import Gen, Poly, Row
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.actuation import actuation
from wmrgen.mobility.configure import admissible, fixed_numbers, rank_C1
from wmrgen.mobility.coupled import constant_rows, geared
from wmrgen.mobility.findings import Findings
from wmrgen.mobility.freedom import closure, growth_vector
from wmrgen.mobility.nullspace import null_columns
from wmrgen.mobility.ranks import decide, independent, null_basis, singular_values, to_array, unit_rows
from wmrgen.mobility.reasons import reasons
from wmrgen.mobility.records import Admissible, Array, Mobility, Rank
from wmrgen.mobility.singular import singularities
from wmrgen.mobility.unit import Unit, unit_of

INDEPENDENT = 1e-3  # smallest singular value of rows taken for clearly independent
MOST_CANDIDATES = 16  # steered wheels among which the independent ones are sought
CAMPION = ((3, 0), (2, 0), (2, 1), (1, 1), (1, 2))


@dataclass(frozen=True, slots=True)
class _Basis:
    """Independent rows of C1 at a generic admissible configuration, and where they come from."""

    sources: tuple[int | None, ...]  # constant rows: the fixed wheel, or None for a coupling
    coupled: tuple[Row, ...]  # the rows of the None sources, in order
    steered: tuple[int, ...]
    spins: tuple[tuple[int, int], ...]  # pairs of wheels with equal spins

    def leaders(self, robot: Robot) -> tuple[str, ...]:
        """The wheels whose joint angles the rows depend on, each coupled set once."""
        return tuple(dict.fromkeys(robot.wheels[robot.steer_group[i]].name for i in self.turning(robot)))

    def turning(self, robot: Robot) -> tuple[int, ...]:
        """The steered wheels that give a row."""
        by_spin = (i for pair in self.spins for i in pair if robot.wheels[i].kind.steers)
        return tuple(dict.fromkeys((*self.steered, *by_spin)))

    def rows(self, robot: Robot, view: View) -> tuple[Row, ...]:
        """The rows in one view of the geometry."""
        spare = iter(self.coupled)
        found = [
            next(spare) if i is None else sliding_row(robot.wheels[i], view(robot.wheels[i])).row
            for i in self.sources
        ]
        found += [_led(robot, sliding_row(robot.wheels[i], view(robot.wheels[i])).row) for i in self.steered]
        found += [_led(robot, _equal_spins(robot.wheels[i], robot.wheels[k], view)) for i, k in self.spins]
        return tuple(found)


def analyse(robot: Robot) -> Mobility:
    """Degrees, ranks, reachable dimensions and the reasons for them."""
    unit = unit_of(robot)
    own = unit.robot(robot)
    c = constrain(own, nominal_view)
    constant = constant_rows(c)
    picked, numbers = admissible(c, [row for row, _ in constant])
    rank, at = rank_C1(own, numbers, picked)
    mobility = 3 - rank.value
    steerability = max(picked.dimension - mobility, 0) if mobility else 0
    basis = _basis(own, unit, constant, picked, at, rank)
    rank_fixed = decide(fixed_numbers(c, [r.row for r in c.sliding_fixed]))
    dof = closure(_all_twists(c, [row for row, _ in constant], picked)) if mobility else 0
    now = null_basis(unit_rows(at)) if mobility else np.zeros((0, 3))
    growth = growth_vector(now, picked.tangent, steerability)
    degenerate = (mobility, steerability) not in CAMPION
    found = Findings(
        own, unit, picked, rank_fixed, rank, mobility, steerability, basis.turning(robot), at, degenerate
    )
    symbolic = null_columns(basis.rows(robot, symbolic_view)) if mobility else ()
    columns = tuple(_fixed(column, robot) for column in symbolic)
    return Mobility(
        degree_of_mobility=mobility, degree_of_steerability=steerability,
        degree_of_maneuverability=mobility + steerability,
        rank_C1f=rank_fixed, rank_C1=rank, ddof=mobility, dof=dof, holonomic=mobility == dof,
        omnidirectional=mobility == 3, robot_type=None if degenerate else (mobility, steerability),
        degenerate=degenerate, reasons=reasons(found), actuation=actuation(found), growth_vector=growth,
        degree_of_nonholonomy=len(growth), singularities=singularities(found, columns),
        admissible=_in_metres(picked, unit),
        basis_rows=basis.rows(robot, working_view), basis_wheels=basis.leaders(robot),
        null_space=columns, null_space_symbolic=symbolic,
    )  # fmt: skip


def _in_metres(picked: Admissible, unit: Unit) -> Admissible:
    """The admissible twists as twists of P in SI units."""
    normal = None if picked.normal is None else unit.row(picked.normal)
    basis, sample, tangent = (unit.twists(rows) for rows in (picked.basis, picked.sample, picked.tangent))
    return replace(picked, normal=normal, basis=basis, sample=sample, tangent=tangent)


def _basis(
    robot: Robot,
    unit: Unit,
    constant: list[tuple[Row, int | None]],
    picked: Admissible,
    at: Array,
    rank: Rank,
) -> _Basis:
    """Constant rows first, then the coupling's own row, then as many steered wheels as the rank needs.

    All but the basis is in ``unit``.
    """
    sources: list[int | None] = [constant[i][1] for i in picked.chosen]
    coupled = [unit.row(constant[i][0]) for i in picked.chosen if constant[i][1] is None]
    head = at[: len(sources)]
    if picked.normal is not None:
        sources.append(None)
        coupled.append(unit.row(picked.normal))
        head = np.vstack([head, to_array([[p.constant or ZERO for p in picked.normal]])])
    steered = [w.index for w in robot.wheels if w.kind.steers]
    pairs = geared(robot)
    rows = unit_rows(np.vstack([head, at[len(picked.chosen) :]]))
    chosen = _chosen(robot, rows, len(head), steered, rank.value)
    keep = [i for i in chosen if i < len(head)]
    if len(keep) < len(head):
        coupled = [
            row
            for i, row in zip([k for k, s in enumerate(sources) if s is None], coupled, strict=True)
            if i in keep
        ]
        sources = [sources[i] for i in keep]
    free = [i - len(head) for i in chosen if i >= len(head)]
    return _Basis(
        tuple(sources),
        tuple(coupled),
        tuple(steered[i] for i in free if i < len(steered)),
        tuple(pairs[i - len(steered)] for i in free if i >= len(steered)),
    )


def _fixed(column: Row, robot: Robot) -> Row:
    """A column with the parameters that are not tunable at their values."""
    return fix(column[0], robot.constants), fix(column[1], robot.constants), fix(column[2], robot.constants)


def _chosen(robot: Robot, rows: Array, head: int, steered: list[int], rank: int) -> list[int]:
    """Rows that span: all independent constant ones, and the steered wheels that stay independent longest.

    Rows of equal spins (those after the steered wheels) come where the steered wheels do not suffice.
    Of several choices the one is taken whose axles differ most with every wheel at its zero angle, then with
    every wheel turned by 90 degrees: the posture model is singular where they fall into one line.
    """
    if not rank:
        return []
    constant = independent(rows[:head], min(rank, head)) if head else []
    wanted = rank - len(constant)
    candidates = range(head, head + min(len(steered), MOST_CANDIDATES))
    best: tuple[tuple[float, float], list[int]] | None = None
    for group in combinations(candidates, wanted):
        picked = [*constant, *group]
        if singular_values(rows[picked])[-1] < INDEPENDENT:
            continue
        wheels = [robot.wheels[steered[i - head]] for i in group]
        apart = [_apart(rows[constant], wheels, turned) for turned in (False, True)]
        score = (round(apart[0], 6), round(apart[1], 6))
        if best is None or score > best[0]:
            best = (score, picked)
    return best[1] if best is not None else independent(rows, rank)


def _apart(constant: Array, wheels: list[Wheel], turned: bool) -> float:
    """The smallest singular value of the rows with every steered wheel at its zero angle, or turned."""
    rows = [list(map(float, row)) for row in constant]
    for w in wheels:
        c, s, x, y = (float(v) for v in (w.nominal.ch, w.nominal.sh, w.nominal.x, w.nominal.y))
        c, s = (-s, c) if turned else (c, s)
        rows.append([-s, c, x * c + y * s])
    return singular_values(np.array(rows).reshape(-1, 3))[-1] if rows else 0.0


def _equal_spins(a: Wheel, b: Wheel, view: View) -> Row:
    """r_b e_a - r_a e_b: the rolling rows of two wheels that turn alike."""
    p, q = view(a), view(b)
    x, y, k = (
        u * q.rolling_radius - v * p.rolling_radius
        for u, v in zip(rolling_row(a, p).row, rolling_row(b, q).row, strict=True)
    )
    return x, y, k


def _led(robot: Robot, row: Row) -> Row:
    """A row of steered wheels in the joint angles of the wheels that their couplings follow."""

    def value(gen: Gen) -> Poly | None:
        if gen.kind not in ("cos", "sin"):
            return None
        return Poly.gen(gen.kind, robot.wheels[robot.steer_group[robot.wheel(gen.name).index]].name)

    return row[0].substitute(value), row[1].substitute(value), row[2].substitute(value)


def _all_twists(c: Constraints, rows: list[Row], picked: Admissible) -> Array:
    """A spanning set of every admissible twist, over castor angles where those matter."""
    if any(g.kind in ("cos", "sin") for row in rows for p in row for g in p.generators):
        return np.vstack([admissible(c, rows, seed)[0].basis for seed in range(3)])
    return picked.basis
