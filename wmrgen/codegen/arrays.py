"""Arrays: ``<robot>.py``, a Python module for arrays of samples, and the same functions for NumPy without a file.

The module uses the array library of its arguments (https://data-apis.org/array-api): NumPy, JAX, PyTorch or CuPy.
Arguments have the contract names with ``_`` for the dot (``left_spin``). Results are dictionaries by contract name.
Arguments broadcast, and every result has their common shape. The state space takes vectors x, u and p along the last
axis. STATE, INPUTS and PARAMETERS name their entries, LBX to UBU are their bounds, and LBH and UBH are the bounds of
`limits`.
"""

from __future__ import annotations

import keyword
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import islice
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wmrgen.codegen.expression import Style, body, variables
from wmrgen.codegen.registry import Facts, Request, VectorForm
from wmrgen.codegen.render import render
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.calls import complete, self_contained
from wmrgen.ir.interpret import values_of
from wmrgen.ir.nodes import Function, Module
from wmrgen.ir.rounding import to_float64


def _literal(value: Exact) -> str:
    text = repr(to_float64(value))
    return f"({text})" if text.startswith("-") else text


_STYLE = Style(
    literal=_literal,
    form=lambda op: op.arrays,
    declare="{0} = {1}",
    temporary="_t{0}",  # no port or parameter begins with an underscore
    named="_{}".format,
)


# Operations that may get a number and an array, and need both as arrays of the same type.
_MIXED = ("select", "with_sign_of", "at_least", "flip", "atan2")
# Operations that are written differently for libraries whose arrays have derivatives.
_STEEP = ("sqrt", "atan2", "max", "min", "clamp", "at_least")
_OWN = ("xp", "arguments")  # variables of the generated functions


def argument_names(function: Function) -> dict[str, str]:
    """Return the Python argument of each input by contract name."""
    return variables(function, lambda name: name in _OWN or keyword.iskeyword(name))


# ---- as text


def _plain(text: str) -> str:
    """Return ``text`` for a docstring: one line, without quotes or backslashes that could end the docstring."""
    return " ".join(text.replace("\\", "/").replace('"', "'").split())


def _described(name: str, unit: str, text: str) -> str:
    return _plain(f"{name} [{unit}] {text}" if unit else f"{name} {text}")


def _document(function: Function, names: Mapping[str, str]) -> list[str]:
    """Return the docstring of ``function``; ``names``: contract name -> argument."""
    lines = [_plain(function.text) or f"{function.name}.", ""]
    for title, ports, shown in (
        ("Arguments:", function.inputs, names),
        ("Returns:", function.outputs, {p.name: p.name for p in function.outputs}),
    ):
        if ports:
            lines += [title, *(f"    {_described(shown[p.name], p.unit, p.text)}" for p in ports)]
    return lines


def _printed(function: Function) -> dict[str, Any]:
    """Return a function of the module, as finished lines."""
    names = argument_names(function)
    code = body(function, names.__getitem__, _STYLE)
    results = _apart(code.results, names.values())
    return {
        "name": function.name,
        "signature": [
            names[p.name] if p.default is None else f"{names[p.name]}={_literal(p.default)}"
            for p in function.inputs
        ],
        "document": _document(function, names),
        "lines": code.statements,
        "arguments": list(names.values()),
        "results": [f'"{p.name}": {text}' for p, text in zip(function.outputs, results, strict=True)],
        "needs": {op.name for op in code.ops},
    }


def _apart(results: Sequence[str], arguments: Iterable[str]) -> list[str]:
    """Return ``results`` as different arrays, none of which is an argument, because users may change arrays."""
    taken, apart = set(arguments), []
    for text in results:
        apart.append(f"{text} * 1.0" if text in taken else text)
        taken.add(text)
    return apart


def _entries(vectors: Sequence[VectorForm]) -> dict[str, tuple[Any, ...]]:
    """Return the constants of the state space: names of the entries of x, u and p, nominal parameters, bounds."""
    if not vectors:
        return {}
    names = zip(("STATE", "INPUTS", "PARAMETERS"), vectors[0].vectors, strict=True)
    bounds = zip(("LBX", "UBX", "LBU", "UBU", "LBH", "UBH"), vectors[0].bounds, strict=True)
    return {**dict(names), "NOMINAL": vectors[0].nominal, **dict(bounds)}


def _tuple(values: tuple[Any, ...]) -> str:
    """Return a tuple as Python text; Python has no literal for infinity."""
    words = [f"{v!r}" if isinstance(v, str) else f"{v!r}".replace("inf", 'float("inf")') for v in values]
    return f"({', '.join(words)}{',' * (len(words) == 1)})"


def _described_vectors(vector: VectorForm) -> list[str]:
    """Return the docstring of a function of vectors."""
    return [
        _plain(f"{vector.result} of the {vector.function.text}"),
        "",
        "Arrays (..., n): STATE names the entries of x, INPUTS those of u, PARAMETERS those of p.",
    ]


def _of_vectors(vector: VectorForm) -> dict[str, Any]:
    """Return a function of vectors, as finished lines."""
    places: dict[str, str] = {}
    for letter, names in zip("xup", vector.vectors, strict=True):
        places |= {name: f"{letter}[..., {k}]" for k, name in enumerate(names)}
    code = body(vector.function, places.__getitem__, _STYLE)
    document = _described_vectors(vector)
    return {
        "name": vector.name,
        "document": document,
        "lines": code.statements,
        "results": code.results,
        "needs": {op.name for op in code.ops},
    }


