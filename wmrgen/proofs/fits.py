"""Fits that a function contains: a result |R|, R = b - A x, beside the results x = (v, w) that make it least.

w is a quotient with divisor D; v are the best for any w. Then, with numbers M and c,

    |R(v + dv, w + dw)|^2 = |R(v, w)|^2 + dv M dv + c D dw^2.

b is made of ``data``, velocities of contact points say. v are the best for any data, also such as no wheel can have.
N, the dividend of w, need not be: it may have been simplified by what data are. For other data it is off by a number
times a sine or cosine: their ``defect``.

Whether a function is such a fit is checked on its nodes, modulo a prime at random points: a sine and its cosine lie on
a circle there, all else is free. What holds there does not hold in general with a probability of about 2**-50.
"""

from __future__ import annotations

import random
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wmrgen.exact.number import ONE
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.residues import PRIME, RESIDUES, Residue
from wmrgen.proofs.patterns import Term, terms_below_root

_FORMULA = frozenset({Op.CONST, Op.INPUT, Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.NEG, Op.SIN, Op.COS})
_POINTS = 3
_ROOM = 1 + 1e-6  # covers the rounding of M and c
_plus, _minus, _times, _over = (RESIDUES.apply[op] for op in (Op.ADD, Op.SUB, Op.MUL, Op.DIV))


@dataclass(frozen=True, slots=True)
class Datum:
    """``node`` adds ``column`` times its value to R. N is off by up to ``defect`` times what it is off."""

    node: int
    column: NDArray[np.float64]
    defect: float


@dataclass(frozen=True, slots=True)
class Fit:
    """``root``: the node of |R|, the root of the sum of ``terms``. ``w`` is ``above`` / ``below``, or by 1/below.

    ``matrix``: upper bounds of |M|; ``factor``: of c.
    """

    root: int
    terms: tuple[Term, ...]
    v: tuple[int, ...]
    w: int
    above: int
    below: int
    matrix: NDArray[np.float64]
    factor: float
    data: tuple[Datum, ...]


def fit_of(function: Function) -> Fit | None:
    """The fit among the results of ``function``, None where there is none."""
    nodes, results = function.nodes, function.results
    roots = [k for k in results if nodes[k].op is Op.SQRT]
    if len(roots) != 1:
        return None
    terms, cone = terms_below_root(nodes, nodes[roots[0]].args[0]), below(nodes, roots)
    fitted = sorted({k for k in results if k in cone} - set(roots))
    if not all(t.squared for t in terms) or any(nodes[k].op not in _FORMULA for k in below(nodes, fitted)):
        return None
    quotients = {k: parts for k in fitted if (parts := _quotient(nodes, k)) is not None}
    if len(quotients) != 1:
        return None
    ((w, (dividend, divisor)),) = quotients.items()
    v = tuple(k for k in fitted if k != w)
    if any(below(nodes, [k], {w}) & {w, *v} != {w, k} for k in v):
        return None
    data = _data(nodes, roots[0], fitted)
    for known in (data, ()) if data else ((),):
        points = [_Point(nodes, terms, known, seed) for seed in range(_POINTS)]
        try:
            found = _settled([p.forms(v, w, dividend, divisor) for p in points], points)
        except ZeroDivisionError:
            return None
        if found is not None:
            return Fit(roots[0], terms, v, w, dividend, divisor, *found)
    return None


def below(nodes: Sequence[Node], roots: Collection[int], stop: Collection[int] = ()) -> set[int]:
    """Nodes that ``roots`` need, up to those of ``stop``."""
    found, stack = set[int](), list(roots)
    while stack:
        k = stack.pop()
        if k not in found:
            found.add(k)
            stack += () if k in stop else nodes[k].args
    return found


def _quotient(nodes: Sequence[Node], k: int) -> tuple[int, int] | None:
    """(N, D) of N / D, or of N (1/D)."""
    if nodes[k].op is Op.DIV:
        above, divisor = nodes[k].args
        return above, divisor
    if nodes[k].op is Op.MUL:
        for above, inverse in (nodes[k].args, nodes[k].args[::-1]):
            if nodes[inverse].op is Op.DIV and nodes[nodes[inverse].args[0]].value == ONE:
                return above, nodes[inverse].args[1]
    return None


