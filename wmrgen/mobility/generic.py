"""Ranks at the given values against ranks at general values of the named parameters.

A mecanum base whose rollers form an X has rank 3 in general and rank 2 when its two half-lengths are equal:
a coincidence worth a sentence.
"""

from __future__ import annotations

from dataclasses import fields
from fractions import Fraction

from wmrgen.constraints import constrain, nominal_view
from wmrgen.exact.evaluate import fix
from wmrgen.exact.poly import Poly, Row
from wmrgen.layout.records import Geometry, Robot, Wheel
from wmrgen.mobility.ranks import numeric_rank, to_array, unit_rows
from wmrgen.mobility.unit import Unit


def coincidences(robot: Robot, unit: Unit) -> tuple[str, ...]:
    """One sentence for each matrix whose rank is lower at the given values than in general.

    ``robot``: in ``unit``.
    """
    if not robot.parameters:
        return ()
    values = {
        p.name: Poly.of(p.nominal * Fraction(1000 + 37 * (k + 1), 1000))
        for k, p in enumerate(robot.parameters)
    }

    def general(w: Wheel) -> Geometry[Poly]:
        return Geometry(*(fix(getattr(w.symbolic, f.name), values) for f in fields(Geometry)))

    here, there = constrain(robot, nominal_view), constrain(robot, unit.view(general))
    pairs = (
        ("C1f", [c.row for c in here.sliding_fixed], [c.row for c in there.sliding_fixed]),
        (
            "J1",
            [c.row for c in here.rolling if not c.wheel.turns],
            [c.row for c in there.rolling if not c.wheel.turns],
        ),
    )
    given = ", ".join(f"{p.name} = {float(p.nominal):.6g}" for p in robot.parameters)
    said = []
    for name, rows, others in pairs:
        actual, generic = _rank(rows), _rank(others)
        if actual < generic:
            said.append(
                f"rank {name} is {actual} at the given values ({given}) and {generic} for general ones."
            )
    return tuple(said)


def _rank(rows: list[Row]) -> int:
    numbers = [[value for p in row if (value := p.constant) is not None] for row in rows]
    complete = [row for row in numbers if len(row) == 3]
    return numeric_rank(unit_rows(to_array(complete)))[0]
