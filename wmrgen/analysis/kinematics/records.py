"""Formulas: functions of the model with named inputs, named intermediate results and named outputs."""

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
    """Substitute without evaluation, because sympy would take minutes to compare nested maxima.

    Args:
        expr: The expression.
        values: Replacements for symbols.
        memo: Results for subexpressions, which the function extends; share it between calls with equal ``values``.

    Returns:
        The expression with the replacements.
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
            # Their constructors simplify piecewise conditions even without evaluation.
            memo[expr] = sympy.Basic.__new__(type(expr), *args)
        elif isinstance(expr, _LAZY):
            memo[expr] = expr.func(*args, evaluate=False)
        else:
            memo[expr] = expr.func(*args)
    return memo[expr]


class Call(NamedTuple):
    """A call of a kernel. The formula that contains it also defines its results in base operations."""

    kernel: Formula
    args: tuple[Expr, ...]  # in the order of the kernel's inputs
    results: tuple[Local, ...]  # intermediate results of the formula, in the order of the kernel's outputs


@dataclass(frozen=True, slots=True)
class Formula:
    """A function of the model in symbols."""

    name: str
    inputs: tuple[Port, ...]
    locals: tuple[tuple[Local, Expr], ...]  # intermediate results, which may refer to earlier ones
    outputs: tuple[tuple[Port, Expr], ...]
    text: str  # description, without a full stop at the end
    source: str = ""  # this and the next two are from the declaration in `wmrgen.functions.registry`
    limits: Limits = Limits.NONE
    in_place: bool = False
    calls: tuple[
        Call, ...
    ] = ()  # locals that are results of kernels, which are separate functions in generated C
    quantities: tuple[tuple[str, str], ...] = ()  # names of locals, and what reports call them

    def closed(self) -> dict[str, Expr]:
        """Return the outputs by name, as expressions in the inputs alone."""
        values: dict[Expr, Expr] = {}
        memo: dict[Expr, Expr] = {}
        for symbol, expr in self.locals:
            values[symbol] = substituted(expr, values, memo)
        return {port.name: substituted(expr, values, memo) for port, expr in self.outputs}


# The vector with a given size and angle. Generated C has it as a library kernel, `wmrgen.ir.kernels.trigonometry`.
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
    """The intermediate results of a formula under construction.

    Their names are made unique: a wheel called ``mean`` may have a ``mean_bx``, and so may the formula.
    """

    def __init__(self) -> None:
        self.items: list[tuple[Local, Expr]] = []
        self.calls: list[Call] = []
        self.quantities: dict[str, str] = {}
        self._names: set[str] = set()

    def copy(self) -> Locals:
        """Return a copy that can be extended independently."""
        other = Locals()
        other.items, other.calls = list(self.items), list(self.calls)
        other.quantities, other._names = dict(self.quantities), set(self._names)
        return other

    def define(self, name: str, value: Expr | Poly, quantity: str = "") -> Local:
        """Add an intermediate result.

        Args:
            name: Its name, which gets a number if it is already used.
            value: Its value.
            quantity: What reports and comments in generated code call it, in ASCII; "" to use its name.

        Returns:
            Its symbol.
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
        """Add the components of a vector, as a call of a kernel.

        Args:
            name: The prefix of their names.
            size: The size of the vector.
            angle: Its angle [rad].

        Returns:
            The symbols of size cos(angle) and size sin(angle).
        """
        x, y = self.call(VECTOR_AT, {"size": size, "angle": angle}, f"{name}_")
        return x, y

    def call(self, kernel: Formula, args: Mapping[str, Expr], prefix: str = "") -> tuple[Local, ...]:
        """Add the outputs of a kernel as intermediate results.

        Args:
            kernel: The kernel.
            args: Its arguments by port name.
            prefix: A prefix for the names of its outputs.

        Returns:
            The symbols of its outputs, in order.

        Raises:
            ValueError: If ``args`` does not have exactly the inputs of the kernel.
        """
        if {port.name for port in kernel.inputs} != set(args):
            takes = " ".join(port.name for port in kernel.inputs)
            raise ValueError(f"the kernel {kernel.name} takes {takes}, and the call gives {' '.join(args)}")
        values: dict[Expr, Expr] = {signal(name): value for name, value in args.items()}
        results = []
        for name, value in kernel.closed().items():
            results.append(self.define(f"{prefix}{name}", substituted(value, values, {})))
        in_order = tuple(args[port.name] for port in kernel.inputs)
        self.calls.append(Call(kernel, in_order, tuple(results)))
        return tuple(results)

    def turned(self, name: str, vector: tuple[Expr, Expr], angle: Expr) -> tuple[Expr, Expr]:
        """Rotate a vector by an angle, with named intermediate results.

        Args:
            name: The prefix of the names.
            vector: The components (x, y).
            angle: The angle [rad], counter-clockwise.

        Returns:
            The components of the rotated vector.
        """
        if vector[1].is_zero:
            return self.vector_at(name, vector[0], angle)
        c, s = self.define(f"{name}_cos", sympy.cos(angle)), self.define(f"{name}_sin", sympy.sin(angle))
        return rotated(c, s, *vector)

    def poly(self, name: str, value: Expr | Poly, quantity: str = "") -> Poly:
        """Add an intermediate result.

        Args:
            name: Its name.
            value: Its value.
            quantity: What reports call it, see `define`.

        Returns:
            Its symbol as a polynomial.
        """
        return Poly.gen("local", self.define(name, value, quantity).name)

    def short(self, name: str, value: Poly, quantity: str = "") -> Poly:
        """Add an intermediate result if its value is a sum.

        Args:
            name: Its name.
            value: Its value.
            quantity: What reports call it, see `define`.

        Returns:
            Its symbol as a polynomial, or the value itself if it is a single term.
        """
        return self.poly(name, value, quantity) if len(value.terms) > 1 else value

    def formula(
        self, name: str, inputs: Iterable[Port], outputs: Iterable[tuple[Port, Expr]], text: str
    ) -> Formula:
        """Return the finished formula.

        Args:
            name: The name of the function.
            inputs: Its inputs.
            outputs: Its outputs, with their values.
            text: Its description.

        Returns:
            A formula with all intermediate results that were added.
        """
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
        """Add the intermediate results of another formula, without evaluation.

        ``inputs`` replaces inputs by port name; the others remain inputs. Return the outputs by name.
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
    """Return the port ``<wheel>.<joint>`` of a joint.

    Args:
        wheel: The wheel.
        joint: spin, steer or steer_rate.
        role: The role of the port.

    Returns:
        The port, with the unit and the description of the joint.
    """
    return replace(JOINTS[joint], name=f"{wheel.name}.{joint}", role=role)


def slip_port(text: str) -> Port:
    """Return the port ``slip``."""
    return Port("slip", Role.COMMAND, "m/s", text)


def tunable_ports(robot: Robot) -> tuple[Port, ...]:
    """Return the tunable parameters as inputs, in file order, with their nominal values and ranges."""
    angles = _angles(robot) if robot.tunable else set()
    ports = []
    for p in robot.tunable:
        unit = "rad" if p.name in angles else "m"
        ports.append(Port(p.name, Role.GEOMETRY, unit, "tunable parameter", p.nominal, range=(p.low, p.high)))
    return tuple(ports)


def parameter_ports(robot: Robot) -> tuple[Port, ...]:
    """Return every parameter as an input, with its nominal value."""
    tunable = {port.name: port for port in tunable_ports(robot)}
    angles = _angles(robot)
    ports = []
    for p in robot.parameters:
        unit = "rad" if p.name in angles else "m"
        ports.append(tunable.get(p.name) or Port(p.name, Role.GEOMETRY, unit, "parameter", p.nominal))
    return tuple(ports)


def _angles(robot: Robot) -> set[str]:
    """Return the names of the parameters that occur in a sine or cosine of a wheel's geometry."""
    names: set[str] = set()
    for w in robot.wheels:
        for view in (w.symbolic, w.working):
            for f in fields(view):
                for g in getattr(view, f.name).generators:
                    if g.kind in ("cosf", "sinf"):
                        names |= {inner.name for inner in g.args[0].generators if inner.kind == "param"}
    return names


def signal_poly(name: str) -> Poly:
    """Return an input as a polynomial."""
    return Poly.gen("input", name)
