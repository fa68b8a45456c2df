"""A driftless control system q' = g_1(q) u_1 + ... + g_m(q) u_m, as every kinematic model is (Tzafestas (2.32))."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import Port, Role
from wmrgen.geometry.symbolic import (
    Expr,
    Local,
    Parameter,
    absolute,
    add,
    at_least,
    maximum,
    select,
    signal,
    times,
)


class Domain(NamedTuple):
    """A condition of a model: it holds if ``expression`` is not zero."""

    expression: Expr
    text: str  # what happens where it is zero, with names in backticks


class System(NamedTuple):
    """State q, inputs u and vector fields. The symbol of a port is ``signal(port.name)``."""

    name: str
    text: str
    state: tuple[Port, ...]
    inputs: tuple[Port, ...]
    # ``fields[k][i]``: component i of g_k, an exact expression in the state and in ``geometry``
    fields: tuple[tuple[Expr, ...], ...]
    # parameters that remain symbols, ``parameter(port.name)``: the tunable ones, or all in the symbolic
    # view
    geometry: tuple[Port, ...] = ()
    domain: tuple[Domain, ...] = ()
    # the same rates by way of the twist, in fewer operations; None if the fields are as short
    code: Callable[[], Formula] | None = None

    @property
    def G(self) -> sympy.Matrix:
        """Return G of q' = G(q) u, (states) x (inputs): column k is the vector field of input k."""
        return sympy.Matrix(len(self.state), len(self.inputs), lambda i, k: self.fields[k][i])

    @property
    def rates(self) -> tuple[Expr, ...]:
        """Return q' as expressions in state, inputs and geometry, in the order of the state."""
        pairs = [(field, signal(u.name)) for field, u in zip(self.fields, self.inputs, strict=True)]
        rates = []
        for i in range(len(self.state)):
            rates.append(add(*(times(field[i], u) for field, u in pairs)))
        return tuple(rates)

    def formula(self, guards: bool = True) -> Formula:
        """Return the function from state and inputs to the rates of the state.

        With ``guards`` a quotient is 0 if a divisor of the model vanishes. Optimisers are faster without them.
        """
        inputs = (*self.state, *self.inputs, *self.geometry)
        if self.code:
            plain = replace(self.code(), name=self.name, inputs=inputs, text=self.text)
        else:
            rates = tuple(zip(map(rate_port, self.state), self.rates, strict=True))
            plain = Formula(self.name, inputs, (), rates, self.text)
        return with_guards(plain) if guards else plain


class Lag(NamedTuple):
    """A steering angle that follows its command with first-order lag."""

    command: Port  # wanted angle [rad]
    rate: Expr  # rad/s
    constant: Exact  # time constant [s]


def with_commands(text: str, lags: Mapping[str, Lag]) -> str:
    """Return a description of a model with commands in place of the rates that follow from them."""
    for name, lag in lags.items():
        text = text.replace(name, lag.command.name)
    return text


def rate_port(port: Port) -> Port:
    """Return the port of the rate: ``x`` -> ``x_rate``, ``front.steer`` -> ``front.steer_rate``, ``front.angle`` ->
    ``front.spin``."""
    name = f"{port.name[:-6]}.spin" if port.name.endswith(".angle") else f"{port.name}_rate"
    unit = f"{port.unit}/s" if port.unit else "1/s"
    return Port(name, Role.COMMAND, unit, f"rate of {port.name}")


SMALLEST = sympy.Rational(1, 10**9)  # a smaller divisor, in its SI unit, is treated as zero


class Gate(NamedTuple):
    """A condition: open if |value| is at least ``least``."""

    value: Expr
    least: Expr

    def choose(self, closed: Expr, opened: Expr) -> Expr:
        """Return ``opened`` if the gate is open, else ``closed``."""
        return select(absolute(self.value), self.least, closed, opened)

    def inverse(self, names: Locals, divisor: Expr, kept: str, name: str, power: Expr = -1) -> Local:
        """Return divisor**power, or 0 if the gate is closed.

        The divisor gets a lower bound first, so that neither the value nor a derivative is NaN there.

        Args:
            names: Takes the intermediate results.
            divisor: The divisor.
            kept: The name of the divisor with the lower bound.
            name: The name of the result.
            power: A negative power.
        """
        same = divisor == self.value
        safe = names.define(
            kept, at_least(divisor, self.least) if same else self.choose(sympy.S.One, divisor)
        )
        return names.define(name, self.choose(sympy.S.Zero, sympy.Pow(safe, power, evaluate=False)))


def guarded(expr: Expr, names: Locals, memo: dict[Expr, Expr]) -> Expr:
    """Return ``expr`` with every 1/d replaced by a local that is 0 if d is 0, and roots without negative arguments.

    Divisors that consist of geometry alone are not changed. The argument of a root is a sum of squares, multiplied
    out, which rounding may make negative.

    Args:
        expr: The expression.
        names: Takes the intermediate results.
        memo: Results of shared parts.
    """
    if not expr.args:
        return expr
    if expr in memo:
        return memo[expr]
    if _divides(expr):
        base = guarded(expr.base, names, memo)
        number = sum(symbol.name.startswith("divisor") for symbol, _ in names.items)
        kept, inverse = f"divisor{number + 1}", f"over{number + 1}"
        result = Gate(base, SMALLEST).inverse(names, base, kept, inverse, expr.exp)
    else:
        args = [guarded(a, names, memo) for a in expr.args]
        if isinstance(expr, sympy.Pow) and expr.exp == sympy.S.Half and _moves(expr.base):
            args[0] = maximum(sympy.S.Zero, args[0])
        result = _rebuilt(expr, args)
    memo[expr] = result
    return result


def with_guards(formula: Formula) -> Formula:
    """Return ``formula`` with every quotient 0 if its divisor is 0: see `guarded`."""
    names, memo = Locals(), dict[Expr, Expr]()
    for symbol, value in formula.locals:
        names.define(symbol.name, guarded(value, names, memo))
    calls = []
    for call in formula.calls:
        args = tuple(guarded(a, names, memo) for a in call.args)
        calls.append(call._replace(args=args))
    names.calls = calls
    outputs = [(port, guarded(value, names, memo)) for port, value in formula.outputs]
    return names.formula(formula.name, formula.inputs, outputs, formula.text)


def _divides(expr: Expr) -> bool:
    """Return whether an expression is a quotient by more than geometry."""
    if not isinstance(expr, sympy.Pow) or not expr.exp.is_Rational or expr.exp >= 0:
        return False
    return _moves(expr.base)


def _moves(expr: Expr) -> bool:
    """Return whether an expression consists of more than geometry."""
    return any(not isinstance(s, Parameter) for s in expr.free_symbols)


def _rebuilt(expr: Expr, args: list[Expr]) -> Expr:
    """Return ``expr`` with new arguments, unchanged if they are the same."""
    if all(a is b for a, b in zip(args, expr.args, strict=True)):
        return expr
    if isinstance(expr, sympy.Add):
        return add(*args)
    if isinstance(expr, sympy.Mul):
        return times(*args)
    if isinstance(expr, sympy.Pow):
        return sympy.Pow(*args, evaluate=False)
    return expr.func(*args)
