"""An oracle for bounds that shares no code with them: exact values, and the worst that roundings may do.

`exact` evaluates a function with mpmath to 50 digits, deciding as the float32 program does. `injected` evaluates it
with an error in every operation, as large as the model of the bounds allows and with the sign that moves a result most.
The model allows this program, so a bound that it exceeds is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np

from tests.ir.bounds.observe import run
from wmrgen.ir.nodes import Function, Node, Op

DIGITS = 50
SUMS = (Op.ADD, Op.SUB)
ROUNDED = (*SUMS, Op.MUL, Op.DIV, Op.SQRT, Op.COMPENSATED, Op.ROUNDING_ERROR)
# What the bounds assume of a C library, in units in the last place [1]; see docs/numerics of any robot.
LIBRARY = {Op.SIN: 1.0, Op.COS: 1.0, Op.ATAN: 1.0, Op.ATAN2: 2.0}
Values = list[Any]  # by node: an array over the points, of float64 or of mpmath numbers
Slot = tuple[
    int, int | None
]  # a rounding of a node, for one user only if a compiler may contract the product


def _elementwise(function: Callable[..., Any], count: int = 1) -> Callable[..., Any]:
    return np.frompyfunc(function, count, 1)


MPMATH = {
    "sqrt": _elementwise(mpmath.sqrt),
    "sin": _elementwise(mpmath.sin),
    "cos": _elementwise(mpmath.cos),
    "atan": _elementwise(mpmath.atan),
    "atan2": _elementwise(mpmath.atan2, 2),
}
FLOAT64 = {"sqrt": np.sqrt, "sin": np.sin, "cos": np.cos, "atan": np.arctan, "atan2": np.arctan2}


EXACT: dict[Op, Callable[..., Any]] = {
    Op.ADD: lambda a, b: a + b,
    Op.SUB: lambda a, b: a - b,
    Op.MUL: lambda a, b: a * b,
    Op.DIV: lambda a, b: a / b,
    Op.NEG: lambda a: -a,
    Op.ABS: abs,
    Op.COMPENSATED: lambda a, b: a + b,
    Op.ROUNDING_ERROR: lambda a, b: a * 0,
    Op.MIN: lambda a, b: np.where(a < b, a, b),
    Op.MAX: lambda a, b: np.where(a < b, b, a),
    Op.CLAMP: lambda a, m: np.where(a > m, m, np.where(a < -m, -m, a)),
}


def decision(op: Op, a: Sequence[np.ndarray]) -> np.ndarray | None:
    """How a node with arguments ``a`` decides; None where its result has no jump, so that exact numbers may decide."""
    if op is Op.SELECT:
        return np.asarray(a[0] < a[1])
    if op is Op.RINT:
        return np.rint(a[0].astype(np.float64))
    if op is Op.FLIP:
        return np.asarray(a[1] % 2 == 1)
    if op is Op.WITH_SIGN_OF:
        return np.signbit(a[1].astype(np.float64))
    if op is Op.AT_LEAST:
        return np.signbit(a[0].astype(np.float64))
    return None


def value(op: Op, a: Sequence[Any], chosen: np.ndarray | None, functions: Mapping[str, Any]) -> Any:
    """The exact result of an operation that decides as ``chosen`` says."""
    if op in EXACT:
        return EXACT[op](*a)
    if op.name in functions:
        return functions[op.name](*a)
    assert chosen is not None, op
    if op is Op.RINT:
        return chosen + 0 * a[0]
    if op is Op.SELECT:
        return np.where(chosen, a[2], a[3])
    if op in (Op.FLIP, Op.WITH_SIGN_OF):
        return np.where(chosen, -a[0], a[0])
    assert op is Op.AT_LEAST, op
    below, above = np.where(a[0] > -a[1], -a[1], a[0]), np.where(a[0] < a[1], a[1], a[0])
    return np.where(chosen, below, above)


@dataclass(frozen=True)
class Runs:
    """One float32 run of a function at many points, and the other evaluations that decide as it does."""

    function: Function
    inputs: Mapping[str, np.ndarray]  # float32
    single: list[np.ndarray]
    decisions: list[np.ndarray | None]

    @classmethod
    def of(cls, function: Function, inputs: Mapping[str, np.ndarray]) -> Runs:
        """Run the float32 program; its library returns either of the two floats around the exact result."""
        single = run(function, inputs).single
        decisions = [decision(n.op, [single[k] for k in n.args]) for n in function.nodes]
        return cls(function, inputs, single, decisions)

    def exact(self) -> Values:
        """Every node with mpmath, from the float32 inputs and the exact constants."""
        with mpmath.workdps(DIGITS):

            def constant(node: Node) -> Any:
                assert node.value is not None
                q = node.value.rational()
                return mpmath.mpf(q.numerator) / q.denominator

            return self._values(constant, _elementwise(mpmath.mpf), MPMATH, {})

    def wide(self, noise: Mapping[Slot, np.ndarray] | None = None) -> Values:
        """Every node in float64: the exact formula, or the code with these roundings and with float32 constants."""

        def constant(node: Node) -> Any:
            assert node.value is not None
            exact = float(node.value.rational())
            return exact if noise is None else float(np.float32(exact))

        return self._values(constant, lambda x: x.astype(np.float64), FLOAT64, noise or {})

    def _values(
        self,
        constant: Callable[[Node], Any],
        number: Callable[[np.ndarray], Any],
        functions: Mapping[str, Any],
        noise: Mapping[Slot, np.ndarray],
    ) -> Values:
        count = len(next(iter(self.inputs.values())))
        values: Values = []
        with np.errstate(all="ignore"):
            for i, node in enumerate(self.function.nodes):
                if node.value is not None:
                    c = constant(node)
                    values.append(np.full(count, c, dtype=object if functions is MPMATH else np.float64))
                elif node.op is Op.INPUT:
                    values.append(number(self.inputs[node.name or ""]))
                else:
                    args = [values[k] + noise.get((k, i), 0) for k in node.args]
                    made = value(node.op, args, self.decisions[i], functions)
                    values.append(made + noise.get((i, None), 0))
        return values

    # ---- the worst that roundings may do

    def roundings(self) -> dict[Slot, np.ndarray]:
        """The largest error of each rounding at these points: half the spacing of floats at the result, or below it."""
        found: dict[Slot, np.ndarray] = {}
        for i, node in enumerate(self.function.nodes):
            size = self._rounding(i, node)
            if size is not None:
                for user in self._users(i, node):
                    found[i, user] = size
        return found

    def _rounding(self, i: int, node: Node) -> np.ndarray | None:
        a = [self.single[k] for k in node.args]
        reference = a[0] + a[1] if node.op is Op.ROUNDING_ERROR else self.single[i]
        # Just below a power of two floats have half the spacing that they have above it.
        half = np.spacing(np.nextafter(np.abs(reference), np.float32(0))).astype(np.float64) / 2
        if node.op in LIBRARY:
            return 2 * LIBRARY[node.op] * half
        if node.op not in ROUNDED:
            return None
        if node.op in SUMS:
            # Each operand is a float: the float nearest to the sum is no farther from it than they are.
            smaller = np.minimum(np.abs(a[0]), np.abs(a[1])).astype(np.float64)
            return np.asarray(np.minimum(half, smaller))
        if node.op is Op.MUL:
            exact = [np.abs(np.frexp(x)[0]) == 0.5 for x in a]
            # 0 is a float, so that rounding does not change the sign, whatever the factors are off by.
            product = 0.99 * np.abs(a[0].astype(np.float64) * a[1])
            return np.asarray(np.where(np.logical_or.reduce(exact), 0.0, np.minimum(half, product)))
        if node.op is Op.DIV:
            return np.asarray(np.where(a[0] == 0, 0.0, half))
        return half

    def _users(self, i: int, node: Node) -> list[int | None]:
        """The users that see roundings of their own: those of a product of which one is a sum."""
        users = [k for k, n in enumerate(self.function.nodes) if i in n.args]
        sums = any(self.function.nodes[k].op in SUMS for k in users)
        if node.op is Op.MUL and sums and len(users) > 1 and i not in self.function.results:
            return [*users]
        return [None]

    def injected(self, result: int) -> tuple[np.ndarray, list[Values]]:
        """Two runs with the largest errors in every operation, for the largest change of node ``result`` up and down.

        Returns:
            For which points both runs decide as the float32 program does, and the values of the two runs.
        """
        sizes = self.roundings()
        base = self.wide({})[result]
        signs = {slot: np.sign(self.wide({slot: size})[result] - base) for slot, size in sizes.items()}
        runs = [
            self.wide({slot: way * signs[slot] * size for slot, size in sizes.items()}) for way in (1, -1)
        ]
        alike = np.ones(len(base), dtype=bool)
        for values in runs:
            for node, chosen in zip(self.function.nodes, self.decisions, strict=True):
                if chosen is not None:
                    alike &= decision(node.op, [values[k] for k in node.args]) == chosen
        return alike, runs
