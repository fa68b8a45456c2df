"""The reference in docs/python.md, made of signatures and docstrings.

``python -m tests.packaging.python_page`` writes it.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any

import wmrgen
from tests.conftest import ROOT
from wmrgen.analysis.kinematics.records import Formula
from wmrgen.analysis.mobility.records import Mobility, Rank, Singularity
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.records import Parameter, Robot, Wheel
from wmrgen.geometry.ports import Port

PAGE = ROOT / "docs" / "python.md"
MARK = "<!-- What follows is written by python -m tests.packaging.python_page. -->\n"
# What backends and other stages take from a derivation.
INTERNAL = set(
    "itself raw_module module c_module c_in_operations bounds bounds_of program default_state_space vector_forms"
    " twist_in_symbols driven nearest measured measured_at_nominal constraints determined system"
    " basis_rows basis_rows_symbolic basis_wheels null_space_symbolic scaled scaled_symbolic bodies ball".split()
)
CLASSES = (Derivation, Robot, Wheel, Parameter, Mobility, Rank, Singularity, Port, Formula, Exact)


def reference() -> str:
    """The part below `MARK`."""
    return "\n".join(_lines()) + "\n"


def page() -> str:
    """The whole page, its reference renewed."""
    head, mark, _ = PAGE.read_text(encoding="utf-8").partition(MARK)
    assert mark, "the page has no place for its reference"
    return head + MARK + "\n" + reference()


def _lines() -> Iterator[str]:
    for function in (wmrgen.load, wmrgen.derive):
        yield from (f"### `wmrgen.{_signature(function)}`", "", *_document(function), "")
    for cls in CLASSES:
        yield from (f"### {cls.__name__}", "", *_document(cls), "")
        rows = list(_members(cls))
        if rows:
            yield from (
                "| name | meaning |",
                "|:--|:--|",
                *(f"| {name} | {what} |" for name, what in rows),
                "",
            )
    yield from ("### Errors", "", "| name | meaning |", "|:--|:--|")
    for error in (wmrgen.RobotFileError, wmrgen.NotDerivableError):
        yield f"| `{error.__name__}` | {_first(error)} |"


def _signature(function: Callable[..., Any]) -> str:
    text = str(inspect.signature(function)).replace("'", "")
    return f"{function.__name__}{text.replace('(self, ', '(').replace('(self)', '()')}"


def _document(thing: Any) -> list[str]:
    """A docstring as Markdown: lists of arguments as lists."""
    lines = []
    for line in inspect.getdoc(thing).splitlines():  # type: ignore[union-attr]
        heading = re.fullmatch(r"(Args|Returns|Raises):", line)
        argument = re.fullmatch(r"    (\w+): (.*)", line)
        if heading:
            lines += [f"{heading[1]}:", ""]
        elif argument:
            lines.append(f"* `{argument[1]}`: {argument[2]}")
        else:
            lines.append(f"  {line.strip()}" if line.startswith("    ") else line)
    return [line.replace("``", "`") for line in lines]


def _first(thing: Any) -> str:
    """The first paragraph of a docstring on one line."""
    text = " ".join((inspect.getdoc(thing) or "").partition("\n\n")[0].split())
    return text.replace("``", "`").replace("|", "\\|")


def _members(cls: type) -> Iterator[tuple[str, str]]:
    """Name and meaning of each public attribute, in the order in which they are written, bases first."""
    if cls is Derivation:
        yield "`robot`", "The robot, from `load`."
    for kind in (k for k in reversed(cls.__mro__) if k.__module__.startswith("wmrgen")):
        for name, annotation in inspect.get_annotations(kind).items():
            if not name.startswith("_") and name not in INTERNAL:
                text = getattr(annotation, "__forward_arg__", annotation)
                yield f"`{name}`", f"`{text}`".replace("|", "\\|")
        for name, value in vars(kind).items():
            if name.startswith("_") or name in INTERNAL:
                continue
            if isinstance(value, property | cached_property):
                yield f"`{name}`", _first(value)
            elif inspect.isfunction(value):
                yield f"`{_signature(value)}`".replace("|", "\\|"), _first(value)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
