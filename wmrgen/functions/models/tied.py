"""Parallel wheels that one motor steers: either their axles are one line, or the robot goes straight.

The two kinds of motion meet where a robot goes straight with those axles on one line. If the axles can never be one
line, as in a synchro drive, the robot goes straight in every motion.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import sympy

from wmrgen.analysis.kinematics.least_squares import NEGLIGIBLE
from wmrgen.analysis.mobility.admissible import along
from wmrgen.analysis.mobility.analyse import towards
from wmrgen.analysis.mobility.basis import led
from wmrgen.analysis.mobility.ranks import numeric_rank
from wmrgen.functions.models.polynomials import zero_condition
from wmrgen.functions.system import Domain
from wmrgen.geometry.constraints import View
from wmrgen.geometry.exact.poly import Row
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.layout.skid import parallel
from wmrgen.geometry.notation import in_backticks
from wmrgen.geometry.symbolic import add, expression, signal, square


def parallel_groups(robot: Robot) -> list[list[Wheel]]:
    """Return groups of parallel steered wheels that turn together; from wheels at one place, only the first."""
    sets: list[list[Wheel]] = []
    for w in (w for w in robot.wheels if w.kind.steers):
        for members in sets:
            same = members[0].steer_sign == w.steer_sign
            alike = same and parallel([members[0].zero_heading, w.zero_heading])
            if alike and robot.steer_group[w.index] == robot.steer_group[members[0].index]:
                if all(abs(w.pivot - other.pivot) > NEGLIGIBLE for other in members):
                    members.append(w)
                break
        else:
            sets.append([w])
    return sets


def only_straight(robot: Robot) -> bool:
    """Return whether such groups prevent every motion that turns the robot.

    This is so if their axles cannot be lines that meet in one point of the axle line of the fixed wheels.
    """
    sets = _groups_apart(robot)
    lines = [(first, second.pivot - first.pivot) for first, second, *_ in sets]
    for members, (first, line) in zip(sets, lines, strict=True):
        if any(abs(((w.pivot - first.pivot) / line).imag) > NEGLIGIBLE for w in members):
            return True
    fixed = [along(w, 1j * w.zero_heading) for w in robot.wheels if w.kind.fixed_axle]
    rows = fixed if fixed and numeric_rank(np.array(fixed))[0] == 1 else []
    every = np.array([*rows, *(along(first, line / abs(line)) for first, line in lines)]).reshape(-1, 3)
    return bool(sets) and numeric_rank(every)[0] > numeric_rank(every * [1, 1, 0])[0]


def where_motions_meet(robot: Robot, view: View, columns: Sequence[Row] | None = None) -> tuple[Domain, ...]:
    """Return where the two kinds of motion meet.

    Args:
        robot: The robot.
        view: Which parameters are symbols.
        columns: Null space of a model that has only one kind of motion; None for a model in twist inputs, which has
            both.

    Returns:
        One domain, or none if the robot has no such groups.
    """
    sets = _groups_apart(robot)
    if not sets or only_straight(robot):
        return ()
    who, omega = f"{in_backticks(w.name for m in sets for w in m)}, which turn together", signal("omega")
    gap = led(robot, towards(sets[0][0], sets[0][1], view))  # 0 where the axles of the first set are one line
    if columns is None:
        if len(sets) > 1:
            lines = len(sets) + any(w.kind.fixed_axle for w in robot.wheels)
            everywhere = lines > 2  # to turn, three lines would have to meet in one point
            when = "moves" if everywhere else "goes straight"
            text = f"the robot {when}: the constraints of {who}, are dependent"
            return (Domain(sympy.S.Zero if everywhere else omega, text),)
        text = f"the robot goes straight with {who}, on one line: their constraints are dependent"
        return (Domain(add(square(omega), square(expression(gap))), text),)
    if len(sets) > 1 or len(columns) > 1:
        return ()
    text = f"the axles of {who}, are on one line: there the robot can also turn about the points of the line"
    if columns[0][2]:
        gap, text = columns[0][2], f"the robot goes straight: {who}, allow this at any angle"
    return (Domain(expression(zero_condition(gap)), f"{text} (the form `twist` has these motions)"),)


def _groups_apart(robot: Robot) -> list[list[Wheel]]:
    """Return the groups whose wheels are at two places or more."""
    return [members for members in parallel_groups(robot) if len(members) > 1]
