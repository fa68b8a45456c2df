"""The functions over arrays of states, compiled by the compiler of the system and loaded for NumPy arrays."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from wmrgen.codegen.c.batch import batch, many
from wmrgen.codegen.c.emit import printed, unit
from wmrgen.codegen.compiler import load_library
from wmrgen.ir.calls import nominal
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Module

Columns = dict[str, Any]


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