def _data(nodes: Sequence[Node], root: int, fitted: Collection[int]) -> tuple[int, ...]:
    """Nodes that depend on rates and which both R and the fit start from; what R needs them for is no angle alone."""
    angles = {k for n in nodes if n.op in (Op.SIN, Op.COS) for k in n.args}
    rated: set[int] = set()
    for i, n in enumerate(nodes):
        if (n.op is Op.INPUT and i not in angles) or not rated.isdisjoint(n.args):
            rated.add(i)
    shared = below(nodes, [root], fitted) & below(nodes, fitted) & rated - set(fitted)
    ends = {k for i, n in enumerate(nodes) if i not in shared for k in n.args if k in shared}
    return tuple(sorted(k for k in ends if nodes[k].op is not Op.INPUT))


@dataclass(frozen=True, slots=True)
class _Forms:
    """M row by row, and c; per datum: what it adds to R, and the defect of N."""

    matrix: list[Residue]
    factor: Residue
    columns: list[list[Residue]]
    defects: list[Residue]


def _settled(
    found: Sequence[_Forms | None], points: Sequence[_Point]
) -> tuple[NDArray[np.float64], float, tuple[Datum, ...]] | None:
    """M, c and the data, where they are the same at all points."""
    forms = [f for f in found if f is not None]
    first = forms[0] if len(forms) == len(points) else None
    numbers = [[x.r for x in (*f.matrix, f.factor, *(x for c in f.columns for x in c))] for f in forms]
    if first is None or any(n != numbers[0] for n in numbers):
        return None
    data = []
    for j, node in enumerate(points[0].data):
        defect = _wave([f.defects[j] for f in forms], [p.circle_of(node) for p in points])
        if defect is None:
            return None
        data.append(Datum(node, np.array([abs(x.size) for x in first.columns[j]]) * _ROOM, defect))
    side = round(len(first.matrix) ** 0.5)
    matrix = np.array([abs(x.size) for x in first.matrix]).reshape(side, side) * _ROOM
    return matrix, abs(first.factor.size) * _ROOM, tuple(data)


def _wave(values: Sequence[Residue], circles: Sequence[dict[Op, Residue] | None]) -> float | None:
    """|(a, b)| where all values are a sin + b cos of one angle; None where they are not."""
    if not any(x.r for x in values):
        return 0.0
    known = [c for c in circles if c is not None]
    if len(known) < len(values):
        return None
    (s, c), (t, d) = ((k[Op.SIN], k[Op.COS]) for k in known[:2])
    area = _minus(_times(s, d), _times(c, t))
    a = _over(_minus(_times(values[0], d), _times(c, values[1])), area)
    b = _over(_minus(_times(s, values[1]), _times(values[0], t)), area)
    for x, k in zip(values, known, strict=True):
        if _minus(x, _plus(_times(a, k[Op.SIN]), _times(b, k[Op.COS]))).r:
            return None
    return float(np.hypot(a.size, b.size)) * _ROOM


