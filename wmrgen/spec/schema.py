"""Robot files as a JSON Schema, for editors and validators: from the field table."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

from wmrgen.spec.expressions import MAX_CHARACTERS
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
from wmrgen.spec.joint_keys import ENCODER, LIMITS, NOISE
from wmrgen.spec.keys import ROBOT, WHEEL
from wmrgen.spec.names import NAME_PATTERN
from wmrgen.spec.numbers import NUMBER, Kind, spellings_of, units_of
from wmrgen.spec.wheels import keys_of_type, takes
from wmrgen.wheels import WHEEL_TYPES, WheelType

Schema = dict[str, Any]
SCHEMA_FILE = "robot.schema.json"  # beside robot files
MODELINE = f"# yaml-language-server: $schema={SCHEMA_FILE}"  # the first line of robot files: editors check and complete
SI = {
    Kind.LENGTH: "m", Kind.ANGLE: "rad", Kind.SPEED: "m/s", Kind.RATE: "rad/s", Kind.TIME: "s", Kind.ANY: "SI",
    Kind.ACCELERATION: "m/s^2", Kind.ANGULAR_ACCELERATION: "rad/s^2",
}  # fmt: skip


def json_schema(functions: Sequence[str] = ()) -> Schema:
    """JSON Schema 2020-12 of a robot file. ``functions``: those that a file may ask for; any where none are listed.

    It admits a little more than reading does: names may be reserved or nowhere declared, expressions wrong.
    """
    function = {"enum": list(functions)} if functions else _ref("name")
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "wmrgen robot file",
        **_section(ROBOT),
        "$defs": {
            "name": {"type": "string", "pattern": NAME_PATTERN},
            "function": function,
            **{_kind(kind): _quantity(kind) for kind in Kind},
            "plain": _written("a number, or an expression", []),
            **{kind.name: _wheel(kind) for kind in WHEEL_TYPES.values()},
        },
    }


def _kind(kind: Kind) -> str:
    return kind.name.lower()


def _quantity(kind: Kind) -> Schema:
    text = f"[{SI[kind]}] a number, a number with a unit ({', '.join(units_of(kind))}), or an expression"
    return _written(text, spellings_of(kind))


def _written(text: str, units: Iterable[str]) -> Schema:
    """What ``text`` says: no word stands behind a number but one of ``units``, at the end, and nothing that no quantity
    has. Editors show the text of a value that is none."""
    number = rf"[+-]?{NUMBER}(?![0-9.]|[eE][+-]?[0-9])"
    other = rf"\s*{number}[ \t]*(?!(?:{'|'.join(map(re.escape, units))})\s*$)[A-Za-zµμ°π_]"
    return {
        "type": ["number", "string"],
        "maxLength": MAX_CHARACTERS,
        "pattern": rf"^(?!{other})[-+*/().,\sA-Za-z0-9_πΠµμ°²^]+$",
        "patternErrorMessage": text,
        "description": text,
    }


def _ref(name: str) -> Schema:
    return {"$ref": f"#/$defs/{name}"}


def _section(section: Section, fields: Iterable[Field] | None = None) -> Schema:
    """A mapping with the keys of a section, or with those of ``fields``."""
    fields = section.fields if fields is None else tuple(fields)
    schema: Schema = {
        "type": "object",
        "additionalProperties": False,
        "properties": {word: _property(f) for f in fields for word in f.spellings},
    }
    if section.required:
        schema["required"] = list(section.required)
    if section.choices:
        schema["allOf"] = [_choice(section, choice, choice.optional) for choice in section.choices]
    return schema


def _property(field: Field) -> Schema:
    """A key's value with its meaning, which stands at alternatives too: editors show that of the one that fits."""
    schema, said = _value(field.value), {"description": field.meaning}
    if isinstance(field.value, Amount | Interval) and field.value.kind is not Kind.ANY:
        said["description"] += f" [{SI[field.value.kind]}]"
    if "anyOf" in schema:
        schema["anyOf"] = [{**alternative, **said} for alternative in schema["anyOf"]]
    return {**schema, **said}


