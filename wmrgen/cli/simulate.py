"""``wmrgen simulate``: a robot in motion, as numbers, as a picture and as a page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robot, Words, argument, option, option_with_default, robot_files, verb
from wmrgen.cli.loading import derived
from wmrgen.cli.motion import planned
from wmrgen.cli.values import from_option, from_words, with_joints
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.ports import POSE, TWIST, Port, Role

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.functions.motion.segments import Phase
    from wmrgen.geometry.layout.records import Robot as Loaded
    from wmrgen.tools.simulating.drive import Drive, Source
    from wmrgen.tools.simulating.model import Model, Reals

_TIME = Port("time", Role.COMMAND, "s")
_STEP = Port("step", Role.COMMAND, "s")
_SPEED = Port("speed", Role.COMMAND, "m/s")
_PATIENCE = 60.0  # s: a robot that has not reached its goal by then gives up
_USUAL_STEP = "0.01"  # s, as a user writes it: firmware computes a control law at 100 Hz
_CRUISE = "0.5"  # m/s, as a user writes it: walking pace of an indoor robot
_MOST_STARTS = 64  # more paths are not visible in one picture
_HUGE = 1e9  # m or rad: no robot gets there, and more digits make the table wide
_LARGEST = 16 << 20  # bytes of a CSV file: an hour at 50 Hz
_POSE = ("x", "y", "theta")
_FUNCTIONS = ("inverse", "forward", "odometry", "odometry_increment")
Law = Literal["goto_pose", "pursuit"]


class Course(NamedTuple):
    """What a robot is to do, in words of the command line. One of the first four is given."""

    segments: str | None
    twist: str | None
    goal: str | None
    table: str | None  # path of a CSV file
    time: str | None
    start: str | None
    law: Law
    speed: str | None
    step: str
    angles: Sequence[str]  # NAME=VALUE words


@verb("simulate")
def simulate(
    robot: Robot,
    inputs: Annotated[
        Words,
        argument(
            "[inputs.csv] [NAME=VALUE]...",
            "A table of commands over t: vx vy omega, joints or inputs of the model; steering angles at the start.",
        ),
    ] = None,
    segments: Annotated[
        str | None, option("Drive the segments of a file, as `wmrgen motion` takes them.", "FILE.json")
    ] = None,
    twist: Annotated[str | None, option("Drive a constant twist for --time.", "VX,VY,OMEGA")] = None,
    goal: Annotated[str | None, option("Drive to a pose by a control law.", "X,Y,THETA")] = None,
    law: Annotated[
        Law, option_with_default("The control law of --goal. With pursuit, THETA is ignored.")
    ] = "goto_pose",
    start: Annotated[
        str | None,
        option(
            "The pose at the start; circle:N is N poses on a circle of RADIUS, 1 m, around the goal.",
            "X,Y,THETA|circle:N[:RADIUS]",
            name="--from",
        ),
    ] = None,
    time: Annotated[
        str | None, option("The duration of --twist; with --goal the longest duration, 60 s.", "T")
    ] = None,
    speed: Annotated[
        str | None, option("The speed of pursuit [m/s], 0.5 by default; negative drives backwards.", "V")
    ] = None,
    step: Annotated[
        str, option_with_default("The longest step [s]; a control law computes once in a step.", "T")
    ] = _USUAL_STEP,
    compare: Annotated[
        Path | None, option("Another robot on the same course.", "ROBOT.yaml", completion=robot_files)
    ] = None,
    csv: Annotated[Path | None, option("Write every step as CSV.", "FILE")] = None,
    svg: Annotated[Path | None, option("Write a picture that moves without script.", "FILE")] = None,
    html: Annotated[
        Path | None, option("Write a page that plays the drive, with the robot to drive.", "FILE")
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen simulate robots/pioneer3dx.yaml --goal 0,0,0 --from circle:8 --svg drive.svg

    Simulate a drive: print the pose at its end, and write it as CSV, as an animated picture or as a page. Exit code 1
    if a robot does not reach its --goal. The pose
    moves by exact steps of constant twist; castors and trailers follow by the rates of the model. The motion is
    kinematic: the robot has the commanded velocity at once, and steered wheels turn at once unless they wait for
    segments.
    """
    tables = [word for word in inputs or () if "=" not in word]
    angles = [word for word in inputs or () if "=" in word]
    if len(tables) > 1:
        raise UsageError(f"there are two files of commands: {tables[0]} and {tables[1]}. Give one of them.")
    table = tables[0] if tables else None
    course = Course(segments, twist, goal, table, time, start, law, speed, step, angles)
    _check(course)
    paths = [robot] if compare is None else [robot, compare]
    with ExitStack() as stack:
        derivations = [stack.enter_context(derived(path, _functions(course))) for path in paths]
        angles_of = _angles(course.angles, derivations)
        drives = [_drive(d, course, own) for d, own in zip(derivations, angles_of, strict=True)]
    for drive in drives:
        for text in _remarks(drive, course):
            console.note(f"{drive.name}: {text}")
    _write(drives, course, csv, svg, html)
    if as_json:
        console.data({"drives": [_facts(drive, k) for drive in drives for k in range(drive.starts)]})
    else:
        for line in _table(drives):
            console.result(line)
    return 0 if all(map(_reached, drives)) else 1


