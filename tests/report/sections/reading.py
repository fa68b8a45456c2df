"""The value of LaTeX that the report prints: sums, products, fractions, roots, powers, functions of known symbols."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from wmrgen.geometry import notation
from wmrgen.geometry.layout.records import Robot

_SKIPPED = re.compile(r"(\\[,;]|\\cdot|\\qquad|\\\\|[\s&])+")
_NUMBER = re.compile(r"\d+(\.\d+)?")
_OPENED = {r"\left(": r"\right)", r"\Bigl(": r"\Bigr)", "{": "}", r"\left|": r"\right|"}
_FUNCTIONS = {r"\cos": math.cos, r"\sin": math.sin, r"\tan": math.tan, r"\cot": lambda a: 1 / math.tan(a)}


def lengths_in_formulas(robot: Robot) -> dict[str, float]:
    """Return the values of a robot's parameters by their LaTeX."""
    own = {}
    for p in robot.parameters:
        own[notation.letter(p.symbol) if p.symbol else notation.parameter(p.name)] = float(p.nominal)
    return own


class Reading:
    """One text, read from left to right. ``values``: of symbols, by their LaTeX."""

    def __init__(self, text: str, values: Mapping[str, float]) -> None:
        self.text, self.at = text, 0
        self.values = dict(sorted(values.items(), key=lambda item: -len(item[0])))

    def taken(self, word: str) -> bool:
        while skipped := _SKIPPED.match(self.text, self.at):
            self.at = skipped.end()
        if self.text.startswith(word, self.at):
            self.at += len(word)
            return True
        return False

    def expect(self, word: str) -> None:
        assert self.taken(word), f"{word} is missing before {self.text[self.at :]!r}"

    def whole(self) -> float:
        value = self.sum()
        assert self.taken("") and self.at == len(self.text), self.text[self.at :]
        return value

    def sum(self) -> float:
        total, sign = 0.0, -1 if self.taken("-") else 1
        while True:
            total += sign * self.product()
            if self.taken("+"):
                sign = 1
            elif self.taken("-"):
                sign = -1
            else:
                return total

    def product(self) -> float:
        value, count = 1.0, 0
        while (factor := self.factor()) is not None:
            value, count = value * factor, count + 1
        assert count, f"nothing stands before {self.text[self.at :]!r}"
        return value

    def factor(self) -> float | None:
        value = self.base()
        if value is not None and self.taken("^"):
            return float(value ** self.braced())
        return value

    def braced(self) -> float:
        self.expect("{")
        value = self.sum()
        self.expect("}")
        return value

    def base(self) -> float | None:
        self.taken("")
        if number := _NUMBER.match(self.text, self.at):
            self.at = number.end()
            return float(number[0])
        if self.taken(r"\frac"):
            return self.braced() / self.braced()
        if self.taken(r"\sqrt"):
            return math.sqrt(self.braced())
        if self.taken(r"\mathrm{atan2}\left("):
            y = self.sum()
            self.expect(",")
            x = self.sum()
            self.expect(r"\right)")
            return math.atan2(y, x)
        for name, function in _FUNCTIONS.items():
            if self.taken(name):
                power = self.braced() if self.taken("^") else 1
                argument = self.base()
                assert argument is not None, name
                return float(function(argument) ** power)
        for symbol, value in self.values.items():
            if self.taken(symbol):
                return value
        for opened, closed in _OPENED.items():
            if self.taken(opened):
                inner = self.sum()
                self.expect(closed)
                return abs(inner) if "|" in opened else inner
        return None


def read(text: str, values: Mapping[str, float]) -> float:
    """What ``text`` is worth."""
    return Reading(text, values).whole()


def formulas(text: str) -> list[tuple[str, str]]:
    """Left and right sides of aligned formulas; a further line of a sum begins with & and two quads."""
    joined = text.replace("\\\\\n&\\qquad ", "")
    pairs = (
        line.removesuffix("[4pt]").removesuffix(r"\\").strip().partition(" &= ")
        for line in joined.split("\n")
    )
    return [(left, right) for left, equal, right in pairs if equal]
