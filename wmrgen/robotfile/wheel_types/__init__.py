"""Wheel types by name. Every stage asks the record for a property, never for its name.

To add one, in `wmrgen.robotfile.wheel_types.types` or from outside, make a `WheelType` and `register` it before a
robot file is read:
its joints and keys decide what it does, `words` and `glyph` how the report and the drawing show it.
`tests/robotfile/wheel_types` has two examples.
`docs/ARCHITECTURE.md` says what a key takes that no type has yet.
"""

from wmrgen.robotfile.wheel_types.types import (
    CASTOR,
    FIXED,
    SPHERICAL,
    STEERED,
    SWEDISH,
    Check,
    Glyph,
    WheelType,
    Words,
)

__all__ = ["WHEEL_TYPES", "Check", "Glyph", "WheelType", "Words", "register"]

WHEEL_TYPES: dict[str, WheelType] = {}


def register(kind: WheelType) -> None:
    """Adds a wheel type. ValueError where its name is taken, or where it says what no wheel can be."""
    if kind.name in WHEEL_TYPES:
        raise ValueError(f"there is a wheel type {kind.name} already; give the new one another name")
    for contradicts, why in _contradictions(kind):
        if contradicts:
            raise ValueError(f"{kind.name}: {why}")
    WHEEL_TYPES[kind.name] = kind


def _contradictions(kind: WheelType) -> tuple[tuple[bool, str], ...]:
    """What no wheel can be: whether ``kind`` says it, and why none can."""
    off_axis = any(kind.takes(key) for key in ("d", "offset_y", "per_steer"))
    return (
        (kind.turns and not kind.sliding_row,
         "a wheel that steers needs a sliding row, which decides its angle or its rate"),
        (kind.turns and not kind.has_spin,
         "a wheel that steers needs a spin, or its angle is nobody's command"),
        (not set(kind.actuated) <= set(kind.joints), f"actuated names {kind.actuated}, of the joints {kind.joints}"),
        (kind.has_spin and "r" not in kind.required, "a wheel with a spin needs r among its required keys"),
        (kind.turns and "d" in kind.keys and not kind.swivels,
         "a wheel that steers has d among its required keys, as a castor, or not at all"),
        (off_axis and not kind.turns, "d, offset_y and per_steer are seen from a steering axis, and it has none"),
        (kind.rollers and kind.sliding_row, "a wheel with rollers (gamma) slides across them: sliding_row=False"),
        (not kind.constrains and not kind.words.free, "words.free must say why it constrains no twist"),
    )  # fmt: skip


for _kind in (FIXED, STEERED, CASTOR, SWEDISH, SPHERICAL):
    register(_kind)
