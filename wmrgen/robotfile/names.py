"""Check that names of a robot file are valid and distinct; read the position of a wheel off its name."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import replace

from wmrgen.errors import Code, RobotFileError
from wmrgen.robotfile.reserved_words import (
    AVR_MACROS,
    DEVICES,
    EXPRESSION_WORDS,
    FILE_NAMES,
    MODEL_WORDS,
    NAMES_OF_LIBRARIES,
    why_reserved,
)
from wmrgen.robotfile.text import Node, Scalar, latin, lookalike, quoted

MAX_NAME = 31  # characters; see _WHY_SO_LONG
NAME_PATTERN = f"^[A-Za-z][A-Za-z0-9_]{{0,{MAX_NAME - 1}}}$"
# Names in public descriptions have prefixes (front_left/wheel), models (robot::wheel), hyphens and version numbers.
OUTER_NAME_PATTERN = "^[A-Za-z0-9_/](?:[A-Za-z0-9_./: -]{0,198}[A-Za-z0-9_./-])?$"
# Letters that reports do not use for anything else in the formulas of a robot: not v, x, y, theta, omega, psi, phi, …
SYMBOL_LETTERS = (*"abdfghjlrsDEFGKLQSUWXYZ", *"alpha beta gamma epsilon zeta kappa lambda mu tau".split())
SYMBOL_PATTERN = f"^({'|'.join(SYMBOL_LETTERS)})(_[A-Za-z0-9]{{1,8}})?$"  # an index of a word at most
_WHY_SO_LONG = (
    "C compilers need to compare only 63 characters of a macro (C99, 5.2.4.1): the robot's name, _ and a wheel's name, "
    f"with at most {MAX_NAME} characters each."
)


def _reserved(name: str) -> str:
    """Return why no name may be this word, in upper or lower case; "" if it may."""
    if name.endswith("_t"):
        return "POSIX reserves names that end in _t for types."
    if "__" in name:
        return "C++ reserves names with a double underscore."
    if name.lower() in DEVICES:
        return why_reserved(name) or "Windows reserves this name for a device."
    return why_reserved(name)


def _refusal(name: str, what: str) -> tuple[str, str] | None:
    """Return why a robot, wheel or parameter (``what``) may not have this name, and a similar name; None if it may."""
    word = name.lower()
    if what == "robot":
        if word == "textbook":
            return "`wmrgen textbook` writes a folder of this name.", "textbook_robot"
        if word in FILE_NAMES:
            return "The generated files would hide a standard header or module.", f"{name}_robot"
        if AVR_MACROS.keeps(name):
            return AVR_MACROS.why, _free(name)
        if word in NAMES_OF_LIBRARIES:
            why = "Packages name a C++ namespace, a library or a crate after the robot, and one of this name exists."
            return why, f"{name}_robot"
    words = word in EXPRESSION_WORDS or name in MODEL_WORDS or re.fullmatch(r"eta[0-9]+", name)
    if what == "parameter" and words:
        why = "Expressions, inputs or outputs use this word."
        return why, "pi as it is" if word == "pi" else f"{name}_0 or a longer name"
    why = _reserved(name)
    return (why, _free(name)) if why else None


def _check(node: Scalar, what: str) -> str:
    """Return the name at a node; raise RobotFileError if a robot, wheel or parameter (``what``) may not have it."""
    name = node.text
    if not name:
        raise _no_name(node, f"the {what} name is empty", "", "front_left")
    if not re.fullmatch(NAME_PATTERN, name):
        why = f"A name has letters a-z and A-Z, digits and _, a letter first, and at most {MAX_NAME} characters."
        if len(name) > MAX_NAME:
            why = f"It has {len(name)} characters. {_WHY_SO_LONG}"
        elif latin(name) != name:
            why = lookalike(name)
        raise _no_name(node, f"{quoted(name)} is not a valid {what} name", why, _repaired(name, what))
    refusal = _refusal(name, what)
    if refusal:
        raise _no_name(node, f"the {what} name {quoted(name)} is reserved", *refusal)
    return name


def _no_name(node: Scalar, what: str, why: str, instead: str) -> RobotFileError:
    """Return the error for an invalid name; ``instead`` is a valid one, or ""."""
    return node.error(what, why, f"Write {instead or 'a name such as front_left'}.", code=Code.NAME)


def _free(name: str) -> str:
    """Return a similar name that is not reserved: the name in lower case, or with _1."""
    if not _reserved(name.lower()):
        return name.lower()
    return re.sub(r"__+", "_", name.removesuffix("_t"))[:28].rstrip("_") + "_1"


def _repaired(name: str, what: str) -> str:
    """Return a valid name that is similar to an invalid one, or ""."""
    near = re.sub(r"[^A-Za-z0-9]+", "_", latin(in_latin_letters(name))).strip("_")[:MAX_NAME].rstrip("_")
    return near if re.fullmatch(NAME_PATTERN, near) and not _refusal(near, what) else ""


def robot_name(node: Scalar) -> str:
    """Return the name of a robot, which its files and folder also have; raise RobotFileError if it is invalid."""
    return _check(node, "robot")


def wheel_name(node: Scalar) -> str:
    """Return the name of a wheel, trailer or virtual wheel; raise RobotFileError if it is invalid."""
    return _check(node, "wheel")


def numbered_names(node: Scalar, count: int) -> tuple[str, ...]:
    """Return the names of the ``count`` drives of a ball: its own name, or ``name_1`` and ``name_2``."""
    if count == 1:
        return (wheel_name(node),)
    return tuple(_check(replace(node, text=f"{node.text}_{k + 1}"), "wheel") for k in range(count))


def parameter_name(node: Scalar) -> str:
    """Return the name of a parameter; raise RobotFileError if it is invalid, or a word of expressions or the model."""
    return _check(node, "parameter")


def symbol_name(node: Scalar, what: str) -> str:
    """Return the letter, with or without an index, that stands for a parameter in formulas: ``h``, ``l_x``, ``lambda``.

    A Greek letter may be written as its name or as itself. RobotFileError is raised if reports use the letter for
    something else, or if the text is no letter.
    """
    text = in_latin_letters(node.text)
    if not re.fullmatch(SYMBOL_PATTERN, text):
        raise node.error(
            f"{quoted(node.text)} cannot be the symbol of {what}",
            "A symbol is one letter, Latin or Greek, that reports do not use for anything else. It may have an index "
            "of letters and digits, as l_x has.",
            f"Write one of {' '.join(SYMBOL_LETTERS)}, with an index if you need more.",
            code=Code.NAME,
        )
    return text


def in_latin_letters(text: str) -> str:
    """Return the text with each Greek letter replaced by its name: ``α_1`` becomes ``alpha_1``."""

    def name(letter: re.Match[str]) -> str:
        word = unicodedata.name(letter[0]).split()[3].lower()
        return "lambda" if word == "lamda" else word  # Unicode's spelling

    return re.sub("[Α-Ωα-ω]", name, text)


def outer_name(node: Scalar, what: str) -> str:
    """Return the name of a joint or frame (``what``) in other tools; raise RobotFileError if it is invalid."""
    if not is_outer_name(node.text):
        raise node.error(
            f"{quoted(node.text)} is not the name of a {what}",
            "It has letters a-z and A-Z, digits, spaces and _ - . / :, and at most 200 characters.",
            f"Write the name that the robot description has for the {what}.",
            code=Code.NAME,
        )
    return node.text


def is_outer_name(text: str) -> bool:
    """Return whether a robot file may have this name for a joint or frame of other tools."""
    return bool(re.fullmatch(OUTER_NAME_PATTERN, text))


class Names:
    """The names of a file. No two may be equal or differ only in upper and lower case."""

    def __init__(self) -> None:
        self._named: dict[str, tuple[str, str, int]] = {}  # in lower case: the name, what has it, its line

    def add(self, name: str, what: str, node: Node) -> None:
        """Add a name.

        Args:
            name: The name.
            what: What has the name, such as "a wheel".
            node: The place of the name.

        Raises:
            RobotFileError: The name is taken.
        """
        if name.lower() not in self._named:
            self._named[name.lower()] = name, what, node.mark.line
            return
        other, whose, line = self._named[name.lower()]
        if other != name:
            problem = f"{quoted(name)} and {quoted(other)} ({whose} on line {line}) differ only in case"
            why = "Macros are in upper case, and many file systems ignore case."
        else:
            problem, why = f"{quoted(name)} is already the name of {whose}", f"It is on line {line}."
        raise node.error(problem, why, "Write another name.", code=Code.TWICE)


# ---- where a wheel is, by its name

_ENDS = {"front": "front", "fore": "front", "fwd": "front", "middle": "middle", "center": "middle"}
_ENDS |= dict.fromkeys(("rear", "back", "hind", "aft"), "rear")
_SIDES = {"left": "left", "right": "right"}
_WHOLE = _ENDS | _SIDES
_END_LETTERS = {"f": "front", "m": "middle", "r": "rear", "b": "rear"}
_SIDE_LETTERS = {"l": "left", "r": "right"}


def _joined_words() -> dict[str, list[str]]:
    """Return the words that join an end and a side, in both orders, such as frontleft, lfront and fl."""
    found = {}
    for ends, sides in ((_ENDS, _SIDES | _SIDE_LETTERS), (_END_LETTERS, _SIDE_LETTERS)):
        for end, end_meant in ends.items():
            for side, side_meant in sides.items():
                found[end + side] = found[side + end] = [end_meant, side_meant]
    return found


_JOINED = _joined_words()
# The words of a name: two capitals before a word (FLwheel), a run of capitals, or a word with or without a capital.
_WORDS = re.compile(r"(?<![A-Z])(?:[FMRB][LR]|[LR][FMB])(?=[a-z]{2})|[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
_UNDERSCORE_BETWEEN_LETTERS = re.compile(  # as in f_l or R_F
    r"(?i)(?<=(?<![a-z])[fmrb])_(?=[lr](?![a-z]))|(?<=(?<![a-z])[lr])_(?=[fmrb](?![a-z]))"
)


def role(*texts: str) -> str:
    """Return the position of a wheel that its names say, such as "front left".

    The first text that says it counts; in a text, whole words count before letters: in "fr left", fr is front.
    """
    found: dict[str, str] = {}  # by axis: x for front, middle and rear, y for left and right
    for text in texts:
        joined = _UNDERSCORE_BETWEEN_LETTERS.sub("", text)
        words = [word.lower() for word in _WORDS.findall(joined)]
        words.sort(key=lambda word: word not in _WHOLE)
        for word in words:
            for side in _sides(word):
                found.setdefault("y" if side in _SIDES else "x", side)
        if "r" in words and "x" in found:  # next to front or rear, r is right
            found.setdefault("y", "right")
    return " ".join(found[axis] for axis in "xy" if axis in found)


def _sides(word: str) -> list[str]:
    """Return the ends and sides that a word in lower case names, such as rear, lf, frontleft, lfront, flwheel or l."""
    word = word.removeprefix("wheel").removesuffix("wheel")
    if word in _WHOLE:
        return [_WHOLE[word]]
    return _JOINED.get(word, ["left"] if word == "l" else [])
