"""Write the reference page of robot files, in Markdown, from the table of keys."""

from __future__ import annotations

from collections.abc import Iterator

from wmrgen.errors import Code
from wmrgen.robotfile.fields import (
    Amount,
    Choice,
    Field,
    Interval,
    ListOf,
    Mapped,
    Name,
    OneOf,
    OuterName,
    Section,
    Text,
    Value,
    Version,
    Word,
)
from wmrgen.robotfile.keys import SECTIONS, WHEEL
from wmrgen.robotfile.numbers import Kind, units_of
from wmrgen.robotfile.schema import SI
from wmrgen.robotfile.wheel_types import WHEEL_TYPES
from wmrgen.robotfile.wheels import takes

# For each kind of quantity, a valid and an invalid value.
_AMOUNTS = {
    Kind.LENGTH: ("150 mm", "45 deg"), Kind.ANGLE: ("45 deg", "150 mm"), Kind.SPEED: ("1.2 m/s", "1.2 m"),
    Kind.RATE: ("90 deg/s", "90 deg"), Kind.ACCELERATION: ("0.6", "0.6 m/s"),
    Kind.ANGULAR_ACCELERATION: ("200 deg/s^2", "200 deg/s"), Kind.TIME: ("150 ms", "150 mm"),
}  # fmt: skip
_HEAD = """\
# Robot files

A robot file is a page of YAML (UTF-8, at most 256 KiB; no anchors, tags or directives). It is data and is never
executed. The robot frame has its origin at P, x forward and y left; angles are counter-clockwise.
`wmrgen schema` prints the JSON Schema of these keys, and `wmrgen schema --markdown` prints this page. Both come from
the table that the reader uses.

A quantity is a number (`0.15`), a number with a unit (`150 mm`, `45 deg`) or an expression of `+ - * / **`,
`sqrt sin cos tan atan2`, `pi` and parameters. Without a unit, it is in SI units; the key `angles` gives the unit of
angles. Fractions and roots remain exact.

For each key, the tables show a valid value, and an invalid value with the code of its error (`wmrgen explain CODE`).
A missing required key is WMR103, an unknown key is WMR102.
"""
_ONE_OF = {
    "joint": "joints: `spin`, `steer`", "wheel": "names of wheels", "wheel.joint": "joints, as `left.steer`",
    "type": "a wheel type, see below", "function": "names of functions",
}  # fmt: skip


def reference() -> str:
    """Return the page ``docs/robot_file.md``."""
    lines = [_HEAD, *_units(), ""]
    for title, section in SECTIONS.items():
        lines += [f"## {title}", "", f"Example: `{section.example}`", "", *_table(section), ""]
        if section is WHEEL:
            lines += [*_types(), ""]
        lines += [f"{' '.join(map(_sentence, section.choices))}\n"] if section.choices else []
    return "\n".join(lines).rstrip() + "\n"


def _units() -> Iterator[str]:
    """Yield the table of quantities and units."""
    yield "| quantity | SI | units |"
    yield "|---|---|---|"
    for kind in Kind:
        if kind is not Kind.ANY:
            yield f"| {kind} | {SI[kind]} | {' '.join(units_of(kind))} |"


def _table(section: Section) -> Iterator[str]:
    """Yield the table of the keys of a section."""
    yield "| key | meaning | value | default | example | invalid |"
    yield "|---|---|---|---|---|---|"
    for f in section.fields:
        spelled = " or ".join(f"`{word}`" for word in f.spellings)
        right, (wrong, code) = example(f), mistake(f)
        cells = (
            f.meaning, _in_words(f.value), _default(section, f), f"`{right}`",
            f"`{wrong}` ([{code}](lint.md#{code.lower()}))",
        )  # fmt: skip
        yield f"| {spelled} | {' | '.join(cells)} |"


