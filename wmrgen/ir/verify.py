"""Exact checks that a pass changed no output.

Both functions are evaluated exactly at pseudo-random rational points. Opaque operations (square root, sine, cosine,
arctangent) are replaced by an arbitrary rational function of their exact arguments, which is the same before and after,
so that the comparison remains exact. This function is odd or even if the operation is, and has the correct value where
builders fold constants; passes use no other property. Comparisons use the exact values.

The quick check for large functions computes modulo a prime: unequal values have equal residues with probability 2**-61.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any

from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.interpret import EXACT, Arithmetic, Number, evaluate
from wmrgen.ir.nodes import Function, Module, Op

PRIME = 2**61 - 465  # = 23 modulo 24: 2 and 3 are squares, so that all of Q(√2, √3) embeds
_ROOT2 = pow(2, (PRIME + 1) // 4, PRIME)
_ROOT3 = pow(3, (PRIME + 1) // 4, PRIME)
_ROOTS = (1, _ROOT2, _ROOT3, _ROOT2 * _ROOT3 % PRIME)


class PassError(AssertionError):
    """A pass changed the value of an output, which is a bug of wmrgen."""

    def __init__(self, text: str, step: str, output: str = "") -> None:
        super().__init__(f"{step}: {text}")
        self.step = step  # the pass, and the function
        self.output = output  # the name of the output; empty if the function is no longer defined


def mix(*numbers: int) -> int:
    """Return a hash of integers that does not depend on Python's own."""
    state = 0x2545F4914F6CDD1D
    for number in numbers:
        residue = number % (2**61 - 1)  # a Mersenne prime: 2**64 would drop upper bits
        state = (state * 6364136223846793005 + residue + 1442695040888963407) % 2**64
        state ^= state >> 29
    return state


# ---- residues


class Residue:
    """A number modulo PRIME (``r``), with its approximate value (``size``), which only decides comparisons."""

    __slots__ = ("r", "size")

    def __init__(self, r: int, size: float) -> None:
        self.r, self.size = r, size

    def __bool__(self) -> bool:
        return self.r != 0

    @property
    def sign(self) -> int:
        """Return -1, 0 or 1."""
        return 0 if not self.r else 1 if self.size > 0 else -1

    def rational(self) -> int:
        """Return the whole number, if it is one."""
        return self.r if self.size > 0 else -(-self.r % PRIME)

    def __add__(self, other: Residue) -> Residue:
        return Residue((self.r + other.r) % PRIME, self.size + other.size)

    def __sub__(self, other: Residue) -> Residue:
        return Residue((self.r - other.r) % PRIME, self.size - other.size)

    def __mul__(self, other: Residue) -> Residue:
        return Residue(self.r * other.r % PRIME, self.size * other.size)

    def __truediv__(self, other: Residue) -> Residue:
        if not other:
            raise ZeroDivisionError("division by 0 modulo a prime")
        size = self.size / other.size if other.size else 0.0
        return Residue(self.r * pow(other.r, -1, PRIME) % PRIME, size)

    def __neg__(self) -> Residue:
        return Residue(-self.r % PRIME, -self.size)

    def __abs__(self) -> Residue:
        return -self if self.r and self.size < 0 else self

    def __lt__(self, other: Residue) -> bool:
        return self.r != other.r and self.size < other.size


def _residue(value: Number | Residue) -> Residue:
    if isinstance(value, Residue):  # an output of prepare()
        return value
    e = Exact.of(Fraction(value)) if isinstance(value, float) else Exact.of(value)
    numerator = sum(n * root for n, root in zip(e.num, _ROOTS, strict=True) if n)
    return Residue(numerator * pow(e.den, -1, PRIME) % PRIME, float(e))


# ---- opaque functions


def _arbitrary(op: Op, enter: Callable[[Any], Any], folds: bool) -> Callable[..., Any]:
    """Return an arbitrary function with values in [1/64, 4), with the properties of ``op`` that builders use."""
    salt = mix(*op.name.encode())

    def value(*args: Any) -> Any:
        folded = op.fold(*args) if folds and op.fold is not None else None
        if folded is not None:
            return enter(folded)
        if op.parity < 0 and not args[0]:
            return enter(0)
        if op.parity and args[0].sign < 0:
            return value(-args[0]) if op.parity > 0 else -value(-args[0])
        return enter(Fraction(mix(salt, *(n for a in args for n in _digest(a))) % 255 + 1, 64))

    return value


def _digest(value: Exact | Residue) -> tuple[int, ...]:
    return (value.r,) if isinstance(value, Residue) else (*value.num, value.den)


@cache
def _over_the_field(op: Op) -> Callable[..., Any]:
    return _arbitrary(op, EXACT.enter, True) if op.opaque else EXACT.of(op)


@cache
def _modulo_the_prime(op: Op) -> Callable[..., Any]:
    if op.opaque or not op.modular:
        return _arbitrary(op, _residue, op.modular)
    assert op.exact is not None
    return op.exact


OPAQUE = Arithmetic(EXACT.enter, _over_the_field)
RESIDUES = Arithmetic(_residue, _modulo_the_prime)


# ---- checks


def points(function: Function, count: int) -> list[dict[str, Exact]]:
    """Return ``count`` rational points, which depend on the names of the inputs alone."""
    names = [port.name for port in function.inputs]
    found = []
    for k in range(count):
        found.append({name: _number(name, k) for name in names})
    return found


def _number(name: str, k: int) -> Exact:
    seed = mix(k, *name.encode())
    return Exact(Fraction(seed % 1999 - 999 or 7, 16 + (seed >> 32) % 5))


def check_module(before: tuple[Function, ...], after: Module) -> None:
    """Raise PassError if an output changed: check one point modulo a prime, and differences exactly."""
    try:
        _check(before, after, "the pipeline", 1, RESIDUES)
    except PassError:
        verify_module(before, after, "the pipeline", 1)


def verify_module(before: tuple[Function, ...], after: Module, step: str, count: int = 2) -> None:
    """Check that a module has the same outputs as the functions before a pass, exactly.

    Args:
        before: the functions.
        after: the module, with its `prepare`.
        step: the name of the pass, for the error.
        count: at how many points.

    Raises:
        PassError: an output differs.
    """
    _check(before, after, step, count, OPAQUE)


def _check(
    before: tuple[Function, ...], after: Module, step: str, count: int, arithmetic: Arithmetic
) -> None:
    prepared: list[dict[str, Any]] = [{}] * count
    if after.prepare is not None:
        prepared = [evaluate(after.prepare, point, arithmetic) for point in points(after.prepare, count)]
    for function in before:
        for own, point in zip(prepared, points(function, count), strict=True):
            new = _values(after.function(function.name), {**own, **point}, arithmetic)
            _compare(_values(function, point, arithmetic), new, f"{step} of {function.name}")


def _values(function: Function, point: dict[str, Any], arithmetic: Arithmetic) -> dict[str, Any] | None:
    """Return the outputs, or None if the point is outside the domain."""
    try:
        return evaluate(function, point, arithmetic)
    except ZeroDivisionError:
        return None


def _compare(before: dict[str, Any] | None, after: dict[str, Any] | None, step: str) -> None:
    if before is None:
        return
    if after is None:
        raise PassError("defined before, undefined after", step)
    for name, value in before.items():
        if _identity(after.get(name)) != _identity(value):
            raise PassError(f"{name} was {value} and is {after.get(name)}", step, name)


def _identity(value: Any) -> Any:
    """Return what must be equal: the exact value, or the residue without its approximate value."""
    return value.r if isinstance(value, Residue) else value
