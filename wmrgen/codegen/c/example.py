"""``example/main.c``: a control loop from sensors to motors, with every function of the loop that the robot has.

The example simulates motors that follow commands at once; in a real program, drivers take their place. The robot drives
a figure: the first of a list that it can drive and measure. Along the figure a factor, the swing, runs from 0 to 1, to
-1 and back to 0, in straight lines over time. It scales the part of the twist that turns the robot or moves it
sideways.

To decide whether a robot can drive a figure, the loop runs in double precision for a few moments of the figure. The
twist that `forward` computes from the commands must be the wanted one. This fails if curvature exceeds a steering stop,
if the wheels cannot turn the robot, if they skid, if limits of rates apply, or if the wheels do not determine the yaw
rate. No figure has a motion that no motor commands.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from itertools import dropwhile, product
from math import degrees, hypot, pi
from typing import NamedTuple

from wmrgen.codegen.c.counters import FUNCTION as COUNTS
from wmrgen.codegen.c.functions import call as call_of
from wmrgen.codegen.c.text import comment_lines
from wmrgen.codegen.loop import Loop, Stage, loop, only_read
from wmrgen.codegen.render import render
from wmrgen.codegen.signature import arguments
from wmrgen.codegen.unit import Unit
from wmrgen.geometry.ports import GYRO, TWIST_NAMES, Reading, Site
from wmrgen.ir.calls import by_name, inline_prepare, inlined
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.nodes import Module

DURATION = 60  # s: the sentences about figures say "a minute"
STARTING = 3  # s: duration of speeding up, and of slowing down
PER_SECOND = 100  # steps of the control loop in a second
STEPS = DURATION * PER_SECOND
ABOUT = (
    "{figure} The loop runs {rate} times a second: from sensors to twist and pose, and from a commanded twist to "
    "motors. hardware() simulates motors that follow commands at once. Call your drivers there, and start with "
    "commands that are the present state of the joints. To build it in the folder of {robot}.c: "
    "cc -D{upper}_EXAMPLE_MAIN example/main.c {robot}.c -lm"
)

# ---- the program


def example(module: Module, unit: Unit, site: Site, common: Mapping[str, object]) -> str:
    """Return the text of the program.

    Args:
        module: The functions of the robot.
        unit: Its C functions.
        site: What the robot file says about inputs.
        common: Variables of every template.
    """
    steps = {step.function: step for step in unit.every}
    stages = loop(module, steps)
    drawn = figure(module, site.unmotored)
    variables: dict[str, str] = {"wanted": f"{unit.robot}_twist"}

    def call(stage: Stage) -> str:
        step = steps[stage.function]
        passed = {p: stage.variables.get(p, p) for p in step.variables}
        variables.update({passed[p]: kind for p, kind in step.variables.items()})
        return f"{call_of(step, passed)};"

    sensing, acting = ([call(stage) for stage in part] for part in (stages.senses, stages.acts))
    before = unit.before([steps[stage.function] for stage in (*stages.senses, *stages.acts)])
    variables |= {name: kind for step in before for name, kind in step.variables.items()}
    acting = [*_kept(module, variables), *acting]
    variables.pop("dt", None)
    return render(
        "c99/example.c.j2",
        **common,
        about=comment_lines(
            ABOUT.format(figure=drawn.text, robot=unit.robot, upper=unit.robot.upper(), rate=PER_SECOND)
        ),
        variables=[(kind, name) for name, kind in variables.items()],
        prepare=[*(f"{call_of(step)};" for step in before), *_initial_counters(module, unit)],
        sensing=sensing,
        acting=acting,
        hardware=[*_hardware(module, unit, variables), *_gyro(stages, variables)],
        counts="counters" in variables,
        wraps=any(not reading.wraps_as_integer for reading in _readings(module, unit).values()),
        steps=STEPS,
        dt=_number(unit, 1 / PER_SECOND),
        starting=STARTING * PER_SECOND,
        wanted=list(_wanted(unit, drawn)),
        starts=any(drawn.steady),
        swings=any(drawn.swinging),
        one=_number(unit, 1.0),
    )


def _wanted(unit: Unit, figure: Figure) -> Iterator[str]:
    """Yield the statements that set the wanted twist of step k."""
    for name, steady, swinging in zip(TWIST_NAMES, figure.steady, figure.swinging, strict=True):
        parts = [(steady, "started(k)"), (swinging, "swing(k)")]
        terms = [f"({_number(unit, part)} * {times})" for part, times in parts if part]
        if terms:
            yield f"wanted.{name} = {' + '.join(terms) if len(terms) > 1 else terms[0][1:-1]};"


def _initial_counters(module: Module, unit: Unit) -> Iterator[str]:
    """Yield the statements that set absolute encoders to their readings at joint angle 0."""
    for joint, reading in _readings(module, unit).items():
        if reading.offset:
            yield f"counters.{joint} = {reading.offset}u;"


def _kept(module: Module, variables: Collection[str]) -> Iterator[str]:
    """Yield the statements before the commands: they save what `steer_toward` starts from and copy passive joints."""
    if "before" in variables:
        yield "before = commands;"
    if "commands" in variables:
        yield from (f"commands.{member} = wheels.{member};" for member in only_read(module))


def _number(unit: Unit, value: float) -> str:
    text = f"{value:.9g}"
    return text + ("" if set(text) & set(".e") else ".0") + ("f" if unit.choice.scalar == "float" else "")


def _hardware(module: Module, unit: Unit, variables: Collection[str]) -> Iterator[str]:
    """Yield the statements of motors and sensors: joints equal their commands, and encoders count them."""
    if "wheels" not in variables:  # no joint is sensed
        return
    readings = _readings(module, unit)
    commanded = {p.name for f in module.functions if f.name == "inverse" for p in f.outputs}
    if readings:
        yield "counters_before = counters;"
    for joint in unit.joints:
        rate, reading = f"{joint}_rate", readings.get(joint)
        swivels = rate in unit.joints and joint not in commanded  # only its rate is commanded
        if reading is None and swivels:
            yield f"wheels.{joint} += dt * commands.{rate};"
        elif reading is None and joint.removesuffix("_rate") not in readings:
            yield f"wheels.{joint} = commands.{joint};"
        elif reading is not None:
            per_radian = _number(unit, _counts_per_radian(module, f"{joint}_counts"))
            if swivels or joint.endswith(".spin"):
                moved = f"commands.{rate if swivels else joint}"
                counted = f"counted(dt * {moved} * {per_radian}, &uncounted.{joint})"
                yield f"counters.{joint} = {_shown(f'counters.{joint}', counted, reading)};"
            else:
                turned = f"(int32_t)(commands.{joint} * {per_radian})"
                yield f"counters.{joint} = {_shown(f'{reading.offset or 0}', turned, reading)};"


def _gyro(stages: Loop, variables: Collection[str]) -> Iterator[str]:
    """Yield the statement of a gyro, which measures the commanded yaw rate."""
    if GYRO.name in variables:
        (twist,) = (s.variables["twist"] for s in stages.acts if s.function == "inverse")
        yield f"{GYRO.name} = {twist}.omega;"


def _readings(module: Module, unit: Unit) -> dict[str, Reading]:
    """Return the encoder's reading for each spin and steer joint that has one."""
    inputs = module.function(COUNTS).inputs if unit.counting is not None else ()
    each = {port.name.removesuffix("_counts"): port.reading for port in inputs if port.reading}
    return {joint: reading for joint, reading in each.items() if not joint.endswith("_rate")}


