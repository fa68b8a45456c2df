"""Small functions to test with, and hypothesis strategies for large ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from hypothesis import strategies as st

from wmrgen.geometry.exact.number import SQRT2, SQRT3, Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Module, Node, Op, Port, Role
from wmrgen.ir.pipeline import AFTER_HOIST, BEFORE_HOIST, Pass, hoist, optimise
from wmrgen.ir.verify import verify_module

Matrix = list[list[Exact]]
CONSTANTS = (
    *(Exact(n) for n in (-2, -1, 0, 1, 2, 3)),
    Exact(Fraction(1, 2)), Exact(Fraction(-7, 5)), SQRT2 / 2, -SQRT3 / 10, SQRT3 - SQRT2,
)  # fmt: skip


def port(name: str, role: Role = Role.COMMAND, default: int | Fraction | None = None) -> Port:
    return Port(name, role, "", "", None if default is None else Exact(default))


def build(
    inputs: Sequence[str],
    body: Callable[[Builder, dict[str, int]], dict[str, int]],
    geometry: dict[str, Fraction] | None = None,
    name: str = "f",
) -> Function:
    """The function whose body makes outputs by name from inputs by name."""
    builder, geometry = Builder(), geometry or {}
    outputs = body(builder, {name: builder.input(name) for name in (*inputs, *geometry)})
    ports = (*(port(n) for n in inputs), *(port(n, Role.GEOMETRY, v) for n, v in geometry.items()))
    return builder.function(name, ports, tuple(port(n) for n in outputs), list(outputs.values()))


def transposed(matrix: Matrix) -> Matrix:
    return [list(column) for column in zip(*matrix, strict=True)]


def inverse(matrix: Matrix) -> Matrix:
    """Gauss and Jordan."""
    n = len(matrix)
    work = [list(row) + [Exact(int(i == j)) for j in range(n)] for i, row in enumerate(matrix)]
    for i in range(n):
        pivot = next(k for k in range(i, n) if work[k][i])
        work[i], work[pivot] = work[pivot], work[i]
        scale = work[i][i].inverse()
        work[i] = [a * scale for a in work[i]]
        for k in range(n):
            if k != i and work[k][i]:
                factor = work[k][i]
                work[k] = [a - factor * b for a, b in zip(work[k], work[i], strict=True)]
    return [row[n:] for row in work]


def product(a: Matrix, b: Matrix) -> Matrix:
    columns = transposed(b)
    return [[sum((x * y for x, y in zip(r, c, strict=True)), Exact(0)) for c in columns] for r in a]


def pseudo_inverse(matrix: Matrix) -> Matrix:
    """(M'M)^-1 M'."""
    turned = transposed(matrix)
    return product(inverse(product(turned, matrix)), turned)


INPUTS = ("x", "y", "z")
GEOMETRY = ("g", "h")
_KINDS = (Op.ADD, Op.SUB, Op.MUL, Op.NEG, Op.ADD, Op.SUB, Op.MUL, Op.MUL, Op.ABS, Op.MIN, Op.MAX,
          Op.SIN, Op.COS, Op.ATAN, Op.SQRT, Op.ATAN2, Op.DIV, Op.SELECT,
          Op.CLAMP, Op.AT_LEAST, Op.WITH_SIGN_OF)  # fmt: skip


@st.composite
def functions(draw: st.DrawFn, kinds: Sequence[Op] = _KINDS, size: int = 24) -> Function:
    """A random function as a raw node list. Divisors are 1 + v*v, roots are of absolute values."""
    nodes = [Node(Op.INPUT, name=name) for name in (*INPUTS, *GEOMETRY)]
    nodes += [Node(Op.CONST, value=draw(st.sampled_from(CONSTANTS))) for _ in range(3)]
    nodes.append(Node(Op.CONST, value=Exact(1)))
    one = len(nodes) - 1

    def pick() -> int:
        return draw(st.integers(0, len(nodes) - 1))

    for _ in range(draw(st.integers(1, size))):
        op = draw(st.sampled_from(kinds))
        args = tuple(pick() for _ in range({Op.SELECT: 4}.get(op, 1 if op in _UNARY else 2)))
        if op is Op.DIV:
            square = Node(Op.MUL, (args[1], args[1]))
            nodes += [square, Node(Op.ADD, (len(nodes), one))]
            args = (args[0], len(nodes) - 1)
        if op is Op.SQRT:
            nodes.append(Node(Op.ABS, args))
            args = (len(nodes) - 1,)
        if op in (Op.CLAMP, Op.AT_LEAST):
            args = (args[0], one)
        nodes.append(Node(op, args))
    results = tuple(pick() for _ in range(draw(st.integers(1, 4))))
    inputs = (*(port(n) for n in INPUTS), *(port(n, Role.GEOMETRY, 1) for n in GEOMETRY))
    return Function("f", inputs, tuple(nodes), tuple(port(f"o{k}") for k in range(len(results))), results)


_UNARY = (Op.NEG, Op.ABS, Op.SIN, Op.COS, Op.ATAN, Op.SQRT)
RING = (Op.ADD, Op.SUB, Op.MUL, Op.NEG)


def optimised(functions: tuple[Function, ...], name: str) -> Module:
    """`optimise`, and every pass of it checked at several exact points."""
    before = tuple(_checked(function, BEFORE_HOIST) for function in functions)
    hoisted = hoist(before, name)
    verify_module(before, hoisted, "hoist")
    for function in hoisted.every:
        _checked(function, AFTER_HOIST)
    module = optimise(functions, name)
    verify_module(functions, module, "the pipeline", 3)
    return module


def verify_function(before: Function, after: Function, step: str, count: int = 2) -> None:
    """PassError unless both functions have the same outputs at ``count`` exact points."""
    verify_module((before,), Module(before.name, (after,)), step, count)


def _checked(function: Function, passes: Sequence[Pass]) -> Function:
    for step in passes:
        changed = step(function)
        verify_function(function, changed, step.__name__)
        function = changed
    return function
