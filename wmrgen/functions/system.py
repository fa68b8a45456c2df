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
    """The model holds where ``expression`` is not zero; ``text`` says what happens there, names in backticks."""

    expression: Expr
    text: str


class System(NamedTuple):
    """State q, inputs u and vector fields. The symbol of a port is ``signal(port.name)``.

    ``fields[k][i]``: component i of g_k, an exact expression in the state and in ``geometry``: the tunable
    parameters, or in the symbolic view all of them; the symbol of those is ``parameter(port.name)``.
    ``code`` returns the same rates by way of the twist, in the fewest operations; None if the fields say it as shortly.
    """

    name: str
    text: str
    state: tuple[Port, ...]
    inputs: tuple[Port, ...]
    fields: tuple[tuple[Expr, ...], ...]
    geometry: tuple[Port, ...] = ()
    domain: tuple[Domain, ...] = ()
    code: Callable[[], Formula] | None = None

    @property
    def G(self) -> sympy.Matrix:
        """(states) x (inputs): q' = G(q) u. Column k is the vector field of input k."""
        return sympy.Matrix(len(self.state), len(self.inputs), lambda i, k: self.fields[k][i])

    @property
    def rates(self) -> tuple[Expr, ...]:
        """q' as expressions in state, inputs and geometry, in the order of the state."""
        pairs = [(field, signal(u.name)) for field, u in zip(self.fields, self.inputs, strict=True)]
        return tuple(add(*(times(field[i], u) for field, u in pairs)) for i in range(len(self.state)))

    def formula(self, guards: bool = True) -> Formula:
        """State and inputs to the rates of the state. Where a divisor of the model vanishes its quotient reads 0, but
        without ``guards``, which cost an optimiser time."""
        inputs = (*self.state, *self.inputs, *self.geometry)
        if self.code:
            plain = replace(self.code(), name=self.name, inputs=inputs, text=self.text)
        else:
            rates = tuple(zip(map(rate_port, self.state), self.rates, strict=True))
            plain = Formula(self.name, inputs, (), rates, self.text)
        return with_guards(plain) if guards else plain


class Lag(NamedTuple):
    """A steering angle that follows its ``command`` [rad] at ``rate`` [rad/s], with a time ``constant`` [s]."""

    command: Port
    rate: Expr
    constant: Exact


def of_commands(text: str, lags: Mapping[str, Lag]) -> str:
    """What is said of a model, with commands in place of the rates that follow from them."""
    for name, lag in lags.items():
        text = text.replace(name, lag.command.name)
    return text


def rate_port(port: Port) -> Port:
    """``x`` -> ``x_rate``, ``front.steer`` -> ``front.steer_rate``, ``front.angle`` -> ``front.spin``."""
    name = f"{port.name[:-6]}.spin" if port.name.endswith(".angle") else f"{port.name}_rate"
    unit = f"{port.unit}/s" if port.unit else "1/s"
    return Port(name, Role.COMMAND, unit, f"rate of {port.name}")


SMALLEST = sympy.Rational(1, 10**9)  # a divisor nearer to zero than this counts as zero


class Gate(NamedTuple):
    """Open where |value| is at least ``least``."""

    value: Expr
    least: Expr

    def choose(self, closed: Expr, opened: Expr) -> Expr:
        """``opened`` where the gate is open."""
        return select(absolute(self.value), self.least, closed, opened)

    def inverse(self, names: Locals, divisor: Expr, kept: str, name: str, power: Expr = -1) -> Local:
        """``name`` = divisor**power, power < 0: 0 where the gate is closed.

        The divisor itself is ``kept`` off zero, so that neither the value nor a derivative is NaN there.
        """
        same = divisor == self.value
        safe = names.define(
            kept, at_least(divisor, self.least) if same else self.choose(sympy.S.One, divisor)
        )
        return names.define(name, self.choose(sympy.S.Zero, sympy.Pow(safe, power, evaluate=False)))


def guarded(expr: Expr, names: Locals, memo: dict[Expr, Expr]) -> Expr:
    """``expr`` with every 1/d, d not of geometry alone, replaced by a local that is 0 where d is, and what stands under
    a root kept from falling below 0 by rounding: it is a sum of squares, multiplied out.

    ``memo`` keeps what shared parts became.
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
    """``formula`` with every quotient 0 where its divisor, not of geometry alone, is: see `guarded`."""
    names, memo = Locals(), dict[Expr, Expr]()
    for symbol, value in formula.locals:
        names.define(symbol.name, guarded(value, names, memo))
    names.calls = [
        call._replace(args=tuple(guarded(a, names, memo) for a in call.args)) for call in formula.calls
    ]
    outputs = [(port, guarded(value, names, memo)) for port, value in formula.outputs]
    return names.formula(formula.name, formula.inputs, outputs, formula.text)


def _divides(expr: Expr) -> bool:
    if not isinstance(expr, sympy.Pow) or not expr.exp.is_Rational or expr.exp >= 0:
        return False
    return _moves(expr.base)


def _moves(expr: Expr) -> bool:
    """It is not of geometry alone."""
    return any(not isinstance(s, Parameter) for s in expr.free_symbols)


def _rebuilt(expr: Expr, args: list[Expr]) -> Expr:
    if all(a is b for a, b in zip(args, expr.args, strict=True)):
        return expr
    if isinstance(expr, sympy.Add):
        return add(*args)
    if isinstance(expr, sympy.Mul):
        return times(*args)
    if isinstance(expr, sympy.Pow):
        return sympy.Pow(*args, evaluate=False)
    return expr.func(*args)
