"""All generated files of one robot, in memory: model.json, and the files of every back end with their banners."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from math import degrees
from typing import TYPE_CHECKING, SupportsFloat

from wmrgen.codegen.registry import BACKENDS, Entry, Facts, unasked
from wmrgen.derivation.version import __version__
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import GYRO, JOINTS, TWIST, TWIST_NAMES, Site
from wmrgen.ir.bounds.robot import header_lines, reach
from wmrgen.ir.kernels.choice import DEFAULT, Choice

if TYPE_CHECKING:
    from wmrgen.codegen.packages import Package
    from wmrgen.derivation.facade import Derivation

MODEL = "model.json"


def artifacts(
    derivation: Derivation, choice: Choice = DEFAULT, switches: Collection[str] = ()
) -> dict[str, bytes]:
    """Return all files of the folder ``DIR/<name>/``, except the manifest.

    Args:
        derivation: The robot's derivation.
        choice: Scalar type, sines and processor of the generated C.
        switches: fuzz adds a fuzzing harness to the C, batch adds functions over arrays.

    Returns:
        File name -> content.
    """
    model = (json.dumps(derivation.model(), indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()
    common = facts(derivation, choice, model)
    files = {MODEL: model}
    # Back ends that describe the robot come last, because they refer to lines of the code.
    for entry in sorted(unasked(), key=lambda entry: entry.source == "itself"):
        written = _written(entry, derivation, common, choice, switches)
        clash = files.keys() & written.keys()
        if clash:
            raise ValueError(f"backend {entry.name} writes {sorted(clash)} again")
        files.update(written)
        places = entry.offers("places")
        if places:
            common = replace(common, places=(*common.places, *places(written)))
    return files


def _written(
    entry: Entry, derivation: Derivation, common: Facts, choice: Choice, switches: Collection[str] = ()
) -> dict[str, bytes]:
    """Return the files of one back end."""
    chosen = choice._asdict()
    options = {
        **{name: chosen[name] for name in entry.options},
        **{name: name in switches for name in entry.switches},
    }
    lines = _bound_lines(derivation, choice) if entry.proved else ()
    own = replace(common, options=options, bound_lines=lines)
    return entry.load().emit(getattr(derivation, entry.source), own)


def package(
    kind: Package, derivation: Derivation, choice: Choice, files: Mapping[str, bytes]
) -> dict[str, bytes]:
    """Return the files of a package of the robot.

    Args:
        kind: The kind of package.
        derivation: The robot's derivation.
        choice: Scalar type, sines and processor of the C.
        files: The `artifacts` of the robot.

    Returns:
        File name -> content.
    """
    from wmrgen.codegen.packages import packaged

    common = facts(derivation, choice, files[MODEL])
    if kind.backend:
        return _written(BACKENDS[kind.backend], derivation, common, choice)
    return packaged(kind, derivation.c_module, replace(common, options=choice._asdict()), files)


def facts(derivation: Derivation, choice: Choice, model: bytes) -> Facts:
    """Return what the banners of generated files say.

    Args:
        derivation: The robot's derivation.
        choice: Scalar type, sines and processor of the C.
        model: The content of model.json.

    Returns:
        The facts. Their hash covers ``model``, ``choice`` and the version of wmrgen.
    """
    digest = hashlib.sha256(model)
    digest.update(f"{' '.join(choice.words().values())} {__version__}".encode())
    where = site(derivation)
    return Facts(
        description=derivation.robot.description,
        wheel_lines=wheel_lines(derivation.robot),
        model_hash=digest.hexdigest()[:32],
        wmrgen_version=__version__,
        joint_names=joint_names(derivation.robot),
        motors=motors(derivation.robot),
        frame=derivation.robot.frame,
        robot_type=derivation.mobility.robot_type,
        site=where,
        constants=constants(derivation.robot, where),
        vectors=derivation.vector_forms,
        written=derivation.raw_module,
    )


def joint_names(robot: Robot) -> dict[str, tuple[str, int]]:
    """Return joint of the functions (left.spin) -> its name in other tools, and the sign of its rotation there."""
    found = {}
    for wheel in robot.wheels:
        for joint in ("spin", "steer", "steer_rate"):
            name = wheel.joint_name(joint.removesuffix("_rate"))
            found[f"{wheel.name}.{joint}"] = (name.name, name.sign)
    return found


def motors(robot: Robot) -> frozenset[str]:
    """Return the joints of the functions (left.spin) that have a motor."""
    found = set()
    for wheel in robot.wheels:
        for joint in ("spin", "steer", "steer_rate"):
            if wheel.commands(joint.removesuffix("_rate")):
                found.add(f"{wheel.name}.{joint}")
    return frozenset(found)


def _bound_lines(derivation: Derivation, choice: Choice) -> tuple[str, ...]:
    """Return the lines of the banner about proved bounds; none for double, for which nothing is proved."""
    if choice.scalar != DEFAULT.scalar:
        return ()
    return header_lines(derivation.bounds if choice == DEFAULT else derivation.bounds_of(choice))


def site(derivation: Derivation) -> Site:
    """Return limits, pivots and reach of a robot as numbers.

    The limit of a wheel takes precedence over that of the robot. The steering range of a virtual wheel is from the
    least to the largest angle of the wheels that it replaces.
    """
    robot = derivation.robot
    names = [*(name for name in robot.limits if name in TWIST_NAMES), GYRO.name]
    for w in robot.wheels:
        joints = ("spin",) * w.has_spin + ("steer", "steer_rate") * w.turns
        names += [f"{w.name}.{joint}" for joint in joints]
    pivots = tuple((w.name, w.pivot.real, w.pivot.imag) for w in robot.wheels)
    numbers = {n: (float(limit.low), float(limit.high)) for n in names if (limit := robot.limit_of(n))}
    for v in robot.virtual:
        angles = [f"{name}.steer" for name in v.wheels]
        if v.role == "steers" and all(name in numbers for name in angles):
            numbers[f"{v.name}.steer"] = (
                min(numbers[name][0] for name in angles),
                max(numbers[name][1] for name in angles),
            )
    unmotored = any(balance.lacking for balance in derivation.mobility.actuation)
    return Site(numbers, pivots, reach(robot, derivation.c_in_operations, numbers), unmotored)


_LIMITED = {port.name: port for port in (*TWIST, GYRO)} | JOINTS


def constants(robot: Robot, where: Site) -> tuple[tuple[str, float, str], ...]:
    """Return the numbers of a robot file that generated code offers as constants.

    Args:
        robot: The robot.
        where: Its limits as numbers.

    Returns:
        Name, nominal value in SI units, and a text with the unit and the meaning, for each number.
    """
    numbers: list[tuple[str, float, str]] = [("wheels", len(robot.bodies), "number of wheels")]
    for w in robot.wheels:
        g = w.nominal
        lengths = (
            (g.x, "x", "pivot, forward of P"),
            (g.y, "y", "pivot, to the left of P"),
            (g.r, "radius", "radius"),
        )
        numbers += [
            (f"{w.name}.{name}", float(v), f"[m] {text}")
            for v, name, text in lengths
            if name != "radius" or v
        ]
    for name, ends in where.limits.items():
        unit = _LIMITED[name.rpartition(".")[2]].unit
        for value, end, text in zip(ends, ("min", "max"), ("least", "most"), strict=True):
            numbers.append((f"{name}.{end}", value, f"[{unit}] {text} that the robot file allows"))
    return tuple(numbers)


_LEGEND: tuple[tuple[Callable[[Wheel], bool], str], ...] = (
    (lambda w: True,
     "x, y: wheel pivot seen from P. For a wheel beside P, |y| is the half-track, not the track."),
    (lambda w: w.kind.directed,
     "heading: rolling direction at spin > 0, from the x axis (steered: at steer 0)."),
    (lambda w: bool(w.ball) and w.ball != w.name,
     "name_1, name_2: the two directions in which the ball called name is driven."),
    (lambda w: w.kind.swivels,
     "d: contact point minus pivot, along the rolling direction."),
    (lambda w: w.kind.rollers,
     "gamma: from the wheel plane to the axis of the roller at the ground."),
    (lambda w: w.kind.rollers and bool(w.gamma),
     "The rollers seen on top lean the other way than those at the ground."),
)  # fmt: skip


def wheel_lines(robot: Robot) -> tuple[str, ...]:
    """Return the wheel table of a banner: one line per wheel in file order, then the legend for these wheels."""
    track = robot.effective_track
    turning = (f"effective track {_number(track.nominal)} m",) if track else ()
    legend = []
    for concerns, text in _LEGEND:
        if any(concerns(w) for w in robot.wheels):
            legend.append(text)
    return (*map(wheel_line, robot.wheels), *turning, *legend)


def wheel_line(wheel: Wheel) -> str:
    """Return ``left: fixed, x 0 m, y 0.1655 m, heading 0 deg, r 0.0975 m`` and other lengths that the type has."""
    g, kind = wheel.nominal, wheel.kind
    quantities: tuple[tuple[bool, str, SupportsFloat, str], ...] = (
        (True, "x", g.x, "m"),
        (True, "y", g.y, "m"),
        (kind.directed, "heading", degrees(wheel.heading), "deg"),
        (bool(g.r), "r", g.r, "m"),
        (bool(g.d), "d", g.d, "m"),
        (bool(g.o), "offset_y", g.o, "m"),
        (bool(g.per_steer), "per_steer", g.per_steer, ""),
        (kind.rollers, "gamma", degrees(wheel.gamma), "deg"),
    )
    parts = [f"{name} {_number(value)} {unit}".rstrip() for occurs, name, value, unit in quantities if occurs]
    return ", ".join([f"{wheel.name}: {wheel.type}", *parts])


def _number(value: SupportsFloat) -> str:
    """Return a number with six significant digits and without negative zero."""
    return f"{round(float(value), 12) + 0.0:.6g}"
