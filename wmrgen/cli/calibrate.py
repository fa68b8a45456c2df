"""``wmrgen calibrate``: estimate the tunable parameters of a robot file from logs of drives."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import asdict
from math import degrees, inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robot, argument, flag, option, output, verb
from wmrgen.cli.loading import print_notes
from wmrgen.cli.values import from_option
from wmrgen.errors import UsageError
from wmrgen.geometry.ports import Port, Role
from wmrgen.robotfile.text import bytes_of

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.tools.calibration.errors import Errors
    from wmrgen.tools.calibration.plan import Course
    from wmrgen.tools.calibration.result import Calibration


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
    bag: Annotated[
        list[Path] | None, option("A ROS bag instead of logs, with --poses. Once for each drive.", "BAG")
    ] = None,
    poses: Annotated[
        str | None, option("Topic of the bag's odometry or pose of a tracked body.", "TOPIC")
    ] = None,
    joint_states: Annotated[str, option("Topic of the bag's joint readings.", "TOPIC")] = "/joint_states",
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
    mount: Annotated[
        str | None,
        option("Place and heading of the tracked body on the robot, if they are known.", "X,Y,THETA"),
    ] = None,
    start_error: Annotated[
        float, option("Standard deviation of each first reference pose [m]: the robot starts at a mark.", "M")
    ] = inf,
    gain: Annotated[
        list[str] | None,
        option("Estimate the scale of a joint's readings, such as front.steer. Once for each.", "JOINT"),
    ] = None,
    workers: Annotated[int, option("Read the logs in N processes.", "N")] = 1,
    scheduler: Annotated[
        str | None, option("Read the logs on the Dask cluster of this scheduler.", "ADDRESS")
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen calibrate robot.yaml run-*.csv

    Estimate the tunable parameters from joint readings and reference poses. The verdict comes first: whether the new
    parameters predict drives that they were not fitted to. Exit code 1, and no file, if they do not.
    """
    from wmrgen.tools.calibration.calibrate import calibrate as estimate
    from wmrgen.tools.calibration.calibrate import increments_of
    from wmrgen.tools.workers import cluster, pool, serial

    with console.progress() as step:
        step(f"deriving {robot}")
        derivation = wmrgen.derive(print_notes(wmrgen.load(robot)))
        if bag or poses:
            if logs or not bag or not poses:
                raise UsageError("a bag needs both --bag and --poses, and no CSV files")
            step(f"reading {len(bag)} bags")
            logs, truth = _of_bags(derivation, bag, poses, joint_states)
        if not logs:
            if not plan:
                raise UsageError(
                    "no log is given: write wmrgen calibrate ROBOT.yaml LOG.csv…, or --plan for drives to record"
                )
            step(f"planning drives of {derivation.robot.name}")
            increments_of(derivation)
            courses, never = _planned(derivation, precision, None, gain or ())
            _show_plan(courses, never, precision, as_json)
            return 0
        for path in () if bag else (*logs, *(truth or ())):
            if path.exists():
                bytes_of(path, 0)  # RobotFileError for a device or a pipe, which might never end
        step(f"calibrating {derivation.robot.name} with {len(logs)} files")
        every = cluster(scheduler) if scheduler else pool(workers) if workers > 1 else nullcontext(serial)
        with every as mapped:
            result = estimate(
                derivation, logs, truth or (), one_clock=one_clock, mount=_mount(mount), start_error=start_error,
                gains=gain or (), mapped=mapped,
            )  # fmt: skip
        good = result.better
        if good:
            _write(robot, derivation, result, out, files)
        more = _planned(derivation, precision, result, gain or ()) if plan or result.unobservable else None
    data = _as_data(derivation, result)
    if more is not None:
        data["plan"] = _plan_data(more[0])
    if as_json:
        console.data(data)
    else:
        _show(derivation, result)
        if more is not None:
            _show_plan(*more, precision, False)
    return 0 if good else 1


