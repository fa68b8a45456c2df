"""Notes on a calibration in addition to its numbers, one sentence each."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, isfinite

from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import default_range
from wmrgen.tools.calibration.result import Calibration
from wmrgen.tools.calibration.written import beyond

_LATE = 0.02  # [s] that a clock is off by, to be worth a sentence
_EACH = 6  # clocks or slips that get a sentence each; more of them share one


def notes(robot: Robot, result: Calibration) -> list[str]:
    """Return the sentences."""
    return [
        *_turns(result), *_gains(result), *_open(result), *_mount(result), *_clocks(result), *_gyro(result),
        *_slips(result), *_folds(result), *_noise(result), *_ranges(robot, result),
    ]  # fmt: skip


def _turns(result: Calibration) -> list[str]:
    if not result.alternatives:
        return []
    every = [
        f"{abs(other.turns):.4g} turns: {_values(other.parameters)}" for other in result.alternatives[:_EACH]
    ]
    return [
        f"The reference does not determine how often the robot turned. {abs(result.turns):.4g} turns are assumed. "
        f"Also possible: {'; '.join(every)}. Record cumulative headings, or more poses on the way."
    ]


def _gains(result: Calibration) -> list[str]:
    return [
        f"Multiply readings of {name.removesuffix('.gain')} by {e.value:.5g} before they go into the model: "
        "a robot file has no key for this."
        for name, e in result.parameters.items()
        if name.endswith(".gain") and e.sigma is not None
    ]


def _values(values: dict[str, float]) -> str:
    return ", ".join(f"{name} {value:.4g}" for name, value in values.items())


def _open(result: Calibration) -> list[str]:
    said = []
    for group in result.unobservable:
        if any(name.startswith("mount.") for name in group):
            continue
        if len(group) == 1:
            said.append(f"These drives do not determine {group[0]}. It stays nominal.")
        else:
            said.append(
                f"These drives determine {_and(group)} only together. Use their values together, or measure one."
            )
    return said


def _and(names: Sequence[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"


def _mount(result: Calibration) -> list[str]:
    said = []  # of what has a deviation: None is not determined, 0 is known
    if result.mount["x"].sigma:
        said.append(f"x = {result.mount['x'].value:.4f} m")
    if result.mount["y"].sigma:
        said.append(f"y = {result.mount['y'].value:.4f} m")
    if result.mount["theta"].sigma:
        said.append(f"a heading of {degrees(result.mount['theta'].value):.2f} deg")
    return [f"The tracked body is at {', '.join(said)} on the robot."] if said else []


def _clocks(result: Calibration) -> list[str]:
    late = {
        n: e
        for n, e in result.clocks.items()
        if e.sigma is not None and abs(e.value) > max(_LATE, 3 * e.sigma)
    }
    if len(late) > _EACH:
        low, high = min(e.value for e in late.values()), max(e.value for e in late.values())
        return [
            f"Clocks of {len(late)} of {len(result.clocks)} references are off, by {low:+.3f} to {high:+.3f} s."
        ]
    return [
        f"{name}: the clock of the reference is {e.value:+.3f} +- {e.sigma:.1g} s off."
        for name, e in late.items()
    ]


def _gyro(result: Calibration) -> list[str]:
    if result.gyro is None:
        return []
    scale, bias = result.gyro.scale, result.gyro.bias
    said = f"Gyro: subtract {bias.value:.3g} +- {bias.sigma:.1g} rad/s from each reading"
    if scale.sigma is None:
        return [f"{said}. These drives turn too little to show its scale."]
    return [f"{said}, and multiply the result by {scale.value:.5g} +- {scale.sigma:.1g}."]


def _slips(result: Calibration) -> list[str]:
    slips = result.slips
    said = [
        f"{s.log}: wheels slip at t = {s.start:.1f} s, by {s.moved:.2g} m and {abs(s.turned):.2g} rad. "
        "This part is left out."
        for s in slips[:_EACH]
    ]
    return [*said, f"{len(slips) - _EACH} more slips are left out."] if len(slips) > _EACH else said


def _folds(result: Calibration) -> list[str]:
    if result.verdict is None or not result.verdict.blind:
        return []
    return [
        f"Without some drives, the others do not determine {', '.join(result.verdict.blind)}. "
        "Those drives do not count in the verdict."
    ]


def _noise(result: Calibration) -> list[str]:
    if result.joint_noise is None:
        return []
    share, step = result.joint_noise.proportional, result.joint_noise.step
    return [
        f"Odometry errs as if each wheel speed were {100 * share:.2g} % off, at random every {step:.2g} s: "
        f"noise: {{spin: {{proportional: {share:.3g}}}}}."
    ]


def _ranges(robot: Robot, result: Calibration) -> list[str]:
    said = []
    for p in robot.tunable:
        value = result.parameters[p.name].value
        if isfinite(value) and beyond(p, value) and (p.low, p.high) != default_range(p.nominal):
            said.append(
                f"{p.name} = {value:.6g} is outside its range in the robot file, {float(p.low):.6g} to "
                f"{float(p.high):.6g}. The new robot file has a wider range."
            )
    return said