def _check(course: Course) -> None:
    """Raise UsageError unless the words name one course."""
    given = {"--segments": course.segments, "--twist": course.twist, "--goal": course.goal}
    given["a file of commands"] = course.table
    named = [name for name, value in given.items() if value is not None]
    if not named:
        raise UsageError(
            "there is no course. Write --twist VX,VY,OMEGA --time T, --goal X,Y,THETA, --segments FILE.json or "
            "inputs.csv."
        )
    if len(named) > 1:
        raise UsageError(f"there are both {named[0]} and {named[1]}. Give one of them.")
    if course.twist is not None and course.time is None:
        raise UsageError("--twist needs a duration. Write --time 5 [s].")
    if course.time is not None and named[0] not in ("--twist", "--goal"):
        raise UsageError(f"--time is for --twist and --goal; {named[0]} has times of its own.")
    if course.law != "goto_pose" and course.goal is None:
        raise UsageError(f"--law {course.law} needs a goal. Write --goal X,Y,THETA.")
    if course.speed is not None and course.law != "pursuit":
        raise UsageError(
            "--speed is for --goal with --law pursuit. Write --law pursuit too, or leave out --speed."
        )
    if (course.start or "").startswith("circle") and course.goal is None:
        raise UsageError("--from circle:N is a circle around the goal. Write --goal X,Y,THETA too.")


# ---- Words to numbers.


def _numbers(option: str, text: str, ports: Sequence[Port]) -> tuple[float, ...]:
    """Return the numbers of an option as floats, in SI units; see `from_option`."""
    return tuple(map(float, from_option(option, text, ports)))


def _number(option: str, text: str, port: Port, positive: bool = True) -> float:
    """Return the number of an option.

    Args:
        option: The option, as messages name it.
        text: The number, with a unit if the user writes it.
        port: What the number is.
        positive: Whether it must be above 0.

    Returns:
        The number in SI units.
    """
    (value,) = _numbers(option, text, [port])
    if positive and value <= 0:
        raise UsageError(f"{option} {text[:60]!r}: the value must be above 0")
    return value


def _starts(course: Course) -> Reals:
    """Return the poses at the start, (N, 3)."""
    import numpy as np

    if course.start is None:
        return np.zeros((1, 3))
    if not course.start.startswith("circle"):
        return np.array([_numbers("--from", course.start, POSE)])
    word, *rest = course.start.split(":")
    if (
        word != "circle"
        or len(rest) not in (1, 2)
        or not rest[0].isdigit()
        or not 1 <= int(rest[0]) <= _MOST_STARTS
    ):
        raise UsageError(
            f"--from {course.start[:60]!r}: write circle:8, with 1 to {_MOST_STARTS} poses, or circle:8:2."
        )
    radius = 1.0 if len(rest) < 2 else _radius(course.start, rest[1])
    x, y, theta = _numbers("--goal", course.goal or "", POSE)
    angles = theta + 2 * np.pi * np.arange(int(rest[0])) / int(rest[0])
    return np.stack(
        [x + radius * np.cos(angles), y + radius * np.sin(angles), np.full(len(angles), theta)], axis=-1
    )


