"""What an operation is: one record holds all that is said of it and done with it.

The records stand in the modules beside this one, a family of operations in each; `wmrgen.ir.nodes` imports them all. A
record may also stand outside the package: it is known from the moment that it is made. Everything else asks records.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from wmrgen.ir.ops.analysis import by_slopes, from_slopes
from wmrgen.ir.rounding import nearest_float32

Rule = Callable[..., Any]

OPERATIONS: dict[str, Op] = {}  # by name


class Conditional(str):
    """The text of a value that is chosen: it is printed as a statement of its own."""

    __slots__ = ()


@dataclass(frozen=True, slots=True, eq=False)
class Op:
    """A scalar operation.

    Numbers. ``exact`` computes with numbers of the field Q(√2, √3). It uses + - * / abs and < alone, so that it also
    computes with their residues modulo a prime, or ``modular`` is False. ``float64`` is ``exact`` and
    ``float32`` the float64 result, rounded once more where the operation ``rounds``, if they are not given.
    ``many`` does the same to arrays of NumPy.

    Checks of passes. ``opaque``: they put an arbitrary function of the arguments in the place of the operation, which
    is odd where ``parity`` is -1, even where it is 1, and true where ``fold`` gives a value: what builders make of
    constants.

    Text. ``infix`` is the sign of an operator that all languages have. ``c`` and ``arrays`` are formats over the
    arguments by position. ``{f}`` is the suffix of C's float functions, ``xp`` the array namespace of the arguments
    (https://data-apis.org/array-api); functions of arrays with ``_`` in front are defined in templates/arrays.
    ``includes`` the headers that C's text takes. ``rust`` is what Rust writes where it is not what C writes, as a call
    is; ``javascript`` the same, where C's functions are members of Math. ``casadi`` is the name of one of CasADi's
    operations, or a function of the module and the arguments.

    Bounds. ``interval`` encloses the results of intervals, ``slopes`` the derivatives in each argument. ``lemma`` says
    what a walk over boxes records, see `wmrgen.ir.ops.analysis.Value`; ``running`` the error of one value per point.
    Both follow from ``interval`` and ``slopes`` if they are not given. ``ulps``: what is assumed of a C library's
    function, in units in the last place.
    """

    name: str
    arity: int
    exact: Rule | None = None
    float64: Rule | None = None
    float32: Rule | None = None
    rounds: bool = False
    many: Rule | None = None
    modular: bool = True
    opaque: bool = False
    parity: int = 0
    fold: Rule | None = None
    commutative: bool = False
    infix: str = ""
    c: str = ""
    rust: str = ""
    javascript: str = ""
    includes: tuple[str, ...] = ()
    arrays: str = ""
    casadi: str | Rule = ""
    cost: str = ""  # a field of `wmrgen.ir.nodes.Cost`
    interval: Rule | None = None
    slopes: Rule | None = None
    lemma: Rule | None = None
    running: Rule | None = None
    ulps: float = 0.0

    def __post_init__(self) -> None:
        if self.name in OPERATIONS:
            raise ValueError(f"there is an operation called {self.name} already: choose another name")
        OPERATIONS[self.name] = self
        wide = self.float64 or self.exact
        derived = {
            "float64": wide,
            "float32": self.float32 or (_rounded(wide) if wide and self.rounds else wide),
        }
        if not self.opaque and self.fold is None:
            derived["fold"] = self.exact
        if self.interval and self.slopes:
            derived |= {"lemma": self.lemma or by_slopes(self), "running": self.running or from_slopes(self)}
        for field, value in derived.items():
            object.__setattr__(self, field, value)

    def __str__(self) -> str:
        return self.name

    __repr__ = __str__

    def __reduce__(self) -> tuple[Callable[[str], Op], tuple[str]]:
        return OPERATIONS.__getitem__, (self.name,)

    CONST: ClassVar[Op]
    INPUT: ClassVar[Op]
    ADD: ClassVar[Op]
    SUB: ClassVar[Op]
    MUL: ClassVar[Op]
    SQUARE: ClassVar[Op]  # what MUL is of one value twice; no node has it, see `Node.meaning`
    DIV: ClassVar[Op]
    COMPENSATED: ClassVar[Op]  # compensated(a, b): a + b, the rounding of b made good where b is a product
    ROUNDING_ERROR: ClassVar[Op]  # rounding_error(a, b): what a + b loses when it is rounded; exactly 0
    NEG: ClassVar[Op]
    ABS: ClassVar[Op]
    MIN: ClassVar[Op]
    MAX: ClassVar[Op]
    SELECT: ClassVar[Op]  # select(a, b, x, y): x where a < b, else y
    SQRT: ClassVar[Op]
    SIN: ClassVar[Op]
    COS: ClassVar[Op]
    ATAN: ClassVar[Op]
    ATAN2: ClassVar[Op]  # atan2(y, x); atan2(0, 0) = 0
    RINT: ClassVar[Op]  # the nearest whole number, ties to even
    FLIP: ClassVar[Op]  # flip(a, n): a where the whole number n is even, else -a
    # What only the C of some processors has, see `wmrgen.ir.kernels`:
    FMA: ClassVar[Op]  # a * b + c, rounded once
    ISIN: ClassVar[Op]  # sine, cosine and arctangent (|q| <= 1) in integers: wmrgen.ir.ops.integer
    ICOS: ClassVar[Op]
    IATAN: ClassVar[Op]
    IMUL: ClassVar[Op]  # MUL, DIV and SQRT to the last bit, in integers
    IDIV: ClassVar[Op]
    ISQRT: ClassVar[Op]
    NEGATE_IF_ODD: ClassVar[Op]  # negate_if_odd(a, b): -a where the last bit of the float b is set, else a
    CLAMP: ClassVar[Op]  # clamp(a, m): m with the sign of a where |a| > m, else a; m of NaN; m > 0
    AT_LEAST: ClassVar[Op]  # at_least(a, m): m with the sign of a where |a| < m, else a; m > 0
    WITH_SIGN_OF: ClassVar[Op]  # with_sign_of(a, b): -a where the sign bit of the float b is set, else a
    # Operations that keep their meaning, see `Module.kernels`:
    CALL: ClassVar[Op]  # of the kernel called ``name``, over its inputs
    RESULT: ClassVar[Op]  # the result number ``name`` of a call whose kernel has several


def _rounded(operation: Rule) -> Rule:
    return lambda *args: nearest_float32(operation(*args))
