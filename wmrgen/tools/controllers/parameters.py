"""Parameters of controllers as files have them, and the terms of a controller's formula that they give."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest

from wmrgen.errors import Mark
from wmrgen.robotfile.numbers import MAX_DIGITS, NUMBER
from wmrgen.robotfile.text import MappingNode, Node, Scalar, SequenceNode
from wmrgen.tools.controllers.record import ControllerType, Distro

_NODE = "ros__parameters"  # the key of ROS 2 above the parameters of a node
_MANAGER = "controller_manager"  # the node of ROS 2 that has the types of all controllers
_ANY_NODE = ("**", "*", "<<", "")  # keys for any node, and YAML's merge key
_SUBSTITUTION = re.compile(r"\$\(arg ([^()\s]+)\)|\$[({][^(){}]*[)}]")

Keys = tuple[str, ...]  # from the top of a file to a value


@dataclass(frozen=True, slots=True)
class Written:
    """The texts of a parameter, one or those of a list, and their places."""

    texts: tuple[str, ...]
    marks: tuple[Mark | None, ...] = ()

    @property
    def mark(self) -> Mark | None:
        """Return the place of the first text."""
        return self.marks[0] if self.marks else None

    @property
    def number(self) -> float | None:
        """Return the number; None if the text is none, an argument without a value, or out of range."""
        text = self.texts[0] if len(self.texts) == 1 else ""
        if len(text) > MAX_DIGITS or not re.fullmatch(f"[+-]?{NUMBER}", text):
            return None
        value = float(text)
        # In m, rad or as a factor: beyond these nothing is a length or a speed of a robot.
        return value if value == 0 or 1e-9 < abs(value) < 1e9 else None


@dataclass(frozen=True, slots=True)
class ParameterSet:
    """The parameters of one controller in a file."""

    name: str
    type: str
    values: Mapping[str, Written]  # by the path of keys, with dots


@dataclass(frozen=True, slots=True)
class NamedJoint:
    """A joint that a controller commands, as the file writes it; "" if the file does not name it."""

    name: str
    mark: Mark | None = None


@dataclass(frozen=True, slots=True)
class Terms:
    """The terms of a controller's formula that a file gives."""

    numbers: Mapping[str, float]
    joints: Mapping[str, tuple[NamedJoint, ...]]
    parameters: Mapping[str, tuple[str, Mark | None]] = field(default_factory=dict)  # term -> its parameter
    unread: tuple[tuple[str, Mark | None], ...] = ()  # parameters of other releases, which this one ignores
    complete: bool = True  # every parameter of the file was read


def parameter_sets(tree: Node | None, arguments: Mapping[str, str]) -> list[ParameterSet]:
    """Return the controllers of a YAML file that have a type, in the order of the file.

    Args:
        tree: The file, as `robotfile.reader` reads it.
        arguments: Values of ``$(arg name)``.
    """
    leaves = list(_leaves(tree, ())) if tree else []
    types: dict[str, str] = {}
    groups: dict[Keys, dict[str, Written]] = {}
    for path, written in leaves:
        if path and path[-1] == "type" and written.texts:
            types.setdefault(_last_name(path[:-1]), written.texts[0])
    tops = {path[:-1] for path, _ in leaves if path and path[-1] == "type" and _MANAGER not in path}
    for path, written in leaves:
        top = _top(path, tops)
        if top is not None and _last_name(top) in types:
            texts = tuple(_substituted(text, arguments) for text in written.texts)
            key = ".".join(path[len(top) :])
            groups.setdefault(top, {}).setdefault(key, Written(texts, written.marks))
    return [ParameterSet(_last_name(top), types[_last_name(top)], each) for top, each in groups.items()]


def _top(path: Keys, tops: set[Keys]) -> Keys | None:
    """Return the path of the node that has a value; None for the controller manager and for what has no type."""
    if _NODE in path:
        top = path[: path.index(_NODE) + 1]
        return None if _last_name(top) == _MANAGER else top
    return next((path[:k] for k in range(len(path)) if path[:k] in tops), None)


def _last_name(path: Sequence[str]) -> str:
    return next((word for word in reversed(path) if word != _NODE), "")


def _substituted(text: str, arguments: Mapping[str, str]) -> str:
    """Return a text with the values of its arguments; an argument without a value is removed from a name."""
    return _SUBSTITUTION.sub(lambda match: arguments.get(match[1] or "", ""), text)


def _leaves(node: Node, path: Keys) -> Iterator[tuple[Keys, Written]]:
    """Yield the values of a file with their paths; dots and slashes in a key separate levels."""
    if isinstance(node, MappingNode):
        for key, value in sorted(node.entries, key=lambda entry: entry[0].text == "<<"):
            words = tuple(word for word in re.split("[./]", key.text) if word not in _ANY_NODE)
            yield from _leaves(value, (*path, *words))
    elif isinstance(node, SequenceNode):
        scalars = [item for item in node.items if isinstance(item, Scalar)]
        yield path, Written(tuple(s.text for s in scalars), tuple(s.mark for s in scalars))
    elif isinstance(node, Scalar):
        yield path, Written((node.text,), (node.mark,))


def terms_of(record: ControllerType, given: ParameterSet, distro: Distro | None = None) -> Terms:
    """Return the terms that a parameter set gives.

    Args:
        record: The controller.
        given: Its parameters.
        distro: The release of ROS 2 whose names are read; None: those of all releases.
    """
    texts = {name: " ".join(written.texts) for name, written in given.values.items()}
    names = record.names_of(texts, distro)
    numbers = dict(record.defaults)
    joints: dict[str, tuple[NamedJoint, ...]] = {}
    parameters: dict[str, tuple[str, Mark | None]] = {}
    for name, terms in names.items():
        written = given.values.get(name)
        for term in terms.split() if written else ():
            assert written is not None
            if term in record.places:
                named = zip_longest(written.texts, written.marks)
                joints.setdefault(term, tuple(NamedJoint(text, mark) for text, mark in named))
            elif term not in parameters and _is_given(record, term, written.number):
                numbers[term], parameters[term] = written.number or 0.0, (name, written.mark)
    of_others = record.known_names() - record.known_names(distro)
    unread = tuple((name, written.mark) for name, written in given.values.items() if name in of_others)
    return Terms(numbers, joints, parameters, unread)


def _is_given(record: ControllerType, term: str, number: float | None) -> bool:
    """Return whether a number is a value of a term: a length of 0 stands for one that the file leaves out."""
    return number is not None and (number > 0 or term not in record.lengths)
