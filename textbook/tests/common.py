"""Evaluating functions of the library on every backend."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from tests.conftest import ROOT
from textbook import Textbook, textbook
from wmrgen.backends.c99.driver import evaluate_c
from wmrgen.backends.registry import BACKENDS
from wmrgen.ir.interpret import EXACT, evaluate_module
from wmrgen.ir.kernels.choice import Choice

BACKEND_NAMES = ("exact", "casadi", "numpy", "c")
FILE = ROOT / "tests" / "seeds" / "cases.json"
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
        return evaluate_c(book.c_module, name, [case], Choice("double"))[0]
    return BACKENDS[backend].load().evaluate(book.module, name, [case])[0]


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


def matrix(found: Mapping[str, float], name: str, rows: int, columns: int) -> list[list[float]]:
    return [[found[f"{name}{i}{j}"] for j in range(1, columns + 1)] for i in range(1, rows + 1)]
