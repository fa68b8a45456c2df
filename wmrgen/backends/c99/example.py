"""``example/main.c``: a robot's loop from sensors to motors, with every function of the loop that the robot has.

What stands for motors and sensors follows commands at once; a program of one's own puts its drivers in the place of it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from wmrgen.backends.c99.counters import FUNCTION as COUNTS
from wmrgen.backends.c99.figure import DURATION, figure
from wmrgen.backends.c99.records import Step, Unit
from wmrgen.backends.c99.text import comment_lines
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.nodes import Module
from wmrgen.loop import Stage, loop
from wmrgen.ports import TWIST_NAMES
from wmrgen.render import render

PER_SECOND = 100
STEPS = DURATION * PER_SECOND
STARTING = 3 * PER_SECOND  # steps in which it speeds up, and comes to rest
ABOUT = (
    "{figure} {rate} steps a second: sensors to twist and pose, a commanded twist to motors. hardware() stands for "
    "both: motors that follow at once. Put your drivers in its place, and begin with commands as the joints stand. "
    "From the folder of {robot}.c: cc -D{upper}_EXAMPLE_MAIN example/main.c {robot}.c -lm"
)


def example(module: Module, unit: Unit, common: Mapping[str, object]) -> str:
    """The text of the file; ``unit``: the C functions of ``module``, ``common``: what every template is told."""
    steps = {step.name.removeprefix(f"{unit.robot}_"): step for step in unit.every}
    stages = loop(module, steps)
    drawn = figure(module)
    variables: dict[str, str] = {"wanted": f"{unit.robot}_twist"}

    def call(stage: Stage) -> str:
        step = steps[stage.function]
        passed = {p: stage.variables.get(p, p) for p in step.variables}
        variables.update({passed[p]: kind for p, kind in step.variables.items()})
        return f"{step.call(passed)};"

    sensing, acting = ([call(stage) for stage in part] for part in (stages.senses, stages.acts))
    before = unit.before([steps[stage.function] for stage in (*stages.senses, *stages.acts)])
    variables |= {name: kind for step in before for name, kind in step.variables.items()}
    acting = [*_kept(steps, variables), *acting]
    variables.pop("dt", None)
    return render(
        "c99/example.c.j2",
        **common,
        about=comment_lines(
            ABOUT.format(figure=drawn.text, robot=unit.robot, upper=unit.robot.upper(), rate=PER_SECOND)
        ),
        variables=[(kind, name) for name, kind in variables.items()],
        prepare=[f"{step.call()};" for step in before],
        sensing=sensing,
        acting=acting,
        hardware=[*_hardware(module, unit)],
        counts="counters" in variables,
        steps=STEPS,
        dt=_number(unit, 1 / PER_SECOND),
        starting=STARTING,
        parts={name: _number(unit, part) for name, part in zip(TWIST_NAMES, drawn[:3], strict=True) if part},
        one=_number(unit, 1.0),
    )


def _kept(steps: Mapping[str, Step], variables: Collection[str]) -> Iterator[str]:
    """Statements before the commands: what `steer_toward` starts from, and what `inverse` only reads."""
    if "before" in variables:
        yield "before = commands;"
    if "inverse" in steps:
        parameters = steps["inverse"].parameters
        commanded = {member for p in parameters for member in p.writes.values()}
        for member in (m for p in parameters if p.name == "now" for m in p.reads.values()):
            if member not in commanded:
                yield f"commands.{member} = wheels.{member};"


def _number(unit: Unit, value: float) -> str:
    text = f"{value:.9g}"
    return text + ("" if set(text) & set(".e") else ".0") + ("f" if unit.choice.scalar == "float" else "")


def _hardware(module: Module, unit: Unit) -> Iterator[str]:
    """The statements of motors and sensors: joints are what is commanded, and encoders count them."""
    bits = {}
    commanded = {p.name for f in module.functions if f.name == "inverse" for p in f.outputs}
    if unit.counting is not None:
        bits = {port.name: port.bits for port in module.function(COUNTS).inputs if port.bits}
        yield "counters_before = counters;"
    for joint in unit.joints:
        rate, width = f"{joint}_rate", bits.get(f"{joint}_counts")
        swivels = rate in unit.joints and joint not in commanded  # its rate is what is commanded
        if width is None and swivels:
            yield f"wheels.{joint} += dt * commands.{rate};"
        elif width is None:
            yield f"wheels.{joint} = commands.{joint};"
        elif swivels or joint.endswith(".spin"):
            per_radian = _number(unit, _counts(module, f"{joint}_counts"))
            moved = f"commands.{rate if swivels else joint}"
            counted = f"counted(dt * {moved} * {per_radian}, &uncounted.{joint})"
            yield f"counters.{joint} = (uint{width}_t)(counters.{joint} + (uint{width}_t){counted});"
        elif joint.endswith(".steer"):
            per_radian = _number(unit, _counts(module, f"{joint}_counts"))
            yield f"counters.{joint} = (uint{width}_t)(int{width}_t)(commands.{joint} * {per_radian});"


def _counts(module: Module, port: str) -> float:
    """How many counts a radian is."""
    function = module.function(COUNTS)
    values = {p.name: 0.0 for p in function.inputs} | {port: 1.0, "dt": 1.0}
    return float(1 / evaluate(function, values, FLOAT64)[port.removesuffix("_counts")])
