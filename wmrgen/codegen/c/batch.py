"""``<robot>_many.h`` and ``.c``, with ``--batch``: every function over arrays of states, for processors with vectors.

The source includes ``<robot>.c``, so that a compiler can inline the scalar functions into the loop over the states.
Every input and output is an array of its own (structure of arrays). Tunable parameters are inputs like the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from wmrgen.codegen.c.records import Step, Unit
from wmrgen.codegen.render import render


class Many(NamedTuple):
    """A function over arrays, ready to print. ``inputs`` and ``outputs``: contract name -> array and member."""

    name: str
    inputs: Mapping[str, tuple[str, str]]
    outputs: Mapping[str, tuple[str, str]]
    variables: Mapping[str, str]
    calls: tuple[str, ...]


def many(unit: Unit) -> dict[str, Many]:
    """By name of the robot's function: its form over arrays."""
    return {name: _many(unit, step) for name, step in unit.contract.items()}


def _many(unit: Unit, step: Step) -> Many:
    return Many(
        f"{step.name}_many",
        _arrays(unit.inputs(step)),
        _arrays(step.outputs),
        unit.variables(step),
        tuple(f"{each.call()};" for each in (*unit.before([step])[-1:], step)),
    )


def _arrays(members: Mapping[str, str]) -> dict[str, tuple[str, str]]:
    """Contract name -> name of its array, and member. ``_`` replaces the dot, and follows a name that is taken."""
    arrays: dict[str, tuple[str, str]] = {}
    taken: set[str] = set()
    for name, member in members.items():
        array = name.replace(".", "_")
        while array in taken:
            array += "_"
        taken.add(array)
        arrays[name] = array, member
    return arrays


def batch(unit: Unit, common: Mapping[str, object]) -> tuple[str, str]:
    """The text of header and source; ``common``: what every template is told."""
    functions = [*many(unit).values()]
    header, source = (render(f"c99/many.{end}.j2", **common, functions=functions) for end in ("h", "c"))
    return header, source
