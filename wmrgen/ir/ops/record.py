"""The record of an operation, which has everything that is known about it and done with it.

The records are in the other modules of this package, one family in each; `wmrgen.ir.nodes` imports all of them. A
record may also be outside the package: it is registered when it is made.
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
    """The text of a choice, which is printed as a statement of its own."""

    __slots__ = ()


@dataclass(frozen=True, slots=True, eq=False)
class Op:
    """A scalar operation."""

    name: str
    arity: int
    # ---- numbers
    # Computes with numbers of the field Q(√2, √3). It only uses + - * / abs and <, so that it also computes with
    # residues modulo a prime; otherwise ``modular`` is False.
    exact: Rule | None = None
    float64: Rule | None = None  # by default ``exact``
    float32: Rule | None = None  # by default ``float64``, rounded once more if the operation ``rounds``
    rounds: bool = False
    many: Rule | None = None  # the same for arrays of NumPy
    # ---- checks of passes
    modular: bool = True
    # Checks put an arbitrary function of the arguments in place of an opaque operation. It is odd if ``parity`` is -1,
    # even if it is 1, and correct where ``fold`` returns a value: what builders make of constant arguments.
    opaque: bool = False
    parity: int = 0
    fold: Rule | None = None
    commutative: bool = False
    # ---- text
    infix: str = ""  # an operator that all languages have
    # Formats over the arguments by position. {f} is the suffix of C's float functions. {xp} is the array namespace of
    # the arguments (https://data-apis.org/array-api); functions of arrays with _ in front are in templates/arrays.
    c: str = ""
    rust: str = ""  # if it is not C's text as a method call
    javascript: str = ""  # if it is not C's text with functions as members of Math
    includes: tuple[str, ...] = ()  # headers that the C text needs
    arrays: str = ""
    casadi: str | Rule = (
        ""  # the name of an operation of CasADi, or a function of the module and the arguments
    )
    cost: str = ""  # a field of `wmrgen.ir.nodes.Cost`
    # ---- bounds
    interval: Rule | None = None  # encloses the results for intervals
    slopes: Rule | None = None  # encloses the derivatives in each argument
    # What a walk over boxes records (`wmrgen.ir.ops.analysis.Value`), and the error at one value per point. Both
    # follow from ``interval`` and ``slopes`` by default.
    lemma: Rule | None = None
    running: Rule | None = None
    ulps: float = 0.0  # the error that is assumed of a C library's function [units in the last place]

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
    SQUARE: ClassVar[Op]  # MUL of a value with itself, for analyses; no node has it, see `Node.meaning`
    DIV: ClassVar[Op]
    COMPENSATED: ClassVar[Op]  # compensated(a, b): a + b, without the rounding error of b if b is a product
    ROUNDING_ERROR: ClassVar[Op]  # rounding_error(a, b): the error of rounding a + b; 0 for exact numbers
    NEG: ClassVar[Op]
    ABS: ClassVar[Op]
    MIN: ClassVar[Op]
    MAX: ClassVar[Op]
    SELECT: ClassVar[Op]  # select(a, b, x, y): x if a < b, else y
    SQRT: ClassVar[Op]
    SIN: ClassVar[Op]
    COS: ClassVar[Op]
    ATAN: ClassVar[Op]
    ATAN2: ClassVar[Op]  # atan2(y, x); atan2(0, 0) = 0
    RINT: ClassVar[Op]  # the nearest whole number, ties to even
    FLIP: ClassVar[Op]  # flip(a, n): a if the whole number n is even, else -a
    # Operations in the C of some processors only, see `wmrgen.ir.kernels`:
    FMA: ClassVar[Op]  # a * b + c, rounded once
    ISIN: ClassVar[Op]  # sine, cosine and arctangent (|q| <= 1) in integers: wmrgen.ir.ops.integer
    ICOS: ClassVar[Op]
    IATAN: ClassVar[Op]
    IMUL: ClassVar[Op]  # MUL, DIV and SQRT to the last bit, in integers
    IDIV: ClassVar[Op]
    ISQRT: ClassVar[Op]
    NEGATE_IF_ODD: ClassVar[Op]  # negate_if_odd(a, b): -a if the last bit of the float b is set, else a
    CLAMP: ClassVar[Op]  # clamp(a, m), m > 0: m with the sign of a if |a| > m, else a; m if a is NaN
    AT_LEAST: ClassVar[Op]  # at_least(a, m), m > 0: m with the sign of a if |a| < m, else a
    WITH_SIGN_OF: ClassVar[Op]  # with_sign_of(a, b): -a if the sign bit of the float b is set, else a
    # Calls, see `Module.kernels`:
    CALL: ClassVar[Op]  # of the kernel ``name`` of the node, with its inputs as arguments
    RESULT: ClassVar[Op]  # result number ``name`` of a call whose kernel has several results


def _rounded(operation: Rule) -> Rule:
    return lambda *args: nearest_float32(operation(*args))
