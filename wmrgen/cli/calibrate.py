"""``wmrgen calibrate``: the tunable parameters of a robot file from logs of drives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import degrees, isfinite, isnan, pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

import wmrgen
from wmrgen.artifacts import write_file
from wmrgen.cli import console
from wmrgen.cli.loading import derived
from wmrgen.errors import UsageError

_SHOWN = 1e-9  # [rad] rounding
_FAR_OFF = 0.15  # of a length: nobody measures worse

if TYPE_CHECKING:
    from wmrgen.calibrating.calibrate import Calibration, Estimate
    from wmrgen.calibrating.drifts import Drift
    from wmrgen.calibrating.observability import Course, Offer
    from wmrgen.robot import Derivation


def calibrate(
    robot: Path,
    logs: Sequence[Path] | None,
    truth: Sequence[Path] | None,
    out: Path | None,
    files: Path | None,
    plan: bool,
    precision: float,
    scheduler: str | None,
    as_json: bool,
) -> int:
    """Print what the logs tell of the parameters, and which drives would tell more."""
    from wmrgen.calibrating import calibrate as work
    from wmrgen.calibrating.written import told as values_of
    from wmrgen.calibrating.written import with_values

    with derived(robot) as derivation:
        pass
    if not logs:
        if not plan:
            raise UsageError(
                "no log is given: wmrgen calibrate ROBOT.yaml LOG.csv…, or --plan for drives to make"
            )
        planned = _Planned.of(derivation, precision)
        if as_json:
            console.data(
                {"plan": planned.as_data(), "unobservable": [list(group) for group in planned.never]}
            )
        else:
            planned.tell()
        return 0
    if scheduler is None:
        result = work.calibrate(derivation, logs, truth or ())
    else:
        from wmrgen.calibrating.cluster import cluster

        with cluster(scheduler) as each:
            result = work.calibrate(derivation, logs, truth or (), each)
    values = values_of(result)
    if out is not None:
        write_file(out, with_values(robot, values).encode())
    if files is not None:
        _write_all(files, robot, derivation, result, values)
    told = _Told.of(derivation, result)
    more = _Planned.of(derivation, precision, result) if plan else None
    if as_json:
        console.data(_as_data(result, told) | ({} if more is None else {"plan": more.as_data()}))
        return 0
    _tell(derivation.robot.name, result, told)
    if more is not None:
        more.tell()
    return 0


def _write_all(
    folder: Path, robot: Path, derivation: Derivation, result: Calibration, values: dict[str, float]
) -> None:
    """The new robot file, the picture, parameters for ROS and the numbers for the C."""
    from wmrgen.calibrating.picture import picture
    from wmrgen.calibrating.written import c_values, controllers, with_values

    name = derivation.robot.name
    write_file(folder / robot.name, with_values(robot, values).encode())
    write_file(folder / f"{name}_calibration.svg", picture(result).encode())
    nominal = {p.name: float(p.nominal) for p in derivation.robot.tunable}
    if header := c_values(derivation.c_module, nominal | values):
        write_file(folder / f"{name}_calibrated.h", header.encode())
    ros, why = controllers(wmrgen.load(folder / robot.name))
    if ros:
        write_file(folder / f"{name}_controllers.yaml", ros.encode())
    else:
        console.note(f"no parameters for ROS: {why}")


@dataclass(frozen=True, slots=True)
class _Told:
    """What a calibration says beside its parameters: what joints disagree by [rad] and counts per turn, by joint;
    sentences that a user should know."""

    by_joint: dict[str, float]
    counts_per_turn: dict[str, float]
    notes: list[str]

    @staticmethod
    def of(derivation: Derivation, result: Calibration) -> _Told:
        from wmrgen.calibrating.drawn import by_joint
        from wmrgen.calibrating.written import counts_per_turn, told

        values = {name: e.nominal for name, e in result.parameters.items()} | told(result)
        counts = counts_per_turn(derivation.robot, values)
        return _Told(by_joint(derivation, result.fit), counts, _notes(derivation, result))


def _as_data(result: Calibration, told: _Told) -> dict[str, Any]:
    from wmrgen.calibrating.drawn import by_time

    return {
        "parameters": {name: asdict(e) for name, e in result.parameters.items()},
        "unobservable": [list(group) for group in result.unobservable],
        "notes": told.notes,
        "counts_per_turn": told.counts_per_turn,
        "rms": result.fit.rms[0],
        "rms_heading": result.fit.rms[1],
        "mount": dict(zip(("x", "y", "theta"), result.fit.mount, strict=True)),
        "clock_offsets": result.clocks,
        "residuals": {
            "by_time": {
                name: [dict(zip(("t", "position", "heading"), row, strict=True)) for row in rows]
                for name, rows in by_time(result.fit).items()
            },
            "by_joint": told.by_joint,
        },
        "outliers": [asdict(slip) for slip in result.outliers],
        "errors": {
            name: None if errors is None else asdict(errors)
            for name, errors in (
                ("before", result.before),
                ("after", result.after),
                ("held_out", result.held_out),
            )
        },
    }


def _tell(robot: str, result: Calibration, told: _Told) -> None:
    drives = result.fit.problem.drives
    seconds = sum(float(d.t[-1] - d.t[0]) for d in drives)
    count = len(result.clocks)
    console.result(f"{robot}: {count} drive{'s' * (count > 1)}, {seconds:.0f} s")
    width = max(map(len, result.parameters))
    for name, e in result.parameters.items():
        change = f" ({100 * (e.value / e.nominal - 1):+.2f} %)" if e.nominal else ""
        weak = "" if e.observable else "  not observable"
        sure = f"{e.sigma:.1g}" if isfinite(e.sigma) else "?"
        console.result(f"  {name:<{width}} = {e.value:.6g} +- {sure}   nominal {e.nominal:g}{change}{weak}")
    x, y, theta = result.fit.mount
    console.result(
        f"  tracked point at x = {x:.4f}, y = {y:.4f} m of the robot, turned by {degrees(theta):.2f} deg"
    )
    rows = [("before", result.before), ("after", result.after), ("of drives left out", result.held_out)]
    for title, errors in rows:
        if errors is not None and isfinite(errors.position):
            console.result(
                f"  odometry {title}: {1000 * errors.position:.1f} mm and {degrees(errors.heading):.2f} deg (rms)"
            )
    joints = [f"{joint} {value:.2g}" for joint, value in told.by_joint.items() if value > _SHOWN]
    if joints:
        console.result(f"  what joints disagree by in each reading, rad (rms): {', '.join(joints)}")
    for joint, counts in told.counts_per_turn.items():
        console.result(f"  or, with the nominal radius, {joint} has {counts:.8g} counts a turn")
    for note in told.notes:
        console.note(note)


def _notes(derivation: Derivation, result: Calibration) -> list[str]:
    """What a user should know of the logs and of what they do not tell, a sentence each."""
    from wmrgen.calibrating.observability import blind, offers
    from wmrgen.calibrating.written import untold

    notes, theta = [], result.fit.mount[2]
    if abs(theta) > pi / 2:
        notes.append(
            f"the tracked body is turned by {degrees(theta):.0f} deg on the robot; if it is not, the wheels "
            "count the other way, or left and right are exchanged"
        )
    for name, offset in result.clocks.items():
        if abs(offset) > 0.02:
            notes.append(f"{name}: the truth's clock is {offset:+.3f} s off")
    notes += map(_drifting, result.drifts)
    if far := [name for name, e in result.parameters.items() if _far_off(e)]:
        notes.append(
            f"{', '.join(far)}: more than {100 * _FAR_OFF:.0f} % from nominal; if that was measured, see whether "
            "counts of a turn, gears and units of log and truth are right"
        )
    for slip in result.outliers:
        how = (
            "its joints disagree"
            if isnan(slip.moved)
            else f"{slip.moved:.2g} m and {slip.turned:.2g} rad off"
        )
        notes.append(
            f"{slip.drive}: left out from t = {slip.start:.1f} to {slip.end:.1f} s, where wheels slip: {how}"
        )
    if result.fit.freedom <= 0:
        notes.append(
            "as many unknowns as measurements: no standard deviation can be told; add drives, or poses between "
            "start and end"
        )
    if result.unobservable:
        choices = offers(result.fit.problem, derivation)
        never = blind(result.fit.problem, choices)
        for group in result.unobservable:
            notes.append(
                f"{_together(group, untold(result, group))}: {_remedy(choices, result, group, never)}"
            )
    return notes


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
    from wmrgen.calibrating.observability import WEAK, plan

    them, measure = ("it", "measure it") if len(group) == 1 else ("them apart", "measure one of them")
    if any(set(group) & set(other) for other in never):
        return f"no drive tells {them}; {measure}, and delete its tunable: true"
    courses = plan(result.fit.problem, choices, WEAK, result.fit.information)
    return f"add {' and '.join(course.text for course in courses)}" if courses else measure


@dataclass(frozen=True, slots=True)
class _Planned:
    """The ``courses`` after which every parameter is certain to ``precision``, None where none do; parameters that no
    drive tells apart, ``never``."""

    courses: Sequence[Course] | None
    never: Sequence[Sequence[str]]
    precision: float

    @staticmethod
    def of(derivation: Derivation, precision: float, result: Calibration | None = None) -> _Planned:
        """Without drives, or after those of a calibration."""
        from wmrgen.calibrating.calibrate import problem_of
        from wmrgen.calibrating.observability import blind, offers, plan

        problem = problem_of(derivation) if result is None else result.fit.problem
        choices = offers(problem, derivation)
        courses = plan(problem, choices, precision, None if result is None else result.fit.information)
        return _Planned(courses, blind(problem, choices), precision)

    def as_data(self) -> list[dict[str, Any]] | None:
        """For JSON."""
        if self.courses is None:
            return None
        return [{"drive": course.text, "seconds": course.seconds} for course in self.courses]

    def tell(self) -> None:
        """Print the courses."""
        for group in self.never:
            apart = ": measure it" if len(group) == 1 else " apart: measure one of them"
            console.note(f"no drive tells {' and '.join(group)}{apart}")
        if self.courses is None:
            console.result(f"none of the drives makes every parameter certain to {100 * self.precision:g} %")
        elif not self.courses:
            console.result(f"the drives make every parameter certain to {100 * self.precision:g} % already")
        for course in self.courses or ():
            console.result(f"{course.text}: {course.seconds:.0f} s")
