"""``<robot>_many.h`` and ``.c``, with ``--batch``: every function for arrays of states; compiled for NumPy, too.

The source includes ``<robot>.c``, so that a compiler inlines the scalar functions into the loop over the states and
vectorises the loop. Every input and output is a separate array (structure of arrays). Tunable parameters are inputs,
too.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from wmrgen.codegen.c.emit import printed, unit
from wmrgen.codegen.c.functions import call
from wmrgen.codegen.compiler import load_library
from wmrgen.codegen.render import render
from wmrgen.codegen.unit import Step, Unit
from wmrgen.ir.calls import nominal
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Module


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


# ---- compiled by the compiler of the system and loaded for NumPy arrays

Columns = dict[str, Any]  # contract name -> array


def compiled(module: Module, choice: Choice) -> Callable[[str, Mapping[str, Any]], Columns]:
    """Compile the functions of ``module`` for arrays with the compiler of the system, and load them.

    Args:
        module: The functions.
        choice: Scalar type of the C, its sines, and the processor.

    Returns:
        A function that takes the name of a function and its inputs (contract name -> array; tunable parameters that are
        left out are nominal) and returns the outputs by contract name, in the shape to which the inputs broadcast.

    Raises:
        EnvironmentFailure: There is no C compiler, or it fails.
    """
    functions = unit(module, choice)
    header, source, pair = printed(functions)
    scalar = choice.scalar
    common = {"robot": module.name, "upper": module.name.upper(), "scalar": scalar, "pair": pair}
    files = {f"{module.name}.h": header, f"{module.name}.c": source}
    files[f"{module.name}_many.h"], files[f"{module.name}_many.c"] = batch(functions, common)
    library = load_library(files, f"{module.name}_many.c")
    kind: Any = np.float64 if scalar == "double" else np.float32
    defaults, forms = nominal(module), batch_functions(functions)

    def call_compiled(name: str, inputs: Mapping[str, Any]) -> Columns:
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

    return call_compiled


def _pointers(arrays: Any) -> Any:
    """Return a C struct whose members point to the arrays."""
    addresses = [array.ctypes.data for array in arrays]
    return (ctypes.c_void_p * max(1, len(addresses)))(*addresses)
