"""Files of any form to layouts: robot files, URDF, xacro and SDF, parameters of controllers, generated headers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path

import wmrgen
from wmrgen.errors import Mark, RobotFileError
from wmrgen.geometry.layout.records import Robot
from wmrgen.robotfile.numbers import NUMBER
from wmrgen.robotfile.records import RobotSpec
from wmrgen.robotfile.text import Source, printable, read_at_most
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
from wmrgen.tools.importing.controllers import read_controllers
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
_WHEELS = re.compile(r"^['\"]?wheels['\"]?\s*:", re.MULTILINE)
_LARGEST, _MOST = 8 * 1024 * 1024, 64  # bytes; wheels


def of_robot(spec: RobotSpec, robot: Robot, source: str) -> Layout:
    """The layout of a robot file."""
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
        sides.append(Side((w.name,), w.type, values, marks, w.actuated))
    track, said = robot.effective_track, spec.effective_track
    effective = (float(track.nominal), said.mark) if track and said else None
    return Layout(source, ROBOT_FILE, tuple(sides), True, effective_track=effective, ties=_ties(spec, robot))


def _ties(spec: RobotSpec, robot: Robot) -> tuple[Tie, ...]:
    ties = []
    for joint in JOINTS:
        for members in robot.together(joint, robot.wheels):
            each = [float(robot.turn_ratio(joint, w)) for w in members]
            turns = {w.name: own / each[0] for w, own in zip(members, each, strict=True)}
            marks = (c.mark for c in spec.couplings if c.joint == joint and c.wheels[0] in turns)
            ties.append(Tie(joint, turns, tuple(marks)))
    return tuple(tie for tie in ties if len(tie.turns) > 1)


def of_import(robot: Imported, joints: Iterable[Joint], source: str) -> Layout:
    """The layout of a URDF or SDF, as far as it says: of couplings nothing where one is in doubt. Its wheels stand
    where their joints do."""
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
    return Side(names, wheel.type, values, marks, wheel.actuated)


def of_header(text: str, source: str) -> Layout:
    """The layout of a header that `derive` wrote: lengths are its macros', the rest is said in its first comment."""
    prefix = _HEADER.search(text)
    lines = Source.of(text, source)
    macros = {m[1] + m[2]: m for m in _MACRO.finditer(text)}
    sides = []
    for match in islice(_WHEEL.finditer(text[: prefix.start() if prefix else 0]), _MOST + 1):
        name, kind, rest = match[1], match[2], match[3].replace("\n *  ", "")
        mark = lines.mark_at(text, match.start(1))
        told = {
            k: math.radians(float(v)) if unit == "deg" else float(v) for k, v, unit in _VALUE.findall(rest)
        }
        values = {"d": 0.0, "offset_y": 0.0, **told}
        marks = {"": mark}
        for word, key in _KEYS.items():
            macro = macros.get(f"{prefix[1] if prefix else ''}_{name.upper()}{word}")
            if macro:
                values[key], marks[key] = float(macro[3]), lines.mark_at(text, macro.start(3))
        if kind in WHEEL_TYPES and {"x", "y"} <= values.keys():
            _refuse_what_nothing_has(values, marks)
            sides.append(Side((name,), kind, values, marks))
    if not sides:
        raise RobotFileError(
            f"{source}: no header of wmrgen", None, "", "Give the .h that `wmrgen derive` wrote."
        )
    track = _TRACK.search(text[: prefix.start() if prefix else 0])
    effective = (float(track[1]), lines.mark_at(text, track.start(1))) if track else None
    return Layout(source, HEADER, tuple(sides), True, effective_track=effective)


def _refuse_what_nothing_has(values: Mapping[str, float], marks: Mapping[str, Mark]) -> None:
    """RobotFileError for numbers that `derive` cannot have written."""
    for key, value in values.items():
        if not abs(value) < 1e9 or (key == "r" and value < 1e-9):
            mark = marks.get(key, marks[""])
            raise RobotFileError(
                f"{key} is {value:g}, which no wheel has", mark, "", "Derive the header again."
            )


def of_controller(controller: Controller, source: str) -> Layout:
    """The lengths that a controller has, without wheels yet."""
    title = " ".join(filter(None, (controller.name, f"({controller.type})" if controller.type else "")))
    return Layout(source, CONTROLLER, controller=controller, title=title)


def layouts(
    path: Path, arguments: Sequence[str] = (), packages: Sequence[str] = (), base: str | None = None
) -> list[Layout]:
    """What a file describes: one layout of a robot file or header; that of a description and, after it, those of its
    drive plugins; those of a parameter file. RobotFileError as `wmrgen.load` for a file that is none of these."""
    result = list(_layouts(path, arguments, packages, base))
    if any(len(layout.wheels) > _MOST for layout in result):
        raise RobotFileError(f"{printable(str(path))}: more than {_MOST} wheels")
    return result


def _refuse_without_values(text: str, values: Mapping[str, str], name: str, told: bool) -> None:
    """RobotFileError for parameters of which nothing is ``told`` but ``$(arg …)`` that nobody gave."""
    open_ = [word for word in dict.fromkeys(_ARGUMENT.findall(text)) if word not in values]
    if open_ and not told:
        raise RobotFileError(
            f"{name}: no length of a wheel controller has a value",
            None,
            "$(arg …) stands for what a launch file gives.",
            f"Give them behind the files: {printable(' '.join(f'{word}:=VALUE' for word in open_))[:300]}.",
        )


def _layouts(
    path: Path, arguments: Sequence[str], packages: Sequence[str], base: str | None
) -> Iterator[Layout]:
    name = printable(str(path))
    try:
        start = read_at_most(path, _LARGEST)
    except (OSError, ValueError):
        start = b""  # of which `read` says why
    whole = start.decode("utf-8", "replace")
    text = whole.lstrip("\ufeff \t\r\n")
    controllers: Sequence[Controller] = ()
    if text.startswith("<"):
        description = description_of(path, arguments, packages)
        yield of_import(import_wheels(description, base), description.joints, name)
        controllers = description.controllers
    elif _HEADER.search(text):
        yield of_header(text, name)
    else:
        if text and not re.search(r"^\s*['\"]?wmrgen['\"]?\s*:", text, re.MULTILINE):
            values = pairs(arguments)
            controllers = read_controllers(path, values)
            _refuse_without_values(text, values, name, bool(controllers))
            if not controllers and ":" in text and not _WHEELS.search(text):
                raise RobotFileError(
                    f"{name}: neither a robot file nor parameters of a wheel controller",
                    None,
                    "It has no wheels:, as robot files have, and no length or type of a controller, as"
                    " wheel_separation.",
                    "Give the file that says them.",
                )
        if not controllers:
            yield of_robot(*wmrgen.read(path), name)
    yield from (of_controller(c, name) for c in controllers)
