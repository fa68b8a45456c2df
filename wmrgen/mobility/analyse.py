"""Mobility, steerability, maneuverability: one rule for every layout."""

from __future__ import annotations

import numpy as np

from wmrgen.constraints import symbolic_view, working_view
from wmrgen.exact.evaluate import fix
from wmrgen.exact.poly import Row
from wmrgen.layout.records import Robot
from wmrgen.mobility.basis import basis, null_columns, turning
from wmrgen.mobility.configure import configuration, in_metres
from wmrgen.mobility.ranks import growth_vector, null_basis, unit_rows
from wmrgen.mobility.reasons import actuation, reasons
from wmrgen.mobility.records import Mobility
from wmrgen.mobility.singular import singularities


def analyse(robot: Robot) -> Mobility:
    """Degrees, ranks, reachable dimensions and the reasons for them."""
    at = configuration(robot)
    rows = basis(robot, at)
    now = null_basis(unit_rows(at.at)) if at.mobility else np.zeros((0, 3))
    symbolic = null_columns([row.row(symbolic_view) for row in rows]) if at.mobility else ()
    columns = tuple(fixed(column, robot) for column in symbolic)
    leaders = (robot.wheels[robot.steer_group[w.index]].name for w in turning(rows))
    return Mobility(
        degree_of_mobility=at.mobility, degree_of_steerability=at.steerability,
        rank_C1f=at.rank_fixed, rank_C1=at.rank, dof=at.dof,
        reasons=reasons(at, turning(rows)), actuation=actuation(at),
        growth_vector=growth_vector(now, at.admissible.tangent, at.steerability),
        singularities=singularities(at, turning(rows), columns),
        admissible=in_metres(at.admissible, at.unit),
        basis_rows=tuple(row.row(working_view) for row in rows), basis_wheels=tuple(dict.fromkeys(leaders)),
        null_space=columns, null_space_symbolic=symbolic,
    )  # fmt: skip


def fixed(row: Row, robot: Robot) -> Row:
    """A row with the parameters that are not tunable at their values."""
    return fix(row[0], robot.constants), fix(row[1], robot.constants), fix(row[2], robot.constants)
