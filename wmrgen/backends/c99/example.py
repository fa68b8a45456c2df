"""``example/main.c``: a robot's loop from sensors to motors, with every function of the loop that the robot has.

What stands for motors and sensors follows commands at once; a program of one's own puts its drivers in the place of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi

from wmrgen.backends.c99.counters import FUNCTION as COUNTS
from wmrgen.backends.c99.records import Unit
from wmrgen.backends.c99.text import comment_lines
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.nodes import Module
from wmrgen.loop import Stage, loop
from wmrgen.render import render

STEPS, PER_SECOND = 6000, 100  # a minute
SPEED = 0.25  # m/s, where the limits of the robot allow it
ABOUT = (
    "A figure of eight in a minute, {rate} steps a second: sensors to twist and pose, a commanded twist to motors. "
    "hardware() stands for both: motors that follow at once. Put your drivers in its place. From the folder of "
    "{robot}.c: cc example/main.c {robot}.c -lm"
)


def example(module: Module, unit: Unit, common: Mapping[str, object]) -> str:
    """The text of the file; ``unit``: the C functions of ``module``, ``common``: what every template is told."""
    steps = {step.name.removeprefix(f"{unit.robot}_"): step for step in unit.every}
    stages = loop(module, steps)
    variables: dict[str, str] = {"wanted": f"{unit.robot}_twist"}

    def call(stage: Stage) -> str:
        step = steps[stage.function]
        passed = {p: stage.variables.get(p, p) for p in step.variables}
        variables.update({passed[p]: kind for p, kind in step.variables.items()})
        return f"{step.call(passed)};"

    sensing, acting = ([call(stage) for stage in part] for part in (stages.senses, stages.acts))
    before = unit.before([steps[stage.function] for stage in (*stages.senses, *stages.acts)])
    variables |= {name: kind for step in before for name, kind in step.variables.items()}
    variables.pop("dt", None)
    return render(
        "c99/example.c.j2",
        **common,
        about=comment_lines(ABOUT.format(robot=unit.robot, rate=PER_SECOND)),
        variables=[(kind, name) for name, kind in variables.items()],
        prepare=[f"{step.call()};" for step in before],
        sensing=sensing,
        acting=acting,
        hardware=[*_hardware(module, unit)],
        counts="counters" in variables,
        steps=STEPS,
        dt=_number(unit, 1 / PER_SECOND),
        speed=_number(unit, SPEED),
        turning=_number(unit, 4 * pi * PER_SECOND / STEPS),
    )


def _number(unit: Unit, value: float) -> str:
    return f"{value:.9g}" + ("f" if unit.choice.scalar == "float" else "")


def _hardware(module: Module, unit: Unit) -> Iterator[str]:
    """The statements of motors and sensors: joints are what is commanded, and encoders count them."""
    bits = {}
    if unit.counting is not None:
        bits = {port.name: port.bits for port in module.function(COUNTS).inputs if port.bits}
        yield "counters_before = counters;"
    chosen = {port.name for port in module.function("inverse").outputs}
    for joint in unit.joints:
        rate, width = f"{joint}_rate", bits.get(f"{joint}_counts")
        swivels = rate in unit.joints and joint not in chosen  # its rate is what is commanded
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
