"""Read files of any form as layouts: robot files, URDF, xacro and SDF, parameters of controllers, generated headers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path

import wmrgen
from wmrgen.errors import ErrorCollector, Mark, RobotFileError
from wmrgen.geometry.layout.records import Robot
from wmrgen.robotfile.numbers import NUMBER
from wmrgen.robotfile.reader import read_tree
from wmrgen.robotfile.records import JointName, RobotSpec
from wmrgen.robotfile.text import MAX_BYTES, MappingNode, Source, bytes_of, decode, printable, read_at_most
from wmrgen.robotfile.wheel_types import WHEEL_TYPES
from wmrgen.tools.comparing.record import (
    CONTROLLER,
    DESCRIPTION,
    HEADER,
    JOINTS,
    ROBOT_FILE,
    Layout,
    Side,
    Tie,
)
from wmrgen.tools.controllers import controller_type
from wmrgen.tools.controllers.parameters import (
    NamedJoint,
    ParameterSet,
    Terms,
    Written,
    parameter_sets,
    terms_of,
)
from wmrgen.tools.controllers.record import ControllerType, Distro
from wmrgen.tools.exporting.drives import limits_of
from wmrgen.tools.importing.controllers import read_controllers
from wmrgen.tools.importing.read import below, local, mark_of, parse_file
from wmrgen.tools.importing.records import Controller, Imported, Joint, Wheel
from wmrgen.tools.importing.source import description_of, pairs
from wmrgen.tools.importing.wheels import import_wheels

_HEADER = re.compile(r"^#define (\w+)_WHEELS \d+", re.MULTILINE)
# A wheel, on as many lines as it takes.
_WHEEL = re.compile(r"^ \*   (\w+): (\w+),((?:.|\n \*   (?!\w+: ))*)$", re.MULTILINE)
_VALUE = re.compile(rf" (x|y|heading|r|d|offset_y|gamma) (-?{NUMBER}) (m|deg)\b")
_TRACK = re.compile(rf"^ \*   effective track ({NUMBER}) m$", re.MULTILINE)
_MACRO = re.compile(rf"^#define (\w+)_(X|Y|RADIUS) \(?(-?{NUMBER})f?\)?(?= |$)", re.MULTILINE)
_KEYS = {"X": "x", "Y": "y", "RADIUS": "r"}
_ARGUMENT = re.compile(r"\$\(arg ([^()\s]+)\)")
_LARGEST, _MOST = 8 * 1024 * 1024, 64  # bytes; wheels


def of_robot(spec: RobotSpec, robot: Robot, source: str) -> Layout:
    """Return the layout of a robot file.

    Args:
        spec: The robot as written.
        robot: The robot.
        source: The file.
    """
    sides = []
    for written, w in zip(spec.wheels, robot.wheels, strict=True):
        g = w.nominal
        values = {
            key: float(getattr(g, name))
            for key, name in (("x", "x"), ("y", "y"), ("d", "d"), ("offset_y", "o"))
        }
        values["heading"] = math.atan2(float(g.sh), float(g.ch))
        if w.has_spin:
            values["r"] = float(g.r)
        if w.kind.rollers:
            values["gamma"] = math.atan2(float(g.sg), float(g.cg))
        marks = {"": written.mark}
        for key in ("x", "y", "r", "d", "offset_y", "heading", "gamma", "l", "alpha", "beta"):
            quantity = getattr(written, key)
            marks |= {key: quantity.mark} if quantity else {}
        joints = {joint: w.joint_name(joint) for joint in w.kind.joints}
        sides.append(Side((w.name,), w.type, values, marks, w.actuated, joints))
    track, said = robot.effective_track, spec.effective_track
    effective = (float(track.nominal), said.mark) if track and said else None
    return Layout(
        source,
        ROBOT_FILE,
        tuple(sides),
        True,
        effective_track=effective,
        ties=_ties(spec, robot),
        limits=_twist_limits(robot),
    )


def _twist_limits(robot: Robot) -> dict[str, float]:
    """Return the limits of the twist, its rates and the steering by the terms of controllers, such as "vx.high"."""
    result = {name: value for name, value in limits_of(robot).items() if isinstance(value, float)}
    steering = [limit for w in robot.wheels if w.kind.steers and (limit := robot.limit(w, "steer"))]
    if steering:
        result["steer.low"] = max(float(limit.low) for limit in steering)
        result["steer.high"] = min(float(limit.high) for limit in steering)
    return result


def _ties(spec: RobotSpec, robot: Robot) -> tuple[Tie, ...]:
    ties = []
    for joint in JOINTS:
        for members in robot.together(joint, robot.wheels):
            each = [float(robot.turn_ratio(joint, w)) for w in members]
            turns = {w.name: own / each[0] for w, own in zip(members, each, strict=True)}
            marks = (c.mark for c in spec.couplings if c.joint == joint and c.wheels[0] in turns)
            ties.append(Tie(joint, turns, tuple(marks)))
    return tuple(tie for tie in ties if len(tie.turns) > 1)


def of_import(robot: Imported, joints: Sequence[Joint], source: str) -> Layout:
    """Return the layout of a URDF or SDF, as far as the file has it.

    It has no couplings if one is in doubt. Its wheels are where their joints are.

    Args:
        robot: What was imported.
        joints: All joints of the file.
        source: The file.
    """
    places = {joint.name: joint.mark for joint in joints}
    turns: dict[tuple[str, str], dict[str, float]] = {}
    for each in robot.couplings:
        (first, _, joint), (second, _, _) = each.first.rpartition("."), each.second.rpartition(".")
        turns.setdefault((first, joint), {first: 1.0})[second] = float(each.ratio)
    doubted = any(q.key == "equal" for q in robot.questions)
    ties = None if doubted else tuple(Tie(joint, shaft) for (_, joint), shaft in turns.items())
    sides = tuple(_imported(w, places) for w in robot.wheels)
    return Layout(source, DESCRIPTION, sides, joints=frozenset(places), ties=ties)


def _imported(wheel: Wheel, places: Mapping[str, Mark | None]) -> Side:
    keys = ("x", "y", "heading", "r", "d", "offset_y", "gamma")
    values = {key: float(value) for key in keys if (value := getattr(wheel, key)) is not None}
    names = (wheel.name, *filter(None, (wheel.joint, wheel.steer_joint)))
    mark = next(filter(None, map(places.get, names[1:])), None)
    marks = {"": mark} if mark else {}
    joints = {"spin": JointName(wheel.joint)} if wheel.joint else {}
    if wheel.steer_joint:
        joints["steer"] = JointName(wheel.steer_joint, wheel.steers_down)
    return Side(names, wheel.type, values, marks, wheel.actuated, joints)


def of_header(text: str, source: str) -> Layout:
    """Return the layout of a header that `derive` wrote, from its macros and its first comment."""
    prefix = _HEADER.search(text)
    lines = Source.of(text, source)
    macros = {m[1] + m[2]: m for m in _MACRO.finditer(text)}
    sides = []
    for match in islice(_WHEEL.finditer(text[: prefix.start() if prefix else 0]), _MOST + 1):
        name, kind, rest = match[1], match[2], match[3].replace("\n *  ", "")
        mark = lines.mark_at(text, match.start(1))
        written = {
            k: math.radians(float(v)) if unit == "deg" else float(v) for k, v, unit in _VALUE.findall(rest)
        }
        values = {"d": 0.0, "offset_y": 0.0, **written}
        marks = {"": mark}
        for word, key in _KEYS.items():
            macro = macros.get(f"{prefix[1] if prefix else ''}_{name.upper()}{word}")
            if macro:
                values[key], marks[key] = float(macro[3]), lines.mark_at(text, macro.start(3))
        if kind in WHEEL_TYPES and {"x", "y"} <= values.keys():
            _refuse_what_nothing_has(values, marks)
            joints = {part: JointName(f"{name}_{part}") for part in WHEEL_TYPES[kind].joints}
            sides.append(Side((name,), kind, values, marks, joints=joints))
    if not sides:
        raise RobotFileError(
            f"{source}: no header of wmrgen", None, "", "Give the .h that `wmrgen derive` wrote."
        )
    track = _TRACK.search(text[: prefix.start() if prefix else 0])
    effective = (float(track[1]), lines.mark_at(text, track.start(1))) if track else None
    return Layout(source, HEADER, tuple(sides), True, effective_track=effective)


def _refuse_what_nothing_has(values: Mapping[str, float], marks: Mapping[str, Mark]) -> None:
    """Raise RobotFileError for numbers that `derive` cannot have written."""
    for key, value in values.items():
        if not abs(value) < 1e9 or (key == "r" and value < 1e-9):
            mark = marks.get(key, marks[""])
            raise RobotFileError(
                f"{key} is {value:g}, which no wheel has", mark, "", "Derive the header again."
            )


def of_controller(
    controller: Controller,
    source: str,
    given: ParameterSet | None = None,
    distro: Distro | None = None,
    limits: Mapping[str, Written] | None = None,
) -> Layout:
    """Return the layout of a controller, which has lengths and no wheels.

    Args:
        controller: Its lengths and joints.
        source: The file.
        given: All its parameters; None: only what ``controller`` has, as of a plugin.
        distro: The release of ROS 2 whose names it has; None: those of all releases.
        limits: The elements of a plugin, from which its limits are read.
    """
    title = " ".join(filter(None, (controller.name, f"({controller.type})" if controller.type else "")))
    record = controller_type(given.type if given else controller.type)
    evaluable = None
    if record and (given or record.tag):
        terms = (
            terms_of(record, given, distro) if given else terms_of_plugin(record, controller, limits or {})
        )
        evaluable = record, terms
    return Layout(source, CONTROLLER, controller=controller, title=title, evaluable=evaluable, distro=distro)


def terms_of_plugin(record: ControllerType, controller: Controller, elements: Mapping[str, Written]) -> Terms:
    """Return the terms that a drive plugin gives: its lengths, its joints by their positions, its limits.

    Args:
        record: The record of the plugin.
        controller: What was read of it.
        elements: Its elements by their names.
    """
    terms = {key: term for term, key in record.lengths.items()}
    terms |= {"front_track": "steering_track"} if "steering_track" in record.lengths else {}
    numbers = dict(record.defaults)
    parameters = {}
    for key, setting in controller.lengths.items():
        if key in terms:
            numbers[terms[key]] = float(setting.value)
            parameters[terms[key]] = (setting.key, setting.mark)
    for name, term in record.names.items():
        number = elements[name].number if name in elements and "." in term else None
        if number is not None:
            numbers[term], parameters[term] = number, (name, elements[name].mark)
    joints: dict[str, tuple[NamedJoint, ...]] = {}
    for named in controller.joints:
        for term, (place, *_) in record.places.items():
            words = named.role.split()
            same_kind = named.steers == (term in record.steering)
            if same_kind and words and set(place.split()) - {"rigid", "steering"} <= set(words):
                joints[term] = (*joints.get(term, ()), NamedJoint(named.joint, named.mark))
    return Terms(numbers, joints, parameters, complete=False)


def layouts(
    path: Path,
    arguments: Sequence[str] = (),
    packages: Sequence[str] = (),
    base: str | None = None,
    distro: Distro | None = None,
) -> list[Layout]:
    """Return what a file describes.

    Args:
        path: A robot file, header, description, or parameters of controllers.
        arguments: ``NAME:=VALUE`` of xacro and of ``$(arg NAME)``.
        packages: ``NAME=DIR`` of packages that a description names.
        base: The link that is the robot's frame.
        distro: The release of ROS 2 of the controllers; None: names of all releases are read.

    Returns:
        One layout of a robot file or header; that of a description and, after it, those of its drive plugins; those of
        a parameter file.

    Raises:
        RobotFileError: The file is none of these.
    """
    result = list(_layouts(path, arguments, packages, base, distro))
    if any(len(layout.wheels) > _MOST for layout in result):
        raise RobotFileError(f"{printable(str(path))}: more than {_MOST} wheels")
    return result


def _plugin_elements(path: Path) -> dict[str, dict[str, Written]]:
    """Return the elements of each plugin that a URDF or SDF has itself, by the plugin's name; none of its macros."""
    result: dict[str, dict[str, Written]] = {}
    for plugin in below(parse_file(path), "plugin"):
        elements = {local(e): Written(tuple((e.text or "").split()), (mark_of(e),)) for e in plugin}
        result.setdefault(plugin.get("name") or "", elements)
    return result


