"""Names that may become identifiers of C, C++, Python and files: what is allowed and what is taken."""

from __future__ import annotations

import re

from wmrgen.backends.registry import BACKENDS
from wmrgen.spec.nodes import Scalar
from wmrgen.spec.text import quoted

_FORM = re.compile(r"[a-z][a-z0-9_]{0,30}")
NAME_PATTERN = "^[a-z][a-z0-9_]{0,30}$"

_WINDOWS = " ".join(["con prn aux nul clock", *(f"com{i} lpt{i}" for i in range(10))])
_FILES = """
math stdio stdint stdlib stdbool string stddef stdarg float limits tgmath fenv inttypes numpy sympy casadi
wmrgen
"""

_DEVICES = frozenset(_WINDOWS.split())
_FILE_NAMES = frozenset(_FILES.split())
_EXPRESSION_WORDS = frozenset(
    ["pi", "sqrt", "sin", "cos", "tan", "atan2", "vx", "vy", "omega", "slip", "x", "y", "theta", "dt"]
)


def _reserved(name: str) -> str:
    """Why no name may be this word; nothing where it may."""
    for entry in BACKENDS.values():
        for kept in entry.reserved:
            if name in kept.words:
                return kept.why
    return "Windows keeps that name for a device." if name in _DEVICES else ""


def _check(node: Scalar, what: str) -> str:
    """The name, when it is one; ``what`` says whose: robot, wheel, parameter."""
    name = node.text
    if not name:
        raise node.error(f"the {what} name is empty", "", "Write a name such as front_left.")
    if not _FORM.fullmatch(name):
        raise node.error(
            f"{quoted(name)} is not a valid {what} name",
            "Names become identifiers of generated C: [a-z][a-z0-9_]*, at most 31 characters.",
            f"Write {quoted(_repaired(name))}." if _repaired(name) else "Write a name such as front_left.",
        )
    reason = _reserved(name)
    if "__" in name:
        reason = "C++ keeps names with a double underscore for the implementation."
    if name.endswith("_t"):
        reason = "POSIX keeps names that end in _t for types."
    if reason:
        raise node.error(
            f"the {what} name {quoted(name)} is reserved", reason, f"Write {quoted(_free(name))}."
        )
    return name


def _free(name: str) -> str:
    """A name near a reserved one that is not reserved."""
    return re.sub(r"__+", "_", name.removesuffix("_t"))[:28].rstrip("_") + "_1"


def _repaired(name: str) -> str:
    """A valid name near ``name``, or nothing."""
    near = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:31].rstrip("_")
    return near if _FORM.fullmatch(near) and not _reserved(near) and not near.endswith("_t") else ""


def robot_name(node: Scalar) -> str:
    """A robot's name, which also names its files and folder."""
    if node.text == "textbook":
        raise node.error(
            "the robot name 'textbook' is reserved",
            "Beside the robots' folders, `wmrgen textbook` writes a folder of that name: one would replace the other.",
            "Write textbook_robot.",
        )
    if node.text in _FILE_NAMES:
        raise node.error(
            f"the robot name {quoted(node.text)} is reserved",
            "The generated files would be taken for a standard header or module.",
            f"Write {node.text}_robot.",
        )
    return _check(node, "robot")


def wheel_name(node: Scalar) -> str:
    return _check(node, "wheel")


def parameter_name(node: Scalar) -> str:
    """A parameter's name, which must not be a word of expressions or of the contract either."""
    if node.text in _EXPRESSION_WORDS or re.fullmatch(r"eta[0-9]+", node.text):
        raise node.error(
            f"the parameter name {quoted(node.text)} is reserved",
            "Expressions or the inputs and outputs of the model use that word already.",
            f"Write {node.text}_0 or a longer name." if node.text != "pi" else "Use pi as it is.",
        )
    return _check(node, "parameter")
