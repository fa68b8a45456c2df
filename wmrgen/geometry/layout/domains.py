"""What geometry must be, for every value that tunable parameters may have: nothing negative under a root, no divisor,
radius or castor offset that is 0.

Each value in question is a tree over the parameters, which `wmrgen.geometry.layout.boxes` looks at over the box of
their ranges.
A file with a point where a value is wrong is refused. What is neither proved nor refuted is accepted, for
`prepare_checked` tests what it computes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from wmrgen.errors import ErrorCollector, Mark, RobotFileError
from wmrgen.geometry.exact.evaluate import fix, number, substituted
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.boxes import HOLDS, Box, Point, Search, Verdict, apart
from wmrgen.geometry.layout.demands import Demand, demands
from wmrgen.geometry.layout.expressions import Scope, to_poly
from wmrgen.geometry.layout.records import Need, Parameter
from wmrgen.robotfile.records import (
    Binary,
    Call,
    Expr,
    Neg,
    Num,
    Param,
    ParameterSpec,
    Quantity,
    RobotSpec,
    children,
    parameters_in,
)

_SHRUNK = (2, 5, 10, 20, 50, 100)  # parts of a range that are proposed instead
_ROUNDS = 14  # halvings of boxes: 4,096 of them in two dimensions have sides of 1/64
_WORK = 20_000  # rounds times nodes times slopes of all values of a file: a few seconds
_PROPOSED = 40  # values: of more no ranges are looked for in which all of them hold
_HALVINGS = 24  # of the way to a point that a message shows with six digits


class _Judge(NamedTuple):
    """What the parameters of a file are, nominally and in ``trees``. ``total``: values that are judged."""

    spec: RobotSpec
    parameters: Mapping[str, Parameter]
    trees: Mapping[str, Expr]
    total: int = 1

    @staticmethod
    def of(spec: RobotSpec, parameters: Iterable[Parameter]) -> _Judge:
        """The judge of a file whose ``parameters`` all have values."""
        trees = {p.name: p.value.expr for p in spec.parameters if not p.tunable}
        return _Judge(spec, {p.name: p for p in parameters}, trees)

    def tunables_in(self, *exprs: Expr) -> tuple[str, ...]:
        """The tunable parameters that trees depend on, in the order of the file."""
        found, waiting = set[str](), list(exprs)
        while waiting:
            for name in parameters_in(waiting.pop()) - found:
                found.add(name)
                waiting += [self.trees[name]] if name in self.trees else []
        return tuple(name for name, p in self.parameters.items() if name in found and p.tunable)

    def box(self, names: Iterable[str]) -> dict[str, tuple[Exact, Exact]]:
        """The ranges of parameters."""
        return {name: (self.parameters[name].low, self.parameters[name].high) for name in names}

    def value(self, expr: Expr, point: Point, mark: Mark) -> Exact | None:
        """A tree at a point, exactly; parameters without a value there are nominal. None where it has none."""
        values: dict[str, Poly] = {}
        try:
            for p in self.spec.parameters:
                values[p.name] = self._own(p, point, values)
            return number(to_poly(Quantity(expr, "", mark), values), values)
        except (RobotFileError, ZeroDivisionError):
            return None

    def _own(self, p: ParameterSpec, point: Point, values: Mapping[str, Poly]) -> Poly:
        if p.name in point:
            return Poly.of(point[p.name])
        return self.parameters[p.name].value if p.tunable else substituted(to_poly(p.value, values), values)

    def verdict(self, demand: Demand, box: Box | None = None) -> Verdict:
        """Whether a demand holds on a box, that of the ranges unless another is given."""
        if demand.other is not None:
            return self._either(demand, box)
        return self._of_one(demand.value, demand.strict, demand.quantity.mark, box)

    def _of_one(self, value: Expr, strict: bool, mark: Mark, box: Box | None) -> Verdict:
        for expr, strictly in self._factors(value, strict):
            names = self.tunables_in(expr)
            verdict = self._keeps_sign(expr, strictly, mark, box or self.box(names))
            if not verdict.proved:
                return verdict
        return HOLDS

    def _factors(self, expr: Expr, strict: bool) -> Iterator[tuple[Expr, bool]]:
        """What must not be 0 so that ``expr`` is not; of what must only not be negative, itself."""
        match expr:
            case _ if not self.tunables_in(expr):
                return
            case Param(name) if name in self.trees:
                yield from self._factors(self.trees[name], strict)
            case _ if not strict:
                yield expr, False
            case Neg(arg) | Call("sqrt", (arg,)) | Binary("/", arg, _):
                yield from self._factors(arg, True)
            case Binary("**", base, Num(power)):
                yield from self._factors(base, True) if power > 0 else ()
            case Binary("*", left, right):
                yield from self._factors(left, True)
                yield from self._factors(right, True)
            case _:
                yield expr, True

    def _keeps_sign(self, expr: Expr, strict: bool, mark: Mark, box: Box) -> Verdict:
        nominal = self.value(expr, {}, mark)
        sign = -1 if strict and nominal is not None and nominal.sign < 0 else 1

        def wrong(point: Point) -> bool:
            value = self.value(expr, point, mark)
            return value is not None and (value.sign * sign < 0 or (strict and not value))

        names = [name for name in self.tunables_in(expr) if name in box]
        if isinstance(expr, Param) and strict:  # the most usual one: a radius
            fine = all(end.sign == sign for end in box[expr.name])
            return HOLDS if fine else Verdict(False, {expr.name: ZERO})
        rounds = self.rounds(expr)
        with np.errstate(all="ignore"):
            verdict = Search(expr, sign, strict, wrong, names, box, self.trees).run(rounds)
        if strict and verdict.point is not None:
            verdict = Verdict(False, self._where_it_begins(verdict.point, wrong))
        return verdict

    def _where_it_begins(self, point: Point, wrong: Callable[[Point], bool]) -> Point:
        """On the way from the nominal parameters to a wrong ``point``, about the first that is wrong."""
        right, half = {name: self.parameters[name].nominal for name in point}, Exact(Fraction(1, 2))
        for _ in range(_HALVINGS):
            middle = {name: (right[name] + end) * half for name, end in point.items()}
            if wrong(middle):
                point = middle
            else:
                right = middle
        return point

    def _either(self, demand: Demand, box: Box | None) -> Verdict:
        """Whether one of two values is not 0: one of them alone everywhere, or now one and now the other."""
        one, other = demand.value, demand.other
        assert other is not None
        mark = demand.quantity.mark
        pair = [(expr, self.tunables_in(expr)) for expr in (one, other)]
        names = self.tunables_in(one, other)
        whole = {name: (box or self.box(names))[name] for name in names}
        verdicts = []
        for expr, own in pair:
            nominal = self.value(expr, {}, mark)
            if not own or not nominal:
                verdicts.append(HOLDS if nominal else Verdict(False, {}))
            else:
                verdicts.append(self._of_one(expr, True, mark, box))
            if verdicts[-1].proved:
                return HOLDS
        (_, mine), (_, its) = pair
        if set(mine).isdisjoint(its) and all(v.point is not None for v in verdicts):
            return Verdict(False, {**(verdicts[0].point or {}), **(verdicts[1].point or {})})
        with np.errstate(all="ignore"):
            return apart(one, other, whole, self.trees, self.rounds(one, other))

    def rounds(self, *exprs: Expr) -> int:
        """How often boxes are halved to judge trees: fewer times where a file has many or large ones."""
        size = sum(self._size(expr) for expr in exprs) * (1 + len(self.tunables_in(*exprs)))
        return max(1, min(_ROUNDS, _WORK // (size * max(1, self.total))))

    def _size(self, expr: Expr) -> int:
        """The nodes of a tree, those of the parameters in it too."""
        size, waiting = 0, [expr]
        while waiting:
            node = waiting.pop()
            size += 1
            waiting += [self.trees[node.name]] if isinstance(node, Param) and node.name in self.trees else []
            waiting += children(node)
        return size


# ---- what a robot is told


def needs(
    spec: RobotSpec, parameters: tuple[Parameter, ...], scope: Scope, collector: ErrorCollector
) -> tuple[Need, ...]:
    """What the tunable parameters must keep, in polynomials of them; ``several`` takes what their ranges break."""
    judge = _Judge.of(spec, parameters)
    found: dict[object, Need] = {}
    verdicts: dict[object, Verdict] = {}
    narrower: dict[tuple[str, ...], str] = {}
    every = [d for d in demands(spec) if judge.tunables_in(*d.values)]
    judge = judge._replace(total=len({(d.values, d.strict) for d in every}))
    for demand in every:
        if any(error.mark == demand.quantity.mark for error in collector.errors):
            continue  # the whole of a value follows from its parts
        with collector:
            key = demand.values, demand.strict
            verdict = verdicts[key] = verdicts.get(key) or judge.verdict(demand)
            if verdict.point is not None:
                names = judge.tunables_in(*demand.values)
                narrower[names] = narrower.get(names) or _narrower(judge, names, every)
                raise _crossing(judge, demand, verdict.point, narrower[names])
        if (of := (demand.values, demand.strict, demand.problem)) not in found:
            found[of] = _need(demand, scope)
    return tuple(found.values())


def _need(demand: Demand, scope: Scope) -> Need:
    def poly(expr: Expr) -> Poly:
        return fix(scope.poly(replace(demand.quantity, expr=expr)), scope.constants)

    value = poly(demand.value)
    if demand.other is not None:
        other = poly(demand.other)
        value = value * value + other * other
    elif demand.strict and scope.number(value).sign < 0:
        value = -value
    return Need(value, demand.strict, demand.problem, demand.quantity.mark)


def _crossing(judge: _Judge, demand: Demand, point: Point, instead: str) -> RobotFileError:
    own = [judge.parameters[name] for name in judge.tunables_in(*demand.values)]
    if demand.other is None:
        where = f" where {' and '.join(f'{name} = {float(value):.6g}' for name, value in point.items())}"
    else:
        where = f" for some {' and '.join(p.name for p in own)}"
    ranges = ", ".join(f"{p.name} from {float(p.low):.6g} to {float(p.high):.6g}" for p in own)
    why = f"Calibration may change {ranges}, and the generated code accepts all of these values."
    return RobotFileError(f"{demand.problem}{where}", demand.quantity.mark, why, instead)


def _narrower(judge: _Judge, names: Sequence[str], every: Sequence[Demand]) -> str:
    """Ranges to write, in which everything holds, if some are found; else which to narrow."""
    texts = {p.name: p.value.text for p in judge.spec.parameters}
    own = [judge.parameters[name] for name in names]
    concerned = {(d.values, d.strict): d for d in every if set(names) & {*judge.tunables_in(*d.values)}}
    for box in _candidates(own) if len(concerned) <= _PROPOSED else ():
        whole = judge.box(judge.parameters) | box
        if all(judge.verdict(d, whole).proved for d in concerned.values()):
            written = (
                f"{name}: {{value: {texts[name]}, tunable: [{', '.join(f'{float(end):.6g}' for end in ends)}]}}"
                for name, ends in box.items()
            )
            return f"Narrow what is tunable, such as {', '.join(written)}."
    return f"Narrow the range of {' or '.join(names)}: tunable: [low, high]."


def _candidates(own: Sequence[Parameter]) -> Iterator[dict[str, tuple[Exact, Exact]]]:
    """Boxes around the nominal values: smaller and smaller ones, then halves of a range."""

    def end(p: Parameter, side: Exact, part: Fraction) -> Exact:
        """Part of the way from the value to the end of its range, in a number that is short to write."""
        return Exact(Fraction(f"{float(p.nominal + (side - p.nominal) * part):.6g}"))

    parts = [Fraction(1, part) for part in _SHRUNK]
    for part in parts:
        box = {p.name: (end(p, p.low, part), end(p, p.high, part)) for p in own}
        if all(
            low <= p.nominal <= high and low < high for p, (low, high) in zip(own, box.values(), strict=True)
        ):
            yield box
    for part in (Fraction(1), *parts):
        for p in own:
            halves = (end(p, p.low, part), p.nominal), (p.nominal, end(p, p.high, part))
            yield from ({p.name: half} for half in halves if half[0] < half[1])
