"""Formulas inside formulas: their locals are shared, their inputs replaced, nothing is evaluated."""

from __future__ import annotations

from collections.abc import Mapping

import sympy

from wmrgen.kinematics.records import Formula, Locals
from wmrgen.symbolic import Expr, signal, times


def include(formula: Formula, inputs: Mapping[str, Expr], names: Locals) -> dict[str, Expr]:
    """Add the locals of ``formula`` to ``names``; output name -> expression.

    ``inputs`` replaces inputs by port name; those that it does not name stay inputs.
    """
    return names.adopt(formula, {signal(name): value for name, value in inputs.items()})


def named(outputs: Mapping[str, Expr], wanted: tuple[str, ...], suffix: str, names: Locals) -> list[Expr]:
    """The wanted outputs as intermediate results ``<name>_<suffix>``; a zero stays zero."""
    return [
        value if (value := outputs[name]) is sympy.S.Zero else names.define(f"{name}_{suffix}", value)
        for name in wanted
    ]


def over(above: Expr, below: Expr) -> Expr:
    """above / below as it stands; ``below`` is kept off zero by the caller."""
    return times(above, sympy.Pow(below, -1, evaluate=below.is_Rational))
