"""Couplings: what is left of the constraints when joint rates are eliminated.

In general the left null space of the joint-rate columns, couplings applied, times the xi columns constrains
the twist. An uncoupled wheel needs no elimination: its spin takes the rolling row, a castor's steering rate
takes the sliding row. Only coupled sets of wheels are worked out.
"""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.constraints import ConstraintRow, Constraints
from wmrgen.exact.linalg import left_null_space
from wmrgen.exact.number import ZERO
from wmrgen.exact.poly import Poly, Row
from wmrgen.layout.records import Robot


def coupled_sets(robot: Robot) -> list[frozenset[int]]:
    """Connected sets of wheels that share a coupled joint, each of two wheels or more; steered wheels left out."""
    sets: list[set[int]] = []
    for group in (robot.spin_group, robot.steer_group):
        for leader in dict.fromkeys(group):
            members = {i for i, g in enumerate(group) if g == leader and not robot.wheels[i].kind.steers}
            if len(members) < 2:
                continue
            touching = [s for s in sets if s & members]
            sets = [s for s in sets if not s & members]
            sets.append(members.union(*touching))
    return [frozenset(s) for s in sets]


def eliminate(robot: Robot, rows: Sequence[ConstraintRow]) -> list[Row]:
    """The combinations of ``rows`` (numeric joint coefficients) in which no joint rate occurs."""
    if not rows:
        return []

    def column(key: tuple[int, str]) -> tuple[int, str]:
        wheel, joint = key
        return (robot.spin_group if joint == "spin" else robot.steer_group)[wheel], joint

    keys = sorted({column(key) for c in rows for key, _ in c.rates})
    table = []
    for c in rows:
        line = [ZERO] * len(keys)
        for key, k in c.rates:
            number = k.constant
            line[keys.index(column(key))] += number if number is not None else ZERO
        table.append(line)
    if not keys:
        return [c.row for c in rows]
    combined: list[Row] = []
    for weights in left_null_space(table):
        parts = [Poly({}), Poly({}), Poly({})]
        for w, c in zip(weights, rows, strict=True):
            parts = [p + v.scale(w) for p, v in zip(parts, c.row, strict=True)] if w else parts
        combined.append((parts[0], parts[1], parts[2]))
    return [row for row in combined if any(row)]


def constant_rows(c: Constraints) -> list[tuple[Row, int | None]]:
    """Rows on xi that do not depend on a steered wheel, each with the fixed wheel it comes from.

    The wheel is None for a combination that a coupling produced. A castor's angle may remain in a row (two
    castors turned by one motor). Couplings with steered wheels are treated with the steering.
    """
    rows: list[tuple[Row, int | None]] = []
    sets = coupled_sets(c.robot)
    inside = frozenset[int]().union(*sets)
    for s in sets:
        members = [r for r in (*c.rolling, *c.sliding) if r.wheel.index in s]
        free = {id(r) for r in members if r.kind == "sliding" and not r.rates}
        rows += [(r.row, r.wheel.index) for r in members if id(r) in free]
        rows += [(row, None) for row in eliminate(c.robot, [r for r in members if id(r) not in free])]
    rows += [(r.row, r.wheel.index) for r in c.sliding_fixed if r.wheel.index not in inside]
    return [(row, wheel) for row, wheel in rows if any(row)]


def geared(robot: Robot) -> list[tuple[int, int]]:
    """Pairs of wheels with equal spins, of which the second steers; each wheel of a group once, after the first.

    The first of a pair does not steer where the group has such a wheel. Wheels that steer together follow the first
    of them.
    """
    pairs: list[tuple[int, int]] = []
    for members in robot.together("spin", robot.wheels):
        first = min(members, key=lambda w: (w.kind.steers, w.index))
        for unit in robot.together("steer", (w for w in members if w.kind.steers)):
            if unit[0] is not first:
                pairs.append((first.index, unit[0].index))
            pairs += [(unit[0].index, w.index) for w in unit[1:]]
    return pairs


def coupled_steering(robot: Robot) -> bool:
    """Whether the steering of wheels is tied to other joints."""
    steered = [w.index for w in robot.wheels if w.kind.steers]
    return len({robot.steer_group[i] for i in steered}) < len(steered) or bool(geared(robot))