def emit(module: Module, facts: Facts) -> dict[str, bytes]:
    """Return ``<robot>.py``, which needs only the library of its arrays."""
    functions = [_printed(function) for function in self_contained(module)]
    vectors = [_of_vectors(vector) for vector in facts.vectors]
    needs = {name for printed in (*functions, *vectors) for name in printed["needs"]}
    text = render(
        "arrays/module.py.j2",
        robot=module.name,
        description=_plain(facts.description),
        wheels=[_plain(line) for line in facts.wheel_lines],
        meta=facts,
        functions=functions,
        constants=[f"{name} = {_tuple(value)}" for name, value in _entries(facts.vectors).items()],
        vectors=vectors,
        needs=needs,
        likes=not needs.isdisjoint(_MIXED),
        differentiates=not needs.isdisjoint(_STEEP),
    )
    return {f"{module.name}.py": text.encode()}


# ---- as callables


def _columns(function: Function, inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Return the outputs of ``function`` for arrays by contract name, in the shape to which the inputs broadcast."""
    arrays = {name: np.asarray(value, dtype=np.float64) for name, value in inputs.items()}
    values = values_of(function, arrays, np.float64)
    shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    return {
        name: np.broadcast_to(value, shape).copy()[()] for name, value in function.outputs_of(values).items()
    }


Columns = Callable[[Function, Mapping[str, Any]], dict[str, Any]]


def _callable(function: Function, columns: Columns) -> Callable[..., dict[str, Any]]:
    """Return ``function`` as a Python function with named arguments; ``columns`` computes its outputs."""
    names = argument_names(function)
    contract = {argument: name for name, argument in names.items()}
    nominal = {port.name: to_float64(port.default) for port in function.inputs if port.default is not None}

    def call(*positional: Any, **named: Any) -> dict[str, Any]:
        if len(positional) > len(names):
            raise TypeError(f"{function.name}() takes {len(names)} arguments, {len(positional)} were given")
        inputs = dict(zip(islice(names, len(positional)), positional, strict=True))
        for key, value in named.items():
            name = contract.get(key, key)  # left_spin=… or **{"left.spin": …}
            if name not in names:
                raise TypeError(f"{function.name}() has no argument {key}; it has {', '.join(contract)}")
            if name in inputs:
                raise TypeError(f"{function.name}() got {key} twice")
            inputs[name] = value
        inputs = {**nominal, **inputs}
        missing = [argument for argument, name in contract.items() if name not in inputs]
        if missing:
            raise TypeError(f"{function.name}() needs {', '.join(missing)}")
        return columns(function, inputs)

    call.__name__ = call.__qualname__ = function.name
    call.__doc__ = "\n".join(_document(function, names))
    return call


def _callable_of_vectors(vector: VectorForm) -> Callable[..., NDArray[np.float64]]:
    """Return a function of vectors as a Python function of x, u and p."""

    def call(x: Any, u: Any, p: Any = vector.nominal) -> NDArray[np.float64]:
        arrays = [np.asarray(values, dtype=np.float64) for values in (x, u, p)]
        values: dict[str, Any] = {}
        for letter, array, names in zip("xup", arrays, vector.vectors, strict=True):
            if array.shape[-1:] != (len(names),):
                raise ValueError(f"{letter} has the shape {array.shape}, not (..., {len(names)})")
            values |= {name: array[..., k] for k, name in enumerate(names)}
        results = vector.function.outputs_of(values_of(vector.function, values, np.float64)).values()
        shape = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
        return np.stack([np.broadcast_to(result, shape) for result in results], -1)

    call.__name__ = call.__qualname__ = vector.name
    call.__doc__ = "\n".join(_described_vectors(vector))
    return call


def functions(
    module: Module, vectors: Sequence[VectorForm] = (), columns: Columns = _columns
) -> SimpleNamespace:
    """Return the functions of ``module`` as attributes, as in the generated file; no text is executed.

    Args:
        module: The functions.
        vectors: The state space as functions of x, u and p.
        columns: Computes the outputs of a function for arrays by contract name.

    Returns:
        One attribute for each function, and the constants of the state space.
    """
    return SimpleNamespace(
        **{function.name: _callable(function, columns) for function in self_contained(module)},
        **{vector.name: _callable_of_vectors(vector) for vector in vectors},
        **_entries(vectors),
    )


def evaluate(module: Module, requests: Sequence[Request]) -> list[dict[str, float]]:
    """Return the outputs of each request by contract name, in float64, with one computation for each function."""
    cases: dict[str, list[Mapping[str, float]]] = {}
    for name, case in requests:
        cases.setdefault(name, []).append(case)
    functions = (function for function in self_contained(module) if function.name in cases)
    rows = {function.name: iter(_rows(function, cases[function.name])) for function in functions}
    return [next(rows[name]) for name, _ in requests]


def _rows(function: Function, cases: Sequence[Mapping[str, float]]) -> list[dict[str, float]]:
    rows = [complete(function, case) for case in cases]
    inputs = {}
    for k, port in enumerate(function.inputs):
        inputs[port.name] = [row[k] for row in rows]
    with np.errstate(all="ignore"):  # infinities and NaN are results
        columns = _columns(function, inputs)
    if not function.inputs:
        return [{name: float(value) for name, value in columns.items()} for _ in cases]
    return [{name: float(column[k]) for name, column in columns.items()} for k in range(len(cases))]
