"""Slips as what a fit leaves: the identities that bounds rest on and each part of the bounds, against numpy's lstsq."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest

from tests.bounds.gallery import LIBM_C, NAMES, proved
from tests.bounds.observe import EXACT, draw, run
from tests.bounds.search import rates
from tests.bounds.small import walked
from wmrgen.bounds.fits import Fit, fit_of
from wmrgen.bounds.identities import waved
from wmrgen.bounds.leftover import Parts, _Apart, left_over, parts_of
from wmrgen.bounds.patterns import cone
from wmrgen.bounds.precision import library
from wmrgen.bounds.robot import FunctionBound
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.residues import PRIME, Residue
from wmrgen.ir.rounding import to_float64

FITS = ["kelly_4ws", "neobotix_mpo_700", "nomad_xr4000", "pr2", "tidybot2"]
EACH = [pytest.param(n, marks=[] if n == "kelly_4ws" else pytest.mark.slow) for n in FITS]
OTHER = {Op.ADD: Op.SUB, Op.SUB: Op.ADD}
At = Callable[[Mapping[int, float]], list[float]]


@dataclass(frozen=True)
class Slip:
    """`forward_slip` of a robot."""

    function: Function
    bound: FunctionBound
    fit: Fit

    def left(self, values: list[float]) -> np.ndarray:
        return np.array([np.sqrt(float(t.factor)) * values[t.base] for t in self.fit.terms])

    def solution(self, at: At, data: Mapping[int, float]) -> tuple[np.ndarray, np.ndarray]:
        """What numpy finds for ``data`` with A as it is ``at`` a point: x, w last; and A."""
        x = [*self.fit.v, self.fit.w]
        still = dict.fromkeys(x, 0.0)
        start = self.left(at({**data, **still}))
        columns = [self.left(at({**data, **still, k: 1.0})) - start for k in x]
        matrix = np.array(columns).T
        return np.linalg.lstsq(matrix, -start, rcond=None)[0], matrix


def _slip(name: str) -> Slip:
    ((function, bound),) = [(f, b) for f, b in proved(name).pairs if f.name == "forward_slip"]
    fit = fit_of(function)
    assert fit is not None
    return Slip(function, bound, fit)


def _at(function: Function, inputs: Mapping[str, float]) -> At:
    """Every node in float64, some as given."""

    def values(given: Mapping[int, float]) -> list[float]:
        found: list[float] = []
        for i, node in enumerate(function.nodes):
            if i in given:
                found.append(given[i])
            elif node.value is not None:
                found.append(to_float64(node.value))
            elif node.op is Op.INPUT:
                found.append(inputs[node.name or ""])
            else:
                found.append(float(EXACT[node.op.value](*(found[k] for k in node.args))))
        return found

    return values


def _anywhere(function: Function, seed: int) -> At:
    rng = np.random.default_rng(seed)
    return _at(function, {p.name: rng.uniform(-2, 2) for p in function.inputs})


@pytest.mark.slow
def test_fits_are_those_of_offset_wheels() -> None:
    """Of the gallery: a divisor that moves, and no guard."""
    assert [n for n in NAMES if any(fit_of(f) for f, _ in proved(n).pairs)] == FITS


@pytest.mark.parametrize("name", EACH)
def test_errors_add_at_right_angles(name: str) -> None:
    """|R(v + dv, w + dw)|^2 = |R|^2 + dv M dv + c D dw^2, v the best for w + dw."""
    slip = _slip(name)
    fit = slip.fit
    for seed in range(20):
        at = _anywhere(slip.function, seed)
        solved = at({})
        steps = np.random.default_rng(seed + 100).uniform(-1, 1, len(fit.v) + 1)
        turned = at({fit.w: solved[fit.w] + steps[-1]})
        beside = {k: turned[k] + d for k, d in zip(fit.v, steps, strict=False)}
        moved = at({fit.w: turned[fit.w]} | beside)
        more = steps[:-1] @ fit.matrix @ steps[:-1] + fit.factor * solved[fit.divisor] * steps[-1] ** 2
        squares = [float(x @ x) for x in (slip.left(moved), slip.left(solved))]
        assert squares[0] - squares[1] == pytest.approx(more, rel=2e-5)


@pytest.mark.parametrize("name", EACH)
def test_other_data_put_the_dividend_off_by_their_defects(name: str) -> None:
    """For data that no wheel can have v is still the best; N is off by what was simplified."""
    slip = _slip(name)
    fit, data = slip.fit, [d.node for d in slip.fit.data]
    weights = np.sqrt([float(t.factor) for t in fit.terms])
    assert data and any(d.defect for d in fit.data)
    used = 0.0
    for seed in range(20):
        at = _anywhere(slip.function, seed)
        natural = at({})
        off = np.random.default_rng(seed + 100).uniform(-1, 1, len(data))
        free = {k: natural[k] + d for k, d in zip(data, off, strict=True)}
        best, _ = slip.solution(at, free)
        found, given_w = at(free), at(free | {fit.w: best[-1]})
        assert [given_w[k] for k in fit.v] == pytest.approx(best[:-1], rel=1e-9, abs=1e-9)
        apart = abs(found[fit.dividend] - found[fit.divisor] * best[-1])
        most = sum(d.defect * abs(e) for d, e in zip(fit.data, off, strict=True))
        assert apart <= most
        used = max(used, apart / most)
        x = {k: natural[k] for k in (*fit.v, fit.w)}
        change = np.abs(slip.left(at(free | x)) - slip.left(at(x)))
        by_columns = weights * sum(d.column * abs(e) for d, e in zip(fit.data, off, strict=True))
        assert np.all(change <= by_columns * (1 + 1e-9) + 1e-12)
        assert change.max() > 0.5 * by_columns.max()
    assert used > 0.1


@pytest.mark.parametrize("name", EACH)
def test_every_part_of_a_bound_holds(name: str) -> None:
    """Each error that the bound adds up, as it occurs, is below its part of the bound and not far below."""
    slip = _slip(name)
    fit, function = slip.fit, slip.function
    walk = walked(function, slip.bound.inputs, library(LIBM_C))
    parts = parts_of(fit, function, walk)
    inverse, known = {f.name: (f, b) for f, b in proved(name).pairs}["inverse"]
    anywhere = draw(slip.bound.inputs, 150, 3)
    fitting = rates(inverse, slip.bound.inputs, draw(known.inputs, 150, 4))
    points = {n: np.concatenate([v, fitting[n]]) for n, v in anywhere.items()}
    found = run(function, points)
    seen = dict.fromkeys(("rows", "data", "beside", "turned", "longest"), 0.0)
    for j in range(300):
        single = [float(v[j]) for v in found.single]
        at = _at(function, {n: float(v[j]) for n, v in points.items()})
        natural = at({})
        data = {d.node: single[d.node] for d in fit.data}
        for k in data:
            if k in walk.rows:  # as products of what the float program has
                a, b = function.nodes[k].args
                data[k] = single[a] * single[b]
        (*_, best), matrix = slip.solution(at, data)
        here = at({**data, fit.w: single[fit.w]})
        x = {k: single[k] for k in (*fit.v, fit.w)}
        left = slip.left(single)
        still = dict.fromkeys(x, 0.0)
        dv = np.array([single[k] - here[k] for k in fit.v])
        turned = here[fit.divisor] * fit.factor * (single[fit.w] - best) ** 2
        occurs = {
            "rows": np.linalg.norm(left - slip.left(at({**data, **x}))) - 2**-24 * np.linalg.norm(left),
            "data": np.linalg.norm(slip.left(at({**data, **x})) - slip.left(at(x))),
            "beside": np.linalg.norm(matrix[:, :-1] @ dv),
            "turned": np.sqrt(turned),
            "longest": np.linalg.norm(slip.left(at(still))),
        }
        for part, value in occurs.items():
            seen[part] = max(seen[part], float(value) / getattr(parts, part))
        assert here[fit.divisor] == pytest.approx(natural[fit.divisor])
    assert all(0.03 < share <= 1 for share in seen.values()), seen


@pytest.mark.parametrize("name", EACH)
def test_the_bound_is_the_sum_of_its_parts(name: str) -> None:
    """At least what they add up to where nothing is left; and 0.6 of the plain bounds at most."""
    slip = _slip(name)
    walk = walked(slip.function, slip.bound.inputs, library(LIBM_C))
    parts, claim = parts_of(slip.fit, slip.function, walk), left_over(slip.fit, slip.function, walk)
    roundings = 2**-24 * (max(t.roundings for t in slip.fit.terms) / 2 + 2) * parts.longest
    own = parts.rows + parts.data
    assert claim.error >= own + np.hypot(parts.beside, parts.turned)
    assert claim.error >= own + roundings
    assert claim.error < 0.6 * float(walk.result.error(slip.fit.root)[0])
    assert parts.longest < claim.high < 0.6 * float(walk.range(slip.fit.root)[1][0])
    (published,) = [o for o in slip.bound.outputs if o.name == "slip"]
    assert published.error == pytest.approx(claim.error, rel=1e-5)


@pytest.mark.parametrize("name", EACH)
def test_errors_put_in_by_hand_are_bounded(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """1e-3 of one thing at a time, in place of all roundings: what it does to w or v, and not far more."""
    slip = _slip(name)
    fit, function = slip.fit, slip.function
    points = draw(slip.bound.inputs, 300, 5)
    exact = run(function, points).exact
    n, d, c = exact[fit.dividend], exact[fit.divisor], fit.factor

    def bounded(what: str) -> Parts:
        walk = walked(function, slip.bound.inputs, library(LIBM_C))
        walk.result.noise[:] = 0.0
        if what in ("divisor", "datum"):
            node = fit.divisor if what == "divisor" else fit.data[0].node
            rounded = [k for k in cone(function.nodes, [node]) if k in walk.sources and k not in walk.arms]
            for k in rounded if what == "datum" else (node,):
                walk.result.noise[walk.sources[k]] = 1e-3
        one = {"dividend": lambda a, k: 1e-3 * (k == a.dividend), "v": lambda a, k: 1e-3 * (k == a.v[0])}
        monkeypatch.setattr(_Apart, "error", one.get(what, lambda a, k: 0.0))
        return parts_of(fit, function, walk)

    occurs = {
        "dividend": np.sqrt(c * d) * np.abs((n + 1e-3) / d - n / d),
        "divisor": np.sqrt(c * d) * np.abs(n / (d - 1e-3) - n / d),
    }
    for what, values in occurs.items():
        assert values.max() <= bounded(what).turned <= 20 * values.max(), what
    assert bounded("v").beside == pytest.approx(1e-3 * np.sqrt(fit.matrix[0, 0]))
    parts = bounded("datum")
    assert parts.data >= 1e-3 * np.linalg.norm(fit.data[0].column)
    assert parts.turned >= 1e-3 * fit.data[0].defect * np.sqrt(c / d.max())
    assert parts.rows == pytest.approx(bounded("nothing").rows)


def test_what_is_relative_counts_where_most_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    slip = _slip("kelly_4ws")
    walk = walked(slip.function, slip.bound.inputs, library(LIBM_C))
    monkeypatch.setattr("wmrgen.bounds.leftover.parts_of", lambda *_: Parts(0.0, 0.0, 0.0, 1e-6, 10.0))
    roundings = max(t.roundings for t in slip.fit.terms) / 2 + 2  # of the sum, of the root, of each part
    claim = left_over(slip.fit, slip.function, walk)
    assert claim.error == pytest.approx(roundings * 10 * 2**-24, rel=1e-3)
    assert 10 < claim.high < 10.001


@pytest.mark.parametrize("name", EACH[:3])
def test_what_is_not_the_least_is_no_fit(name: str) -> None:
    """Any sum of the solution with the other sign, one at a time."""
    slip = _slip(name)
    nodes, x = slip.function.nodes, [*slip.fit.v, slip.fit.w]
    alone = cone(nodes, x) - cone(nodes, [slip.fit.root], x)
    tried = [k for k in sorted({*alone, *slip.fit.v}) if nodes[k].op in OTHER]
    for k in tried:
        assert _changed(slip.function, k, Node(OTHER[nodes[k].op], nodes[k].args)) is None, k
    assert len(tried) > 20


def _changed(function: Function, k: int, node: Node) -> Fit | None:
    nodes = list(function.nodes)
    nodes[k] = node
    return fit_of(replace(function, nodes=tuple(nodes)))


@pytest.mark.parametrize("op", [Op.MIN, Op.MAX, Op.ABS, Op.MUL])
def test_only_formulas_linear_in_the_solution_are_fits(op: Op) -> None:
    """A part of R cut off, without its sign, or with v times w in it."""
    slip = _slip("nomad_xr4000")
    nodes, x = slip.function.nodes, {*slip.fit.v, slip.fit.w}
    beside = cone(nodes, [t.base for t in slip.fit.terms], x) - cone(nodes, x)
    k = next(i for i in sorted(beside) if nodes[i].op in OTHER and cone(nodes, [i], x) & x)
    node = Node(op, nodes[k].args[:1] if op is Op.ABS else nodes[k].args)
    assert _changed(slip.function, k, node) is None


def _numbers(*values: int) -> list[Residue]:
    return [Residue(v % PRIME, float(v)) for v in values]


def test_defects_are_waves_or_nothing() -> None:
    """3 s + 4 c over three circles; the same but for one; of unknown angles; none at all."""
    circles = [dict(zip((Op.SIN, Op.COS), _numbers(s, c), strict=True)) for s, c in ((1, 2), (3, -1), (5, 7))]
    assert waved(_numbers(11, 5, 43), circles) == pytest.approx(5.0)
    assert waved(_numbers(11, 5, 44), circles) is None
    assert waved(_numbers(11, 5, 43), [None, *circles[1:]]) is None
    assert waved(_numbers(0, 0, 0), [None, None, None]) == 0.0
