"""``<robot>_many.h`` and ``.c``, with ``--batch``: every function over arrays of states, for processors with vectors.

The source includes ``<robot>.c``, so that a compiler can inline the scalar functions into the loop over the states.
Every input and output is an array of its own (structure of arrays). Tunable parameters are inputs like the others.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from wmrgen.backends.c99.emit import printed, unit
from wmrgen.backends.c99.records import Step, Unit
from wmrgen.compiler import load_library
from wmrgen.ir.calls import nominal
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Module
from wmrgen.render import render

Columns = dict[str, Any]


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


def compiled(module: Module, choice: Choice) -> Callable[[str, Mapping[str, Any]], Columns]:
    """Compile the functions of ``module`` over arrays with the compiler of the system, and load them.

    Args:
        module: The functions.
        choice: Scalar type of the C, its sines, and the processor.

    Returns:
        A function of a function's name and its inputs (contract name -> array; tunables left out are nominal) that
        gives its outputs by contract name, in the shape to which the inputs broadcast.

    Raises:
        EnvironmentFailure: There is no C compiler, or it fails.
    """
    functions = unit(module, choice)
    header, source, pair = printed(functions)
    scalar = choice.scalar
    texts = batch(
        functions, {"robot": module.name, "upper": module.name.upper(), "scalar": scalar, "pair": pair}
    )
    files = {f"{module.name}.h": header, f"{module.name}.c": source}
    files |= {f"{module.name}_many.{end}": text for end, text in zip("hc", texts, strict=True)}
    library = load_library(files, f"{module.name}_many.c")
    kind: Any = np.float64 if scalar == "double" else np.float32
    defaults, forms = nominal(module), many(functions)

    def call(name: str, inputs: Mapping[str, Any]) -> Columns:
        form = forms[name]
        given = {**defaults, **inputs}
        arrays = np.broadcast_arrays(*(np.asarray(given[port], dtype=kind) for port in form.inputs))
        shape = arrays[0].shape if arrays else ()
        flat = [np.ascontiguousarray(array).reshape(-1) for array in arrays]
        results = {port: np.empty(shape, kind) for port in form.outputs}
        function = getattr(library, form.name)
        function.restype = None
        function(ctypes.c_size_t(int(np.prod(shape))), _pointers(flat), _pointers(results.values()))
        return {port: array[()] for port, array in results.items()}

    return call


def _pointers(arrays: Any) -> Any:
    """A C struct whose members point to the arrays."""
    addresses = [array.ctypes.data for array in arrays]
    return (ctypes.c_void_p * max(1, len(addresses)))(*addresses)
