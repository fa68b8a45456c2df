"""What a calibration leaves over: errors of odometry by time, and of each joint's readings."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from wmrgen.calibrating.certainty import Fit
from wmrgen.calibrating.drawn import drawn
from wmrgen.calibrating.path import Reals
from wmrgen.robot import Derivation

_PARTS = 10  # of a drive


def by_time(best: Fit) -> dict[str, list[tuple[float, float, float]]]:
    """Of each drive, by name: the middle of each tenth [s] and the root mean squares of what odometry is off by in it,
    [m] and [rad]."""
    shared = best.problem.shared(best.unknowns)
    every: dict[str, list[Reals]] = {}
    for index, drive in enumerate(best.problem.drives):
        told = drawn(best.problem, shared, best.offsets[index], index)
        every.setdefault(drive.name, []).append(np.array([told.t, *told.off]))
    return {name: _tenths(np.concatenate(parts, axis=1)) for name, parts in every.items()}


def _tenths(columns: Reals) -> list[tuple[float, float, float]]:
    """Of columns of times and errors of place and heading, a row for each tenth that has any."""
    parts = [part for part in np.array_split(columns, _PARTS, axis=1) if part.size]
    return [(float(t.mean()), _rms([x]), _rms([a])) for t, x, a in parts]


def by_joint(derivation: Derivation, best: Fit) -> dict[str, float]:
    """Root mean squares [rad] of what each step of a wheel's spin differs by from the one that the twist of all joints
    makes of it, by `inverse`: 0 where joints tell no more than a twist."""
    inverse = derivation.numpy().inverse
    names = [port.name for port in derivation.program.formula("inverse").inputs]
    off: dict[str, list[Reals]] = {}
    for drive in best.problem.drives:
        step = best.problem.increments(drive.columns, best.values)
        twist = {"vx": step.position.real, "vy": step.position.imag, "omega": step.heading}
        given = dict(zip(best.problem.increments.parameters, best.values, strict=True))
        inputs = {n: v for n, v in {**twist, **drive.columns, **given}.items() if n in names}
        missing = {n: 0.0 for n in names if n.endswith(".steer") and n not in inputs}
        made = inverse(**inputs, **missing)
        for joint, column in drive.columns.items():
            if joint.endswith(".spin") and joint in made:
                off.setdefault(joint, []).append(np.abs(np.abs(column) - np.abs(made[joint])))
    return {joint: _rms(parts) for joint, parts in off.items()}


def _rms(parts: Iterable[Reals]) -> float:
    every = np.concatenate([np.ravel(part) for part in parts])
    return float(np.sqrt(np.mean(every**2)))