class _Point:
    """A random point. Residues and sizes are drawn apart: no operation here compares."""

    def __init__(
        self, nodes: Sequence[Node], terms: Sequence[Term], data: tuple[int, ...], seed: int
    ) -> None:
        self.nodes, self.terms, self.data, self.random = nodes, terms, data, random.Random(seed)
        self.given: dict[int, Residue] = {}
        self.circles: dict[int, dict[Op, Residue]] = {}
        for i, node in enumerate(nodes):
            if node.op is Op.INPUT:
                self.given[i] = self.number()
            elif node.op in (Op.SIN, Op.COS):
                if node.args[0] not in self.circles:
                    self.circles[node.args[0]] = self._circle()
                self.given[i] = self.circles[node.args[0]][node.op]

    def number(self) -> Residue:
        return Residue(self.random.randrange(1, PRIME), self.random.uniform(0.5, 2.0))

    def _circle(self) -> dict[Op, Residue]:
        t, one = self.number(), RESIDUES.enter(1)
        square = _times(t, t)
        length = _plus(one, square)
        return {Op.SIN: _over(_plus(t, t), length), Op.COS: _over(_minus(one, square), length)}

    def circle_of(self, node: int) -> dict[Op, Residue] | None:
        """Sine and cosine of the one angle on which a node depends."""
        angles = {
            self.nodes[k].args[0] for k in below(self.nodes, [node]) if self.nodes[k].op in (Op.SIN, Op.COS)
        }
        return self.circles[angles.pop()] if len(angles) == 1 else None

    def values(self, given: Mapping[int, Residue]) -> list[Residue]:
        """Every node up to the last term, those of ``given`` as they are there."""
        known, found = {**self.given, **given}, list[Residue]()
        for i, node in enumerate(self.nodes[: max(t.base for t in self.terms) + 1]):
            if i in known:
                found.append(known[i])
            elif node.value is not None:
                found.append(RESIDUES.enter(node.value))
            else:
                found.append(RESIDUES.apply[node.op](*(found[k] for k in node.args)))
        return found

    def left(self, values: Sequence[Residue]) -> list[Residue]:
        """R"""
        return [values[t.base] for t in self.terms]

    def inner(self, a: Sequence[Residue], b: Sequence[Residue]) -> Residue:
        """The inner product, each part with its factor below the root."""
        total: Residue = RESIDUES.enter(0)
        for t, x, y in zip(self.terms, a, b, strict=True):
            total = _plus(total, _times(RESIDUES.enter(t.factor), _times(x, y)))
        return total

    def forms(self, v: tuple[int, ...], w: int, dividend: int, divisor: int) -> _Forms | None:
        """M, c and the data here; None where R is not linear in x, or what is left not at right angles to it."""
        free = {k: self.number() for k in self.data}  # data as no wheel can have them
        at, step = self.number(), self.number()
        start = self.values(free | {w: at})
        left = self.left(start)

        def moved(by: Mapping[int, Residue]) -> list[Residue]:
            """How R changes with v beside its best, with w and with data."""
            there = free | {w: at}
            there |= {k: _plus(there[k], b) for k, b in by.items() if k in there}
            best = {k: self.values(there)[k] for k in v}
            there |= {k: _plus(best[k], by[k]) if k in by else best[k] for k in v}
            return [_minus(x, y) for x, y in zip(self.left(self.values(there)), left, strict=True)]

        one = RESIDUES.enter(1)
        columns = [moved({k: one}) for k in v]
        turning = moved({w: one})
        by = {k: self.number() for k in v}
        far = moved(by | {w: step})
        for c, s in zip([*columns, turning], [*by.values(), step], strict=True):
            far = [_minus(x, _times(s, y)) for x, y in zip(far, c, strict=True)]
        solved = self.values({})
        level = [self.inner(c, left) for c in columns] + [self.inner(turning, self.left(solved))]
        if any(x.r for x in far + level):
            return None
        factor = _over(self.inner(turning, turning), solved[divisor])
        each = [self._datum(k, free | {j: start[j] for j in (*v, w)}, start, dividend) for k in self.data]
        added = [a for a, _ in each]
        defects = [_plus(_over(self.inner(turning, a), factor), n) for a, n in each]
        matrix = [self.inner(a, b) for a in columns for b in columns]
        return _Forms(matrix, factor, added, defects)

    def _datum(
        self, k: int, there: Mapping[int, Residue], before: Sequence[Residue], dividend: int
    ) -> tuple[list[Residue], Residue]:
        """How R, for a given x, and N change with datum ``k``."""
        after = self.values({**there, k: _plus(there[k], RESIDUES.enter(1))})
        rows = [_minus(x, y) for x, y in zip(self.left(after), self.left(before), strict=True)]
        return rows, _minus(after[dividend], before[dividend])
