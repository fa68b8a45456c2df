"""``wmrgen calibrate``: the tunable parameters of a robot file from logs of drives."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from math import degrees, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.loading import derived
from wmrgen.derivation.artifacts import write_file
from wmrgen.errors import UsageError

_SHOWN = 1e-9  # [rad] rounding

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.tools.calibrating.calibrate import Calibration
    from wmrgen.tools.calibrating.fit import Problem
    from wmrgen.tools.calibrating.observability import Course
    from wmrgen.tools.calibrating.path import Reals


def calibrate(
    robot: Path,
    logs: Sequence[Path] | None,
    truth: Sequence[Path] | None,
    out: Path | None,
    files: Path | None,
    plan: bool,
    precision: float,
    scheduler: str | None,
    one_clock: bool,
    start_error: float,
    as_json: bool,
) -> int:
    """Print what the logs tell of the parameters, and which drives would tell more."""
    from wmrgen.tools.calibrating import calibrate as work
    from wmrgen.tools.calibrating.cluster import cluster
    from wmrgen.tools.calibrating.fit import serial
    from wmrgen.tools.calibrating.written import told as values_of
    from wmrgen.tools.calibrating.written import with_values

    with derived(robot) as derivation:
        pass
    if not logs:
        if not plan:
            raise UsageError(
                "no log is given: wmrgen calibrate ROBOT.yaml LOG.csv…, or --plan for drives to make"
            )
        planned = _Planned.of(work.problem_of(derivation, one_clock), derivation, precision)
        if as_json:
            console.data(
                {"plan": planned.as_data(), "unobservable": [list(group) for group in planned.never]}
            )
        else:
            planned.tell()
        return 0
    with nullcontext(serial) if scheduler is None else cluster(scheduler) as each:
        result = work.calibrate(derivation, logs, truth or (), each, one_clock, start_error)
    values = values_of(result)
    if out is not None:
        write_file(out, with_values(robot, values).encode())
    if files is not None:
        _write_all(files, robot, derivation, result, values)
    told = _Told.of(derivation, result)
    fit = result.fit
    more = _Planned.of(fit.problem, derivation, precision, fit.information) if plan else None
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
    from wmrgen.tools.calibrating.picture import picture
    from wmrgen.tools.calibrating.written import c_values, controllers, with_values

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
        from wmrgen.tools.calibrating.drawn import by_joint
        from wmrgen.tools.calibrating.notes import notes
        from wmrgen.tools.calibrating.written import counts_per_turn, told

        values = {name: e.nominal for name, e in result.parameters.items()} | told(result)
        counts = counts_per_turn(derivation.robot, values)
        return _Told(by_joint(derivation, result.fit), counts, notes(derivation, result))


def _as_data(result: Calibration, told: _Told) -> dict[str, Any]:
    from wmrgen.tools.calibrating.drawn import by_time

    return {
        "parameters": {name: asdict(e) for name, e in result.parameters.items()},
        "unobservable": [list(group) for group in result.unobservable],
        "notes": told.notes,
        "counts_per_turn": told.counts_per_turn,
        "rms": result.fit.rms[0],
        "rms_heading": result.fit.rms[1],
        "mount": dict(zip(("x", "y", "theta"), result.fit.mount, strict=True)),
        "clock_offsets": result.clocks,
        "clock_sigmas": result.clock_deviations,
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


@dataclass(frozen=True, slots=True)
class _Planned:
    """The ``courses`` after which every parameter is certain to ``precision``, None where none do; parameters that no
    drive tells apart, ``never``."""

    courses: Sequence[Course] | None
    never: Sequence[Sequence[str]]
    precision: float

    @staticmethod
    def of(problem: Problem, derivation: Derivation, precision: float, told: Reals | None = None) -> _Planned:
        """Beside the information of drives that there are, ``told``."""
        from wmrgen.tools.calibrating.observability import blind, offers, plan

        choices = offers(problem, derivation)
        courses = plan(problem, choices, precision, told)
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
