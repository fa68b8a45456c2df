"""Texts that a calibration writes: the robot file with new values, parameters for ROS, and numbers for the C."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from wmrgen.errors import NotDerivableError
from wmrgen.geometry.layout import build
from wmrgen.geometry.layout.records import Parameter, Robot
from wmrgen.geometry.symbolic import expression
from wmrgen.ir.nodes import Module
from wmrgen.robotfile.load import read_robot
from wmrgen.robotfile.records import Quantity
from wmrgen.tools.calibration.joint_noise import JointNoise
from wmrgen.tools.calibration.result import Calibration
from wmrgen.tools.exporting.ros2_control import ros2_control


def new_values(result: Calibration) -> dict[str, float]:
    """Return the values for the robot file, of all parameters that differ from nominal.

    A parameter that is not determined at all stays nominal. Parameters that are determined only together, such as half
    length and half width by their sum, are all returned, because their values belong together.
    """
    gain = ".gain"  # no robot file has one
    return {n: e.value for n, e in result.parameters.items() if e.value != e.nominal and not n.endswith(gain)}


def with_values(path: Path, values: Mapping[str, float], noise: JointNoise | None = None) -> str:
    """Return the text of a robot file with other values of its parameters, every other character as it was.

    A range that a value leaves is widened to it. The noise of wheel speeds replaces its share, if the file has one; a
    file without `noise` gets a line.

    Args:
        path: The robot file.
        values: New values of some parameters, in m and rad.
        noise: Noise of wheel speeds; None: keep the noise in the file.
    """
    lines = path.read_bytes().decode("utf-8").split("\n")
    spec = read_robot(path)
    before = {p.name: p for p in build(spec).parameters}
    changes = list[tuple[Quantity, str]]()
    for p in spec.parameters:
        if p.name in values:
            text = f"{values[p.name]:.8g}"
            side = beyond(before[p.name], float(text))
            changes.append((p.value, text))
            if p.range is not None and side:
                changes.append((p.range[side > 0], text))
    shares = [n.proportional for n in spec.noise if n.joint == "spin" and n.proportional is not None]
    if noise is not None and shares:
        changes.append((shares[0], f"{noise.proportional:.3g}"))
    elif noise is not None and not spec.noise:
        while lines and not lines[-1].strip():
            lines.pop()
        share = f"noise: {{spin: {{proportional: {noise.proportional:.3g}}}}}"
        lines += [f"{share}  # of readings every {noise.step:.2g} s", ""]
    for written, text in sorted(changes, key=lambda c: (c[0].mark.line, c[0].mark.column), reverse=True):
        line, column = written.mark.line - 1, written.mark.column - 1
        start = lines[line].index(written.text, column)
        lines[line] = f"{lines[line][:start]}{text}{lines[line][start + len(written.text) :]}"
    return "\n".join(lines)


def beyond(p: Parameter, value: float) -> int:
    """Return -1 if a value is below the range of its parameter, 1 if it is above, else 0."""
    return (value > float(p.high)) - (value < float(p.low))


def controllers(robot: Robot) -> tuple[str, str]:
    """Return the parameters of the controller of ros2_controllers that fits a robot, and else the reason."""
    try:
        return ros2_control(robot)[f"{robot.name}_controllers.yaml"], ""
    except NotDerivableError as error:
        return "", error.what


def equivalent_counts(robot: Robot, values: Mapping[str, float]) -> dict[str, float]:
    """Return counts per turn of each ``<wheel>.spin`` with an encoder, negative if it counts down.

    With them the wheel's nominal radius is right in place of the one that ``values`` [m] give it: drives determine only
    the ratio of both.
    """
    result = {}
    for wheel in robot.wheels:
        encoder, radius = robot.encoder_of(wheel, "spin"), expression(wheel.working.r)
        if encoder is not None and radius.free_symbols:
            calibrated = float(radius.subs({s: values[s.name] for s in radius.free_symbols}))
            result[f"{wheel.name}.spin"] = float(encoder.turn) * float(wheel.nominal.r) / calibrated
    return result


def c_values(module: Module, values: Mapping[str, float]) -> str:
    """Return a C header with a macro that initialises the robot's struct of parameters; empty if there is no struct."""
    ports = module.prepare.inputs if module.prepare is not None else ()
    if not ports:
        return ""
    name = module.name
    entries = ", ".join(f".{port.name} = {_literal(values[port.name])}" for port in ports)
    macro = f"{name.upper()}_CALIBRATED"
    return (
        f"/* {name}_params params = {macro}; then {name}_prepare(&params, &prepared). Parameters in m and rad. */\n"
        f"#ifndef {macro}\n#define {macro} {{{entries}}}\n#endif\n"
    )


def _literal(value: float) -> str:
    """Return a number with nine digits, so that float and double read the same value."""
    digits = f"{value:.9g}"
    return digits if any(c in digits for c in ".e") else f"{digits}.0"
