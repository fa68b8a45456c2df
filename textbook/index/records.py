"""A row of the table: a place in a text, the command that reproduces it, and the numbers that the command prints.

A row has its numbers itself, or names the case of ``cases.json`` that has them. Tests run every command and compare
its numbers; the page and ``wmrgen textbook --find`` print the same rows.

Inputs and outputs are written as ``port=word`` pairs. A word is a key of the case (``state.x1`` lies deeper,
``alpha_deg°`` is an angle in degrees), or a number. Several ports with commas take a list.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

_HERE = Path(__file__).resolve().parents[1]
_LITERAL = re.compile(r"-?[\d.]|-?pi\b|\[")  # how a number, or a list of numbers, begins
_AXES = "xyz"
LIBRARY = "textbook"  # the word that `wmrgen eval` takes instead of a robot
DIGITS = 6  # significant digits of the numbers that are shown


@dataclass(frozen=True, slots=True)
class Row:
    """A command that reproduces a place in a text.

    ``places``: numbers in the text, as in ``(3.9)-(3.11), Figure 3.20``. ``robot``: a robot file under ``robots/``
    without its suffix, `LIBRARY`, or empty. ``command``: the verb and its words without the robot. ``case``: the case
    that has the numbers.
    """

    text: str
    places: str
    says: str
    robot: str
    command: str
    inputs: str
    outputs: str
    case: str = ""

    @property
    def robot_file(self) -> str:
        """The path of the robot file in a checkout; empty if the command needs none."""
        return f"robots/{self.robot}.yaml" if self.robot and self.robot != LIBRARY else ""

    @property
    def words(self) -> list[str]:
        """The words of the command line after ``wmrgen``."""
        verb, *rest = self.command.split()
        robot = [self.robot_file or self.robot] if self.robot else []
        # A formula takes inputs that are not given as 0.
        given = {name: value for name, value in self.given.items() if value != 0 or self.robot != LIBRARY}
        return [verb, *robot, *rest, *(f"{name}={_typed(value)}" for name, value in given.items())]

    @property
    def given(self) -> dict[str, Any]:
        """Input -> number, or a literal such as pi/2 as text."""
        return spread(dict(_pairs(self.inputs, facts(self.case))))

    @property
    def expected(self) -> dict[str, Any]:
        """Name in the JSON output of the command -> number, or list of numbers."""
        pairs = dict(_pairs(self.outputs, facts(self.case)))
        return spread(pairs) if self.command.startswith("eval ") else pairs

    @property
    def tolerance(self) -> float:
        """The relative and absolute tolerance of the numbers."""
        # 1e-9: numbers in a row are written with all digits.
        return float(_cases()[self.case].get("tol", 1e-9)) if self.case else 1e-9


def facts(case: str) -> dict[str, Any]:
    """Return what a case gives and expects, by name. Empty for no case."""
    if not case:
        return {}
    found = _cases()[case]
    wheels = (found.get("layout") or {}).get("wheels", [{}])
    return {**found, **found.get("given", {}), **found.get("expect", {}), "wheel": wheels[0]}


def spread(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return scalars by port: a list of three is a vector ``v.x v.y v.z``, rows are a matrix ``m11 m12 ...``."""
    case: dict[str, Any] = {}
    for name, value in values.items():
        if not isinstance(value, list):
            case[name] = value
        elif isinstance(value[0], list):
            for i, row in enumerate(value, 1):
                case |= {f"{name}{i}{j}": entry for j, entry in enumerate(row, 1)}
        else:
            case |= {f"{name}.{axis}": v for axis, v in zip(_AXES, value, strict=True)}
    return case


def shown(value: Any) -> str:
    """Return a number, or nested lists of numbers, to six significant digits."""
    if isinstance(value, list):
        return f"[{', '.join(shown(v) for v in value)}]"
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.{DIGITS}g}".replace("-0", "0") if value == 0 else f"{value:.{DIGITS}g}"


@cache
def _cases() -> dict[str, dict[str, Any]]:
    """Return the cases and the layouts of tables, by identifier."""
    cases = json.loads((_HERE / "cases.json").read_text(encoding="utf-8"))["cases"]
    layouts = json.loads((_HERE / "layouts.json").read_text(encoding="utf-8"))
    found = {case["id"]: case for case in cases}
    for layout in layouts:
        found[layout["id"]] = found.get(layout["id"], {}) | layout
    return found


def _pairs(text: str, known: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield port and value of each pair; a literal input that is no decimal number remains text."""
    for pair in text.split():
        ports, _, word = pair.partition("=")
        value = _value(word, known)
        if "," in ports:
            yield from zip(ports.split(","), value, strict=True)
        else:
            yield ports, value


def _value(word: str, known: Any) -> Any:
    """Return what a word stands for."""
    if _LITERAL.match(word):
        return word if "pi" in word or "/" in word else json.loads(word)
    if word.endswith("°"):
        return math.radians(known[word[:-1]])
    for key in word.split("."):
        known = known[int(key)] if isinstance(known, list) else known[key]
    return known


def _typed(value: float | str) -> str:
    """Return an input as a user types it."""
    if isinstance(value, str):
        return value
    return str(int(value)) if value == int(value) else repr(value)
