"""The reference of robot files in Markdown: made from the field table."""

from __future__ import annotations

from collections.abc import Iterator

from wmrgen.spec.fields import (
    Amount,
    Choice,
    Field,
    Interval,
    ListOf,
    Mapped,
    Name,
    OneOf,
    Section,
    Text,
    Value,
    Version,
    Word,
)
from wmrgen.spec.keys import CG, COUPLING, GAINS, LIMITS, PARAMETER, ROBOT, TRAILER, VIRTUAL, WHEEL
from wmrgen.spec.numbers import Kind, units_of
from wmrgen.spec.schema import SI
from wmrgen.spec.wheels import takes
from wmrgen.wheels import WHEEL_TYPES

_HEAD = """\
# Robot files

A robot file is a page of YAML (UTF-8, 256 KiB at most; no anchors, tags or directives) that is read, never executed.
The frame: origin P, x forward, y left, angles counter-clockwise. `wmrgen schema` prints the JSON Schema of these keys,
`wmrgen schema --markdown` this page; both are made from the table that reading goes by.

A quantity is a number (`0.15`), a number with a unit (`150 mm`, `45 deg`) or an expression of `+ - * / **`,
`sqrt sin cos tan atan2`, `pi` and parameters. Without a unit it is in SI units, angles as `angles` says. What is
written as a fraction or a root stays exact.
"""
_ONE_OF = {
    "joint": "joints: `spin`, `steer`", "wheel": "names of wheels", "wheel.joint": "joints, as `left.steer`",
    "type": "a wheel type, see below", "function": "names of functions",
}  # fmt: skip
_SECTIONS = (
    ("The file", ROBOT), ("Each of `wheels`", WHEEL), ("`limits`, of the robot or of a wheel", LIMITS),
    ("A parameter with more than a value", PARAMETER), ("Each of `couplings`", COUPLING),
    ("Each of `virtual`", VIRTUAL), ("Each of `trailers`", TRAILER), ("`cg`", CG), ("`gains`", GAINS),
)  # fmt: skip


def reference() -> str:
    """The page ``docs/robot_file.md``."""
    lines = [_HEAD, *_units(), ""]
    for title, section in _SECTIONS:
        lines += [f"## {title}", "", f"Such as `{section.example}`.", "", *_table(section), ""]
        if section is WHEEL:
            lines += [*_types(), ""]
        lines += [f"{_choices(section)}\n"] if section.choices else []
    return "\n".join(lines).rstrip() + "\n"


def _units() -> Iterator[str]:
    yield "| quantity | SI | units |"
    yield "|---|---|---|"
    for kind in Kind:
        if kind is not Kind.ANY:
            yield f"| {kind} | {SI[kind]} | {' '.join(units_of(kind))} |"


def _table(section: Section) -> Iterator[str]:
    yield "| key | value | when not given | meaning |"
    yield "|---|---|---|---|"
    for f in section.fields:
        spelled = " or ".join(f"`{word}`" for word in f.spellings)
        yield f"| {spelled} | {_value(f.value)} | {_default(section, f)} | {f.meaning} |"


def _default(section: Section, field: Field) -> str:
    if field.required:
        return "**required**"
    if isinstance(field.value, Word):
        return f"`{field.value.default}`"
    if section is WHEEL and any(field.key in kind.required for kind in WHEEL_TYPES.values()):
        return "see the wheel types"
    return field.default


def _value(value: Value) -> str:
    match value:
        case Version(number):
            return f"`{number}`"
        case Name():
            return "new name: a-z, 0-9 and _, 31 characters at most"
        case Text(longest):
            return f"text, {longest} characters at most"
        case Word(words):
            return " or ".join(f"`{word}`" for word in words)
        case Amount(Kind.ANY, unit):
            return f"number [{unit}]" if unit else "quantity"
        case Amount(kind):
            return f"{kind} [{SI[kind]}]"
        case Interval(kind):
            return f"{kind} [{SI[kind]}]: `high` for [-high, high], or `[low, high]`"
        case OneOf(what):
            return _ONE_OF[what]
        case ListOf(item, least=least, most=most):
            bounds = [f"at least {least}" if least else "", f"at most {most}" if most else ""]
            many = ", ".join(text for text in bounds if text)
            items = "mappings, see below" if isinstance(item, Section) else _value(item)
            return f"list of {items}{f' ({many})' if many else ''}"
        case Mapped(_, most):
            return f"`name: quantity` or `name: {{value, tunable}}`, at most {most}"
        case Section():
            return "mapping, see below"


def _types() -> Iterator[str]:
    """Which keys each wheel type takes beyond those of all."""
    yield "| type | what it is | required | may have besides | joints | driven |"
    yield "|---|---|---|---|---|---|"
    for kind in WHEEL_TYPES.values():
        own = [f.key for f in WHEEL.fields if f.misfit and takes(kind, f.key) and f.key not in kind.required]
        orientation = ["beta or heading"] if kind.oriented else []
        columns = [[*kind.required, *orientation], own, kind.joints, kind.actuated]
        cells = " | ".join(", ".join(words) for words in columns)
        yield f"| `{kind.name}` | {kind.meaning} | {cells} |"


def _choices(section: Section) -> str:
    """Sentences about sets of keys that stand together or exclude each other."""
    return " ".join(map(_sentence, section.choices))


def _sentence(choice: Choice) -> str:
    sets = [" with ".join(f"`{key}`" for key in keys) for keys in choice.sets]
    if len(sets) == 1:
        return f"{sets[0]}, or neither."
    return f"{' or '.join(sets)}, not both." if choice.optional else f"Either {' or '.join(sets)}."