def _shown(start: str, counts: str, reading: Reading) -> str:
    """Return the reading of an encoder that has moved by ``counts`` from ``start``."""
    unsigned = f"uint{reading.width}_t"
    if reading.wraps_as_integer:
        return f"({unsigned})({start} + (uint32_t){counts})"
    return f"({unsigned})wrapped((int32_t){start} + {counts}, {reading.modulus}l)"


def _counts_per_radian(module: Module, port: str) -> float:
    """Return the counts per radian of an encoder."""
    function = module.function(COUNTS)
    values = {p.name: 0.0 for p in function.inputs} | {port: 1.0, "dt": 1.0}
    return float(1 / evaluate(function, values, FLOAT64)[port.removesuffix("_counts")])


# ---- the figure

Twist = tuple[float, float, float]  # m/s, m/s, rad/s
_SPEEDS = (0.25, 4.0)  # m/s: a fast robot's `limit_twist` treats 0.25 m/s as standstill
_SHARES = (1.0, 0.4, 0.16)  # of the speed that limits allow, because some wheels are faster in a curve
_HEADINGS = (2 * pi, pi, pi / 2, pi / 4, pi / 8, pi / 16)  # rad: change of heading in half of the figure
_SIDEWAYS = (1.0, 0.5, 0.25)  # of the speed ahead
_MOMENTS = (15.0, 45.0, 7.5, 30.0, 52.5, 1.5, 58.0)  # s: the curve is tightest at the first two
_STEP = 0.5  # s between two rehearsed steps: long enough for limits of rates to have an effect
_TOLERANCE = 1e-3  # of the speed: a tenth of the error that a drive may have
_YAW_TOLERANCE = 2.5e-4  # rad/s: after half of the figure the heading is off by 0.0075 rad
_STILL = (0.0, 0.0, 0.0)
_BOTH = "both commanded by its motors and measured by its sensors"


