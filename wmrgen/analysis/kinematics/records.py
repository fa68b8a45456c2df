"""A function of the model: named inputs, named intermediate results, named outputs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import sympy
from sympy.functions.elementary.piecewise import ExprCondPair

from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import JOINTS, Limits, Port, Role
from wmrgen.geometry.symbolic import (
    Compensated,
    Expr,
    Local,
    Operation,
    expression,
    local,
    rotated,
    signal,
    times,
)

_LAZY = (
    sympy.Add, sympy.Mul, sympy.Pow, sympy.Max, sympy.Min, sympy.Abs, sympy.atan, sympy.atan2, Operation,
    sympy.StrictLessThan,
)  # fmt: skip


def substituted(expr: Expr, values: dict[Expr, Expr], memo: dict[Expr, Expr]) -> Expr:
    """``expr`` with ``values`` put in and nothing evaluated: comparing nested maxima would take sympy minutes.

    ``memo`` keeps what shared parts became.
    """
    if not expr.args:
        return values.get(expr, expr)
    if expr not in memo:
        args = [substituted(a, values, memo) for a in expr.args]
        if all(new is old for new, old in zip(args, expr.args, strict=True)):
            memo[expr] = expr
        elif isinstance(expr, Compensated):
            memo[expr] = Compensated(*args)
        elif isinstance(expr, (sympy.Piecewise, ExprCondPair)):
            # Their constructors fold every piecewise condition, even unevaluated.
            memo[expr] = sympy.Basic.__new__(type(expr), *args)
        elif isinstance(expr, _LAZY):
            memo[expr] = expr.func(*args, evaluate=False)
        else:
            memo[expr] = expr.func(*args)
    return memo[expr]


class Call(NamedTuple):
    """Intermediate results that a kernel computes: ``results`` are the outputs of ``kernel`` for ``args``, in order.

    The formula says all the same what they are, in base operations.
    """

    kernel: Formula
    args: tuple[Expr, ...]
    results: tuple[Local, ...]


@dataclass(frozen=True, slots=True)
class Formula:
    """One function of the model in symbols. ``locals`` may refer to earlier ones; ``calls`` says which of them are
    results of kernels, which generated C keeps as functions of their own.

    ``source``, ``limits`` and ``in_place`` are those of its declaration, see `wmrgen.functions.registry`.
    ``quantities``: what reports call intermediate results, by name, where their names do not say it.
    """

    name: str
    inputs: tuple[Port, ...]
    locals: tuple[tuple[Local, Expr], ...]
    outputs: tuple[tuple[Port, Expr], ...]
    text: str
    source: str = ""
    limits: Limits = Limits.NONE
    in_place: bool = False
    calls: tuple[Call, ...] = ()
    quantities: tuple[tuple[str, str], ...] = ()

    def closed(self) -> dict[str, Expr]:
        """Output name -> expression in the inputs alone."""
        values: dict[Expr, Expr] = {}
        memo: dict[Expr, Expr] = {}
        for symbol, expr in self.locals:
            values[symbol] = substituted(expr, values, memo)
        return {port.name: substituted(expr, values, memo) for port, expr in self.outputs}


# The vector of a size at an angle: generated C has it as a kernel of the library, `wmrgen.ir.kernels.trigonometry`.
VECTOR_AT = Formula(
    "vector_at",
    (Port("size", Role.STATE, "", ""), Port("angle", Role.STATE, "rad", "")),
    (),
    (
        (Port("x", Role.COMMAND, "", ""), times(signal("size"), sympy.cos(signal("angle")))),
        (Port("y", Role.COMMAND, "", ""), times(signal("size"), sympy.sin(signal("angle")))),
    ),
    "The vector of this size at this angle: size (cos angle, sin angle).",
)


class Locals:
    """Collects intermediate results while a formula is written down.

    Each has a name of its own: a wheel called ``mean`` has a ``mean_bx``, and so may the formula.
    """

    def __init__(self) -> None:
        self.items: list[tuple[Local, Expr]] = []
        self.calls: list[Call] = []
        self.quantities: dict[str, str] = {}
        self._names: set[str] = set()

    def copy(self) -> Locals:
        """The same intermediate results, to which others can be added."""
        other = Locals()
        other.items, other.calls = list(self.items), list(self.calls)
        other.quantities, other._names = dict(self.quantities), set(self._names)
        return other

    def define(self, name: str, value: Expr | Poly, quantity: str = "") -> Local:
        """A new intermediate result; returns its symbol, numbered where the name is taken.

        ``quantity``: what the report calls it, in ASCII, for comments of generated code.
        """
        symbol, number = local(name), 2
        while symbol.name in self._names:
            symbol, number = local(f"{name}_{number}"), number + 1
        self._names.add(symbol.name)
        if quantity:
            self.quantities[symbol.name] = quantity
        self.items.append((symbol, expression(value) if isinstance(value, Poly) else value))
        return symbol

    def vector_at(self, name: str, size: Expr, angle: Expr) -> tuple[Local, Local]:
        """Both components of the vector of this size at this angle, new intermediate results of a call."""
        x, y = self.call(VECTOR_AT, {"size": size, "angle": angle}, f"{name}_")
        return x, y

    def call(self, kernel: Formula, args: Mapping[str, Expr], prefix: str = "") -> tuple[Local, ...]:
        """The outputs of ``kernel`` for ``args`` by port name, in order: new intermediate results of a call.

        ValueError where ``args`` are not those that the kernel has.
        """
        if {port.name for port in kernel.inputs} != set(args):
            takes = " ".join(port.name for port in kernel.inputs)
            raise ValueError(f"the kernel {kernel.name} takes {takes}, and the call gives {' '.join(args)}")
        values: dict[Expr, Expr] = {signal(name): value for name, value in args.items()}
        results = tuple(
            self.define(f"{prefix}{name}", substituted(value, values, {}))
            for name, value in kernel.closed().items()
        )
        self.calls.append(Call(kernel, tuple(args[port.name] for port in kernel.inputs), results))
        return results

    def turned(self, name: str, vector: tuple[Expr, Expr], angle: Expr) -> tuple[Expr, Expr]:
        """``vector`` turned by an angle: named are cosine and sine, or both components where it lies along x."""
        if vector[1].is_zero:
            return self.vector_at(name, vector[0], angle)
        c, s = self.define(f"{name}_cos", sympy.cos(angle)), self.define(f"{name}_sin", sympy.sin(angle))
        return rotated(c, s, *vector)

    def poly(self, name: str, value: Expr | Poly, quantity: str = "") -> Poly:
        """A new intermediate result as a generator of polynomials."""
        return Poly.gen("local", self.define(name, value, quantity).name)

    def short(self, name: str, value: Poly, quantity: str = "") -> Poly:
        """A sum as a new intermediate result; a single term as it stands."""
        return self.poly(name, value, quantity) if len(value.terms) > 1 else value

    def formula(
        self, name: str, inputs: Iterable[Port], outputs: Iterable[tuple[Port, Expr]], text: str
    ) -> Formula:
        """The function of these intermediate results."""
        return Formula(
            name,
            tuple(inputs),
            tuple(self.items),
            tuple(outputs),
            text,
            calls=tuple(self.calls),
            quantities=tuple(self.quantities.items()),
        )

    def adopt(self, formula: Formula, inputs: Mapping[str, Expr]) -> dict[str, Expr]:
        """Add the locals of ``formula``, nothing evaluated; output name -> expression.

        ``inputs`` replaces inputs by port name; those that it does not name stay inputs.
        """
        values: dict[Expr, Expr] = {signal(name): value for name, value in inputs.items()}
        memo: dict[Expr, Expr] = {}
        quantities = dict(formula.quantities)
        for symbol, value in formula.locals:
            quantity = quantities.get(symbol.name, "")
            values[symbol] = self.define(symbol.name, substituted(value, values, memo), quantity)
        for call in formula.calls:
            args = tuple(substituted(a, values, memo) for a in call.args)
            self.calls.append(Call(call.kernel, args, tuple(values[r] for r in call.results)))
        return {port.name: substituted(value, values, memo) for port, value in formula.outputs}


def joint_port(wheel: Wheel, joint: str, role: Role) -> Port:
    """``<wheel>.<joint>``"""
    return replace(JOINTS[joint], name=f"{wheel.name}.{joint}", role=role)


def slip_port(text: str) -> Port:
    """``slip``"""
    return Port("slip", Role.COMMAND, "m/s", text)


def tunable_ports(robot: Robot) -> tuple[Port, ...]:
    """The tunable parameters, in file order, with their nominal values."""
    angles = _angles(robot) if robot.tunable else set()
    return tuple(
        Port(
            p.name,
            Role.GEOMETRY,
            "rad" if p.name in angles else "m",
            "tunable parameter",
            p.nominal,
            range=(p.low, p.high),
        )
        for p in robot.tunable
    )


def parameter_ports(robot: Robot) -> tuple[Port, ...]:
    """Every parameter as an input, with its nominal value."""
    tunable = {port.name: port for port in tunable_ports(robot)}
    angles = _angles(robot)
    return tuple(
        tunable.get(p.name)
        or Port(p.name, Role.GEOMETRY, "rad" if p.name in angles else "m", "parameter", p.nominal)
        for p in robot.parameters
    )


def _angles(robot: Robot) -> set[str]:
    """Parameters of which a wheel takes the sine."""
    views = [view for w in robot.wheels for view in (w.symbolic, w.working)]
    functions = {
        g
        for view in views
        for f in fields(view)
        for g in getattr(view, f.name).generators
        if g.kind in ("cosf", "sinf")
    }
    return {g.name for f in functions for a in f.args for g in a.generators if g.kind == "param"}


def signal_poly(name: str) -> Poly:
    """An input as a polynomial."""
    return Poly.gen("input", name)
