"""No rounding error that occurs is above its proved bound, and no bound is far above what occurs."""

from __future__ import annotations

import numpy as np
import pytest

from tests.proofs.gallery import NAMES, proved
from tests.proofs.observe import bred, draw, lengths, run
from wmrgen.ir.nodes import Function, Op
from wmrgen.proofs.bounds import FunctionBound
from wmrgen.proofs.directions import directions

FAST = [
    "clearpath_do100",
    "pioneer3dx",
    "wpilib_swervebot",
    "agilex_ranger",
    "nomad_xr4000",
    "f1tenth",
    "bicycle",
]
GENERATIONS, KEPT = 12, 150


def shares(function: Function, bound: FunctionBound, inputs: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Output -> error over its bound, per point; 0 where none is claimed. Ranges are checked on the way."""
    found = run(function, inputs)
    result = {}
    for o, k in zip(bound.outputs, function.results, strict=True):
        value = found.single[k].astype(np.float64)
        assert np.isfinite(value).all()
        assert ((o.low <= value) & (value <= o.high)).all(), f"{function.name}: {o.name} leaves its range"
        error = np.abs(value - found.exact[k])
        length = lengths(function, found, k) if o.from_length else np.full(len(value), np.inf)
        allowed = o.error + o.per_length / length
        claimed = found.alike & (length >= o.from_length)
        with np.errstate(all="ignore"):
            share = np.where(error > 0, error / allowed, 0.0)
        result[o.name] = np.where(claimed, share, 0.0)
    return result


@pytest.mark.parametrize("name", FAST)
def test_bounds_hold(name: str) -> None:
    for function, bound in proved(name).pairs:
        assert bound.proved
        if bound.inputs:
            for output, share in shares(function, bound, draw(bound.inputs, 3000, 7)).items():
                assert share.max() <= 1, f"{function.name}: {output}"


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_bounds_hold_where_errors_are_largest(name: str) -> None:
    """A search for the worst inputs of each output finds none beyond the bound and some within `loosest` of it."""
    for function, bound in proved(name).pairs:
        assert bound.proved, f"{function.name}: {bound.alarms}"
        if not bound.inputs:
            continue
        inputs = draw(bound.inputs, 20000, 1)
        first = shares(function, bound, inputs)
        for output, share in first.items():
            assert share.max() <= 1, f"{function.name}: {output}"
            if share.max():
                worst = searched(function, bound, output, inputs, share)
                assert worst <= 1, f"{function.name}: {output}"
                assert 1 / worst <= loosest(function, output), f"{function.name}: {output}, {1 / worst:.1f}"


def searched(
    function: Function, bound: FunctionBound, output: str, inputs: dict[str, np.ndarray], share: np.ndarray
) -> float:
    """The largest share of its bound that breeding finds for ``output``."""
    for generation in range(GENERATIONS):
        best = np.argsort(-share)[:KEPT]
        parents, known = {n: v[best] for n, v in inputs.items()}, share[best]
        children = bred(bound.inputs, parents, 2500, generation)
        made = shares(function, bound, children)[output]
        inputs = {n: np.concatenate([parents[n], children[n]]) for n in parents}
        share = np.concatenate([known, made])
    return float(share.max())


def loosest(function: Function, output: str) -> float:
    """How far a bound may be above the worst that was found: 8 times, more where intervals lose what is correlated.

    That is so in quotients of least squares (cars and castors forward), in lengths of residuals, and where steering
    limits cut an angle.
    """
    nodes = function.nodes
    known = directions(nodes)
    quotients = {d.quotient for d in known.values()}
    divides = any(n.op is Op.DIV and i not in quotients for i, n in enumerate(nodes))
    if divides and function.name != "odometry":
        return 400.0 if output == "slip" else 80.0
    if output == "slip":
        return 80.0
    return 25.0 if known and any(n.op in (Op.MIN, Op.MAX, Op.SELECT) for n in nodes) else 8.0
