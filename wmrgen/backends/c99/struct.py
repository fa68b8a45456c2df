"""Ports as C structs: one member per scalar, one nested struct per wheel."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from wmrgen.backends.c99.literal import WIDTH, comment_lines, comment_text
from wmrgen.ir.nodes import Port


@dataclass(frozen=True, slots=True)
class Struct:
    """``lines`` of the typedef; ``members``: contract name -> member path (``left.spin``)."""

    name: str
    lines: tuple[str, ...]
    members: Mapping[str, str]


def _identifier(name: str, taken: Iterable[str]) -> str:
    result = re.sub(r"[^A-Za-z0-9_]", "_", name)
    if not result[:1].isalpha():
        result = "k" + result
    while result in taken:
        result += "_"
    return result


def _paths(ports: tuple[Port, ...]) -> dict[str, tuple[str, str]]:
    """Contract name -> (wheel or "", member), in C identifiers free of clashes at each level."""
    paths: dict[str, tuple[str, str]] = {}
    top: set[str] = set()
    for port in ports:
        if "." not in port.name:
            member = _identifier(port.name, top)
            top.add(member)
            paths[port.name] = ("", member)
    wheels: dict[str, str] = {}
    inside: dict[str, set[str]] = {}
    for port in ports:
        wheel, _, member = port.name.partition(".")
        if not member:
            continue
        if wheel not in wheels:
            wheels[wheel] = _identifier(wheel, top)
            top.add(wheels[wheel])
            inside[wheel] = set()
        name = _identifier(member, inside[wheel])
        inside[wheel].add(name)
        paths[port.name] = (wheels[wheel], name)
    return paths


def _commented(declaration: str, indent: str, column: int, port: Port) -> list[str]:
    """``declaration`` with unit and text of ``port``: behind it where that fits, else above."""
    note = comment_text(f"[{port.unit}] {port.text}" if port.unit else port.text)
    if not note:
        return [indent + declaration]
    line = (indent + declaration).ljust(column) + f" /* {note} */"
    if len(line) <= WIDTH:
        return [line]
    notes = comment_lines(note, WIDTH - len(indent) - 6)
    return [*(f"{indent}/* {text} */" for text in notes), indent + declaration]


def _group(wheel: str, members: list[tuple[str, str, Port]]) -> list[tuple[str, str, Port | None]]:
    """(indent, declaration, port) of a wheel: on one line when it has one member."""
    if len(members) == 1:
        scalar, name, port = members[0]
        return [("    ", f"struct {{ {scalar} {name}; }} {wheel};", port)]
    inner: list[tuple[str, str, Port | None]] = [
        ("        ", f"{scalar} {name};", port) for scalar, name, port in members
    ]
    return [("    ", "struct {", None), *inner, ("    ", f"}} {wheel};", None)]


def struct(name: str, ports: tuple[Port, ...], scalar: str, note: str) -> Struct:
    """The typedef ``name`` for ``ports``, which must not be empty (C99 has no empty struct)."""
    paths = _paths(ports)
    groups: dict[str, list[tuple[str, str, Port]]] = {"": []}
    for port in ports:
        wheel, member = paths[port.name]
        groups.setdefault(wheel, []).append((scalar, member, port))
    rows: list[tuple[str, str, Port | None]] = [
        ("    ", f"{scalar} {member};", port) for scalar, member, port in groups.pop("")
    ]
    for wheel, members in groups.items():
        rows += _group(wheel, members)
    column = max(len(indent + declaration) for indent, declaration, port in rows if port)
    lines = [f"/* {line} */" for line in comment_lines(note, WIDTH - 6)] + ["typedef struct {"]
    for indent, declaration, noted in rows:
        lines += _commented(declaration, indent, column, noted) if noted else [indent + declaration]
    members_of = {key: f"{wheel}.{member}" if wheel else member for key, (wheel, member) in paths.items()}
    ordered = {port.name: members_of[port.name] for port in ports}
    return Struct(name, (*lines, f"}} {name};"), ordered)
