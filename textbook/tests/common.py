"""Evaluating functions of the library on every backend."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from tests.conftest import ROOT
from textbook import Textbook, textbook
from wmrgen.codegen.c.driver import evaluate_c
from wmrgen.codegen.registry import BACKENDS
from wmrgen.ir.interpret import EXACT, evaluate_module
from wmrgen.ir.kernels.choice import Choice

BACKEND_NAMES = ("exact", "casadi", "numpy", "c")
FILE = ROOT / "textbook" / "cases.json"
CASES: dict[str, dict[str, Any]] = {c["id"]: c for c in json.loads(FILE.read_text(encoding="utf-8"))["cases"]}


@cache
def one(name: str) -> Textbook:
    return textbook(name)


def call(backend: str, name: str, **values: float | Sequence[float]) -> dict[str, float]:
    """Outputs by contract name; a sequence of three is a vector, ``v=(1, 2, 3)`` for v.x, v.y, v.z.

    ``left__spin`` stands for ``left.spin``. C is evaluated in double.
    """
    book = one(name)
    case = complete(book, spread(values))
    if backend == "exact":
        found = evaluate_module(book.raw_module, name, case, EXACT)
        return {key: float(value) for key, value in found.items()}
    if backend == "c":
        return evaluate_c(book.c_module, [(name, case)], Choice("double"))[0]
    return BACKENDS[backend].load().evaluate(book.module, [(name, case)])[0]


def spread(values: Mapping[str, float | Sequence[float]]) -> dict[str, float]:
    case: dict[str, float] = {}
    for key, value in values.items():
        name = key.replace("__", ".")
        if isinstance(value, (int, float)):
            case[name] = float(value)
        elif np.ndim(value) == 2:
            for i, row in enumerate(np.asarray(value, float), 1):
                case |= {f"{name}{i}{j}": float(entry) for j, entry in enumerate(row, 1)}
        else:
            case |= {f"{name}.{axis}": float(v) for axis, v in zip("xyz", value, strict=True)}
    return case


def complete(book: Textbook, case: dict[str, float]) -> dict[str, float]:
    ports = {p.name for p in book.raw_module.functions[0].inputs}
    assert case.keys() == ports, (sorted(ports - case.keys()), sorted(case.keys() - ports))
    return case


def vector(found: Mapping[str, float], name: str) -> list[float]:
    return [found[f"{name}.{axis}"] for axis in "xyz"]


def matrix(found: Mapping[str, float], name: str) -> list[list[float]]:
    """The outputs ``m11``, ``m12`` and so on, as many as there are."""
    entries = {key[len(name) :]: value for key, value in found.items() if re.fullmatch(rf"{name}\d\d", key)}
    rows, columns = (sorted({key[k] for key in entries}) for k in (0, 1))
    return [[entries[i + j] for j in columns] for i in rows]


def integrate(rate: Callable[[np.ndarray], np.ndarray], state: Any, t: float, steps: int) -> np.ndarray:
    """Runge-Kutta of order 4."""
    s, h = np.array(state, float), t / steps
    for _ in range(steps):
        a = rate(s)
        b = rate(s + h / 2 * a)
        c = rate(s + h / 2 * b)
        s = s + h / 6 * (a + 2 * b + 2 * c + rate(s + h * c))
    return s
