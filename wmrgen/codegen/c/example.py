"""``example/main.c``: a robot's loop from sensors to motors, with every function of the loop that the robot has.

What stands for motors and sensors follows commands at once; a program of one's own puts its drivers in the place of it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from wmrgen.codegen.c.counters import FUNCTION as COUNTS
from wmrgen.codegen.c.figure import DURATION, STARTING, Figure, figure
from wmrgen.codegen.c.records import Unit
from wmrgen.codegen.c.text import comment_lines
from wmrgen.codegen.loop import Loop, Stage, loop, only_read
from wmrgen.codegen.render import render
from wmrgen.geometry.ports import GYRO, TWIST_NAMES, Reading, Site
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.nodes import Module

PER_SECOND = 100
STEPS = DURATION * PER_SECOND
ABOUT = (
    "{figure} {rate} steps a second: sensors to twist and pose, a commanded twist to motors. hardware() stands for "
    "both: motors that follow at once. Put your drivers in its place, and begin with commands as the joints stand. "
    "From the folder of {robot}.c: cc -D{upper}_EXAMPLE_MAIN example/main.c {robot}.c -lm"
)


def example(module: Module, unit: Unit, site: Site, common: Mapping[str, object]) -> str:
    """The text of the file.

    Args:
        module: The functions of the robot.
        unit: The C functions of ``module``.
        site: What the robot file says of them.
        common: What every template is told.
    """
    steps = {step.name.removeprefix(f"{unit.robot}_"): step for step in unit.every}
    stages = loop(module, steps)
    drawn = figure(module, site.unmotored)
    variables: dict[str, str] = {"wanted": f"{unit.robot}_twist"}

    def call(stage: Stage) -> str:
        step = steps[stage.function]
        passed = {p: stage.variables.get(p, p) for p in step.variables}
        variables.update({passed[p]: kind for p, kind in step.variables.items()})
        return f"{step.call(passed)};"

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
        prepare=[*(f"{step.call()};" for step in before), *_homed(module, unit)],
        sensing=sensing,
        acting=acting,
        hardware=[*_hardware(module, unit, variables), *_turned(stages, variables)],
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
    """The statements that set the twist of step k."""
    for name, steady, swinging in zip(TWIST_NAMES, figure.steady, figure.swinging, strict=True):
        parts = [(steady, "started(k)"), (swinging, "swing(k)")]
        terms = [f"({_number(unit, part)} * {times})" for part, times in parts if part]
        if terms:
            yield f"wanted.{name} = {' + '.join(terms) if len(terms) > 1 else terms[0][1:-1]};"


def _homed(module: Module, unit: Unit) -> Iterator[str]:
    """The statements that put absolute encoders where their joints are at 0."""
    for joint, reading in _readings(module, unit).items():
        if reading.offset:
            yield f"counters.{joint} = {reading.offset}u;"


def _kept(module: Module, variables: Collection[str]) -> Iterator[str]:
    """Statements before the commands: what `steer_toward` starts from, and what `inverse` only reads."""
    if "before" in variables:
        yield "before = commands;"
    if "commands" in variables:
        yield from (f"commands.{member} = wheels.{member};" for member in only_read(module))


def _number(unit: Unit, value: float) -> str:
    text = f"{value:.9g}"
    return text + ("" if set(text) & set(".e") else ".0") + ("f" if unit.choice.scalar == "float" else "")


def _hardware(module: Module, unit: Unit, variables: Collection[str]) -> Iterator[str]:
    """The statements of motors and sensors: joints are what is commanded, and encoders count them."""
    if "wheels" not in variables:  # no joint is sensed
        return
    readings = _readings(module, unit)
    commanded = {p.name for f in module.functions if f.name == "inverse" for p in f.outputs}
    if readings:
        yield "counters_before = counters;"
    for joint in unit.joints:
        rate, reading = f"{joint}_rate", readings.get(joint)
        swivels = rate in unit.joints and joint not in commanded  # its rate is what is commanded
        if reading is None and swivels:
            yield f"wheels.{joint} += dt * commands.{rate};"
        elif reading is None and joint.removesuffix("_rate") not in readings:
            yield f"wheels.{joint} = commands.{joint};"
        elif reading is not None:
            per_radian = _number(unit, _counts(module, f"{joint}_counts"))
            if swivels or joint.endswith(".spin"):
                moved = f"commands.{rate if swivels else joint}"
                counted = f"counted(dt * {moved} * {per_radian}, &uncounted.{joint})"
                yield f"counters.{joint} = {_shown(f'counters.{joint}', counted, reading)};"
            else:
                turned = f"(int32_t)(commands.{joint} * {per_radian})"
                yield f"counters.{joint} = {_shown(f'{reading.offset or 0}', turned, reading)};"


def _turned(stages: Loop, variables: Collection[str]) -> Iterator[str]:
    """The statement of a gyro, which shows the yaw rate that is commanded."""
    if GYRO.name in variables:
        (twist,) = (s.variables["twist"] for s in stages.acts if s.function == "inverse")
        yield f"{GYRO.name} = {twist}.omega;"


def _readings(module: Module, unit: Unit) -> dict[str, Reading]:
    """Spin or steer of a wheel -> what its encoder shows."""
    inputs = module.function(COUNTS).inputs if unit.counting is not None else ()
    each = {port.name.removesuffix("_counts"): port.reading for port in inputs if port.reading}
    return {joint: reading for joint, reading in each.items() if not joint.endswith("_rate")}


def _shown(start: str, counts: str, reading: Reading) -> str:
    """The reading of an encoder that counted on from ``start``."""
    unsigned = f"uint{reading.width}_t"
    if reading.wraps_as_integer:
        return f"({unsigned})({start} + (uint32_t){counts})"
    return f"({unsigned})wrapped((int32_t){start} + {counts}, {reading.modulus}l)"


def _counts(module: Module, port: str) -> float:
    """How many counts a radian is."""
    function = module.function(COUNTS)
    values = {p.name: 0.0 for p in function.inputs} | {port: 1.0, "dt": 1.0}
    return float(1 / evaluate(function, values, FLOAT64)[port.removesuffix("_counts")])
