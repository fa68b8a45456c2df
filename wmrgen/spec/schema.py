"""The robot file as a JSON Schema, for editors: made from the tables that the checks use."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from wmrgen.spec.expressions import MAX_CHARACTERS
from wmrgen.spec.extras import MAX_TRAILERS
from wmrgen.spec.fields import (
    COMMON_KEYS,
    GAINS,
    LIMITS,
    QUANTITIES,
    ROBOT_REQUIRED,
)
from wmrgen.spec.joints import limits_of_type
from wmrgen.spec.load import FORMAT, MAX_PARAMETERS, MAX_TEXT
from wmrgen.spec.names import NAME_PATTERN
from wmrgen.spec.numbers import Kind, units_of
from wmrgen.spec.wheels import MAX_WHEELS
from wmrgen.wheels import WHEEL_TYPES, WheelType

Schema = dict[str, Any]

_GREEK = {"alpha": "α", "beta": "β", "gamma": "γ"}
_SI = {Kind.LENGTH: "m", Kind.ANGLE: "rad", Kind.SPEED: "m/s", Kind.RATE: "rad/s", Kind.ANY: "SI"}


def json_schema(functions: Sequence[str] = ()) -> Schema:
    """JSON Schema 2020-12 of a robot file. It admits a little more than the checks do: names may be
    reserved and expressions wrong. ``functions``: those that a file may ask for; any name where none are listed.
    """
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "wmrgen robot file",
        "type": "object",
        "additionalProperties": False,
        "required": list(ROBOT_REQUIRED),
        "properties": {
            "wmrgen": {"const": int(FORMAT), "description": "format version"},
            "name": {"$ref": "#/$defs/name"},
            "description": {"type": "string", "maxLength": MAX_TEXT},
            "source": {"type": "string", "maxLength": MAX_TEXT},
            "angles": {"enum": ["rad", "deg"], "default": "rad", "description": "unit of bare angles"},
            "snap": {
                "type": "boolean",
                "default": True,
                "description": "take angles within 1e-3 rad of a multiple of pi/12 for that multiple",
            },
            "parameters": _parameters(),
            "wheels": {
                "type": "array",
                "minItems": 1,
                "maxItems": MAX_WHEELS,
                "items": {"oneOf": [{"$ref": f"#/$defs/{name}"} for name in WHEEL_TYPES]},
            },
            "couplings": {"type": "array", "items": _coupling()},
            "limits": _limits(tuple(LIMITS)),
            **_extras(functions),
        },
        "$defs": {
            "name": {"type": "string", "pattern": NAME_PATTERN},
            **{kind.name.lower(): _quantity(kind) for kind in Kind},
            **{name: _wheel(kind) for name, kind in WHEEL_TYPES.items()},
        },
    }


def _quantity(kind: Kind) -> Schema:
    units = ", ".join(units_of(kind))
    return {
        "type": ["number", "string"],
        "maxLength": MAX_CHARACTERS,
        "description": f"[{_SI[kind]}] a number, a number with a unit ({units}), or an expression",
    }


def _ref(kind: Kind) -> Schema:
    return {"$ref": f"#/$defs/{kind.name.lower()}"}


def _parameters() -> Schema:
    full = {
        "type": "object",
        "additionalProperties": False,
        "required": ["value"],
        "properties": {"value": _ref(Kind.ANY), "tunable": {"type": "boolean", "default": False}},
    }
    return {
        "type": "object",
        "maxProperties": MAX_PARAMETERS,
        "propertyNames": {"$ref": "#/$defs/name"},
        "additionalProperties": {"anyOf": [_ref(Kind.ANY), full]},
    }


def _coupling() -> Schema:
    joint = {"type": "string", "pattern": r"\.(spin|steer)$"}
    return {
        "type": "object",
        "additionalProperties": False,
        "required": ["equal"],
        "properties": {"equal": {"type": "array", "minItems": 2, "uniqueItems": True, "items": joint}},
    }


def _limits(names: tuple[str, ...]) -> Schema:
    def limit(kind: Kind) -> Schema:
        return {"anyOf": [_ref(kind), {"type": "array", "minItems": 2, "maxItems": 2, "items": _ref(kind)}]}

    properties = {name: limit(LIMITS[name]) for name in names}
    return {"type": "object", "additionalProperties": False, "properties": properties}


def _extras(functions: Sequence[str]) -> Schema:
    """Keys beyond the wheels: virtual, trailers, slip, cg, gains, functions."""
    length, names = _ref(Kind.LENGTH), {"type": "array", "minItems": 1, "uniqueItems": True}
    virtual: Schema = {key: {**names, "items": {"$ref": "#/$defs/name"}} for key in ("steers", "drives")}
    trailer = {"name": {"$ref": "#/$defs/name"}, "length": length, "hitch": length}
    return {
        "virtual": _list(
            _object({"name": {"$ref": "#/$defs/name"}, **virtual, "x": length, "y": length}, "name")
        ),
        "trailers": {**_list(_object(trailer, "length")), "maxItems": MAX_TRAILERS},
        "slip": {"type": "boolean", "default": False, "description": "slip variables per wheel"},
        "cg": _object({"x": length, "y": length, "z": length}, "x", "y", "z"),
        "gains": _object({k: {**_ref(Kind.ANY), "description": text} for k, text in GAINS.items()}),
        "functions": {**names, "items": {"enum": list(functions)} if functions else {"$ref": "#/$defs/name"}},
    }


def _object(properties: Schema, *required: str) -> Schema:
    found: Schema = {"type": "object", "additionalProperties": False, "properties": properties}
    return {**found, "required": list(required)} if required else found


def _list(item: Schema) -> Schema:
    return {"type": "array", "items": item}


def _wheel(wheel: WheelType) -> Schema:
    """One wheel type: its keys, and the alternatives of place and orientation."""
    joints = {"type": "array", "uniqueItems": True, "items": {"enum": list(wheel.joints)}}
    properties: Schema = {"name": {"$ref": "#/$defs/name"}, "type": {"const": wheel.name}}
    for key, (kind, meaning) in QUANTITIES.items():
        if key in COMMON_KEYS or key in wheel.keys:
            for spelling in (key, *_GREEK.get(key, "")):
                properties[spelling] = {**_ref(kind), "description": meaning}
    properties |= {"actuated": joints, "sensed": joints, "limits": _limits(limits_of_type(wheel))}
    return {
        "type": "object",
        "description": wheel.meaning,
        "additionalProperties": False,
        "required": ["name", "type", *wheel.required],
        "properties": properties,
        "allOf": [_one_of(_place("l", "alpha", "xy"), _place("x", "y", "lα")), _orientation(wheel.oriented)],
    }


def _one_of(*alternatives: Schema) -> Schema:
    return {"oneOf": list(alternatives)}


def _either(key: str) -> Schema:
    """``key`` in Latin or Greek letters, once."""
    spellings = (key, *_GREEK.get(key, ""))
    return _one_of(*({"required": [spelling]} for spelling in spellings))


def _place(first: str, second: str, without: str) -> Schema:
    """Two keys together, and none of those of the other placement."""
    others = [{"required": [key]} for key in (*without, *(["alpha"] if "α" in without else []))]
    return {"allOf": [_either(first), _either(second)], "not": {"anyOf": others}}


def _orientation(required: bool) -> Schema:
    given = [{"required": [key]} for key in ("beta", "β", "heading")]
    return _one_of(*given) if required else _one_of(*given, {"not": {"anyOf": given}})
