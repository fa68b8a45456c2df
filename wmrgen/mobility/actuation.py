"""What is actuated beyond or short of need."""

from __future__ import annotations

import numpy as np

from wmrgen.layout.records import Wheel
from wmrgen.mobility.configure import steering_for
from wmrgen.mobility.findings import Findings
from wmrgen.mobility.ranks import null_basis, unit_rows
from wmrgen.mobility.records import Array


def actuation(f: Findings) -> tuple[str, ...]:
    """One sentence for driving, one for steering."""
    robot = f.robot
    spins = [w for w in robot.wheels if "spin" in w.actuated]
    swivelled = [w for w in robot.wheels if w.kind.swivels and "steer" in w.actuated]
    free = null_basis(unit_rows(f.at)) if f.at.size else np.eye(3)
    rows = [_rate_row(w, f) for w in spins]
    rows += [_castor_row(w) for w in swivelled]
    grip = (
        int(np.linalg.matrix_rank(unit_rows(np.array(rows)) @ free.T, tol=1e-9)) if rows and len(free) else 0
    )
    motors = len(robot.together("spin", spins)) + len(robot.together("steer", swivelled))
    steering = {robot.steer_group[w.index] for w in robot.wheels if w.kind.steers and "steer" in w.actuated}
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
    g = w.nominal
    c, s = steering_for(w, f.admissible.sample) if w.kind.steers else (float(g.ch), float(g.sh))
    cg, sg = float(g.cg), float(g.sg)
    c, s = c * cg - s * sg, s * cg + c * sg
    x, y = float(g.x), float(g.y)
    row = np.array([c, s, x * s - y * c - float(g.o)])
    return row + float(g.o) / float(g.d) * _castor_slide(w) if w.kind.swivels else row


def _castor_slide(w: Wheel) -> Array:
    g = w.nominal
    c, s, x, y = float(g.ch), float(g.sh), float(g.x), float(g.y)
    return np.array([-s, c, x * c + y * s + float(g.d)])


def _castor_row(w: Wheel) -> Array:
    """The twist row of a castor's steering rate."""
    return -_castor_slide(w) / float(w.nominal.d)