class Figure(NamedTuple):
    """A wanted twist over time: ``steady`` plus the swing times ``swinging``."""

    steady: Twist
    swinging: Twist
    text: str  # a sentence for the program


def figure(module: Module, unmotored: bool) -> Figure:
    """Return the figure for a robot; standstill if it can drive none.

    Args:
        module: The functions of the robot, as C has them.
        unmotored: Whether no motor commands some of its motions.
    """
    robot = Rehearsal(module, _STEP)
    if robot.whole:
        for candidate in _candidates(robot, unmotored):
            if _drives(robot, candidate):
                return candidate
    return Figure(_STILL, _STILL, f"Standstill, because no figure of this example is {_BOTH}.")


def _candidates(robot: Rehearsal, unmotored: bool) -> Iterator[Figure]:
    """Yield figures, those that use most of the robot's freedom first. The robot may be unable to drive them."""
    straights = list(_straights(robot))
    for straight in () if unmotored else straights:
        turns = list(dropwhile(lambda f: not _drives(robot, f), _turns(robot, straight)))
        sides = list(dropwhile(lambda f: not _drives(robot, f), _sides(straight)))
        for turn, side in product(turns, sides):
            text = turn.text.replace(" in a", ", partly sideways, in a")
            yield Figure(straight, _sum(turn.swinging, side.swinging), text)
        yield from (*turns[:1], *sides[:1])
    for straight in straights:
        text = f"Straight on for a minute, because {_why_straight(robot, straight, unmotored)}."
        yield Figure(straight, _STILL, text)


def _straights(robot: Rehearsal) -> Iterator[Twist]:
    """Yield straight motions at several speeds: ahead or, if the wheels do not allow that, to the side."""
    for speed in _SPEEDS:
        for wanted in ((speed, 0.0, 0.0), (0.0, speed, 0.0)):
            straight = robot.driven(wanted)
            if hypot(*straight[:2]) > _TOLERANCE * speed and abs(straight[2]) <= _YAW_TOLERANCE:
                yield from (_times(share, straight) for share in _SHARES)
                break


def _turns(robot: Rehearsal, straight: Twist) -> Iterator[Figure]:
    """Yield curves, with the sideways velocity that fixed wheels in front of P or behind P force on a turn."""
    speed = hypot(*straight[:2])
    for heading in _HEADINGS:
        what = "loop" if heading == 2 * pi else f"curve of {degrees(heading):g} degrees"
        rate = _rate(heading)
        driven = robot.driven(_sum(straight, (0.0, 0.0, rate)))
        across = (driven[1] * straight[0] - driven[0] * straight[1]) / speed
        if abs(across * rate) <= _TOLERANCE * speed * abs(driven[2]):
            across = 0.0
        across *= rate / driven[2] if driven[2] else 0.0
        swinging = (-across * straight[1] / speed, across * straight[0] / speed, rate)
        yield Figure(straight, swinging, f"A {what} to the left and one to the right in a minute.")


def _sides(straight: Twist) -> Iterator[Figure]:
    """Yield motions to both sides with a constant heading."""
    text = "To the left and to the right, while the robot drives on and keeps its heading, in a minute."
    for part in _SIDEWAYS:
        yield Figure(straight, (-part * straight[1], part * straight[0], 0.0), text)


def _rate(heading: float) -> float:
    """Return the yaw rate [rad/s] at swing 1 of a figure with this change of heading [rad] in each half."""
    return 4 * heading / DURATION


def _why_straight(robot: Rehearsal, straight: Twist, unmotored: bool) -> str:
    """Return why the robot drives no curve."""
    if unmotored:
        return "its motors do not command all of its motions"
    if robot.slides(_sum(straight, (0.0, 0.0, _rate(_HEADINGS[-1]))), _TOLERANCE):
        return "its wheels would slide in a curve"
    return f"no curve of this robot is {_BOTH}"