def _radius(start: str, text: str) -> float:
    """Return the radius [m] of ``circle:N:RADIUS``, which is ``text`` in ``start``."""
    circle = start.removesuffix(text)
    (radius,) = from_option(f"--from {circle}RADIUS", text, [Port("radius", Role.COMMAND, "m")], circle)
    if radius <= 0:
        raise UsageError(f"--from {start[:60]!r}: the radius must be above 0. Write {circle}1.")
    return float(radius)


def _angles(words: Sequence[str], derivations: Sequence[Derivation]) -> list[dict[str, float]]:
    """Return the angles of wheels and trailers at the start, for each robot those that it has."""
    ports = [_angle_ports(derivation.robot) for derivation in derivations]
    every = {port.name: port for own in ports for port in own}
    for derivation in derivations:
        words = with_joints(words, derivation.robot, "steer", list(every.values()))
    if words and not every:
        raise UsageError(f"{words[0][:60]!r}: this robot has neither steering angles nor trailers")
    case = from_words(words, list(every.values()))
    return [{port.name: float(case[port.name]) for port in own if port.name in case} for own in ports]


def _angle_ports(robot: Loaded) -> list[Port]:
    """Return the steering angles and the headings of trailers of a robot."""
    names = [f"{w.name}.steer" for w in robot.wheels if w.turns] + [f"{t.name}.theta" for t in robot.trailers]
    return [Port(name, Role.STATE, "rad") for name in names]


# ---- The drive.


def _functions(course: Course) -> list[str]:
    """Return the functions that a robot needs."""
    return [*_FUNCTIONS, *([course.law] if course.goal else [])]


def _drive(derivation: Derivation, course: Course, angles: Mapping[str, float]) -> Drive:
    """Return the drive of a robot.

    Args:
        derivation: The robot.
        course: What it is to do.
        angles: Its angles at the start [rad], by name.
    """
    from wmrgen.tools.simulating.drive import simulate as simulated
    from wmrgen.tools.simulating.model import Model

    model = Model(derivation)
    poses = _starts(course)
    source = _source(course, model, poses, angles)
    return simulated(model, model.start(poses, angles), source)


def _source(course: Course, model: Model, poses: Reals, angles: Mapping[str, float]) -> Source:
    """Return the source of the commands.

    Args:
        course: What the robot is to do.
        model: The robot.
        poses: The poses at the start, (N, 3).
        angles: The angles at the start [rad], by name.
    """
    from wmrgen.robotfile.text import bytes_of
    from wmrgen.tools.simulating.sources import GoToPose, Pursue, Recorded, Segments
    from wmrgen.tools.simulating.table import read_table

    step = _number("--step", course.step, _STEP)
    if course.table is not None:
        data = bytes_of(course.table, _LARGEST + 1)
        if len(data) > _LARGEST:
            raise UsageError(f"{course.table} is larger than {_LARGEST >> 20} MiB. Split it.")
        text = data.decode("utf-8-sig", errors="replace")
        return Recorded(read_table(text, course.table, model.derivation), step)
    if course.goal is not None:
        time = _PATIENCE if course.time is None else _number("--time", course.time, _TIME)
        x, y, theta = _numbers("--goal", course.goal, POSE)
        if course.law == "goto_pose":
            return GoToPose((x, y, theta), step, time)
        speed = _number("--speed", _CRUISE if course.speed is None else course.speed, _SPEED, positive=False)
        if not speed:
            raise UsageError("--speed must not be 0")
        return Pursue((x, y), speed, step, time)
    words = [f"{name}={value!r}" for name, value in zip(_POSE, poses[0].tolist(), strict=True)]
    words += [f"{name}={value!r}" for name, value in angles.items() if name.endswith(".steer")]
    if course.segments is not None:
        return Segments(planned(model.derivation, words, course.segments), step)
    return Segments(_constant(course, model.derivation, words), step)


