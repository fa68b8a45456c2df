"""What parameters of wheel controllers say: YAML of ROS 1 and 2, of drivers, and elements of Gazebo's drive plugins.

Parameters are told by their words under whatever node they stand, so that the driver that calls its track
``wheels.separation`` is read as a diff_drive_controller is. What a file does not say is not in the record.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from xml.etree.ElementTree import Element

from wmrgen.errors import Code, ErrorCollector, Mark, RobotFileError
from wmrgen.robotfile.names import role
from wmrgen.robotfile.numbers import NUMBER
from wmrgen.robotfile.reader import read_tree
from wmrgen.robotfile.text import (
    MAX_BYTES,
    MappingNode,
    Node,
    Scalar,
    SequenceNode,
    bytes_of,
    decode,
    printable,
    quoted,
)
from wmrgen.tools.importing.read import local, mark_of
from wmrgen.tools.importing.records import Controller, Named, Setting

LENGTHS = {  # what a parameter gives: the words by which it is known
    "track": "wheel_separation wheel_separation_y wheel_separation_w wheels_separation wheels.separation"
    " wheel_seperation track wheel_track wheels_track track_width axle_track axle_width base_width wheel_distance"
    " chassis_width",
    "front_track": "front_wheel_track steering_track_width kingpin_width",
    "rear_track": "rear_wheel_track traction_track_width",
    "wheelbase": "wheelbase wheel_base axis_separation wheel_separation_x wheel_separation_h chassis_length",
    "sum": "sum_of_robot_center_projection_on_x_y_axis",
    "ring": "robot_radius base_radius",
    "radius": "wheel_radius wheels_radius wheels.radius",
    "left_radius": "left_wheel_radius left_wheels_radius",
    "right_radius": "right_wheel_radius right_wheels_radius",
    "front_radius": "front_wheel_radius front_wheels_radius steering_wheel_radius steering_wheels_radius",
    "rear_radius": "rear_wheel_radius rear_wheels_radius traction_wheel_radius traction_wheels_radius",
    "offset": "wheel_lever_arm wheel_steering_y_offset",
}
_UNITS = {"_mm": Fraction(1, 1000), "_cm": Fraction(1, 100), "_m": Fraction(1), "": Fraction(1)}
_WORDS = {word: key for key, words in LENGTHS.items() for word in words.split()}
_KINDS = (  # the first whose pattern occurs in a type
    ("mecanum", "mecanum"),
    ("four_?wheel_?steer|swerve|omni_?drive_?controller/wheel|omnidrive(?!controller)", "swerve"),
    ("ackermann?", "ackermann"),
    ("bicycle", "bicycle"),
    ("tricycle", "tricycle"),
    ("omni", "omni"),
    ("diff|skid", "differential"),
)
_NAMES = re.compile(r"(names?|joints?|wheels?|steer|drive|steering|axle)$")
_NO_NAMES = re.compile(r"topic|frame|interface|sensor|broadcaster|states?_|plugin")
_ROLLS, _STEERS = re.compile("traction|drive|command"), re.compile("steer|axle_joint|pivot")
_PLACE = re.compile(r"(?:center_pos_|pos_|position_)?([xy])$")
_SUBSTITUTION = re.compile(r"\$\(arg ([^()\s]+)\)|\$[({][^(){}]*[)}]")
_JOINT = re.compile(r"(?=[^A-Za-z]*[A-Za-z])[\w./ -]{1,200}")
_NOTHING = ("", "~", "null", "Null", "NULL")
_NODE, _PASSED, _MOST = "ros__parameters", ("**", "*", "<<", ""), 64  # controllers of a file
_ROVER = [  # role, x and y of the wheels of JPL's rover
    (f"{end} {side}", along, ahead, across, sign)
    for end, along, ahead, across in (
        ("front", "d3", 1, "d1"),
        ("rear", "d2", -1, "d1"),
        ("middle", "0", 1, "d4"),
    )
    for side, sign in (("left", 1), ("right", -1))
]


@dataclass(frozen=True, slots=True)
class _Leaf:
    """A text, or those of a list, under the words of its keys; ``xml``: where others read the same otherwise."""

    path: tuple[str, ...]
    texts: tuple[str, ...]
    marks: tuple[Mark | None, ...]
    xml: bool = False

    @property
    def word(self) -> str:
        return self.path[-1] if self.path else ""


def read_controllers(path: Path, arguments: Mapping[str, str] | None = None) -> tuple[Controller, ...]:
    """The controllers of a YAML file; ``arguments`` stand for ``$(arg name)``. RobotFileError where it cannot be read,
    or a length is no number. Of keys that stand twice the last holds, as in ROS, which the first controller notes."""
    name, told, wrong = printable(str(path)), ErrorCollector(), ErrorCollector()
    tree = read_tree(decode(bytes_of(path, MAX_BYTES + 1), name), name, told, aliases=True)
    twice = [error for error in told.errors if error.code is Code.TWICE]
    wrong.add(*(error for error in told.errors if error not in twice))
    wrong.end()
    controllers = controllers_of(tree, arguments or {})
    lines = [f"{e.mark.line}: {e.what}: the last one holds, as in ROS" for e in twice if e.mark]
    notes = tuple(f"{printable(path.name)}:{line}" for line in lines)
    return (*(replace(c, notes=notes) for c in controllers[:1]), *controllers[1:])


def controllers_of(tree: Node | None, arguments: Mapping[str, str]) -> tuple[Controller, ...]:
    """The controllers of the raw tree of a YAML file, in its order."""
    leaves = list(_leaves(tree, (), arguments)) if tree else []
    types = {_last(leaf.path[:-1]): leaf.texts[0] for leaf in leaves if leaf.word == "type" and leaf.texts}
    tops = {_top(leaf): None for leaf in leaves if _length(leaf) or _placed(leaf) or _typed(leaf)}
    for leaf in leaves:
        if _NODE in leaf.path and _kind(types.get(_last(_top(leaf)), "")):
            tops[_top(leaf)] = None
    if len(tops) > _MOST:
        what, why = f"{len(tops)} nodes with lengths of wheels", f"At most {_MOST} are read."
        raise RobotFileError(what, next(iter(leaves[0].marks), None), why)
    result = []
    for top in tops:
        if not any(top[: len(other)] == other for other in tops if other != top):
            n, called = len(top), _last(top)
            own = [replace(l, path=tuple(map(snake, l.path[n:]))) for l in leaves if l.path[:n] == top]
            result.append(_controller(called, types.get(called, ""), own))
    return tuple(c for c in result if c.lengths or c.places or c.kind)


def plugin_controllers(root: Element) -> tuple[Controller, ...]:
    """The controllers that drive plugins and hardware of ros2_control in a URDF or SDF are, and <mobile> of rby1."""
    result = []
    for element in root.iter():
        if local(element) in ("plugin", "hardware"):
            leaves = [_leaf(snake(e.get("name") or local(e)), e.text or "", e) for e in element]
            kind = " ".join(filter(None, (element.get("filename"), element.get("name"))))
            result.append(_controller(element.get("name") or "", kind, leaves))
        elif local(element) == "mobile" and element.get("type") == "differential":
            track, radius, *_ = [*(element.get("params") or "").split(), "", ""]
            joints = element.get("joints") or ""
            told = {"wheel_names": joints, "wheel_separation": track, "wheel_radius": radius}
            leaves = [_leaf(word, text, element) for word, text in told.items()]
            result.append(_controller("mobile", "differential", leaves))
    return tuple(c for c in result if c.lengths)


def _leaf(word: str, text: str, element: Element) -> _Leaf:
    """What an element says under a word."""
    texts = tuple(text.split())
    return _Leaf((word,), texts, (mark_of(element),) * len(texts), xml=True)


def snake(word: str) -> str:
    return re.sub("(?<=[a-z0-9])(?=[A-Z])", "_", word).lower()


def _leaves(node: Node, path: tuple[str, ...], arguments: Mapping[str, str]) -> Iterator[_Leaf]:
    """All values; dots and slashes in a key part levels, those for any node are passed over, merged ones come last."""
    if isinstance(node, MappingNode):
        for key, value in sorted(node.entries, key=lambda entry: entry[0].text == "<<"):
            words = (word for word in re.split("[./]", key.text) if word not in _PASSED)
            yield from _leaves(value, (*path, *words), arguments)
    elif isinstance(node, SequenceNode) and not all(isinstance(item, Scalar) for item in node.items):
        for index, item in enumerate(node.items):
            yield from _leaves(item, (*path, str(index)), arguments)
    else:
        items = node.items if isinstance(node, SequenceNode) else (node,)
        scalars = [item for item in items if isinstance(item, Scalar)]
        texts = tuple(_substituted(s.text, arguments) for s in scalars)
        yield _Leaf(path, texts, tuple(s.mark for s in scalars))


def _substituted(text: str, arguments: Mapping[str, str]) -> str:
    return _SUBSTITUTION.sub(lambda match: arguments.get(match[1] or "", "$"), text)


def _last(top: Sequence[str]) -> str:
    return next((word for word in reversed(top) if word != _NODE), "")


def _top(leaf: _Leaf) -> tuple[str, ...]:
    """The node to which a value belongs: what stands above ros__parameters, else above the value."""
    if _NODE in leaf.path:
        return leaf.path[: leaf.path.index(_NODE) + 1]
    words = _length(leaf)
    return leaf.path[: -len(words[0].split("."))] if words else leaf.path[:-1]


def _kind(type_: str) -> str:
    return next((kind for pattern, kind in _KINDS if re.search(pattern, type_, re.IGNORECASE)), "")


def _typed(leaf: _Leaf) -> bool:
    """It is the type of a controller of wheels, in its own node."""
    own = leaf.word == "type" and "controller_manager" not in leaf.path
    return own and bool(leaf.texts) and bool(_kind(leaf.texts[0]))


def _placed(leaf: _Leaf) -> bool:
    return leaf.path[-2:-1] == ("rover_dimensions",)


def _length(leaf: _Leaf) -> tuple[str, str, Fraction, bool] | None:
    """Words, key of `LENGTHS`, factor and whether it is a multiplier; None of what is no length."""
    for count in (2, 1):
        words = ".".join(leaf.path[-count:])
        plain = snake(words).removesuffix("_multiplier")
        unit = next((u for u in _UNITS if plain.endswith(u)), "")
        key = _WORDS.get(plain.removesuffix(unit).replace("diameter", "radius"))
        if key and len(leaf.texts) == 1:
            return words, key, _UNITS[unit] / (2 if "diameter" in plain else 1), plain != snake(words)
    return None


def _number(leaf: _Leaf, factor: Fraction = Fraction(1)) -> Setting | None:
    """A value; None of what is not there or null, of an argument that nobody gave, and of 0, which stands for what is
    read elsewhere; in XML, where others read it otherwise, of what is no number."""
    text = leaf.texts[0] if leaf.texts else "$"
    if "$" in text or text in _NOTHING:
        return None
    size = abs(float(text)) if len(text) <= 40 and re.fullmatch(f"[+-]?{NUMBER}", text) else -1.0
    key, mark = ".".join(leaf.path), leaf.marks[0]
    if size != 0 and not 1e-9 < size < 1e9:
        if leaf.xml:
            return None
        raise RobotFileError(f"{quoted(key)} is {quoted(text)}, which is no number", mark)
    return Setting(Fraction(text) * factor, key, mark) if size else None


def _controller(name: str, type_: str, leaves: Sequence[_Leaf]) -> Controller:
    lengths: dict[str, Setting] = {}
    multipliers: dict[str, Setting] = {}
    for leaf in leaves:
        told = _length(leaf)
        setting = _number(leaf, told[2]) if told else None
        if told and setting:
            (multipliers if told[3] else lengths).setdefault(told[1], setting)
    joints: dict[str, Named] = {}
    for joint in (j for leaf in leaves for j in _joints(leaf)):
        joints.setdefault(joint.joint, joint)
    kind = _kind(type_) or _kind(name) or _kind_of(lengths, joints.values())
    if kind != "omni" and "radius" not in lengths:
        lengths.pop("ring", None)  # of a footprint
    return Controller(name, kind, type_, lengths, multipliers, tuple(joints.values()), dict(_places(leaves)))


def _kind_of(lengths: Mapping[str, Setting], joints: Iterable[Named]) -> str:
    """The kind, as far as lengths and joints say it."""
    roles = {joint.role for joint in joints if not joint.steers}
    if "sum" in lengths:
        return "mecanum"
    return "differential" if roles == {"left", "right"} and not any(j.steers for j in joints) else ""


def _joints(leaf: _Leaf) -> Iterator[Named]:
    words = ".".join(leaf.path)
    named = _NAMES.search(leaf.word) and re.search("wheel|joint|steer|axle|drive", words)
    for index, text in enumerate(leaf.texts if named and not _NO_NAMES.search(words) else ()):
        joint = text.replace("$", "")
        if _JOINT.fullmatch(joint) and joint.lower() not in ("true", "false"):
            told = words if _ROLLS.search(words) or _STEERS.search(words) else joint
            yield Named(joint, role(words, joint), bool(_STEERS.search(told)), leaf.marks[index])


def _joints_of(leaf: _Leaf, leaves: Sequence[_Leaf]) -> list[Named]:
    """The joints named beside a value, or one for each value of a list."""
    near = (list(_joints(other)) for other in leaves if other.path[:-1] == leaf.path[:-1])
    return next((joints for joints in near if joints and len(joints) == len(leaf.texts)), [])


def _places(leaves: Sequence[_Leaf]) -> Iterator[tuple[str, tuple[Setting, Setting]]]:
    """Pivots given beside the name of a joint, and those of JPL's rover, which gives four distances."""
    at: dict[str, dict[str, Setting]] = {}
    for leaf in leaves:
        match = _PLACE.match(leaf.word)
        for named in _joints_of(leaf, leaves) if match else ():
            zero = Setting(Fraction(0), leaf.word, leaf.marks[0])
            at.setdefault(named.joint, {})[leaf.word[-1]] = _number(leaf) or zero
    yield from ((joint, (place["x"], place["y"])) for joint, place in at.items() if len(place) == 2)
    rover = {leaf.word: setting for leaf in leaves if _placed(leaf) and (setting := _number(leaf))}
    rover["0"] = Setting(Fraction(0), "")
    for role_, along, ahead, across, sign in _ROVER:
        if along in rover and across in rover:
            x, y = rover[along], rover[across]
            yield role_, (replace(x, value=ahead * x.value), replace(y, value=sign * y.value))