def _of_bags(
    derivation: Derivation, bags: Sequence[Path], poses: str, states: str
) -> tuple[list[Any], list[Any]]:
    """Return logs and references of bags, as columns by name.

    Args:
        derivation: The robot's.
        bags: A bag for each drive.
        poses: Topic of the reference poses.
        states: Topic of the joint readings.
    """
    from wmrgen.tools.calibration.bags import tables
    from wmrgen.tools.calibration.calibrate import increments_of

    joints = increments_of(derivation)[0].joints
    every = [tables(bag, derivation.robot, joints, poses, states) for bag in bags]
    return [log for log, _ in every], [reference for _, reference in every]


def _mount(text: str | None) -> tuple[float, float, float] | None:
    """Return x, y [m] and heading [rad] of a text like ``0.1,-20 mm,90 deg``."""
    if text is None:
        return None
    x, y, theta = map(float, from_option("--mount", text, _MOUNT))
    return x, y, theta


def _write(
    robot: Path, derivation: Derivation, result: Calibration, out: Path | None, folder: Path | None
) -> None:
    """Write the new robot file, and the files for others.

    Args:
        robot: The robot file.
        derivation: Its derivation.
        result: The calibration.
        out: Where the new robot file goes; None: nowhere.
        folder: Where all files go; None: nowhere.
    """
    from wmrgen.derivation.artifacts import write_file
    from wmrgen.tools.calibration.written import c_values, controllers, new_values, with_values

    values = new_values(result)
    if out is not None:
        write_file(out, with_values(robot, values, result.joint_noise).encode())
    if folder is None:
        return
    name = derivation.robot.name
    write_file(folder / robot.name, with_values(robot, values, result.joint_noise).encode())
    write_file(folder / f"{name}_calibration.svg", result.figure().encode())
    nominal = {p.name: float(p.nominal) for p in derivation.robot.tunable}
    if header := c_values(derivation.c_module, nominal | values):
        write_file(folder / f"{name}_calibrated.h", header.encode())
    ros, why = controllers(wmrgen.load(folder / robot.name))
    if ros:
        write_file(folder / f"{name}_controllers.yaml", ros.encode())
    else:
        console.note(f"no parameters for ROS: {why}")


def _as_data(derivation: Derivation, result: Calibration) -> dict[str, Any]:
    """Return a calibration for JSON."""
    from wmrgen.tools.calibration.written import equivalent_counts

    values = {name: e.value for name, e in result.parameters.items()}
    verdict = result.verdict
    return {
        "better": None if verdict is None and result.better else result.better,
        "parameters": {name: asdict(e) for name, e in result.parameters.items()},
        "unobservable": [list(group) for group in result.unobservable],
        "covariance": result.covariance.tolist(),
        "counts_per_turn": equivalent_counts(derivation.robot, values),
        "rms": result.after.position,
        "rms_heading": result.after.heading,
        "mount": {name: asdict(e) for name, e in result.mount.items()},
        "clocks": {name: asdict(e) for name, e in result.clocks.items()},
        "noise": {name: getattr(result.noise, name) ** 0.5 for name in _NOISE},
        "joint_noise": None if result.joint_noise is None else asdict(result.joint_noise),
        "gyro": None if result.gyro is None else asdict(result.gyro),
        "slips": [asdict(slip) for slip in result.slips],
        "turns": result.turns if isfinite(result.turns) else None,
        "alternatives": [asdict(other) for other in result.alternatives],
        "errors": {
            "before": asdict(result.before),
            "after": asdict(result.after),
            "nominal": None if verdict is None else asdict(verdict.nominal),
            "held_out": None if verdict is None else asdict(verdict.held_out),
        },
        "notes": _notes(derivation, result),
    }


_MOUNT = [Port("x", Role.STATE, "m"), Port("y", Role.STATE, "m"), Port("theta", Role.STATE, "rad")]
_NOISE = ("position_walk", "heading_walk", "position", "heading")


