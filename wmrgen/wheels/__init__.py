"""Wheel types by name. Every stage asks the record for a property, never for its name.

To add one, in `wmrgen.wheels.types` or from outside, make a `WheelType` and `register` it before a robot file is read:
its joints and keys decide what it does, `words` and `glyph` how the report and the drawing show it. `tests/wheels` has
two examples.
`docs/ARCHITECTURE.md` says what a key takes that no type has yet.
"""

from wmrgen.wheels.record import Check, Glyph, WheelType, Words
from wmrgen.wheels.types import CASTOR, FIXED, SPHERICAL, STEERED, SWEDISH

__all__ = ["WHEEL_TYPES", "Check", "Glyph", "WheelType", "Words", "register"]

WHEEL_TYPES: dict[str, WheelType] = {}


def register(kind: WheelType) -> None:
    """Adds a wheel type. ValueError where its name is taken, or where it says what no wheel can be."""
    if kind.name in WHEEL_TYPES:
        raise ValueError(f"there is a wheel type {kind.name} already; give the new one another name")
    if kind.turns and not kind.sliding_row:
        raise ValueError(
            f"{kind.name}: a wheel that steers needs a sliding row, which decides its angle or its rate"
        )
    if kind.turns and not kind.has_spin:
        raise ValueError(f"{kind.name}: a wheel that steers needs a spin, or its angle is nobody's command")
    if not set(kind.actuated) <= set(kind.joints):
        raise ValueError(f"{kind.name}: actuated names {kind.actuated}, of the joints {kind.joints}")
    WHEEL_TYPES[kind.name] = kind


for _kind in (FIXED, STEERED, CASTOR, SWEDISH, SPHERICAL):
    register(_kind)