def _drives(robot: Rehearsal, figure: Figure) -> bool:
    """Return whether the robot drives the wanted twist at every moment, never faster sideways than ahead."""
    speed = hypot(*figure.steady[:2])
    if hypot(*figure.swinging[:2]) > 1.001 * speed:
        return False
    for moment in _MOMENTS:
        wanted = _wanted_at(figure, moment + _STEP)
        driven = robot.driven(wanted, _wanted_at(figure, moment))
        off = _sum(driven, _times(-1.0, wanted))
        if hypot(*off[:2]) > _TOLERANCE * speed or abs(off[2]) > _YAW_TOLERANCE:
            return False
    return True


def _wanted_at(figure: Figure, time: float) -> Twist:
    """Return the wanted twist at a ``time`` [s], as the program computes it."""
    quarter, started = DURATION / 4, min(time, DURATION - time, STARTING) / STARTING
    swing = time if time < quarter else 2 * quarter - time if time < 3 * quarter else time - DURATION
    return _sum(_times(started, figure.steady), _times(swing / quarter, figure.swinging))


def _sum(a: Twist, b: Twist) -> Twist:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _times(factor: float, twist: Twist) -> Twist:
    return factor * twist[0], factor * twist[1], factor * twist[2]


# ---- the loop in double precision, to find out which twist a robot drives

_Variables = dict[str, dict[str, float]]  # variable of the loop -> its members
_WITHOUT_RATES = {"limit_twist", "inverse", "desaturate"}  # functions of the loop that limit no rates
_LAGGING = {"compensate_steering"}  # it drives the commands of the last step, and steps are long here


class Rehearsal:
    """The control loop of a robot in double precision, with steps of ``dt`` [s]."""

    def __init__(self, module: Module, dt: float) -> None:
        kernels = by_name(module.kernels)
        self._functions = {
            f.name: inline_prepare(inlined(f, kernels), module.prepare) for f in module.functions
        }
        self._joints, self._dt = module.joints, dt
        self.whole = {"inverse", "forward"} <= self._functions.keys()
        has = self._functions.keys() - _LAGGING
        self._acts = loop(module, has).acts if self.whole else ()

    def driven(self, wanted: Twist, last: Twist | None = None) -> Twist:
        """Return the twist that the robot drives when ``wanted`` is commanded one step after ``last``.

        Without ``last``, the robot has driven the wanted twist for a long time.
        """
        variables = self._steady_state(wanted if last is None else last)
        if last is not None:
            commands = variables["commands"]
            variables |= {"wheels": dict(commands), "before": dict(commands), "wanted": _named(wanted)}
            for stage in self._acts:
                self._call(stage, variables)
        found = self._results("forward", variables["commands"] | {GYRO.name: wanted[2]})
        return found["vx"], found["vy"], found["omega"]

    def slides(self, twist: Twist, share: float) -> bool:
        """Return whether wheels must slide at ``twist`` by more than this ``share`` of its speed."""
        if "inverse_slip" not in self._functions:
            return False
        commands = self._steady_state(twist)["commands"]
        return self._results("inverse_slip", commands | _named(twist))["slip"] > share * hypot(*twist[:2])

    def _steady_state(self, wanted: Twist) -> _Variables:
        """Return the variables after ``wanted`` was commanded for a long time."""
        variables: _Variables = {"wanted": _named(wanted), "commands": {}}
        for stage in self._acts:
            variables["driven"] = dict(variables["wanted"])
            if stage.function in _WITHOUT_RATES:
                self._call(stage, variables)
        return variables

    def _call(self, stage: Stage, variables: _Variables) -> None:
        """Call a function of the loop, which reads and changes ``variables``."""
        function = self._functions[stage.function]
        own = [(stage.variables.get(a.name, a.name), a) for a in arguments(function, self._joints)]
        given = {
            port: variables.get(variable, {}).get(member, 0.0)
            for variable, argument in own
            for port, member in argument.reads.items()
        }
        results = self._results(stage.function, given | {"dt": self._dt})
        for variable, argument in own:
            written = {member: results[port] for port, member in argument.writes.items()}
            variables[variable] = variables.get(variable, {}) | written

    def _results(self, name: str, given: Mapping[str, float]) -> dict[str, float]:
        function = self._functions[name]
        values = {p.name: given.get(p.name, 0.0) for p in function.inputs if p.default is None}
        return evaluate(function, values, FLOAT64)


def _named(twist: Twist) -> dict[str, float]:
    return dict(zip(TWIST_NAMES, twist, strict=True))