def _show(derivation: Derivation, result: Calibration) -> None:
    """Print a calibration, the verdict first."""
    logs, verdict = result.fit.problem.logs, result.verdict
    number, seconds = len({log.name for log in logs}), sum(log.seconds for log in logs)
    console.result(f"{derivation.robot.name}: {number} drive{'s' * (number > 1)}, {seconds:.0f} s")
    if verdict is None:
        console.result(
            "  no verdict: all of these drives are needed for the fit, so no drive is left for a test; record more"
            if result.better
            else "  the new values explain these drives no better than nominal ones, DO NOT USE THEM"
        )
    else:
        word = (
            "predict drives that were left out"
            if verdict.better
            else "do not predict drives that were left out, DO NOT USE THEM"
        )
        console.result(
            f"  the new values {word}: {_errors(verdict.held_out)}, nominal ones {_errors(verdict.nominal)}"
        )
    width = max(map(len, result.parameters))
    for name, e in result.parameters.items():
        change = f" ({100 * (e.value / e.nominal - 1):+.2f} %)" if e.nominal else ""
        sigma = "" if e.sigma is None else f" +- {e.sigma:.1g}"
        weak = "" if e.observable else "  not determined"
        console.result(f"  {name:<{width}} = {e.value:.6g}{sigma}   nominal {e.nominal:g}{change}{weak}")
    console.result(
        f"  odometry of all drives: {_errors(result.before)} before, {_errors(result.after)} after"
    )
    for note in _notes(derivation, result):
        console.note(note)


def _errors(errors: Errors) -> str:
    """Return root mean squares in words."""
    parts = []
    if isfinite(errors.position):
        parts.append(f"{1000 * errors.position:.1f} mm")
    if isfinite(errors.heading):
        parts.append(f"{degrees(errors.heading):.2f} deg")
    return " and ".join(parts) or "no whole pose"


def _notes(derivation: Derivation, result: Calibration) -> list[str]:
    """Return what else a user should know, a sentence each."""
    from wmrgen.tools.calibration.notes import notes

    return notes(derivation.robot, result)


def _planned(
    derivation: Derivation, precision: float, result: Calibration | None, gains: Sequence[str]
) -> tuple[Sequence[Course] | None, Sequence[Sequence[str]]]:
    """Return drives that determine the parameters, and groups that no drive determines.

    Args:
        derivation: The robot.
        precision: Standard deviation of each parameter, relative to nominal.
        result: A calibration, whose drives are counted; None: there are no drives yet.
        gains: Joints whose readings have an unknown scale.
    """
    from wmrgen.tools.calibration.plan import existing, plan, problem_of_plan

    problem, choices, blind = problem_of_plan(derivation, gains)
    return plan(choices, problem, precision, existing(result)), blind


def _plan_data(courses: Sequence[Course] | None) -> list[dict[str, Any]] | None:
    if courses is None:
        return None
    return [{"drive": course.text, "seconds": course.seconds} for course in courses]


def _show_plan(
    courses: Sequence[Course] | None, never: Sequence[Sequence[str]], precision: float, as_json: bool
) -> None:
    """Print planned drives.

    Args:
        courses: The drives; None: no drives reach the precision.
        never: Groups of parameters that no drive determines separately.
        precision: Standard deviation of each parameter, relative to nominal.
        as_json: Whether to print JSON.
    """
    if as_json:
        console.data({"plan": _plan_data(courses), "unobservable": [list(group) for group in never]})
        return
    for group in never:
        if len(group) == 1:
            console.note(f"no drive determines {group[0]}: measure it")
        else:
            console.note(f"no drive determines {' and '.join(group)} separately: measure one of them")
    percent = f"{100 * precision:g} %"
    if courses is None:
        console.result(f"no set of these drives determines every parameter to {percent}")
    elif not courses:
        console.result(f"the drives already determine every parameter to {percent}")
    for course in courses or ():
        console.result(f"{course.text}: {course.seconds:.0f} s")
