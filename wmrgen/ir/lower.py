"""Lowering: the only place where sympy expressions become nodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction

import sympy

from wmrgen.analysis.kinematics.records import Call, Formula
from wmrgen.geometry.exact.evaluate import pi_rational
from wmrgen.geometry.exact.number import ONE, ZERO, Exact, exact_sqrt, sqrt_rational
from wmrgen.geometry.symbolic import Expr, Input, Local, Nearest, Parameter
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Named, Node, Op, places, pruned, renumbered
from wmrgen.ir.ops import OPERATIONS

# The operations of sympy's functions. Our own functions name theirs, see `wmrgen.geometry.symbolic.Operation`.
_OPERATIONS: dict[type, Op] = {
    sympy.sin: Op.SIN, sympy.cos: Op.COS, sympy.atan: Op.ATAN, sympy.atan2: Op.ATAN2,
    sympy.Abs: Op.ABS, sympy.Max: Op.MAX, sympy.Min: Op.MIN,
}  # fmt: skip
# Divisors that depend on tunable geometry are kept this far from zero [SI units]: far below any real geometry.
TINY = Exact(Fraction(1, 10**12))


def lower(formula: Formula, calls: bool = False, as_written: bool = False) -> Function:
    """Return a formula as a function of the IR.

    Args:
        formula: inputs, intermediate results and outputs in symbols.
        calls: whether results of kernels become calls (see `kernels_of`); otherwise they are written out.
        as_written: whether every intermediate result is computed once, as it is written. Otherwise constant factors and
            signs move through them.

    Returns:
        The function, which has simplified operations, each distinct one once.
    """
    lowering = _Lowering(formula, formula.calls if calls else (), as_written)
    results = [lowering.node(expr) for _, expr in formula.outputs]
    ports = tuple(port for port, _ in formula.outputs)
    if as_written:
        nodes, place = lowering.joined()
        whole = Function(
            formula.name, formula.inputs, nodes, ports, tuple(place[r] for r in results), formula.text
        )
        return replace(pruned(whole), limits=formula.limits, in_place=formula.in_place)
    function = lowering.builder.function(formula.name, formula.inputs, ports, results, formula.text)
    return replace(function, named=lowering.named(results), limits=formula.limits, in_place=formula.in_place)


def kernels_of(formulas: Sequence[Formula]) -> tuple[Function, ...]:
    """Return the kernels that ``formulas`` call, as functions."""
    kernels = {call.kernel.name: call.kernel for formula in formulas for call in formula.calls}
    return tuple(lower(kernel) for kernel in kernels.values())


class _Lowering:
    """Turns the expressions of one formula into nodes, each distinct expression once."""

    def __init__(self, formula: Formula, calls: Sequence[Call] = (), as_written: bool = False) -> None:
        self.name = formula.name
        self.builder = Builder()
        self.as_written = as_written
        # The placeholder input of each intermediate result -> the node that computes it.
        self.placeholders: dict[int, int] = {}
        self.memo: dict[Expr, int] = {}
        self.names = {p.name.replace(".", "_"): p.name for p in formula.inputs}
        self.locals, self.quantities = dict(formula.locals), dict(formula.quantities)
        self.calls = {result: (call, k) for call in calls for k, result in enumerate(call.results)}
        self.parameters: set[str] = set()
        # By node: whether it depends on geometry alone; the list grows when it is needed.
        self.geometric: list[bool] = []
        self.rules: dict[type, Callable[[Expr], int]] = {
            sympy.Add: self._add, sympy.Mul: self._mul, sympy.Pow: self._pow, sympy.tan: self._tan,
            sympy.Piecewise: self._select,
            Input: self._input, Parameter: self._parameter, Local: self._local,
        }  # fmt: skip

    def node(self, expr: Expr) -> int:
        """Return the node of an expression."""
        node = self.memo.get(expr)
        if node is None:
            node = self.memo[expr] = self._new(expr)
        return node

    def _new(self, expr: Expr) -> int:
        value = number_of(expr, _rounded)
        if value is not None:
            return self.builder.const(value)
        op = _OPERATIONS.get(type(expr)) or OPERATIONS.get(str(getattr(expr, "op", "")))
        if op is not None and len(expr.args) == op.arity:
            return self.builder.apply(op, [self.node(a) for a in expr.args])
        if op is not None or type(expr) not in self.rules:
            raise self._no_operation(expr)
        return self.rules[type(expr)](expr)

    def _no_operation(self, expr: Expr) -> ValueError:
        """Return the error for an expression that has no operation."""
        return ValueError(
            f"{self.name} writes {expr} ({type(expr).__name__}), which is no operation: "
            "take the functions of wmrgen.geometry.symbolic, and sympy.Rational or number(Exact) for numbers"
        )

    def named(self, results: Sequence[int]) -> tuple[Named, ...]:
        """Return the intermediate results that ``results`` need, with their nodes in the finished function."""
        lowered = (
            Named(symbol.name, self.memo[symbol], self.quantities.get(symbol.name, ""))
            for symbol in self.locals
            if symbol in self.memo
        )
        return renumbered(lowered, places(self.builder.nodes, results))

    def _input(self, expr: Expr) -> int:
        if expr.name not in self.names:
            raise ValueError(
                f"{self.name} uses {expr.name}, which is none of its inputs: "
                "declare its port, and those of parameters by tunable_ports(robot)"
            )
        return self.builder.input(self.names[expr.name])

    def _parameter(self, expr: Expr) -> int:
        node = self._input(expr)
        self.parameters.add(self.names[expr.name])
        return node

    def _local(self, expr: Expr) -> int:
        if expr in self.calls:
            call, number = self.calls[expr]
            result = self.builder.call(call.kernel.name, *(self.node(a) for a in call.args))
            return self.builder.result(result, number) if len(call.results) > 1 else result
        if expr not in self.locals:
            raise ValueError(f"{self.name} uses {expr.name}, which is none of its intermediate results")
        value = self.node(self.locals[expr])
        if not self.as_written or not self.builder.nodes[value].args:
            return value
        placeholder = self.builder.input(f"={expr.name}")  # a name that no port has
        self.placeholders[placeholder] = value
        return placeholder

    def joined(self) -> tuple[tuple[Node, ...], list[int]]:
        """Return the nodes with intermediate results in place of their placeholders, and the new index of each node."""
        nodes: list[Node] = []
        place: list[int] = []
        for i, node in enumerate(self.builder.nodes):
            if i in self.placeholders:
                place.append(place[self.placeholders[i]])
            else:
                place.append(len(nodes))
                nodes.append(node.over(tuple(place[arg] for arg in node.args)))
        return tuple(nodes), place

    def _add(self, expr: Expr) -> int:
        return self.builder.sum(self.node(a) for a in expr.args)

    def _mul(self, expr: Expr) -> int:
        factor, above, below, turns = ONE, [], [], []
        for arg in expr.args:
            value = number_of(arg, _rounded)
            if value is not None:
                factor = factor * value
            elif isinstance(arg, sympy.Pow) and arg.exp.is_Rational and arg.exp < 0:
                below.append(self.node(sympy.Pow(arg.base, -arg.exp)))
            elif isinstance(arg, sympy.Pow) and arg.base == -1:
                turns.append(self.node(arg.exp))
            else:
                above.append(self.node(arg))
        b = self.builder
        product = b.product(above)
        if below:
            product = b.div(product, self._nonzero(b.product(below)))
        product = b.mul(b.const(factor), product)
        for n in turns:
            product = b.flip(product, n)
        return product

    def _pow(self, expr: Expr) -> int:
        b, exponent = self.builder, expr.exp
        if expr.base == -1 and isinstance(exponent, Nearest):
            return b.flip(b.const(1), self.node(exponent))
        if exponent.is_Integer:
            n = int(exponent)
            power = b.power(self.node(expr.base), abs(n))
            return power if n >= 0 else b.div(b.const(1), self._nonzero(power))
        if exponent.is_Rational and exponent.q == 2:
            root = b.power(b.sqrt(self.node(expr.base)), abs(int(exponent.p)))
            return root if exponent > 0 else b.div(b.const(1), self._nonzero(root))
        raise self._no_operation(expr)

    def _nonzero(self, a: int) -> int:
        """Return a divisor, kept away from zero if it depends on tunable geometry alone; others are guarded already."""
        b = self.builder
        if b.value(a) is not None or not self._geometric(a):
            return a
        return b.apply(Op.AT_LEAST, (a, b.const(TINY)))

    def _geometric(self, a: int) -> bool:
        geometric = self.geometric
        for i, node in enumerate(self.builder.nodes[len(geometric) : a + 1], len(geometric)):
            if i in self.placeholders:
                geometric.append(geometric[self.placeholders[i]])
            else:
                geometric.append(
                    all(geometric[k] for k in node.args)
                    if node.name is None
                    else node.name in self.parameters
                )
        return geometric[a]

    def _tan(self, expr: Expr) -> int:
        a = self.node(expr.args[0])
        return self.builder.div(self.builder.sin(a), self._nonzero(self.builder.cos(a)))

    def _select(self, expr: Expr) -> int:
        (then, condition), (otherwise, always) = expr.args[0], expr.args[-1]
        strict = isinstance(condition, sympy.StrictLessThan | sympy.StrictGreaterThan)
        if len(expr.args) != 2 or not strict or always is not sympy.true:
            raise self._no_operation(expr)
        low, high = self.node(condition.lts), self.node(condition.gts)
        return self.builder.select(low, high, self.node(then), self.node(otherwise))


def number_of(expr: Expr, other: Callable[[Expr], Exact | None] = lambda _: None) -> Exact | None:
    """Return a sympy number as an element of the field, ``other`` of other constants, None for symbols."""
    if isinstance(expr, sympy.Symbol):
        return None
    if isinstance(expr, sympy.Rational):
        return Exact.ratio(int(expr.p), int(expr.q))
    if isinstance(expr, sympy.Pow) and isinstance(expr.base, sympy.Rational) and expr.exp == sympy.S.Half:
        root = exact_sqrt(Fraction(int(expr.base.p), int(expr.base.q)))
        return other(expr) if root is None else root
    if not isinstance(expr, (sympy.Add, sympy.Mul)):
        return other(expr)
    result = ZERO if expr.is_Add else ONE
    for arg in expr.args:
        value = number_of(arg, other)
        if value is None:
            return None
        result = result + value if expr.is_Add else result * value
    return result


def _rounded(expr: Expr) -> Exact | None:
    """Return pi, and roots of rationals that are not in the field, to 60 digits."""
    if expr is sympy.pi:
        return Exact(pi_rational())
    if not isinstance(expr, sympy.Pow) or not (expr.base.is_Rational and expr.exp.is_Rational):
        return None
    base, exponent = Fraction(int(expr.base.p), int(expr.base.q)), expr.exp
    if exponent.q == 1:
        return Exact(base) ** int(exponent.p)
    if exponent.q != 2:
        raise ValueError(f"no number for exponent {exponent}")
    root = exact_sqrt(base) or Exact(sqrt_rational(base.numerator * base.denominator) / base.denominator)
    return root ** int(exponent.p)