def _constant(course: Course, derivation: Derivation, words: Sequence[str]) -> list[Phase]:
    """Return the phases of a constant twist: steered wheels turn first, as far as a limit of steer_rate needs time."""
    from wmrgen.functions.motion.segments import Phase, Segment, plan

    robot = derivation.robot
    a, b, c = (Exact(Fraction(value)) for value in _numbers("--twist", course.twist or "", TWIST))
    dt = Exact(Fraction(_number("--time", course.time or "", _TIME)))
    values = from_words(
        words, [*POSE, *(Port(f"{w.name}.steer", Role.STATE, "rad") for w in robot.wheels if w.turns)]
    )
    x, y, theta = (values[name] for name in _POSE)
    if any(w.kind.swivels and w.actuated for w in robot.wheels):  # their commands change with their angles
        return [Phase(0, "drive", dt, {}, {}, (a, b, c), (x, y, theta))]
    now = {w.name: values.get(f"{w.name}.steer", ZERO) for w in robot.wheels if w.turns}
    return plan(robot, [Segment("twist", (a, b, c), dt)], derivation.evaluate, (x, y, theta), now)


# ---- The results.


def _remarks(drive: Drive, course: Course) -> list[str]:
    """Return what is remarkable about a drive."""
    import numpy as np

    from wmrgen.tools.simulating.model import SLIDING

    remarks = []
    slip = float(drive.columns["slip"].max())
    if slip > SLIDING:
        remarks.append(
            f"the wheels slide at up to {slip:.3g} m/s, because they cannot follow the command completely"
        )
    beyond = _beyond(drive)
    if beyond:
        remarks.append(
            f"beyond the limits of the robot file: {', '.join(beyond)}. The simulation does not clip them."
        )
    if drive.limited_by:
        functions = " and ".join(drive.limited_by)
        remarks.append(
            f"the law's commands exceeded limits of the robot file. {functions} reduced them, as in firmware"
        )
    if not any(w.actuated for w in drive.model.robot.wheels):
        remarks.append("no wheel is driven: the robot moves as if it were pushed")
    rates = _limits_of_rates(drive.model.robot) if course.goal is not None or course.table is not None else []
    if rates:
        remarks.append(f"the commands take effect at once: limits of {', '.join(rates)} are not simulated")
    if drive.arrived is not None:
        late = int(np.count_nonzero(np.isnan(drive.arrived)))
        if late:
            which = (
                "the goal was not reached"
                if drive.starts == 1
                else f"{late} of {drive.starts} starts did not reach the goal"
            )
            remarks.append(f"{which} within {float(drive.t.max()):.6g} s{_advice(course)}")
    return remarks


def _reached(drive: Drive) -> bool:
    """Return whether every start has reached the goal, if there is one."""
    import numpy as np

    return drive.arrived is None or not np.isnan(drive.arrived).any()


def _limits_of_rates(robot: Loaded) -> list[str]:
    """Return the limits of acceleration and of steering rates that the robot file has."""
    names = [name for name in ("vx_rate", "vy_rate", "omega_rate") if robot.limits.get(name)]
    for name in ("spin_rate", "steer_rate", "steer_acceleration"):
        if any(robot.limit(w, name) for w in robot.wheels if w.commands(name.partition("_")[0])):
            names.append(name)
    return names


def _advice(course: Course) -> str:
    """Return the end of the sentence about a goal that was not reached, with what may help."""
    if _number("--step", course.step, _STEP) <= float(_USUAL_STEP):
        return ""
    return f". The law is computed once in {course.step} s: try a smaller --step, such as {_USUAL_STEP}"