def _refuse_without_values(text: str, values: Mapping[str, str], name: str, has_values: bool) -> None:
    """Raise RobotFileError for parameters without values, if the file has ``$(arg …)`` that were not given."""
    open_ = [word for word in dict.fromkeys(_ARGUMENT.findall(text)) if word not in values]
    if open_ and not has_values:
        raise RobotFileError(
            f"{name}: no length of a wheel controller has a value",
            None,
            "A launch file gives the values of $(arg …).",
            f"Write them after the files: {printable(' '.join(f'{word}:=VALUE' for word in open_))[:300]}.",
        )


def _parameters(
    path: Path, text: str, name: str, values: Mapping[str, str]
) -> tuple[Sequence[Controller], dict[tuple[str, str], ParameterSet]]:
    """Return the controllers of a parameter file, and their parameters by name and type.

    A file with the key ``wheels`` is a robot file without its first line, ``wmrgen: 1``: it has no controllers, though
    types of its wheels are words that types of controllers have too.

    Args:
        path: The file.
        text: Its text, as far as it was read.
        name: The file, for messages.
        values: Values of ``$(arg NAME)``.

    Raises:
        RobotFileError: The file is neither a robot file nor parameters of a controller.
    """
    tree = read_tree(decode(bytes_of(path, MAX_BYTES + 1), name), name, ErrorCollector(), aliases=True)
    if isinstance(tree, MappingNode) and any(key.text == "wheels" for key, _ in tree.entries):
        return (), {}
    controllers = read_controllers(path, values)
    _refuse_without_values(text, values, name, bool(controllers))
    if not controllers and ":" in text:
        raise RobotFileError(
            f"{name}: neither a robot file nor parameters of a wheel controller",
            None,
            "It has no wheels:, as robot files have, and no length or type of a controller, as wheel_separation.",
            "Give the file that has them.",
        )
    return controllers, {(each.name, each.type): each for each in parameter_sets(tree, values)}


def _layouts(
    path: Path,
    arguments: Sequence[str],
    packages: Sequence[str],
    base: str | None,
    distro: Distro | None,
) -> Iterator[Layout]:
    name = printable(str(path))
    given: dict[tuple[str, str], ParameterSet] = {}
    elements: dict[str, dict[str, Written]] = {}
    try:
        start = read_at_most(path, _LARGEST)
    except (OSError, ValueError):
        start = b""  # `read` reports the reason
    whole = start.decode("utf-8", "replace")
    text = whole.lstrip("\ufeff \t\r\n")
    controllers: Sequence[Controller] = ()
    if text.startswith("<"):
        description = description_of(path, arguments, packages)
        yield of_import(import_wheels(description, base), description.joints, name)
        controllers = description.controllers
        elements = _plugin_elements(path) if controllers else {}
    elif _HEADER.search(text):
        yield of_header(text, name)
    else:
        if text and not re.search(r"^\s*['\"]?wmrgen['\"]?\s*:", text, re.MULTILINE):
            controllers, given = _parameters(path, text, name, pairs(arguments))
        if not controllers:
            yield of_robot(*wmrgen.read(path), name)
    for c in controllers:
        yield of_controller(c, name, given.get((c.name, c.type)), distro, elements.get(c.name))