def _value(value: Value) -> Schema:
    """What stands behind a key."""
    match value:
        case Version(number):
            return {"const": int(number)}
        case Name():
            return _ref("name")
        case Text(longest):
            return {"type": "string", "maxLength": longest}
        case Word(words, default):
            if set(words) == {"true", "false"}:
                return {"type": "boolean", "default": default == "true"}
            return {"enum": list(words), "default": default}
        case Amount(kind, unit):
            return _ref("plain" if unit else _kind(kind))
        case Interval(kind):
            ends = {"type": "array", "minItems": 2, "maxItems": 2, "items": _ref(_kind(kind))}
            return {"anyOf": [_ref(_kind(kind)), ends]}
        case OneOf(what):
            return _one_of(what)
        case ListOf():
            return _list(value)
        case Mapped(section, most):
            return {
                "type": "object",
                "maxProperties": most,
                "propertyNames": _ref("name"),
                "additionalProperties": {"anyOf": [_ref(_kind(Kind.ANY)), _section(section)]},
            }
        case Section():
            return {"oneOf": [_ref(name) for name in WHEEL_TYPES]} if value is WHEEL else _section(value)


def _one_of(what: str) -> Schema:
    match what:
        case "wheel.joint":
            return {"type": "string", "pattern": NAME_PATTERN[:-1] + r"\.(spin|steer)$"}
        case "function":
            return _ref("function")
        case "type":
            return {"enum": list(WHEEL_TYPES)}
    return _ref("name")


def _list(value: ListOf) -> Schema:
    schema: Schema = {"type": "array", "items": _value(value.item)}
    if value.least:
        schema["minItems"] = value.least
    if value.most is not None:
        schema["maxItems"] = value.most
    if value.once:
        schema["uniqueItems"] = True
    return schema


def _wheel(kind: WheelType) -> Schema:
    """One wheel type: the keys that it takes, its joints and their limits."""
    schema = _section(WHEEL, (f for f in WHEEL.fields if takes(kind, f.key)))
    properties = schema["properties"]
    properties["type"] = {"const": kind.name, "description": kind.meaning}
    for key in ("actuated", "sensed"):
        properties[key]["items"] = {"enum": list(kind.joints)}
    for key, section in (("limits", LIMITS), ("noise", NOISE), ("encoder", ENCODER)):
        own = keys_of_type(section, kind)
        of_joints = _section(section, (f for f in section.fields if f.key in own))
        properties[key] = {**of_joints, "description": WHEEL.field(key).meaning}
    placement, orientation = WHEEL.choices
    return {
        **schema,
        "description": kind.meaning,
        "required": [*WHEEL.required, *kind.required],
        "allOf": [_choice(WHEEL, placement, False), _choice(WHEEL, orientation, not kind.oriented)],
    }


def _choice(section: Section, choice: Choice, optional: bool) -> Schema:
    """Exactly one of the sets of keys, whole; where ``optional``, or none of them."""
    every = {key for keys in choice.sets for key in keys}
    alternatives = [
        _keys(section, keys, every - set(keys)) for keys in (*choice.sets, *([()] if optional else []))
    ]
    return {"oneOf": alternatives}


def _keys(section: Section, present: Iterable[str], absent: Iterable[str]) -> Schema:
    """Each of the ``present`` keys, in one spelling; none of the ``absent``."""
    schema: Schema = {"allOf": [{"oneOf": _spelled(section, key)} for key in present]} if present else {}
    others = [entry for key in sorted(absent) for entry in _spelled(section, key)]
    return {**schema, "not": {"anyOf": others}} if others else schema


def _spelled(section: Section, key: str) -> list[Schema]:
    return [{"required": [word]} for word in section.field(key).spellings]
