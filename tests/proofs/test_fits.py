"""Slips as what a fit leaves: the identities that bounds rest on, against numpy's least squares; and what is no fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from tests.proofs.gallery import LIBM_C, NAMES, proved
from tests.proofs.observe import EXACT
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.rounding import to_float64
from wmrgen.proofs.analysis import Pass
from wmrgen.proofs.bounds import FunctionBound
from wmrgen.proofs.boxes import boxed
from wmrgen.proofs.fits import Fit, below, fit_of
from wmrgen.proofs.leftover import left_over
from wmrgen.proofs.precision import SINGLE, library

FITS = ["kelly_4ws", "neobotix_mpo_700", "nomad_xr4000", "pr2", "tidybot2"]


def _slip(name: str) -> tuple[Function, FunctionBound, Fit]:
    ((function, bound),) = [(f, b) for f, b in proved(name).pairs if f.name == "forward_slip"]
    fit = fit_of(function)
    assert fit is not None
    return function, bound, fit


def _values(function: Function, given: Mapping[int, float], rng: np.random.Generator) -> list[float]:
    """Every node at a point that ``rng`` draws, those of ``given`` as they are there."""
    found: list[float] = []
    for i, node in enumerate(function.nodes):
        drawn = rng.uniform(-2, 2) if node.op is Op.INPUT else 0.0
        if i in given:
            found.append(given[i])
        elif node.value is not None:
            found.append(to_float64(node.value))
        elif node.op is Op.INPUT:
            found.append(drawn)
        else:
            found.append(float(EXACT[node.op.value](*(found[k] for k in node.args))))
    return found


def _left(fit: Fit, values: list[float]) -> np.ndarray:
    return np.array([np.sqrt(float(t.factor)) * values[t.base] for t in fit.terms])


def test_fits_are_those_of_offset_wheels() -> None:
    """Of the gallery: a divisor that moves, and no guard."""
    assert [n for n in NAMES if any(fit_of(f) for f, _ in proved(n).pairs)] == FITS


@pytest.mark.parametrize("name", FITS)
def test_errors_add_at_right_angles(name: str) -> None:
    """|R(v + dv, w + dw)|^2 = |R|^2 + dv M dv + c D dw^2, v the best for w + dw: at points of no significance."""
    function, _, fit = _slip(name)
    for seed in range(20):

        def at(given: Mapping[int, float], seed: int = seed) -> list[float]:
            return _values(function, given, np.random.default_rng(seed))

        solved = at({})
        steps = np.random.default_rng(seed + 100).uniform(-1, 1, len(fit.v) + 1)
        turned = at({fit.w: solved[fit.w] + steps[-1]})
        beside = {k: turned[k] + d for k, d in zip(fit.v, steps, strict=False)}
        moved = at({fit.w: turned[fit.w]} | beside)
        more = steps[:-1] @ fit.matrix @ steps[:-1] + fit.factor * solved[fit.below] * steps[-1] ** 2
        squares = [float(x @ x) for x in (_left(fit, moved), _left(fit, solved))]
        assert squares[0] - squares[1] == pytest.approx(more, rel=2e-5)


@pytest.mark.parametrize("name", FITS)
def test_other_data_put_the_dividend_off_by_their_defects(name: str) -> None:
    """N/D beside numpy's solution for data that no wheel can have: v is the best, w off by what was simplified."""
    function, _, fit = _slip(name)
    data, x = [d.node for d in fit.data], [*fit.v, fit.w]
    assert data and any(d.defect for d in fit.data)
    used = 0.0
    for seed in range(20):

        def at(given: Mapping[int, float], seed: int = seed) -> list[float]:
            return _values(function, given, np.random.default_rng(seed))

        natural = at({})
        off = np.random.default_rng(seed + 100).uniform(-1, 1, len(data))
        free = {k: natural[k] + d for k, d in zip(data, off, strict=True)}
        still = dict.fromkeys(x, 0.0)
        start = _left(fit, at(free | still))
        columns = np.array([_left(fit, at(free | still | {k: 1.0})) - start for k in x]).T
        best = np.linalg.lstsq(columns, -start, rcond=None)[0]
        found = at(free)
        given_w = at(free | {fit.w: best[-1]})
        assert [given_w[k] for k in fit.v] == pytest.approx(best[:-1], rel=1e-9, abs=1e-9)
        apart = abs(found[fit.above] - found[fit.below] * best[-1])
        most = sum(d.defect * abs(e) for d, e in zip(fit.data, off, strict=True))
        assert apart <= most
        used = max(used, apart / most)
        by_columns = sum(d.column * abs(e) for d, e in zip(fit.data, off, strict=True))
        change = np.abs(_left(fit, at(free | still)) - _left(fit, at(still)))
        weights = np.sqrt([float(t.factor) for t in fit.terms])
        assert np.all(change <= weights * by_columns * (1 + 1e-9) + 1e-12)
    assert used > 0.1


@pytest.mark.parametrize("name", ["kelly_4ws", "nomad_xr4000"])
def test_what_is_not_the_least_is_no_fit(name: str) -> None:
    """Any sum of the solution with the other sign, one at a time."""
    function, _, fit = _slip(name)
    alone = below(function.nodes, [*fit.v, fit.w]) - below(function.nodes, [fit.root], [*fit.v, fit.w])
    other = {Op.ADD: Op.SUB, Op.SUB: Op.ADD}
    tried = [k for k in sorted({*alone, *fit.v}) if function.nodes[k].op in other]
    for k in tried:
        node = function.nodes[k]
        nodes = list(function.nodes)
        nodes[k] = Node(other[node.op], node.args)
        assert fit_of(replace(function, nodes=tuple(nodes))) is None, k
    assert len(tried) > 20


@pytest.mark.parametrize("name", FITS)
def test_slips_gain_by_it(name: str) -> None:
    """Half the plain bound at most; and no slip is longer than what the wheels say."""
    function, bound, fit = _slip(name)
    walk = Pass(function, boxed(bound.inputs, [], 1), SINGLE, library(LIBM_C))
    walk.run()
    plain, claim = float(walk.result.error(fit.root)[0]), left_over(fit, function, walk)
    assert claim.error < 0.5 * plain
    assert claim.high < 0.5 * float(walk.range(fit.root)[1][0])
    (published,) = [o for o in bound.outputs if o.name == "slip"]
    assert published.error == pytest.approx(claim.error, rel=1e-5)
