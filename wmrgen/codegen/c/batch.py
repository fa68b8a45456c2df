"""``<robot>_many.h`` and ``.c``, with ``--batch``: every function for arrays of states.

The source includes ``<robot>.c``, so that a compiler inlines the scalar functions into the loop over the states and
vectorises the loop. Every input and output is a separate array (structure of arrays). Tunable parameters are inputs,
too.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from wmrgen.codegen.c.functions import call
from wmrgen.codegen.render import render
from wmrgen.codegen.unit import Step, Unit


class BatchFunction(NamedTuple):
    """A function for arrays, ready to print."""

    name: str
    inputs: Mapping[str, tuple[str, str]]  # contract name -> array, and member of a variable
    outputs: Mapping[str, tuple[str, str]]
    variables: Mapping[str, str]  # name -> type
    calls: tuple[str, ...]


def batch_functions(unit: Unit) -> dict[str, BatchFunction]:
    """Return every function of a robot for arrays, by the name of the function."""
    return {name: _batch_function(unit, step) for name, step in unit.contract.items()}


def _batch_function(unit: Unit, step: Step) -> BatchFunction:
    prepare = unit.before([step])[-1:]  # without params_default: the parameters are inputs
    return BatchFunction(
        f"{step.name}_many",
        _arrays(unit.inputs(step)),
        _arrays(step.outputs),
        unit.variables(step),
        tuple(f"{call(each)};" for each in (*prepare, step)),
    )


def _arrays(members: Mapping[str, str]) -> dict[str, tuple[str, str]]:
    """Return the name of the array and the member for each contract name; ``_`` replaces the dot."""
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
    """Return the text of header and source; ``common``: variables of every template."""
    functions = [*batch_functions(unit).values()]
    header, source = (render(f"c99/many.{end}.j2", **common, functions=functions) for end in ("h", "c"))
    return header, source
