"""What a calibration gives to others: the robot file with other values, every other character as it was, parameters
for ROS, and the numbers for the C."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from wmrgen.errors import NotDerivableError
from wmrgen.geometry.layout import build
from wmrgen.geometry.layout.records import Parameter, Robot
from wmrgen.geometry.symbolic import expression
from wmrgen.ir.nodes import Module
from wmrgen.robotfile.load import read_robot
from wmrgen.robotfile.records import Quantity
from wmrgen.tools.calibrating.calibrate import Calibration
from wmrgen.tools.calibrating.mistakes import unlike
from wmrgen.tools.exporting.ros2_control import ros2_control

_LOST = 4.0  # times the nominal value, or less than its fourth part, or of another sign
_LOST_ANGLE = 3.0  # [rad] the same of what is nominally 0


def untold(result: Calibration, group: Sequence[str]) -> bool:
    """Whether parameters that the drives do not tell stay nominal: such as are told nothing of, alone, and such among
    which the fit has lost its way. Those that only scale together are told with one another, as half length and half
    width by their sum, and belong to the other values."""
    off = (result.parameters[name] for name in group)
    return len(group) == 1 or any(unlike(e.value, e.nominal, _LOST, _LOST_ANGLE) for e in off)


def told(result: Calibration) -> dict[str, float]:
    """The values for the robot: all but those of parameters that are `untold`."""
    nominal = {name for group in result.unobservable if untold(result, group) for name in group}
    return {name: e.value for name, e in result.parameters.items() if name not in nominal}


def with_values(path: Path, values: Mapping[str, float]) -> str:
    """The text of a robot file with ``values`` [m, rad] in place of those that it gives the parameters. A range that a
    value leaves is widened to it."""
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
    for written, text in sorted(changes, key=lambda c: (c[0].mark.line, c[0].mark.column), reverse=True):
        line, column = written.mark.line - 1, written.mark.column - 1
        start = lines[line].index(written.text, column)
        lines[line] = f"{lines[line][:start]}{text}{lines[line][start + len(written.text) :]}"
    return "\n".join(lines)


def beyond(p: Parameter, value: float) -> int:
    """Whether a value is below (-1) or above (1) the range of its parameter."""
    return (value > float(p.high)) - (value < float(p.low))


def controllers(robot: Robot) -> tuple[str, str]:
    """The parameters of the controller of ros2_controllers that fits a calibrated ``robot``, and why there are none."""
    try:
        return ros2_control(robot)[f"{robot.name}_controllers.yaml"], ""
    except NotDerivableError as error:
        return "", error.what


def counts_per_turn(robot: Robot, values: Mapping[str, float]) -> dict[str, float]:
    """Counts per turn of each ``<wheel>.spin`` with an encoder, negative where it counts down, with which the wheel's
    nominal radius is right in place of the one that ``values`` [m] give it: drives tell radius over counts alone."""
    result = {}
    for wheel in robot.wheels:
        encoder, radius = robot.encoder_of(wheel, "spin"), expression(wheel.working.r)
        if encoder is not None and radius.free_symbols:
            calibrated = float(radius.subs({s: values[s.name] for s in radius.free_symbols}))
            result[f"{wheel.name}.spin"] = float(encoder.turn) * float(wheel.nominal.r) / calibrated
    return result


def c_values(module: Module, values: Mapping[str, float]) -> str:
    """A header for the robot's C99: a macro that initialises its struct of parameters. Empty where it has none."""
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
    """A number of nine digits, which float and double take alike."""
    digits = f"{value:.9g}"
    return digits if any(c in digits for c in ".e") else f"{digits}.0"
