"""The figures of merit of one design: mobility, drives, reachable speeds, isotropy, accuracy, stability and cost."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Hashable, Mapping
from dataclasses import replace
from fractions import Fraction
from math import inf, sqrt
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import wmrgen
from wmrgen.analysis.mobility.basis import NEGLIGIBLE
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import Mark, NotDerivableError, RobotFileError, UsageError
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.geometry.symbolic import expression
from wmrgen.ir.calls import inlined_calls
from wmrgen.ir.nodes import count
from wmrgen.report.figures.reach import largest_factor
from wmrgen.robotfile.records import Num, Quantity, RobotSpec
from wmrgen.robotfile.text import MAX_BYTES, bytes_of, suggestion

GRAVITY = Exact(Fraction("9.80665"))  # standard gravity [m/s^2]
_FIRMWARE = ("inverse", "forward", "odometry")
Reals = NDArray[np.float64]
Facts = dict[str, float | str | None]  # by name; None: the robot file does not determine it


class Quality(NamedTuple):
    """A figure of merit."""

    name: str  # in JSON
    title: str  # in tables and pictures
    unit: str


QUALITIES = (
    Quality("delta_m", "mobility δm", ""),
    Quality("delta_s", "steerability δs", ""),
    Quality("delta_M", "maneuverability δM", ""),
    Quality("drives", "drives", ""),
    Quality("drives_per_freedom", "drives per freedom (δM)", ""),
    Quality("vx_max", "fastest ahead", "m/s"),
    Quality("vy_max", "fastest sideways", "m/s"),
    Quality("omega_max", "fastest turn on P", "rad/s"),
    Quality("isotropy", "isotropy of H", ""),
    Quality("characteristic_length", "characteristic length", "m"),
    Quality("sigma_x", "σ along, after 1 m", "m"),
    Quality("sigma_y", "σ across, after 1 m", "m"),
    Quality("sigma_theta", "σ heading, after 1 m", "rad"),
    Quality("tip_over", "margin to tip over", "rad"),
    Quality("operations", "operations of a cycle", ""),
    Quality("flash", "flash", "bytes"),
)  # fmt: skip


class Design(NamedTuple):
    """A robot file with values of parameters that replace those of the file."""

    spec: RobotSpec
    values: tuple[tuple[str, Fraction], ...] = ()
    flash: int | None = None  # bytes, if the C of exactly this file was measured


def varied(spec: RobotSpec, values: Mapping[str, Fraction]) -> RobotSpec:
    """Return the content of a robot file with other values of its parameters.

    Args:
        spec: The content.
        values: New values in SI units, by name.

    Raises:
        UsageError: If the file has no parameter of this name.
    """
    names = [p.name for p in spec.parameters]
    for name in values:
        if name not in names:
            hint = suggestion(name, names) if names else "It has no parameters."
            raise UsageError(f"{spec.name} has no parameter {name[:60]!r}. {hint}")
    parameters = []
    for p in spec.parameters:
        if p.name in values:
            value = values[p.name]
            mark = Mark(p.value.mark.file, p.value.mark.line, p.value.mark.column, "")
            p = p._replace(value=Quantity(Num(value), f"{float(value):.12g}", mark), range=None)
        parameters.append(p)
    return replace(spec, parameters=tuple(parameters))


def qualities(design: Design) -> Facts:
    """Return the name of a design, its varied parameters and its `QUALITIES`.

    A design that is impossible, such as one with a wheel of radius 0, has an ``error`` instead. That ends no sweep.
    """
    facts: Facts = {"name": design.spec.name}
    facts |= {name: float(value) for name, value in design.values}
    try:
        robot = wmrgen.robot_of(varied(design.spec, dict(design.values)))
        facts |= _measured(wmrgen.derive(robot, _FIRMWARE), design.spec)
    except (RobotFileError, NotDerivableError) as error:
        if not design.values:
            raise
        return facts | {"error": str(error).partition("\n")[0]}
    facts["flash"] = design.flash
    return facts


def _measured(derivation: Derivation, spec: RobotSpec) -> Facts:
    """Return the figures of merit of a robot, which is a variant of ``spec``."""
    m, robot = derivation.mobility, derivation.robot
    drives = _drives(robot)
    freedoms = m.degree_of_maneuverability
    length = characteristic_length(robot)
    facts: Facts = {
        "delta_m": m.degree_of_mobility,
        "delta_s": m.degree_of_steerability,
        "delta_M": freedoms,
        "drives": drives,
        "drives_per_freedom": drives / freedoms if freedoms else None,
        **_fastest(derivation),
        "isotropy": isotropy(measurement_matrix(derivation), length),
        "characteristic_length": length,
        **_deviations(derivation),
        "tip_over": _or_none(lambda: _tip_over(derivation)),
        "operations": _or_none(lambda: _operations(derivation, spec)),
    }
    return facts


def _or_none(compute: Callable[[], float]) -> float | None:
    """Return the result, None if the robot does not have the function that it needs."""
    try:
        return compute()
    except NotDerivableError:
        return None


def _drives(robot: Robot) -> int:
    """Return the number of motors: joints that turn together have one."""
    motors = 0
    for joint in ("spin", "steer"):
        for group in robot.together(joint, robot.wheels):
            motors += any(joint in w.actuated for w in group)
    return motors


def _fastest(derivation: Derivation) -> Facts:
    """Return the largest vx, vy and omega about P that the limits allow; 0 if the wheels forbid the motion.

    It is None if no limit is reached.
    """
    facts: Facts = {}
    for k, name in enumerate(TWIST_NAMES):
        slip = derivation.evaluate("inverse", {name: ONE})["slip"]
        twist = (float(k == 0), float(k == 1), float(k == 2))
        factor = largest_factor(derivation.driven.robot, twist) if abs(float(slip)) < NEGLIGIBLE else 0.0
        facts[f"{name}_max"] = factor if factor < inf else None
    return facts


def characteristic_length(robot: Robot) -> float:
    """Return the root mean square of the distances from P to the pivots of the wheels [m].

    It makes yaw rates comparable with velocities: omega L is a speed.
    """
    squares = [abs(w.pivot) ** 2 for w in robot.wheels]
    return sqrt(sum(squares) / len(squares)) if squares else 0.0


def measurement_matrix(derivation: Derivation) -> Reals:
    """Return H (rows x 3) of z = H xi, where z are the measurements of sensed joints in m/s, at steering angles 0."""
    rows = []
    for row, _, weight in derivation.measured_at_nominal:
        scale = sqrt(float(weight))
        rows.append([scale * _at_zero(p) for p in row])
    return np.array(rows, float).reshape(len(rows), 3)


def _at_zero(p: Poly) -> float:
    """Return the value of a polynomial at steering angles 0."""
    if p.constant is not None:
        return float(p.constant)
    value = expression(p)
    return float(value.subs(dict.fromkeys(value.free_symbols, 0)))


def isotropy(h: Reals, length: float) -> float | None:
    """Return the smallest singular value of H by the largest one: 1 measures all motions alike, 0 misses one.

    Args:
        h: rows over (vx, vy, omega), (rows, 3).
        length: the characteristic length [m]; the last column is divided by it.

    Returns:
        The ratio; None without rows or without a length.
    """
    if not len(h) or not length:
        return None
    singular = np.linalg.svd(h / np.array([1.0, 1.0, length]), compute_uv=False)
    smallest = float(singular[2]) if len(singular) == 3 else 0.0
    largest = float(singular[0])
    return (smallest / largest if smallest > NEGLIGIBLE * largest else 0.0) if largest else None


def _deviations(derivation: Derivation) -> Facts:
    """Return the standard deviations of odometry after 1 m straight ahead, driven in one step at 1 m/s.

    The robot file gives the noise of the joints; without it they are None.
    """
    names = ("sigma_x", "sigma_y", "sigma_theta")
    nothing: Facts = dict.fromkeys(names)
    try:
        joints = derivation.evaluate("inverse", {"vx": ONE})
        ports = [port.name for port in derivation.formula("forward_covariance").inputs]
        known = {name: value for name, value in joints.items() if name in ports}
        twist = derivation.evaluate("forward_covariance", known)
        pose = derivation.evaluate("odometry_covariance", {**twist, "vx": ONE, "dt": ONE})
    except NotDerivableError:
        return nothing
    variances = (pose["xx"], pose["yy"], pose["thetatheta"])
    return dict(zip(names, [sqrt(max(float(v), 0.0)) for v in variances], strict=True))


def _tip_over(derivation: Derivation) -> float:
    """Return the angle [rad] by which the force at the centre of gravity may tilt before a robot at rest tips over."""
    values = {port.name: ZERO for port in derivation.formula("stability").inputs if port.default is None}
    return float(derivation.evaluate("stability", values | {"fz": GRAVITY})["margin"])


# Operations of the last robot in this process. A sweep over tunable parameters has the same formulas at every point.
_COUNTED: dict[Hashable, float] = {}


def _operations(derivation: Derivation, spec: RobotSpec) -> float:
    """Return the number of operations of inverse, forward and odometry together, as the C computes them.

    They depend on the formulas. Values of tunable parameters are inputs of the formulas, so they change nothing.

    Args:
        derivation: the robot, which is a variant of ``spec``.
        spec: the content of the robot file.
    """
    formulas = []
    for f in derivation.program.formulas:
        outputs = tuple((port.name, expression) for port, expression in f.outputs)
        formulas.append((f.name, tuple(port.name for port in f.inputs), f.locals, outputs, f.calls))
    key = (replace(spec, parameters=()), tuple(formulas))
    if key not in _COUNTED:
        _COUNTED.clear()
        module = inlined_calls(derivation.c_module)
        counts = [sum(count(function)) for function in module.functions if function.name in _FIRMWARE]
        _COUNTED[key] = float(sum(counts))
    return _COUNTED[key]


def flash_of(name: str, path: Path, folder: Path) -> int | None:
    """Return the bytes of the C of a robot file, if its folder of generated files has a budget for just this file.

    Args:
        name: the name of the robot.
        path: the robot file.
        folder: the folder that contains the folders of the robots.
    """
    try:
        made = json.loads(bytes_of(folder / name / "manifest.json", MAX_BYTES))["made_from"]
        if made["robot_file"] != hashlib.sha256(bytes_of(path, MAX_BYTES)).hexdigest():
            return None
        return int(json.loads(bytes_of(folder / name / "budget.json", MAX_BYTES))["text"])
    except (RobotFileError, ValueError, KeyError, TypeError):
        return None
