"""Names, numbers and structs of Rust: what signatures and bodies are made of."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.nodes import Port
from wmrgen.ir.rounding import constant

WIDTH = 100  # columns
_LONGEST = 12  # digits of a number without an exponent
SCALARS = {"float": "f32", "double": "f64"}
_KEYWORDS = frozenset(
    """
abstract as async await become box break const continue do dyn else enum extern false final fn for gen if impl in let
loop macro match mod move mut override priv pub ref return static struct trait true try type typeof unsafe unsized use
virtual where while yield
""".split()
)


def identifier(name: str) -> str:
    """A name of Rust like ``name``."""
    text = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return f"r#{text}" if text in _KEYWORDS else text


def type_name(*names: str) -> str:
    """``SteerRate`` for ``steer_rate``; several names become one."""
    parts = (part for name in names for part in re.split(r"[^A-Za-z0-9]+", name))
    return "".join(part[:1].upper() + part[1:] for part in parts)


def package(robot: str) -> str:
    """What Cargo calls the crate of a robot."""
    return f"{robot.lower().replace('_', '-')}-kinematics"


def crate(robot: str) -> str:
    """What Rust calls it."""
    return package(robot).replace("-", "_")


def number(value: float, scalar: str) -> str:
    """The shortest decimal that reads back as ``value``, a float32 for ``f32``."""
    kind = np.float32 if scalar == "f32" else np.float64
    plain = np.format_float_positional(kind(value), trim="0")
    return plain if len(plain) <= _LONGEST else str(kind(value))


def literal(value: Exact, scalar: str) -> str:
    """``value``, rounded once. NotDerivableError where it leaves the range of the type."""
    return number(constant(value, single=scalar == "f32"), scalar)


def doc(text: str) -> str:
    """``text`` on one line of documentation, without links and tags."""
    return re.sub(r"([\[\]<>`\\])", r"\\\1", " ".join(text.split()))


def sentence(text: str) -> str:
    """``text`` as documentation, with a capital and a full stop."""
    return doc(text[:1].upper() + text[1:] + ("" if text.endswith(".") else ".")) if text else ""


def wrapped(text: str, first: str = "") -> list[str]:
    """``text`` in lines of documentation."""
    return textwrap.wrap(first + text, WIDTH - 4, subsequent_indent=" " * len(first), break_on_hyphens=False)


class Field(NamedTuple):
    """``type``: a scalar, or the struct of a wheel, whose members are ``inner``."""

    name: str
    type: str
    doc: str
    inner: tuple[Field, ...] = ()


class Struct(NamedTuple):
    """``paths``: contract name -> path of the member (``left.spin``)."""

    name: str
    doc: str
    fields: tuple[Field, ...]
    paths: Mapping[str, str]

    def value(self, texts: Mapping[str, str], base: str = "") -> list[str]:
        """The lines of an expression: members by contract name, those that ``texts`` lacks as in ``base``."""
        by_path = {self.paths[name]: text for name, text in texts.items()}
        return _value(self.name, self.fields, by_path, "", base)


def _value(name: str, fields: Sequence[Field], texts: Mapping[str, str], path: str, base: str) -> list[str]:
    lines, whole = [f"{name} {{"], True
    for field in fields:
        place = f"{path}{field.name}"
        if place in texts:
            text = texts[place]
            lines.append(f"    {field.name}," if text == field.name else f"    {field.name}: {text},")
        elif any(p.startswith(f"{place}.") for p in texts):
            inner = _value(field.type, field.inner, texts, f"{place}.", base)
            lines += (f"    {line}" for line in f"{field.name}: {chr(10).join(inner)},".split("\n"))
        else:
            whole = False
    lines += [] if whole else [f"    ..{'.'.join((base, *path.split('.')[:-1])) if path else '*' + base}"]
    if len(lines) == 2 and whole:
        return [f"{lines[0]} {lines[1].strip().rstrip(',')} }}"]
    return [*lines, "}"]


def struct(name: str, ports: Sequence[Port], scalar: str, text: str) -> Struct:
    """The struct ``name`` of ``ports``: a member of its own for each wheel."""
    fields: dict[str, list[Field]] = {}
    paths: dict[str, str] = {}
    plain = {identifier(port.name) for port in ports if "." not in port.name}
    for port in ports:
        wheel, _, last = port.name.rpartition(".")
        member = group = identifier(last)
        if wheel:
            group = identifier(wheel)
            group += "_" * (group in plain)  # a name without a dot keeps its own
        paths[port.name] = f"{group}.{member}" if wheel else member
        fields.setdefault(group, []).append(Field(member, scalar, _about(port)))
    return Struct(name, text, tuple(_field(group, own, paths) for group, own in fields.items()), paths)


def _field(name: str, own: Sequence[Field], paths: Mapping[str, str]) -> Field:
    if name in paths.values():
        return own[0]
    return Field(name, type_name(*(field.name for field in own)), "", tuple(own))


def _about(port: Port) -> str:
    """Text, unit and nominal value."""
    nominal = "" if port.default is None else f"nominal {float(port.default):.6g}"
    return doc(", ".join(part for part in (port.text, port.unit, nominal) if part))


def signature(head: str, parameters: Sequence[str], arrow: str) -> tuple[str, ...]:
    """The lines of ``head(parameters) -> … {``."""
    line = f"{head}({', '.join(parameters)}){arrow} {{"
    if len(line) <= WIDTH:
        return (line,)
    return (f"{head}(", *(f"    {parameter}," for parameter in parameters), f"){arrow} {{")
