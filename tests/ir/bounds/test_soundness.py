"""No program that the model allows leaves its claimed range, or errs more than claimed: random functions, an oracle.

The oracle (`tests.ir.bounds.oracle`) shares no code with the bounds. Points are at ends of ranges, at zeros of either
sign, at quarter turns, on both sides of each comparison, and anywhere.
"""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from tests.ir.bounds.oracle import Runs
from tests.ir.bounds.programs import Program, beside_thresholds, points, program
from wmrgen.ir.bounds.analysis import Claim, Outcome, analysed
from wmrgen.ir.bounds.assumptions import LIBM
from wmrgen.ir.bounds.patterns import SMALL_ANGLE

EVERYDAY, DEEP = range(150), range(150, 1500)
POINTS, EXACT_POINTS = 300, 12
ROOM = 1 + 1e-9  # for the float64 arithmetic of the oracle [1]


def runs_of(made: Program, seed: int) -> tuple[Outcome, Runs]:
    """The claims of a random function, and runs at points of its ranges."""
    outcome = analysed(made.function, made.ranges, LIBM)
    tried = points(made.ranges, POINTS, seed)
    beside = beside_thresholds(made.function, tried)
    return outcome, Runs.of(made.function, {n: np.concatenate([v, beside[n]]) for n, v in tried.items()})


def allowed(claim: Claim, h: np.ndarray) -> np.ndarray:
    """The claimed error for vectors of length ``h``; infinite where there is no claim."""
    if claim.singular:
        return np.full(len(h), np.inf)
    with np.errstate(all="ignore"):
        error = claim.error + (claim.per_length / h if claim.per_length else 0.0)
    return np.where(h >= SMALL_ANGLE * claim.length_error, error, np.inf)


def check(seed: int) -> Counter[str]:
    """All claims of one random function; what was checked."""
    made = program(seed)
    outcome, runs = runs_of(made, seed)
    if outcome.alarms:
        return Counter(alarms=1)
    exact = runs.wide()
    done = Counter(functions=1)
    for claim, k in zip(outcome.claims, made.function.results, strict=True):
        single = runs.single[k].astype(np.float64)
        assert np.isfinite(single).all()
        assert ((claim.low <= single) & (single <= claim.high)).all()
        most = allowed(claim, made.shortest(runs.inputs)) * ROOM + 1e-13 * np.abs(exact[k])
        claimed = np.isfinite(most)
        off = np.abs(single - exact[k])
        assert (off <= most)[claimed].all()
        # The exact value that decides as the float program does may be outside the range by its error.
        beyond = most if any(d is not None for d in runs.decisions) else 1e-13 * np.abs(exact[k])
        assert ((claim.low - beyond <= exact[k]) & (exact[k] <= claim.high + beyond))[claimed].all()
        alike, injected = runs.injected(k)
        for values in injected:
            off = np.abs(values[k] - exact[k])
            assert (off <= most)[alike & claimed].all()
            done["injected"] += int((alike & claimed).sum())
        done["in terms of a length"] += bool(claim.per_length)
        done["singular"] += claim.singular
    return done


@pytest.mark.parametrize("part", range(5))
def test_no_allowed_program_errs_more_than_claimed(part: int) -> None:
    seeds = EVERYDAY[part::5]
    done = sum((check(seed) for seed in seeds), Counter())
    assert done["alarms"] < len(seeds) / 4 and done["singular"] < len(seeds) / 4
    assert done["injected"] > 200 * len(seeds) and done["in terms of a length"] > 0


@pytest.mark.slow
def test_no_allowed_program_errs_more_than_claimed_at_length() -> None:
    for seed in DEEP:
        check(seed)


@pytest.mark.parametrize("seed", EVERYDAY[:40])
def test_exact_values_are_in_the_range_and_float32_within_the_error(seed: int) -> None:
    """With mpmath to 50 digits."""
    made = program(seed)
    outcome, runs = runs_of(made, seed)
    few = np.linspace(0, len(runs.single[0]) - 1, EXACT_POINTS).astype(int)
    runs = Runs.of(made.function, {n: v[few] for n, v in runs.inputs.items()})
    exact = runs.exact()
    for claim, k in zip(() if outcome.alarms else outcome.claims, made.function.results, strict=False):
        for value, single, most in zip(
            exact[k], runs.single[k], allowed(claim, made.shortest(runs.inputs)), strict=True
        ):
            if np.isfinite(most):
                beyond = most if any(d is not None for d in runs.decisions) else 0
                assert claim.low - beyond <= value <= claim.high + beyond
                assert abs(value - float(single)) <= most


@pytest.mark.parametrize("share", [0.25, 4.0])
def test_an_injected_error_as_large_as_the_bound_is_noticed(share: float) -> None:
    """At a point, the claim is close to the effect of injected errors: 4 times the effect exceeds it, 1/4 does not."""
    exceeded = total = 0
    for seed in EVERYDAY[:60]:
        made = program(seed)
        single = {n: v[:1] for n, v in points(made.ranges, 5, seed).items()}
        at = {n: (float(v[0]), float(v[0])) for n, v in single.items()}
        outcome, runs = analysed(made.function, at, LIBM), Runs.of(made.function, single)
        exact = runs.wide()
        for claim, k in zip(outcome.claims, made.function.results, strict=True):
            most = allowed(claim, made.shortest(runs.inputs))[0]
            alike, injected = runs.injected(k)
            off = max(float(abs(values[k][0] - exact[k][0])) for values in injected)
            if alike[0] and np.isfinite(most) and off > 1e-12 and not outcome.alarms:
                total += 1
                exceeded += share * off > most
    assert total > 50
    assert exceeded == 0 if share < 1 else exceeded > 0.8 * total
