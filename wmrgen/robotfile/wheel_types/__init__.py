"""The wheel types by name. Other modules use the properties of a type, and never its name.

To add a type, make a `WheelType` and `register` it before a robot file is read. Its joints and keys decide what it
does; `words` and `glyph` decide how the report and the drawing show it. `tests/robotfile/wheel_types` has two examples,
and `docs/ARCHITECTURE.md` explains how to add a key that no type has yet.
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
    """Add a wheel type. Raise ValueError if its name is taken or its properties contradict each other."""
    if kind.name in WHEEL_TYPES:
        raise ValueError(f"there is a wheel type {kind.name} already; give the new one another name")
    for contradicts, rule in _contradictions(kind):
        if contradicts:
            raise ValueError(f"{kind.name}: {rule}")
    WHEEL_TYPES[kind.name] = kind


def _contradictions(kind: WheelType) -> tuple[tuple[bool, str], ...]:
    """Return the rules that each wheel type must satisfy, each with whether ``kind`` violates it."""
    off_axis = any(kind.takes(key) for key in ("d", "offset_y", "per_steer"))
    return (
        (kind.turns and not kind.sliding_row,
         "a wheel that steers needs a sliding row, from which its angle or its rate is computed"),
        (kind.turns and not kind.has_spin,
         "a wheel that steers needs the joint spin"),
        (not set(kind.actuated) <= set(kind.joints), f"actuated is {kind.actuated}, but the joints are {kind.joints}"),
        (kind.has_spin and "r" not in kind.required, "a wheel with a spin needs r among its required keys"),
        (kind.turns and "d" in kind.keys and not kind.swivels,
         "a wheel that steers has d among its required keys, as a castor, or does not have d"),
        (off_axis and not kind.turns, "d, offset_y and per_steer need a steering axis, and this type has none"),
        (kind.rollers and kind.sliding_row, "a wheel with rollers (gamma) slides across them: write sliding_row=False"),
        (not kind.constrains and not kind.words.free, "words.free must say why the wheel does not constrain the twist"),
    )  # fmt: skip


for _kind in (FIXED, STEERED, CASTOR, SWEDISH, SPHERICAL):
    register(_kind)