def _beyond(drive: Drive) -> list[str]:
    """Return the quantities that exceed limits of the robot file, each with its largest value and the limit."""
    from wmrgen.analysis.mobility.basis import NEGLIGIBLE

    robot = drive.model.robot
    limits = {name: robot.limits.get(name) for name in ("vx", "vy", "omega")}
    for wheel in robot.wheels:
        for joint in ("spin", "steer"):
            limits[f"{wheel.name}.{joint}"] = robot.limit(wheel, joint)
    texts = []
    for name, limit in limits.items():
        if limit is None or name not in drive.columns:
            continue
        for value, end in ((drive.columns[name].min(), limit.low), (drive.columns[name].max(), limit.high)):
            excess = (float(value) - float(end)) * (1 if end is limit.high else -1)
            if excess > NEGLIGIBLE * max(1.0, abs(float(end))):
                texts.append(f"{name} reaches {float(value):.3g}, limit {float(end):.3g}")
    return texts


def _write(
    drives: Sequence[Drive], course: Course, csv: Path | None, svg: Path | None, html: Path | None
) -> None:
    """Write the files that the user asks for.

    Args:
        drives: The drives.
        course: What they did.
        csv: The path of the table.
        svg: The path of the picture.
        html: The path of the page.
    """
    from wmrgen.derivation.artifacts import write_file
    from wmrgen.tools.simulating.page import written as page
    from wmrgen.tools.simulating.picture import picture
    from wmrgen.tools.simulating.table import written as table

    if csv is not None:
        write_file(csv, table(drives).encode())
    if svg is None and html is None:
        return
    goal = None
    if course.goal is not None:
        x, y, _ = _numbers("--goal", course.goal, POSE)
        goal = (x, y)
    drawn = picture(drives, goal)
    if svg is not None:
        write_file(svg, drawn.svg.encode())
    if html is not None:
        write_file(html, page(drives, drawn).encode())
        if any(drive.starts > 1 for drive in drives):
            console.note("the page plays the first start; its figure shows all of them")


def _facts(drive: Drive, start: int) -> dict[str, Any]:
    """Return the result of one start for JSON: the end of the drive."""
    arrived = drive.arrived
    facts: dict[str, Any] = {
        "robot": drive.name,
        "start": list(drive.pose(0, start)),
        "end": list(drive.pose(-1, start)),
        "time": float(drive.t[-1, start]),
        "path_length": float(drive.length[start]),
        "reversals": drive.reversals(start),
        "slip": float(drive.columns["slip"][:, start].max()),
        "angles": {
            name: float(column[-1, start])
            for name, column in drive.columns.items()
            if name.endswith((".steer", ".theta"))
        },
    }
    if arrived is not None:
        facts["arrived"] = float(arrived[start])  # null if not
    return facts


def _table(drives: Sequence[Drive]) -> list[str]:
    """Return a line for each start: where it ends, after how long, and how far it drives."""
    rows = [
        [
            "robot",
            "from x",
            "y",
            "theta",
            "time [s]",
            "to x [m]",
            "y [m]",
            "theta [rad]",
            "path [m]",
            "reversals",
        ]
    ]
    for drive in drives:
        for start in range(drive.starts):
            facts = _facts(drive, start)
            time = facts.get("arrived", facts["time"])
            shown = facts["time"] if time != time else time  # nan: it has not arrived
            numbers = [*facts["start"], shown, *facts["end"], facts["path_length"]]
            rows.append([drive.name, *map(_rounded, numbers), str(facts["reversals"])])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for name, *cells in rows:
        right = [f"{cell:>{width}}" for cell, width in zip(cells, widths[1:], strict=True)]
        lines.append("  ".join([f"{name:<{widths[0]}}", *right]))
    return lines


def _rounded(value: float) -> str:
    """Return a number of the table, in tenths of a millimetre or of a milliradian; a huge one with few digits."""
    return f"{value:.4e}" if abs(value) >= _HUGE else f"{round(value, 4) + 0.0:.4f}"