def example(field: Field) -> str:
    """Return a valid ``key: value``."""
    key = field.key
    if field.example:
        return f"{key}: {field.example}"
    match field.value:
        case Version(number):
            return f"{key}: {number}"
        case Name():
            return f"{key}: front"
        case OuterName():
            return f"{key}: left_wheel_joint"
        case Text():
            return f"{key}: two wheels and a ball"
        case Word(words, default):
            return f"{key}: {next(word for word in words if word != default)}"
        case Amount(kind) | Interval(kind):
            return f"{key}: {_AMOUNTS[kind][0] if kind in _AMOUNTS else field.default}"
        case OneOf():
            return f"{key}: fixed"
        case ListOf(Section() as section):
            return f"{key}: [{section.example}]"
        case ListOf(example=text):
            return f"{key}: {text}"
        case Mapped(section):
            return f"{key}: {{track: 0.4, radius: {section.example}}}"
        case Section(example=text):
            return text if text.startswith(f"{key}:") else f"{key}: {text.partition(': ')[2]}"


def mistake(field: Field) -> tuple[str, Code]:
    """Return an invalid ``key: value``, and the code of its error."""
    key = field.key
    match field.value:
        case Name():
            return f"{key}: front-left", Code.NAME
        case OuterName():
            return f"{key}: wheel*", Code.NAME
        case ListOf(OneOf("wheel" | "function")):
            return f"{key}: [none]", Code.UNDECLARED
        case ListOf(OneOf()):
            return f"{key}: [none]", Code.FORM
        case Amount(Kind.ANY):
            return f"{key}: half", Code.UNDECLARED
        case Amount(kind):
            return f"{key}: {_AMOUNTS[kind][1]}", Code.FORM
        case Interval():
            return f"{key}: [1, 0]", Code.VALUE
        case Version():
            return f"{key}: 2", Code.FORM
        case Text():
            return f"{key}: [two wheels]", Code.FORM
    return f"{key}: maybe", Code.FORM


def _default(section: Section, field: Field) -> str:
    """Return the cell for the default of a key."""
    if field.required:
        return "**required**"
    if isinstance(field.value, Word):
        return f"`{field.value.default}`"
    if section is WHEEL and any(field.key in kind.required for kind in WHEEL_TYPES.values()):
        return "see the wheel types"
    return field.default


def _in_words(value: Value) -> str:
    """Return what a value is, in words."""
    match value:
        case Version(number):
            return f"`{number}`"
        case Name():
            return "new name: a-z, A-Z, 0-9 and _, at most 31 characters"
        case OuterName(signed):
            return f"name in other tools{', with `-` before it if its axis is opposite' * signed}"
        case Text(longest):
            return f"text, at most {longest} characters"
        case Word(words, interval=interval):
            return " or ".join(f"`{word}`" for word in (*words, *(["[low, high]"] if interval else [])))
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
            items = "mappings, see below" if isinstance(item, Section) else _in_words(item)
            return f"list of {items}{f' ({many})' if many else ''}"
        case Mapped(_, most):
            return f"`name: quantity` or `name: {{value, tunable}}`, at most {most}"
        case Section():
            return "mapping, see below"


def _types() -> Iterator[str]:
    """Yield the table of wheel types, with the keys that not all types have."""
    yield "| type | what it is | required | optional | joints | driven |"
    yield "|---|---|---|---|---|---|"
    for kind in WHEEL_TYPES.values():
        own = [f.key for f in WHEEL.fields if f.misfit and takes(kind, f.key) and f.key not in kind.required]
        orientation = ["beta or heading"] if kind.oriented else []
        columns = [[*kind.required, *orientation], own, kind.joints, kind.actuated]
        cells = " | ".join(", ".join(words) for words in columns)
        yield f"| `{kind.name}` | {kind.meaning} | {cells} |"


def _sentence(choice: Choice) -> str:
    """Return a sentence about sets of keys that belong together or exclude each other."""
    sets = []
    for keys in choice.sets:
        sets.append(" with ".join(f"`{key}`" for key in keys))
    if len(sets) == 1:
        return f"Either {sets[0]}, or neither."
    return f"{' or '.join(sets)}, but not both." if choice.optional else f"Either {' or '.join(sets)}."
