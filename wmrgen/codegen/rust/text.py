"""The parts of Rust text: names, numbers, documentation and structs."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from wmrgen.codegen.unit import Field, Struct
from wmrgen.codegen.unit import struct as struct_of
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.nodes import Port
from wmrgen.ir.rounding import constant

WIDTH = 100  # columns of a line, as rustfmt has it
SCALARS = {"float": "f32", "double": "f64"}
_KEYWORDS = frozenset(
    """
abstract as async await become box break const continue do dyn else enum extern false final fn for gen if impl in let
loop macro match mod move mut override priv pub ref return static struct trait true try type typeof unsafe unsized use
virtual where while yield
""".split()
)


def identifier(name: str) -> str:
    """Return a Rust identifier that resembles ``name``."""
    text = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return f"r#{text}" if text in _KEYWORDS else text


def type_name(*names: str) -> str:
    """Return ``SteerRate`` for ``steer_rate``; several names become one."""
    parts = (part for name in names for part in re.split(r"[^A-Za-z0-9]+", name))
    return "".join(part[:1].upper() + part[1:] for part in parts)


def package(robot: str) -> str:
    """Return the name of a robot's crate for Cargo."""
    return f"{robot.lower().replace('_', '-')}-kinematics"


def crate(robot: str) -> str:
    """Return the name of a robot's crate in Rust code."""
    return package(robot).replace("-", "_")


def number(value: float, scalar: str) -> str:
    """Return the shortest decimal that reads back as ``value``, a float32 if ``scalar`` is f32."""
    kind = np.float32 if scalar == "f32" else np.float64
    plain = np.format_float_positional(kind(value), trim="0")
    return plain if len(plain) <= 12 else str(kind(value))  # many digits are easier to read with an exponent


def literal(value: Exact, scalar: str) -> str:
    """Return ``value``, rounded once. Raise NotDerivableError if it is outside the range of the type."""
    return number(constant(value, single=scalar == "f32"), scalar)


def doc(text: str) -> str:
    """Return ``text`` on one line of documentation, without links and tags."""
    return re.sub(r"([\[\]<>`\\])", r"\\\1", " ".join(text.split()))


def sentence(text: str) -> str:
    """Return ``text`` as documentation, with a capital and a full stop."""
    return doc(text[:1].upper() + text[1:] + ("" if text.endswith(".") else ".")) if text else ""


def wrapped(text: str, first: str = "") -> list[str]:
    """Return lines of documentation with ``first`` before ``text``; the other lines are indented by its length."""
    return textwrap.wrap(first + text, WIDTH - 4, subsequent_indent=" " * len(first), break_on_hyphens=False)


def struct(name: str, ports: Sequence[Port], text: str) -> Struct:
    """Return the Rust struct ``name`` of ``ports``.

    Args:
        name: Name of the type.
        ports: The members.
        text: What the struct is.
    """
    return struct_of(name, ports, text, identifier)


def declaration(struct: Struct, scalar: str) -> list[dict[str, Any]]:
    """Return name, documentation and fields of a struct and of its nested structs, for the template."""
    fields = [_field(field, scalar) for field in struct.fields]
    declared: list[dict[str, Any]] = [{"name": struct.name, "doc": struct.text, "fields": fields}]
    for field in struct.fields:
        if field.inner:
            inner = [_field(each, scalar) for each in field.inner]
            declared.append({"name": _type_of(field), "doc": "Joints of a wheel.", "fields": inner})
    return declared


def _field(field: Field, scalar: str) -> dict[str, str]:
    if field.port is None:
        return {"name": field.name, "type": _type_of(field), "doc": ""}
    return {"name": field.name, "type": scalar, "doc": _about(field.port)}


def _type_of(field: Field) -> str:
    """Return the type of the struct of a wheel: ``SpinSteer``."""
    return type_name(*(inner.name for inner in field.inner))


def value(struct: Struct, texts: Mapping[str, str], base: str = "") -> list[str]:
    """Return the lines of an expression of the type ``struct``.

    Args:
        struct: The type.
        texts: Path of a member -> expression.
        base: Reference to a value whose members are taken if ``texts`` lacks them.
    """
    return _value(struct.name, struct.fields, texts, "", base)


def _value(name: str, fields: Sequence[Field], texts: Mapping[str, str], path: str, base: str) -> list[str]:
    lines, complete = [f"{name} {{"], True
    for field in fields:
        place = f"{path}{field.name}"
        if place in texts:
            text = texts[place]
            lines.append(f"    {field.name}," if text == field.name else f"    {field.name}: {text},")
        elif any(p.startswith(f"{place}.") for p in texts):
            inner = _value(_type_of(field), field.inner, texts, f"{place}.", base)
            inner[0] = f"{field.name}: {inner[0]}"
            inner[-1] += ","
            lines += [f"    {line}" for line in inner]
        else:
            complete = False
    if not complete:
        rest = ".".join((base, *path.split(".")[:-1])) if path else f"*{base}"
        lines.append(f"    ..{rest}")
    if len(lines) == 2 and complete:
        return [f"{lines[0]} {lines[1].strip().rstrip(',')} }}"]
    return [*lines, "}"]


def _about(port: Port) -> str:
    """Return text, unit and nominal value of a port."""
    nominal = "" if port.default is None else f"nominal {float(port.default):.6g}"
    return doc(", ".join(part for part in (port.text, port.unit, nominal) if part))


def signature(head: str, parameters: Sequence[str], arrow: str) -> tuple[str, ...]:
    """Return the lines of ``head(parameters) -> … {``.

    Args:
        head: Visibility, ``fn`` and the name.
        parameters: Declarations of the parameters.
        arrow: The type of the result with its arrow, or "".
    """
    line = f"{head}({', '.join(parameters)}){arrow} {{"
    if len(line) <= WIDTH:
        return (line,)
    return (f"{head}(", *(f"    {parameter}," for parameter in parameters), f"){arrow} {{")
