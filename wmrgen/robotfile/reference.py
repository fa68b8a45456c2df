"""Write the reference page of robot files, in Markdown, from the table of keys."""

from __future__ import annotations

from collections.abc import Iterator

from wmrgen.robotfile.fields import (
    Amount,
    Choice,
    Field,
    Interval,
    Letter,
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
from wmrgen.robotfile.names import SYMBOL_LETTERS
from wmrgen.robotfile.numbers import Kind, units_of
from wmrgen.robotfile.schema import SI
from wmrgen.robotfile.wheel_types import WHEEL_TYPES
from wmrgen.robotfile.wheels import takes

_HEAD = """\
# Robot files: a guide, and every key

A robot file is a page of YAML that lists the wheels of a robot (UTF-8, at most 256 KiB; no anchors, tags or
directives). It is data and is never executed. A [tutorial](first_robot.md) writes one for each kind of drive. This
page explains the keys in the order in which most people need them. The [tables](#the-file) list all keys.

`wmrgen schema --markdown` prints this page, and `wmrgen schema` prints the JSON Schema, from the table that the
reader uses.

## Guide

**The smallest file** has a version, a name and wheels:

```yaml
wmrgen: 1
name: cart
wheels:
  - {name: left,  type: fixed, x: 0, y: 16 cm,  heading: 0, r: 5 cm}
  - {name: right, type: fixed, x: 0, y: -16 cm, heading: 0, r: 5 cm}
```

**Position.** P is the origin of the robot frame. x points forward and y to the left. Write the position of a wheel as
`x` and `y`, or as the distance `l` and the direction `alpha` seen from P. For a wheel that steers or swings, this is
the position of the steering axis.

**Direction.** `heading` is the direction in which the wheel rolls at a positive speed: 0 is forward, `90 deg` is
left. Textbooks use `beta` in its place. Angles are counter-clockwise.

**Type.** Choose the type by the wheel:

| wheel | write |
|---|---|
| ordinary wheel that does not steer | `type: fixed` |
| wheel with a steering axis through its contact | `type: steered` |
| caster that swings behind its steering axis | `type: castor`, with `d` |
| omni wheel | `type: swedish` |
| mecanum wheel | `type: swedish`, with `gamma` |
| ball | `type: spherical` |

**Motors and sensors.** `actuated` lists the driven joints of a wheel, and `sensed` the measured joints. The front
wheels of a car have `actuated: [steer]`. A wheel without a motor has `actuated: []`.

**Quantities.** A quantity is a number (`0.15`), a number with a unit (`150 mm`, `45 deg`) or an expression. Expressions
may use `+ - * / **`, `sqrt sin cos tan atan2`, `pi` and parameters. Without a unit, a quantity is in SI units; the key
`angles` gives the unit of angles. Fractions and roots remain exact.

UNITS

**Parameters** are names for numbers. A tunable parameter remains an input of the generated code, so that you can
calibrate it:

```yaml
wmrgen: 1
name: cart
parameters: {track: 32 cm, radius: {value: 5 cm, tunable: true}}
wheels:
  - {name: left,  type: fixed, x: 0, y: track/2,  heading: 0, r: radius}
  - {name: right, type: fixed, x: 0, y: -track/2, heading: 0, r: radius}
```

Formulas of reports show the names of parameters. `symbol` replaces a name by a letter, as in a textbook:
`half_track: {value: 16 cm, symbol: h}`.

**More functions** need more keys, and are listed under `functions`:

| to get | add | and write |
|---|---|---|
| speeds inside the limits of the robot | `limits` with `vx`, `omega`, `spin` | `functions: [limit_twist, desaturate]` |
| smooth acceleration | `limits` with `vx_rate`, `omega_rate` | `functions: [limit_acceleration]` |
| wheel speeds from encoder counts | `encoder` | `functions: [joints_from_counts]` |
| the covariance of the pose | `noise` | `functions: [forward_covariance, odometry_covariance]` |
| correct heading of a robot that skids | `effective_track` | |
| the names of joints in ROS 2 | `joints` of the wheels, `frame` | |
| trailers | `trailers` | `functions: [trailer]` |
| the margin against tipping over | `cg` | `functions: [stability]` |

```yaml
limits: {vx: 1.2 m/s, omega: 180 deg/s, spin: 25, vx_rate: 0.6, omega_rate: 4}
encoder: {spin: {counts: 2048, gear: 30}}
noise: {spin: {proportional: 0.02, constant: 0.02 rad/s}}
functions: [limit_twist, limit_acceleration, desaturate, joints_from_counts, forward_covariance, odometry_covariance]
```

**When something is wrong**, the message names the line and the correction. An unknown key is [WMR102](lint.md#wmr102),
a missing key [WMR103](lint.md#wmr103), a value of the wrong type [WMR104](lint.md#wmr104). `wmrgen lint` reports
likely mistakes in a valid file.
"""
_ONE_OF = {
    "joint": "joints: `spin`, `steer`", "wheel": "names of wheels", "wheel.joint": "joints, as `left.steer`",
    "type": "a wheel type, see below", "function": "names of functions",
}  # fmt: skip


def reference() -> str:
    """Return the page ``docs/robot_file.md``."""
    lines = [_HEAD.replace("UNITS", "\n".join(_units()))]
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
    yield "| key | meaning | value | default | example |"
    yield "|---|---|---|---|---|"
    for f in section.fields:
        spelled = " or ".join(f"`{word}`" for word in f.spellings)
        cells = (f.meaning, _in_words(f.value), _default(section, f), f"`{example(f)}`")
        yield f"| {spelled} | {' | '.join(cells)} |"


def example(field: Field) -> str:
    """Return a valid ``key: value``. Raise ValueError if neither the key nor its kind of value has an example."""
    key = field.key
    if field.example:
        return f"{key}: {field.example}"
    match field.value:
        case Version(number):
            return f"{key}: {number}"
        case Word(words, default):
            return f"{key}: {next(word for word in words if word != default)}"
        case OneOf("type"):
            return f"{key}: {next(iter(WHEEL_TYPES))}"
        case ListOf(Section() as section):
            return f"{key}: [{section.example}]"
        case ListOf(example=text):
            return f"{key}: {text}"
        case Mapped(section):
            return f"{key}: {{track: 0.4, radius: {section.example}}}"
        case Section(example=text):
            return text if text.startswith(f"{key}:") else f"{key}: {text.partition(': ')[2]}"
    raise ValueError(f"the key {key} has no example")


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
        case Letter():
            return f"one of {' '.join(SYMBOL_LETTERS)}; an index may follow, as in `l_x`"
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
            return f"`name: quantity` or `name: {{value, tunable, symbol}}`, at most {most}"
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
