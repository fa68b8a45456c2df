"""Turn the parts of a gallery robot that describe this robot alone into comments, for ``wmrgen new --from``."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence

import wmrgen
from wmrgen.errors import NotDerivableError
from wmrgen.robotfile.load import read_text
from wmrgen.robotfile.records import RobotSpec, WheelSpec
from wmrgen.robotfile.wheel_types import WHEEL_TYPES

# Sections of a robot and of a wheel that were measured on one robot, or describe its motors and sensors.
_SECTIONS = ("limits", "deadband", "encoder", "noise", "lag", "cg", "gyro")
_WHEEL = re.compile(
    r"(?:wheels: \[| *- | +)(\{.*\})[],]*( *#.*)?"
)  # the line of a wheel, as the gallery has it
_OF_WHEEL = re.compile(rf", (({'|'.join(_SECTIONS)}): \{{[^{{}}]*(?:\{{[^{{}}]*\}}[^{{}}]*)*\}})")
_KEY = re.compile(r"(\w+):")


def comment_own_parts(text: str, spec: RobotSpec, start: str) -> tuple[str, list[str]]:
    """Comment out the parts of a copy that describe one robot alone.

    These are passive wheels, limits, encoders and the like, and the functions that need them. The wheels that remain
    have the same constraints. If no wheel is driven or sensed, all remain.

    Args:
        text: The copy of a robot file of the gallery.
        spec: The robot of the gallery.
        start: Its name, for comments.

    Returns:
        The text, and the names of the wheels, sections and functions that are comments now.
    """
    driven = any(w.actuated or w.sensed for w in spec.wheels)
    passive = [w.name for w in spec.wheels if driven and _is_passive(w)]
    left_out = dict.fromkeys(passive)
    lines = list[str]()
    for key, section in _sections(text.rstrip("\n").split("\n")):
        if key == "wheels":
            section = list(_wheels(section, passive, start, left_out))
        elif key in _SECTIONS:
            left_out[key] = None
            section = list(_as_comments(section, start))
        lines += section
    text = "\n".join(lines) + "\n"
    return _without_functions(text, spec, start, left_out), list(left_out)


def _is_passive(wheel: WheelSpec) -> bool:
    """Return whether a wheel constrains no motion and has no motor and no sensor, such as a castor that swivels."""
    return not (WHEEL_TYPES[wheel.type].actuated or wheel.actuated or wheel.sensed)


def _sections(lines: Sequence[str]) -> Iterator[tuple[str, list[str]]]:
    """Yield the key and the lines of each section of a robot file, with the comments above the key."""
    key, section = "", list[str]()
    above = list[str]()  # comments that belong to the next key
    for line in lines:
        if line.startswith("#"):
            above.append(line)
            continue
        if match := _KEY.match(line):
            if section:
                yield key, section
            key, section = match[1], []
        section += [*above, line]
        above = []
    yield key, [*section, *above]


def _as_comments(section: Sequence[str], start: str) -> Iterator[str]:
    """Yield the lines of a section as comments, with a remark below the comments above its key."""
    meaning = [line for line in section if line.startswith("#")]
    yield from meaning
    yield f"# Values of {start}: write those of your robot, and remove the #."
    yield from (f"# {line}" for line in section if line not in meaning)


def _wheels(
    section: Sequence[str], passive: Sequence[str], start: str, left_out: dict[str, None]
) -> Iterator[str]:
    """Yield the section ``wheels`` with one line for each wheel, passive wheels and own parts of wheels as comments.

    Args:
        section: The lines of the section.
        passive: The names of the passive wheels.
        start: The robot of the gallery, for comments.
        left_out: Gets the names of the sections of wheels that are comments.
    """
    for line in section:
        match = _WHEEL.fullmatch(line)
        if line.startswith("wheels:") and match:
            yield "wheels:"
        if not match:
            yield line
            continue
        wheel, comment = match[1], match[2] or ""
        name = re.search(r"name: (\w+)", wheel)
        if name and name[1] in passive:
            yield f"  # A passive wheel of {start}: correct it, and remove the #, or delete it."
            yield f"  # - {wheel}{comment}"
            continue
        for part, key in _OF_WHEEL.findall(wheel):
            left_out[f"{key} of wheels"] = None
            wheel = wheel.replace(f", {part}", "")
            comment += f"   # of {start}: {part}"
        yield f"  - {wheel}{comment}"


def _without_functions(text: str, spec: RobotSpec, start: str, left_out: dict[str, None]) -> str:
    """Return the copy without the functions that it does not have after the other parts became comments.

    Args:
        text: The copy.
        spec: The robot of the gallery.
        start: Its name, for comments.
        left_out: Gets the names of the functions.
    """
    sections = list(_sections(text.rstrip("\n").split("\n")))
    bare = "\n".join(line for key, section in sections if key != "functions" for line in section)
    derivation = wmrgen.derive(wmrgen.robot_of(read_text(bare + "\n", f"{spec.name}.yaml")))
    missing = list[str]()
    for function in spec.functions:
        try:
            derivation.formula(function.name)
        except NotDerivableError:
            missing.append(function.name)
    if not missing:
        return text
    left_out.update(dict.fromkeys(missing))
    kept = [function.name for function in spec.functions if function.name not in missing]
    lines = list[str]()
    for key, section in sections:
        if key != "functions":
            lines += section
            continue
        lines += [line for line in section if line.startswith("#")]
        words = f"These functions of {start} need parts that are comments: {', '.join(missing)}"
        lines += textwrap.wrap(words, 110, initial_indent="# ", subsequent_indent="#   ")
        lines += [f"functions: [{', '.join(kept)}]"] if kept else []
    return "\n".join(lines) + "\n"
