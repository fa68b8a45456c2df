"""What makes a fit, modulo a prime at random points (see `wmrgen.bounds.fits` for R, v, w, M, c, D, N).

At a point a sine and its cosine lie on a circle; all else, data included, is free. What holds at all points does not
hold in general with a probability of about 2**-50.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from wmrgen.bounds.patterns import Term, cone
from wmrgen.ir.nodes import Node, Op
from wmrgen.ir.residues import PRIME, RESIDUES, Residue
from wmrgen.ir.verify import mix

POINTS = 3  # two for the numbers of a wave, another to see that it is one
Circle: TypeAlias = Mapping[Op, Residue]
_ZERO, _ONE = RESIDUES.enter(0), RESIDUES.enter(1)
_plus, _minus, _times, _over = (RESIDUES.apply[op] for op in (Op.ADD, Op.SUB, Op.MUL, Op.DIV))


@dataclass(frozen=True, slots=True)
class Forms:
    """M and c; per datum: what a change of one adds to the parts of R, and how much of N's change is a defect."""

    matrix: list[list[Residue]]
    factor: Residue
    columns: list[list[Residue]]
    defects: list[Residue]

    def numbers(self) -> list[Residue]:
        """What does not depend on the point."""
        return [self.factor, *(x for rows in (self.matrix, self.columns) for row in rows for x in row)]


def same(found: Sequence[Sequence[Residue]]) -> bool:
    """Whether all have the same numbers."""
    return all([x.r for x in f] == [x.r for x in found[0]] for f in found)


def waved(values: Sequence[Residue], circles: Sequence[Circle | None]) -> float | None:
    """The amplitude |(a, b)| where every value is a sin + b cos on its circle; None where they are no such wave."""
    if not any(x.r for x in values):
        return 0.0
    known = [(c[Op.SIN], c[Op.COS]) for c in circles if c is not None]
    if len(known) < len(values):
        return None
    (s, c), (t, d) = known[:2]  # two equations for a and b
    area = _minus(_times(s, d), _times(c, t))
    a = _over(_minus(_times(values[0], d), _times(c, values[1])), area)
    b = _over(_minus(_times(s, values[1]), _times(values[0], t)), area)
    for x, (sine, cosine) in zip(values, known, strict=True):
        if _minus(x, _plus(_times(a, sine), _times(b, cosine))).r:
            return None
    return float((a.size**2 + b.size**2) ** 0.5)


class Point:
    """A random point. Residues and sizes are drawn apart: nothing here compares."""

    def __init__(
        self, nodes: Sequence[Node], terms: Sequence[Term], data: tuple[int, ...], seed: int
    ) -> None:
        self.terms, self.data, self.seed, self.drawn = terms, data, seed, 0
        self.nodes = nodes[: max(t.base for t in terms) + 1]
        self.weights = [RESIDUES.enter(t.factor) for t in terms]
        self.given: dict[int, Residue] = {}
        self.circles: dict[int, Circle] = {}
        for i, node in enumerate(self.nodes):
            if node.value is not None:
                self.given[i] = RESIDUES.enter(node.value)
            elif node.op is Op.INPUT:
                self.given[i] = self.number()
            elif node.op in (Op.SIN, Op.COS):
                if node.args[0] not in self.circles:
                    self.circles[node.args[0]] = self._circle()
                self.given[i] = self.circles[node.args[0]][node.op]

    def number(self) -> Residue:
        """The next one, of a size between 0.5 and 2."""
        self.drawn += 1
        residue, size = (mix(self.seed, self.drawn, k) for k in (0, 1))
        return Residue(residue % (PRIME - 1) + 1, 0.5 + 1.5 * size / 2**64)

    def _circle(self) -> Circle:
        t = self.number()
        square = _times(t, t)
        length = _plus(_ONE, square)
        return {Op.SIN: _over(_plus(t, t), length), Op.COS: _over(_minus(_ONE, square), length)}

    def circle_of(self, node: int) -> Circle | None:
        """Sine and cosine of the one angle on which a node depends."""
        waves = [k for k in cone(self.nodes, [node]) if self.nodes[k].op in (Op.SIN, Op.COS)]
        angles = {self.nodes[k].args[0] for k in waves}
        return self.circles[angles.pop()] if len(angles) == 1 else None

    def forms(self, v: tuple[int, ...], w: int, dividend: int, divisor: int) -> Forms | None:
        """M, c and the data; None where R is not linear in x, or what is left not at right angles to A."""
        try:
            return self._forms(v, w, dividend, divisor)
        except ZeroDivisionError:
            return None

    def _forms(self, v: tuple[int, ...], w: int, dividend: int, divisor: int) -> Forms | None:
        free = {k: self.number() for k in self.data}
        start = self._values(free | {w: self.number()})
        here = free | {k: start[k] for k in (*v, w)}

        def changed(by: Mapping[int, Residue]) -> list[Residue]:
            """How R changes with w, v going along as the best, and with v beside it."""
            best = self._values(free | {w: _plus(here[w], by.get(w, _ZERO))})
            x = {w: best[w]} | {k: _plus(best[k], by.get(k, _ZERO)) for k in v}
            return self._apart(self._values(free | x), start)

        columns, turning = [changed({k: _ONE}) for k in v], changed({w: _ONE})
        steps = {k: self.number() for k in (*v, w)}
        curved = changed(steps)
        for k, column in zip((*v, w), (*columns, turning), strict=True):
            curved = [_minus(x, _times(steps[k], y)) for x, y in zip(curved, column, strict=True)]
        possible = self._values({})  # of data that wheels can have, w is the best
        tilted = [self._inner(c, self._parts(start)) for c in columns]
        tilted.append(self._inner(turning, self._parts(possible)))
        if any(x.r for x in curved + tilted):
            return None
        factor = _over(self._inner(turning, turning), possible[divisor])
        added, defects = [], []
        for k in self.data:
            after = self._values(here | {k: _plus(here[k], _ONE)})
            added.append(self._apart(after, start))
            wanted = _over(
                _minus(_ZERO, self._inner(turning, added[-1])), factor
            )  # of N, for w to stay the best
            defects.append(_minus(_minus(after[dividend], start[dividend]), wanted))
        matrix = [[self._inner(a, b) for b in columns] for a in columns]
        return Forms(matrix, factor, added, defects)

    def _values(self, given: Mapping[int, Residue]) -> list[Residue]:
        """Every node up to the last part of R, those of ``given`` as they are there."""
        known, found = {**self.given, **given}, list[Residue]()
        for i, node in enumerate(self.nodes):
            made = known.get(i)
            found.append(RESIDUES.apply[node.op](*(found[k] for k in node.args)) if made is None else made)
        return found

    def _parts(self, values: Sequence[Residue]) -> list[Residue]:
        """Those of R."""
        return [values[t.base] for t in self.terms]

    def _apart(self, values: Sequence[Residue], before: Sequence[Residue]) -> list[Residue]:
        """The change of R."""
        return [_minus(x, y) for x, y in zip(self._parts(values), self._parts(before), strict=True)]

    def _inner(self, a: Sequence[Residue], b: Sequence[Residue]) -> Residue:
        """The inner product of two R, each part with its factor below the root."""
        total: Residue = _ZERO
        for weight, x, y in zip(self.weights, a, b, strict=True):
            total = _plus(total, _times(weight, _times(x, y)))
        return total
