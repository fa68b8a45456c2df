"""``wmrgen calibrate``: estimate the tunable parameters of a robot file from logs of drives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from itertools import count
from math import degrees, inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robot, argument, flag, option, output, verb
from wmrgen.cli.loading import print_notes
from wmrgen.errors import UsageError
from wmrgen.robotfile.text import bytes_of

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.tools.calibrating.calibrate import Calibration
    from wmrgen.tools.calibrating.fit import Problem, Result, Task
    from wmrgen.tools.calibrating.observability import Course
    from wmrgen.tools.calibrating.path import Reals


@verb("calibrate")
def calibrate(
    robot: Robot,
    logs: Annotated[
        list[Path] | None,
        argument("[LOG.csv]...", "Columns t [s] and <wheel>.angle, .counts or .spin, <wheel>.steer."),
    ] = None,
    truth: Annotated[
        list[Path] | None,
        option(
            "Reference poses: columns t, x, y, theta. Once for each log; default LOG.truth.csv.", "POSES.csv"
        ),
    ] = None,
    out: Annotated[Path | None, output("ROBOT.yaml", "Write the robot file with the new values.")] = None,
    files: Annotated[
        Path | None,
        option("Write the robot file, a picture, parameters for ROS and the numbers for the C.", "DIR"),
    ] = None,
    plan: Annotated[bool, flag("--plan", "Suggest drives that determine the parameters.")] = False,
    precision: Annotated[
        float, option("The standard deviation that --plan aims at, relative to the nominal value.", "0.01")
    ] = 0.01,
    one_clock: Annotated[
        bool, flag("--one-clock", "Log and reference share a clock: estimate no time offset.")
    ] = False,
    start_error: Annotated[
        float,
        option(
            "Standard error of the first reference pose of each drive [m]. Without it the start is unknown.",
            "0.001",
        ),
    ] = inf,
    scheduler: Annotated[
        str | None, option("Process the drives on the Dask cluster of this scheduler.", "ADDRESS")
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen calibrate robot.yaml run-1.csv run-2.csv

    Estimate the tunable parameters, with standard deviations, from joint readings and reference poses. Parameters that
    the drives do not determine are reported, with drives that would determine them.
    """
    from wmrgen.derivation.artifacts import write_file
    from wmrgen.tools.calibrating.calibrate import problem_of
    from wmrgen.tools.calibrating.written import told as new_values
    from wmrgen.tools.calibrating.written import with_values

    with console.progress() as step:
        step(f"deriving {robot}")
        derivation = wmrgen.derive(print_notes(wmrgen.load(robot)))
        if not logs:
            if not plan:
                raise UsageError(
                    "no log is given: wmrgen calibrate ROBOT.yaml LOG.csv…, or --plan for drives to make"
                )
            step(f"planning drives of {derivation.robot.name}")
            planned = _Plan.of(problem_of(derivation, one_clock), derivation, precision)
        else:
            for path in (*logs, *(truth or ())):
                if path.exists():
                    bytes_of(path, 0)  # RobotFileError for a device or a pipe, which might never end
            result = _estimated(derivation, logs, truth or (), one_clock, start_error, scheduler, step)
            values = new_values(result)
            if out is not None:
                write_file(out, with_values(robot, values).encode())
            if files is not None:
                _write_all(files, robot, derivation, result, values)
            remarks = _Remarks.of(derivation, result)
            fit = result.fit
            more = _Plan.of(fit.problem, derivation, precision, fit.information) if plan else None
    if not logs:
        if as_json:
            unobservable = [list(group) for group in planned.never]
            console.data({"plan": planned.as_data(), "unobservable": unobservable})
        else:
            planned.show()
        return 0
    if as_json:
        planned_too = {} if more is None else {"plan": more.as_data()}
        console.data(_as_data(result, remarks) | planned_too)
        return 0
    _show(derivation.robot.name, result, remarks)
    if more is not None:
        more.show()
    return 0


def _estimated(
    derivation: Derivation,
    logs: Sequence[Path],
    references: Sequence[Path],
    one_clock: bool,
    start_error: float,
    scheduler: str | None,
    step: Callable[[str], None],
) -> Calibration:
    """Return the estimate from the logs; ``step`` shows how often the drives have been evaluated."""
    from wmrgen.tools.calibrating.calibrate import calibrate
    from wmrgen.tools.calibrating.cluster import cluster
    from wmrgen.tools.calibrating.fit import serial

    passes = count(1)
    with nullcontext(serial) if scheduler is None else cluster(scheduler) as each:

        def with_progress(problem: Problem, unknowns: Reals, task: Task[Result]) -> Sequence[Result]:
            number = len(problem.drives)
            drives = f"{number} drive{'s' * (number > 1)}"
            step(f"fitting {derivation.robot.name} to {drives}, pass {next(passes)}")
            return each(problem, unknowns, task)

        return calibrate(derivation, logs, references, with_progress, one_clock, start_error)


