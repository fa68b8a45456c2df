"""SymForce's code generator: its cse and its C++ printer, the lines made C for float."""

from __future__ import annotations

import importlib.util
import re

import sympy

from benchmarks.others.decimals import decimals, with_plain_functions
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.symbolic import signal

_CPP = re.compile(r"std::(\w+)(?:<Scalar>)?|\bScalar\b|\bx(\d+)\b")
_OTHER_NAMES = {"max": "fmax", "min": "fmin", "abs": "fabs"}


def present() -> bool:
    return importlib.util.find_spec("symforce") is not None


def source(
    derivation: Derivation, function: str, outputs: tuple[str, ...]
) -> tuple[str, str, tuple[str, ...]] | None:
    """C of some outputs, the name of its function and the inputs; None for what SymForce cannot print."""
    import symforce.symbolic as sf
    from symengine import SympifyError
    from symforce.codegen import CppConfig
    from symforce.codegen.codegen_util import print_code
    from symforce.values import Values

    formula = derivation.formula(function)
    closed = {
        name: with_plain_functions(value) for name, value in formula.closed().items() if name in outputs
    }
    inputs = tuple(port.name for port in formula.inputs)
    plain = {signal(name): sympy.Symbol(f"x{k}", real=True) for k, name in enumerate(inputs)}
    plain |= decimals([closed[name] for name in outputs])
    try:
        values = Values({f"y{k}": sf.S(closed[name].xreplace(plain)) for k, name in enumerate(outputs)})
        code = print_code(
            Values({f"x{k}": sf.Symbol(f"x{k}") for k in range(len(inputs))}), values, {}, CppConfig()
        )
    except (TypeError, ValueError, NotImplementedError, AttributeError, RuntimeError, SympifyError):
        return None
    name = f"symforce_{derivation.robot.name}_{function}"
    lines = ["#include <math.h>", "#include <stdbool.h>", f"void {name}(const float *x, float *y)", "{"]
    lines += [f"    const float {left} = {_in_c(right)};" for left, right in code.intermediate_terms]
    lines += [f"    y[{k}] = {_in_c(output.terms[0][1])};" for k, output in enumerate(code.dense_terms)]
    return "\n".join([*lines, "}", ""]), name, inputs


def _in_c(text: object) -> str:
    def one(match: re.Match[str]) -> str:
        if match[1]:
            return f"{_OTHER_NAMES.get(match[1], match[1])}f"
        return f"x[{match[2]}]" if match[2] else "(float)"

    return _CPP.sub(one, str(text))
