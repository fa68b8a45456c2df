"""The two ways to mount four mecanum wheels, as one choice."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence

from wmrgen.geometry.layout.skid import parallel
from wmrgen.tools.importing.records import Wheel
from wmrgen.tools.importing.view import EVEN

ROLLERS = "rollers"  # the name of the answer
MECANUM_TEXT = (
    "seen from above, do the rollers on top of the four wheels form an X or an O? Those below cross them"
)
# gamma of the rollers at the ground, front left first: tangential for X, as the ones on top point to the middle.
_GAMMAS = {"X": ("-pi/4", "pi/4", "pi/4", "-pi/4"), "O": ("pi/4", "-pi/4", "-pi/4", "pi/4")}


def mecanum_choices(
    wheels: Sequence[Wheel], more: Mapping[str, str] | None = None
) -> dict[str, dict[str, str]]:
    """Return X and O with the values of each wheel; empty if the wheels are not four in a rectangle along x.

    Args:
        wheels: The wheels.
        more: Key -> value of what each wheel has in addition, such as its type.

    Returns:
        Word -> WHEEL.KEY -> value.
    """
    if len(wheels) != 4 or not in_rectangle(wheels) or abs(math.sin(wheels[0].heading or 0.0)) > 1e-3:
        return {}
    middle = sum(float(w.x) for w in wheels) / 4, sum(float(w.y) for w in wheels) / 4
    ordered = sorted(wheels, key=lambda w: (float(w.x) < middle[0], float(w.y) < middle[1]))
    choices = {}
    for word, gammas in _GAMMAS.items():
        values = {}
        for wheel, gamma in zip(ordered, gammas, strict=True):
            values.update({f"{wheel.name}.{key}": value for key, value in (more or {}).items()})
            values[f"{wheel.name}.gamma"] = gamma
        choices[word] = values
    return choices


def in_rectangle(wheels: Sequence[Wheel]) -> bool:
    """Return whether wheels roll in parallel on two axles, with a wheel on each side of each axle."""
    first = wheels[0].heading or 0.0
    if not parallel([cmath.rect(1, w.heading or 0.0) for w in wheels]):
        return False
    ahead = [math.cos(first) * float(w.x) + math.sin(first) * float(w.y) for w in wheels]
    aside = [math.cos(first) * float(w.y) - math.sin(first) * float(w.x) for w in wheels]
    return all(_in_pairs(values) for values in (ahead, aside))


def _in_pairs(values: Sequence[float]) -> bool:
    """Return whether four values are two pairs of equal values."""
    a, b, c, d = sorted(values)
    return b - a < EVEN and d - c < EVEN and c - b > EVEN
