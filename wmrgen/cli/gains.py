"""``wmrgen gains``: do gains of the polar feedback law stabilise it, decided exactly."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.values import from_words
from wmrgen.errors import UsageError
from wmrgen.exact.number import Exact
from wmrgen.ports import Port, Role

if TYPE_CHECKING:
    from wmrgen.layout.records import Robot

LARGEST = Exact(10**50)  # 1/s; cubes of gains are doubles up to here


def run(words: Sequence[str], *, as_json: bool) -> int:
    """Verdict on the gains of the words, else of the robot file before them, else of the text."""
    from wmrgen.functions.control.gains import TEXTBOOK, judge, linearisation, nominal_gains, polynomial

    gains = dict(TEXTBOOK)
    if words and "=" not in words[0]:
        robot = wmrgen.load(Path(words[0]))
        gains, words = nominal_gains(robot), words[1:]
    gains |= from_words(words, [Port(name, Role.COMMAND, "1/s") for name in gains])
    if any(abs(value) > LARGEST for value in gains.values()):
        raise UsageError(
            f"a gain is beyond {float(LARGEST):g} in magnitude; gains of robots are near 1 to 10"
        )
    verdict = judge(**gains)
    values: dict[str, object] = {name: float(value) for name, value in gains.items()}
    values |= {
        "stable": verdict.stable,
        "strong_3_65": verdict.strong,
        "strong_all_beta": verdict.strong_all_beta,
        "violated": list(verdict.violated),
        "linearisation": [[float(v) for v in row] for row in linearisation(**gains)],
        "polynomial": [float(v) for v in polynomial(**gains)],
        "eigenvalues": [[e.real + 0.0, e.imag + 0.0] for e in verdict.eigenvalues],
    }
    if as_json:
        console.data(values)
        return 0
    console.values({key: _text(key, value) for key, value in values.items()})
    for text in verdict.lost if verdict.stable else ():
        console.note(f"not from every pose: {text} fails")
    return 0


def warn(robot: Robot) -> None:
    """Say which gains of a robot's file do not stabilise, or not from everywhere."""
    from wmrgen.functions.control.gains import warnings

    for text in warnings(robot):
        console.note(f"{robot.name}: warning: {text}")


def _text(key: str, value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if key == "violated" and isinstance(value, list):
        return ", ".join(value) if value else "nothing"
    if key == "eigenvalues" and isinstance(value, list):
        return ", ".join(f"{re:.6g}" if not im else f"{re:.6g}{im:+.6g}i" for re, im in value)
    if key == "polynomial" and isinstance(value, list):
        return " ".join(f"{c:+.6g} {p}".rstrip() for c, p in zip(value, ("s^3", "s^2", "s", ""), strict=True))
    return repr(value)
