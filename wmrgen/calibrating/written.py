"""A robot file with other values of its parameters, every other character as it was."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from wmrgen.spec.load import read_robot


def with_values(path: Path, values: Mapping[str, float]) -> str:
    """The text of a robot file with ``values`` [m, rad] in place of those that it gives the parameters."""
    lines = path.read_bytes().decode("utf-8").split("\n")
    parameters = [p for p in read_robot(path).parameters if p.name in values]
    for p in sorted(parameters, key=lambda p: (p.value.mark.line, p.value.mark.column), reverse=True):
        line, column = p.value.mark.line - 1, p.value.mark.column - 1
        text = lines[line]
        start = text.index(p.value.text, column)
        lines[line] = f"{text[:start]}{values[p.name]:.8g}{text[start + len(p.value.text) :]}"
    return "\n".join(lines)
