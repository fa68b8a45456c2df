"""Polynomials of sines and cosines: expansions, their bounds, quotients of least squares; and what is none."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from tests.bounds.gallery import proved
from tests.bounds.observe import draw, run
from tests.bounds.small import OUT, walked
from wmrgen.bounds import gram
from wmrgen.bounds import interval as iv
from wmrgen.bounds.analysis import Pass
from wmrgen.bounds.circles import Poly
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Op, Port, Role

CASTORS = ["nomad_xr4000", "tidybot2", "neobotix_mpo_700", "kelly_4ws", "pr2"]
TURN = (-3.2, 3.2)
RANGES = {"vx": (-2.0, 2.0), "vy": (-3.0, 3.0), "a": TURN, "b": TURN}


def _function(make: Callable[[Builder, dict[str, int]], int]) -> Function:
    builder = Builder()
    at = {n: builder.input(n) for n in RANGES}
    ports = tuple(Port(n, Role.COMMAND, "1", "an input") for n in RANGES)
    return builder.function("control", ports, OUT, [make(builder, at)])


def _values(walk: Pass, found: Poly, exact: list[np.ndarray]) -> np.ndarray:
    """A polynomial at the points where ``exact`` are the values of the nodes."""
    return np.asarray(
        sum(c * np.prod([exact[k] for k in m], axis=0, initial=1.0) for m, c in found.terms.items())
    )


@pytest.mark.parametrize("name", CASTORS)
def test_fits_of_castors_are_known(name: str) -> None:
    """Expansions agree with the nodes; omega is bounded as one of least squares."""
    for f, b in proved(name).pairs:
        if f.name == "forward":
            ((above, below),) = {n.args for n in f.nodes if n.op is Op.DIV}
            walk, found = walked(f, b.inputs), run(f, draw(b.inputs, 4000, 3))
            exact, single = found.exact, found.single
            for k in (above, below):
                form = walk.circles.of(k)
                at = _values(walk, form, exact)
                assert np.abs(at - exact[k]).max() <= 1e-9 * np.abs(exact[k]).max()
                there = _values(walk, form, [np.asarray(v, dtype=np.float64) for v in single])
                assert np.abs(there - single[k]).max() <= form.slack
            lo, hi = (float(end[0]) for end in walk.range(below))
            assert lo <= exact[below].min() and exact[below].max() <= hi
            most = gram.quotient(walk, above, below)
            assert most is not None
            seen = float(np.abs(exact[above] / exact[below]).max())
            plain = float(iv.magnitude(walk.range(above))[0]) / lo
            assert seen <= float(most[0]) < 0.85 * plain


@pytest.mark.parametrize("count", [1, 2, 4])
def test_bounds_of_polynomials_on_circles_hold(count: int) -> None:
    rng, known = np.random.default_rng(count), 0
    for _ in range(10):
        weights = [int(v) for v in rng.integers(-9, 10, 20)]
        names = ("a", "b")[: min(count, 2)]

        def make(b: Builder, at: dict[str, int], weights: list[int] = weights, names: tuple = names) -> int:
            waves = [w for n in names for w in (b.cos(at[n]), b.sin(at[n]))][:count]
            linear = [b.mul(b.const(Fraction(w, 3)), x) for w, x in zip(weights, waves, strict=False)]
            pairs = [(x, y) for i, x in enumerate(waves) for y in waves[i:]]
            square = [b.product((b.const(w), x, y)) for w, (x, y) in zip(weights[4:], pairs, strict=False)]
            return b.sum([b.const(weights[-1]), *linear, *square])

        f = _function(make)
        walk = walked(f, RANGES)
        bounds = walk.circles.range(walk.circles.of(f.results[0]))
        seen = run(f, draw(RANGES, 20000, 1)).single[f.results[0]]
        if bounds is not None:
            known += 1
            assert bounds[0][0] <= seen.min() and seen.max() <= bounds[1][0]
    assert known >= 8  # all but those whose squares cancel


def test_one_circle_is_exact() -> None:
    """3 c + 4 s + 2 s s on one circle: by one multiplier, the bounds are those that occur."""

    def make(b: Builder, at: dict[str, int]) -> int:
        c, s = b.cos(at["a"]), b.sin(at["a"])
        return b.sum([b.mul(b.const(3), c), b.mul(b.const(4), s), b.product((b.const(2), s, s))])

    f = _function(make)
    walk = walked(f, RANGES)
    bounds = walk.circles.range(walk.circles.of(f.results[0]))
    a = np.linspace(-np.pi, np.pi, 100001)
    value = 3 * np.cos(a) + 4 * np.sin(a) + 2 * np.sin(a) ** 2
    assert bounds is not None
    assert bounds[0][0] == pytest.approx(value.min(), rel=2e-3) and bounds[0][0] <= value.min()
    assert bounds[1][0] == pytest.approx(value.max(), rel=2e-3) and bounds[1][0] >= value.max()


def _above(b: Builder, at: dict[str, int]) -> int:
    """vx (2 + cos a + cos b) + vy (sin a - sin b)."""
    first = b.mul(at["vx"], b.sum([b.const(2), b.cos(at["a"]), b.cos(at["b"])]))
    return b.add(first, b.mul(at["vy"], b.sub(b.sin(at["a"]), b.sin(at["b"]))))


def _squares(b: Builder, at: dict[str, int], second: int) -> int:
    """(2 + cos a + cos b)**2 + ``second`` (sin a - sin b)**2, multiplied out and regrouped."""
    ca, cb, sa, sb = b.cos(at["a"]), b.cos(at["b"]), b.sin(at["a"]), b.sin(at["b"])
    whole = b.sum(
        [b.const(4 + 2 * second), b.mul(b.const(4), b.add(ca, cb)), b.product((b.const(2), ca, cb))]
    )
    rest = b.add(b.mul(b.const(1 - second), b.square(ca)), b.mul(b.const(1 - second), b.square(cb)))
    return b.sub(b.add(whole, rest), b.product((b.const(2 * second), sa, sb)))


@pytest.mark.parametrize(("second", "fits"), [(1, True), (3, True), (-1, False)])
def test_only_a_positive_matrix_counts(second: int, fits: bool) -> None:
    """x h over h G h is recognised where G is positive; where it is not, a vector may be longer than its square."""
    f = _function(
        lambda b, at: b.div(_above(b, at), b.max(_squares(b, at, second), b.const(Fraction(1, 10))))
    )
    walk = walked(f, RANGES)
    node = f.nodes[f.results[0]]
    most = gram.quotient(walk, *node.args)
    assert (most is not None) == fits
    if most is not None:
        seen = float(np.abs(run(f, draw(RANGES, 50000, 5)).exact[f.results[0]]).max())
        wanted = np.sqrt((4 + 9 / second) / 0.1)
        assert seen <= float(most[0]) == pytest.approx(wanted, rel=1e-2)


def test_a_divisor_of_another_shape_is_not_taken_for_one() -> None:
    f = _function(
        lambda b, at: b.div(_above(b, at), b.add(b.const(9), b.product((b.cos(at["a"]), b.sin(at["b"])))))
    )
    walk = walked(f, RANGES)
    assert gram.quotient(walk, *f.nodes[f.results[0]].args) is None


def test_the_smaller_of_two_is_no_divisor() -> None:
    """Where the divisor is a constant smaller than h G h, nothing bounds the quotient by Cauchy and Schwarz."""
    f = _function(lambda b, at: b.div(_above(b, at), b.min(_squares(b, at, 1), b.const(Fraction(1, 10)))))
    walk = walked(f, RANGES)
    assert gram.quotient(walk, *f.nodes[f.results[0]].args) is None