def _write_all(
    folder: Path, robot: Path, derivation: Derivation, result: Calibration, values: dict[str, float]
) -> None:
    """Write the new robot file, the picture, parameters for ROS and the numbers for the C."""
    from wmrgen.derivation.artifacts import write_file
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
class _Remarks:
    """What a calibration reports in addition to its parameters."""

    by_joint: dict[str, float]  # rms residual of the readings of a joint [rad], by joint
    counts_per_turn: dict[str, float]  # of encoders, with the nominal radius, by joint
    notes: list[str]

    @staticmethod
    def of(derivation: Derivation, result: Calibration) -> _Remarks:
        """Return the remarks on a calibration."""
        from wmrgen.tools.calibrating.drawn import by_joint
        from wmrgen.tools.calibrating.notes import notes
        from wmrgen.tools.calibrating.written import counts_per_turn, told

        values = {name: e.nominal for name, e in result.parameters.items()} | told(result)
        counts = counts_per_turn(derivation.robot, values)
        return _Remarks(by_joint(derivation, result.fit), counts, notes(derivation, result))


def _as_data(result: Calibration, remarks: _Remarks) -> dict[str, Any]:
    """Return a calibration for JSON."""
    from wmrgen.tools.calibrating.drawn import by_time

    residuals = {}
    for name, rows in by_time(result.fit).items():
        residuals[name] = [dict(zip(("t", "position", "heading"), row, strict=True)) for row in rows]
    errors = {"before": result.before, "after": result.after, "held_out": result.held_out}
    return {
        "parameters": {name: asdict(e) for name, e in result.parameters.items()},
        "unobservable": [list(group) for group in result.unobservable],
        "notes": remarks.notes,
        "counts_per_turn": remarks.counts_per_turn,
        "rms": result.fit.rms[0],
        "rms_heading": result.fit.rms[1],
        "mount": dict(zip(("x", "y", "theta"), result.fit.mount, strict=True)),
        "clock_offsets": result.clocks,
        "clock_sigmas": result.clock_deviations,
        "residuals": {"by_time": residuals, "by_joint": remarks.by_joint},
        "outliers": [asdict(slip) for slip in result.outliers],
        "errors": {name: None if error is None else asdict(error) for name, error in errors.items()},
    }


def _show(robot: str, result: Calibration, remarks: _Remarks) -> None:
    """Print a calibration."""
    drives = result.fit.problem.drives
    seconds = sum(float(d.t[-1] - d.t[0]) for d in drives)
    number = len(result.clocks)
    console.result(f"{robot}: {number} drive{'s' * (number > 1)}, {seconds:.0f} s")
    width = max(map(len, result.parameters))
    for name, e in result.parameters.items():
        change = f" ({100 * (e.value / e.nominal - 1):+.2f} %)" if e.nominal else ""
        weak = "" if e.observable else "  not observable"
        deviation = f"{e.sigma:.1g}" if isfinite(e.sigma) else "?"
        console.result(
            f"  {name:<{width}} = {e.value:.6g} +- {deviation}   nominal {e.nominal:g}{change}{weak}"
        )
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
    rounding = 1e-9  # rad
    joints = [f"{joint} {value:.2g}" for joint, value in remarks.by_joint.items() if value > rounding]
    if joints:
        console.result(f"  residuals of joint readings, rad (rms): {', '.join(joints)}")
    for joint, counts in remarks.counts_per_turn.items():
        console.result(f"  or, with the nominal radius, {joint} has {counts:.8g} counts a turn")
    for note in remarks.notes:
        console.note(note)


@dataclass(frozen=True, slots=True)
class _Plan:
    """Drives that determine the parameters."""

    # After which every parameter has the precision; None if no drives reach it.
    courses: Sequence[Course] | None
    never: Sequence[Sequence[str]]  # groups of parameters that no drive can determine separately
    precision: float  # standard deviation relative to the nominal value

    @staticmethod
    def of(
        problem: Problem, derivation: Derivation, precision: float, information: Reals | None = None
    ) -> _Plan:
        """Plan drives in addition to those whose ``information`` matrix is given."""
        from wmrgen.tools.calibrating.observability import blind, offers, plan

        choices = offers(problem, derivation)
        courses = plan(problem, choices, precision, information)
        return _Plan(courses, blind(problem, choices), precision)

    def as_data(self) -> list[dict[str, Any]] | None:
        """Return the drives for JSON."""
        if self.courses is None:
            return None
        return [{"drive": course.text, "seconds": course.seconds} for course in self.courses]

    def show(self) -> None:
        """Print the drives."""
        for group in self.never:
            if len(group) == 1:
                console.note(f"no drive determines {group[0]}: measure it")
            else:
                console.note(f"no drive determines {' and '.join(group)} separately: measure one of them")
        percent = f"{100 * self.precision:g} %"
        if self.courses is None:
            console.result(f"none of the drives makes every parameter certain to {percent}")
        elif not self.courses:
            console.result(f"the drives make every parameter certain to {percent} already")
        for course in self.courses or ():
            console.result(f"{course.text}: {course.seconds:.0f} s")
