"""What a user should know of logs and of what they do not tell, in sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import degrees, isnan, pi

from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.ports import default_range
from wmrgen.tools.calibrating.calibrate import Calibration, Estimate
from wmrgen.tools.calibrating.drifts import Drift
from wmrgen.tools.calibrating.observability import WEAK, Offer, blind, offers, plan
from wmrgen.tools.calibrating.written import beyond, untold

_FAR_OFF = 0.15  # of a length: nobody measures worse
_LATE = 0.02  # [s] that a clock is off by, to be told
_EACH = 6  # clocks that are told one by one; of more a line says how far they are off


def notes(derivation: Derivation, result: Calibration) -> list[str]:
    """What a user should know of the logs and of what they do not tell, a sentence each."""
    said, theta = list[str](), result.fit.mount[2]
    if abs(theta) > pi / 2:
        said.append(
            f"the tracked body is turned by {degrees(theta):.0f} deg on the robot; if it is not, the wheels "
            "count the other way, or left and right are exchanged"
        )
    said += _late(result.clocks, result.clock_deviations)
    said += map(_drifting, result.drifts)
    if far := [name for name, e in result.parameters.items() if _far_off(e)]:
        said.append(
            f"{', '.join(far)}: more than {100 * _FAR_OFF:.0f} % from nominal; if that was measured, see whether "
            "counts of a turn, gears and units of log and truth are right"
        )
    for p in derivation.robot.tunable:
        value = result.parameters[p.name].value
        if beyond(p, value) and (p.low, p.high) != default_range(p.nominal):
            said.append(
                f"{p.name} = {value:.6g} is outside its range in the robot file, {float(p.low):.6g} to "
                f"{float(p.high):.6g}: the C of that file refuses it; a new robot file has a wider range"
            )
    for slip in result.outliers:
        how = (
            "its joints disagree"
            if isnan(slip.moved)
            else f"{slip.moved:.2g} m and {slip.turned:.2g} rad off"
        )
        said.append(
            f"{slip.drive}: left out from t = {slip.start:.1f} to {slip.end:.1f} s, where wheels slip: {how}"
        )
    if result.fit.freedom <= 0:
        said.append(
            "as many unknowns as measurements: no standard deviation can be told; add drives, or poses between "
            "start and end"
        )
    if result.unobservable:
        choices = offers(result.fit.problem, derivation)
        never = blind(result.fit.problem, choices)
        for group in result.unobservable:
            said.append(
                f"{_together(group, untold(result, group))}: {_remedy(choices, result, group, never)}"
            )
    return said


def _late(clocks: Mapping[str, float], deviations: Mapping[str, float]) -> list[str]:
    """How far clocks of the truth are off [s], by drive, where that is sure."""
    late = {name: o for name, o in clocks.items() if abs(o) > max(_LATE, 3 * deviations[name])}
    if len(late) <= _EACH:
        return [
            f"{name}: the truth's clock is {offset:+.3f} +- {deviations[name]:.1g} s off"
            for name, offset in late.items()
        ]
    least, most = min(late.values()), max(late.values())
    return [
        f"the truth's clocks of {len(late)} of {len(clocks)} drives are off, by {least:+.3f} to {most:+.3f} s"
    ]


def _far_off(estimate: Estimate) -> bool:
    """Whether a length is sure to be farther from its nominal value than who measures one is off."""
    off = abs(estimate.value - estimate.nominal)
    far = off > max(_FAR_OFF * abs(estimate.nominal), 3 * estimate.sigma)
    return estimate.observable and estimate.nominal != 0 and far


def _drifting(drift: Drift) -> str:
    """How a clock or a tracker's heading moves, in a sentence."""
    times = f"from t = {drift.start:.1f} to {drift.end:.1f} s"
    if drift.at_once:
        return f"{drift.drive}: the truth's clock jumps by {-drift.late:+.2f} s {times}: each part is fitted alone"
    what, much = ("clock", f"{-drift.late:+.2f} s") if drift.late else ("heading", f"{drift.turned:+.3f} rad")
    return f"{drift.drive}: the truth's {what} drifts by {much} {times}, so parameters may be wrong"


def _together(group: Sequence[str], nominal: bool) -> str:
    if len(group) == 1:
        return f"these drives do not tell {group[0]}, so that it is not written"
    names = f"{', '.join(group[:-1])} and {group[-1]}"
    if nominal:
        return f"these drives do not tell {names}, so that they are not written"
    return f"{names} scale together on these drives, so that their values hold only together"


def _remedy(
    choices: Sequence[Offer], result: Calibration, group: Sequence[str], never: Sequence[Sequence[str]]
) -> str:
    """What would tell the parameters of ``group``."""
    them, measure = ("it", "measure it") if len(group) == 1 else ("them apart", "measure one of them")
    if any(set(group) & set(other) for other in never):
        return f"no drive tells {them}; {measure}, and delete its tunable: true"
    courses = plan(result.fit.problem, choices, WEAK, result.fit.information)
    return f"add {' and '.join(course.text for course in courses)}" if courses else measure
