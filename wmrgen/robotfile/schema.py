"""Write the JSON Schema of robot files, for editors and validators, from the table of keys."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from itertools import chain, combinations, permutations
from typing import Any

from wmrgen.robotfile.expressions import MAX_CHARACTERS
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
from wmrgen.robotfile.keys import ENCODER, JOINTS, LIMITS, NOISE, ROBOT, WHEEL
from wmrgen.robotfile.load import OPEN
from wmrgen.robotfile.names import NAME_PATTERN, OUTER_NAME_PATTERN, SYMBOL_PATTERN
from wmrgen.robotfile.numbers import NUMBER, Kind, spellings_of, units_of
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, WheelType
from wmrgen.robotfile.wheels import takes

Schema = dict[str, Any]
SCHEMA_FILE = "robot.schema.json"  # next to robot files
# The first line of a robot file, by which editors find the schema.
MODELINE = f"# yaml-language-server: $schema={SCHEMA_FILE}"
SI = {
    Kind.LENGTH: "m", Kind.ANGLE: "rad", Kind.SPEED: "m/s", Kind.RATE: "rad/s", Kind.TIME: "s", Kind.ANY: "SI",
    Kind.ACCELERATION: "m/s^2", Kind.ANGULAR_ACCELERATION: "rad/s^2",
}  # fmt: skip


def json_schema(functions: Sequence[str] = ()) -> Schema:
    """Return the JSON Schema (2020-12) of a robot file.

    ``functions`` are the functions that a file may request; if it is empty, any name is allowed. The schema accepts
    more than the reader: it does not check reserved or undeclared names, or the grammar of expressions.
    """
    function = {"enum": list(functions)} if functions else _ref("name")
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **_section(ROBOT),
        "title": "wmrgen robot file",
        "$defs": {
            "name": _name(
                NAME_PATTERN, "a name: a letter, then letters, digits and _, 31 characters at most"
            ),
            "function": function,
            **{_kind(kind): _quantity(kind) for kind in Kind},
            "plain": _written("a number, or an expression", []),
            **{kind.name: _wheel(kind) for kind in WHEEL_TYPES.values()},
        },
    }


def _kind(kind: Kind) -> str:
    """Return the name of the definition of a kind of quantity."""
    return kind.name.lower()


def _quantity(kind: Kind, more: str = "") -> Schema:
    """Return the schema of a quantity; ``more`` is what else its description says."""
    text = (
        f"[{SI[kind]}] a number, a number with a unit ({', '.join(units_of(kind))}), or an expression{more}"
    )
    return _written(text, spellings_of(kind))


def _written(text: str, units: Iterable[str]) -> Schema:
    """Return the schema of a number, a number with one of ``units``, or an expression.

    ``text`` describes it; editors also show it as the error message.
    """
    number = rf"[+-]?{NUMBER}(?![0-9.]|[eE][+-]?[0-9])"
    other = rf"\s*{number}[ \t]*(?!(?:{'|'.join(map(re.escape, units))})\s*$)[A-Za-zµμ°π_]"
    return {
        "type": ["number", "string"],
        "maxLength": MAX_CHARACTERS,
        "pattern": rf"^(?!{OPEN}$|{other})[-+*/().,\sA-Za-z0-9_πΠµμ°²^]+$",
        "errorMessage": text,
        "description": text,
    }


def _name(pattern: str, text: str) -> Schema:
    """Return the schema of a name; editors show ``text`` if it does not match."""
    return {"type": "string", "pattern": pattern, "errorMessage": text}


def _ref(name: str) -> Schema:
    """Return a reference to a definition."""
    return {"$ref": f"#/$defs/{name}"}


def _section(
    section: Section, fields: Iterable[Field] | None = None, choices: Iterable[Choice] | None = None
) -> Schema:
    """Return the schema of a mapping.

    Args:
        section: Describes the mapping.
        fields: Its keys; by default those of the section.
        choices: Its choices between keys; by default those of the section.
    """
    fields = section.fields if fields is None else tuple(fields)
    properties: Schema = {}
    for field in fields:
        properties |= dict.fromkeys(field.spellings, _property(field))
    schema: Schema = {
        "title": section.title,
        "type": "object",
        "additionalProperties": False,
        "properties": properties,
    }
    if section.required:
        schema["required"] = list(section.required)
    rules: list[Schema] = []
    for choice in section.choices if choices is None else choices:
        rules += _choice(section, choice)
    rules += [_spelled_once(f) for f in fields if f.greek]
    return {**schema, "allOf": rules} if rules else schema


def _property(field: Field) -> Schema:
    """Return the schema of the value of a key, described by its meaning, unit and default."""
    value = field.value
    unit = SI[value.kind] if isinstance(value, Amount | Interval) and value.kind is not Kind.ANY else ""
    default = value.default if isinstance(value, Word) else field.default
    description = field.meaning
    if unit:
        description += f" [{unit}]"
    if default:
        description += f"; default: {default}"
    return {**_value(value), "description": description}


def _value(value: Value) -> Schema:
    """Return the schema of a value."""
    match value:
        case Version(number):
            return {"const": int(number)}
        case Name():
            return _ref("name")
        case Letter():
            text = "a letter that reports do not use for anything else, with or without an index, such as l_x"
            return _name(SYMBOL_PATTERN.replace("(", "([α-ω]|", 1), text)
        case OuterName(signed):
            pattern = OUTER_NAME_PATTERN.replace("^", "^-?", 1) if signed else OUTER_NAME_PATTERN
            text = "a name: letters, digits, spaces and _ - . / :, 200 characters at most"
            return _name(pattern, text + (", with a minus sign if the axis is opposite" * signed))
        case Text(longest):
            return {"type": "string", "maxLength": longest}
        case Word(words, default, interval=Kind() as kind):
            ends = {"type": "array", "minItems": 2, "maxItems": 2, "items": _ref(_kind(kind))}
            return {"anyOf": [_value(Word(words, default)), ends]}
        case Word(words, default):
            if set(words) == {"true", "false"}:
                return {"type": "boolean", "default": default == "true"}
            return {"enum": list(words), "default": default}
        case Amount(kind, unit):
            return _ref("plain" if unit else _kind(kind))
        case Interval(kind):
            ends = {"minItems": 2, "maxItems": 2, "prefixItems": [_ref(_kind(kind))] * 2}
            return {
                **_quantity(kind, ", or a list [low, high]"),
                "type": ["number", "string", "array"],
                **ends,
            }
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
    """Return the schema of a name that is declared elsewhere."""
    match what:
        case "wheel.joint":
            return _name(
                NAME_PATTERN[:-1] + r"\.(spin|steer)$", "a joint: the wheel's name, then .spin or .steer"
            )
        case "function":
            return _ref("function")
        case "type":
            return {"enum": list(WHEEL_TYPES)}
    return _ref("name")


def _list(value: ListOf) -> Schema:
    """Return the schema of a list."""
    schema: Schema = {"type": "array", "items": _value(value.item)}
    if value.least:
        schema["minItems"] = value.least
    if value.most is not None:
        schema["maxItems"] = value.most
    if value.once:
        schema["uniqueItems"] = True
    return schema


def _wheel(kind: WheelType) -> Schema:
    """Return the schema of the wheels of one type."""
    placement, orientation = WHEEL.choices
    choices = (placement, orientation._replace(optional=not kind.oriented))
    schema = _section(WHEEL, (f for f in WHEEL.fields if takes(kind, f.key)), choices)
    properties = schema["properties"]
    properties["type"] = {"const": kind.name, "description": kind.meaning}
    joints = kind.powered.joints if kind.powered else kind.joints
    for key in ("actuated", "sensed"):
        properties[key]["items"] = {"enum": list(joints)}
    for key, section in (("limits", LIMITS), ("noise", NOISE), ("encoder", ENCODER), ("joints", JOINTS)):
        own = section.keys_of(joints)
        of_joints = _section(section, (f for f in section.fields if f.key in own))
        properties[key] = {**of_joints, "description": WHEEL.field(key).meaning}
    required = [*WHEEL.required, *kind.required]
    if kind.powered:
        schema["allOf"] = [*schema.get("allOf", []), _driven(kind.powered)]
    return {**schema, "title": kind.name, "description": kind.meaning, "required": required}


def _driven(powered: WheelType) -> Schema:
    """Return the rule that a driven ball has the keys that its drives require, and no orientation of its own."""
    spellings = (*WHEEL.field("beta").spellings, *WHEEL.field("heading").spellings)
    oriented = dict.fromkeys(spellings, False)
    driven = {"required": ["driven"], "properties": {"driven": {"minItems": 1}}}
    return {"if": driven, "then": {"required": [*powered.required], "properties": oriented}}


def _choice(section: Section, choice: Choice) -> list[Schema]:
    """Return the rules of a choice, one for each possible mistake, with its error message."""
    rules: list[Schema] = []
    for keys in choice.sets:
        for key, other in permutations(keys, 2):
            rules.append({"if": _any_of(section, [other]), "then": _any_of(section, [key])})
    for one, (key, *_) in combinations(choice.sets, 2):
        twice = {"errorMessage": " ".join(choice.several)}
        refused = {"properties": dict.fromkeys(section.field(key).spellings, False), **twice}
        rules.append({"if": _any_of(section, one), "then": refused})
    if not choice.optional:
        every = list(chain.from_iterable(choice.sets))
        words = {"errorMessage": f"{section.title} {choice.none[0]}. {choice.none[2]}"}
        rules.append({"if": {"not": _any_of(section, every)}, "then": {"required": every[:1], **words}})
    return rules


def _any_of(section: Section, keys: Iterable[str]) -> Schema:
    """Return the rule that at least one of the keys is present, in one of its spellings."""
    alternatives: list[Schema] = []
    for key in keys:
        alternatives += ({"required": [word]} for word in section.field(key).spellings)
    return {"anyOf": alternatives} if len(alternatives) > 1 else alternatives[0]


def _spelled_once(field: Field) -> Schema:
    """Return the rule that a key and its Greek letter are not both present."""
    same = f"{field.greek} is the same key as {field.key}. Keep one of them."
    return {
        "if": {"required": [field.greek]},
        "then": {"properties": {field.key: False}, "errorMessage": same},
    }
