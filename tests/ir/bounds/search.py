"""A search for the largest rounding error of an output, as a share of its proved bound.

Each search starts from some points and breeds from the best of them. The starts are:

* random points; if these lead to less than `NEAR` of the bound and the function has no directions, also points at which
  the analysis allows large errors
* for the slip of wheel rates: rates that fit a motion, for which the slip is zero and rounding is all there is
* for the slip of a motion: only points with some slip

The best points of a slip are changed only by units in the last place. For each sine and arctangent either of the two
floats around it is tried (`choices`), because the proofs hold for every library that is so accurate.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tests.ir.bounds.observe import CHOICE, Ranges, bred, choices, draw, lengths, nudged, run
from wmrgen.ir.bounds.assumptions import LIBM, SINGLE
from wmrgen.ir.bounds.patterns import lengths as vectors
from wmrgen.ir.bounds.robot import FunctionBound
from wmrgen.ir.bounds.walk import Walk
from wmrgen.ir.nodes import Function, pruned

Points = dict[str, np.ndarray]
Score = Callable[[Points], np.ndarray]
Breed = Callable[[Ranges, Points, int, int], Points]
TWIST = ("vx", "vy", "omega")
# Share of the bound [1]. If random points lead so near, the second start finds no more planted faults than the first:
# roundings halved or left out of sums, differences or products, and the error of one factor of a product.
NEAR = 0.25
ISLANDS = 5
TRIES = 48  # steering angles tried for wheels that a motion should not turn fast


def shares(function: Function, bound: FunctionBound, inputs: Points) -> dict[str, np.ndarray]:
    """Return error / bound by output, per point; 0 where no bound is claimed. Ranges are checked too."""
    found = run(function, inputs)
    result = {}
    for o, k in zip(bound.outputs, function.results, strict=True):
        value = found.single[k].astype(np.float64)
        assert np.isfinite(value).all()
        assert ((o.low <= value) & (value <= o.high)).all(), f"{function.name}: {o.name} leaves its range"
        error = np.abs(value - found.exact[k])
        length = lengths(function, found, k) if o.from_length else np.full(len(value), np.inf)
        allowed = o.error + o.per_length / length
        claimed = length >= o.from_length
        with np.errstate(all="ignore"):
            share = np.where(error > 0, error / allowed, 0.0)
        result[o.name] = np.where(claimed, share, 0.0)
    return result


def climbed(
    ranges: Ranges,
    score: Score,
    start: Points,
    generations: int,
    children: int = 2000,
    kept: int = 150,
    breed: Breed = bred,
) -> Points:
    """Return the best points after some generations, the best one first."""
    best = _best(start, score(start), kept)
    for generation in range(generations):
        made = breed(ranges, best[0], children, generation)
        both = {n: np.concatenate([best[0][n], made[n]]) for n in made}
        best = _best(both, np.concatenate([best[1], score(made)]), kept)
    return best[0]


def islands(ranges: Ranges, score: Score, start: Points, generations: int) -> Points:
    """Return the best points of several searches, each from a part of ``start``, because one search may get stuck."""
    parts = [{n: v[k::ISLANDS][:400] for n, v in start.items()} for k in range(ISLANDS)]
    ends = [climbed(ranges, score, part, generations, 400, 40) for part in parts]
    return max(ends, key=lambda end: float(score({n: v[:1] for n, v in end.items()})[0]))


def _best(points: Points, value: np.ndarray, kept: int) -> tuple[Points, np.ndarray]:
    order = np.argsort(-value, kind="stable")[:kept]
    return {n: v[order] for n, v in points.items()}, value[order]


def alone(function: Function, bound: FunctionBound, output: str) -> tuple[Function, FunctionBound]:
    """Return a function with one output, and the bound of that output."""
    row = [o.name for o in bound.outputs].index(output)
    one = pruned(replace(function, outputs=(function.outputs[row],), results=(function.results[row],)))
    read = {node.name for node in one.nodes}
    inputs = {name: limits for name, limits in bound.inputs.items() if name in read}
    return one, bound._replace(inputs=inputs, outputs=(bound.outputs[row],))


def worst(
    function: Function,
    bound: FunctionBound,
    output: str,
    inverse: tuple[Function, FunctionBound] | None,
    generations: int,
    enough: float,
) -> float:
    """Return the largest share that the searches find. Searches for slips stop when ``enough`` is reached."""
    function, bound = alone(function, bound, output)
    ranges = bound.inputs | choices(function)

    def share(points: Points) -> np.ndarray:
        return shares(function, bound, points)[output]

    def allowed(points: Points) -> np.ndarray:
        return np.asarray(possible(function, points)[0])

    def climb(start: Points) -> Points:
        return climbed(ranges, share, start, generations)

    first = draw(ranges, 20000, 1)
    ends = [climb(first)]

    def best() -> float:
        return float(max(share(end).max() for end in ends))

    if not vectors(function.nodes) and best() < NEAR:
        ends.append(climb(climbed(ranges, allowed, draw(ranges, 600, 5), generations // 3, 600, 60)))
    if output != "slip":
        return best()
    if function.name == "inverse_slip" and best() < enough:
        least = bound.outputs[0].error

        def slipping(points: Points) -> np.ndarray:
            exact = run(function, points).exact[function.results[0]]
            return np.where(exact > least, share(points), 0.0)

        ends.append(climbed(ranges, slipping, first, generations))
    if function.name == "forward_slip" and inverse is not None:
        moves, known = inverse
        wide = {n: (30 * lo, 30 * hi) if n in TWIST else (lo, hi) for n, (lo, hi) in known.inputs.items()}
        wide |= choices(function)

        def fit(points: Points) -> Points:
            return rates(moves, ranges, points)

        def fitting(points: Points) -> np.ndarray:
            return share(fit(points))

        moving = motions(moves, wide, 4000)
        ends.append(fit(climbed(wide, fitting, moving, generations)))
        if not vectors(function.nodes) and best() < enough:
            start = islands(wide, lambda p: allowed(fit(p)), moving, generations // 3)
            ends.append(fit(climbed(wide, fitting, start, generations)))
    if best() < enough:
        ends += [climbed(ranges, share, end, generations, breed=nudged) for end in ends]
    return best()


def possible(function: Function, points: Points) -> np.ndarray:
    """Return results x points: the error that the analysis allows at each point."""
    exact = {n: (v.astype(np.float64), v.astype(np.float64)) for n, v in points.items()}
    walk = Walk(function, exact, SINGLE, LIBM).run()
    return walk.errors(function.results).plain


def commanded(inverse: Function, points: Points) -> Points:
    """Return the results of `inverse`; choices of the library in ``points`` belong to another function."""
    found = run(inverse, {n: v for n, v in points.items() if not n.startswith(CHOICE)})
    return {o.name: found.single[k] for o, k in zip(inverse.outputs, inverse.results, strict=True)}


def motions(inverse: Function, ranges: Ranges, count: int) -> Points:
    """Return twists, with the steering angles (of those tried) at which wheels turn least about their pivots."""
    points = draw(ranges, count, 3)
    angles = [n for n in ranges if n.endswith(".steer")]
    least = {n: np.full(count, np.inf) for n in angles}
    for seed in range(TRIES if angles else 0):
        tried = points | {n: v for n, v in draw(ranges, count, 10 + seed).items() if n in angles}
        rates_ = commanded(inverse, tried)
        for n in angles:
            cost = np.abs(rates_.get(f"{n}_rate", np.zeros(count)))
            points[n] = np.where(cost < least[n], tried[n], points[n])
            least[n] = np.minimum(cost, least[n])
    return points


def rates(inverse: Function, ranges: Ranges, motion: Points) -> Points:
    """Return the inputs that fit a motion, after slowing it down until they are within ``ranges``."""
    for _ in range(2):
        made = commanded(inverse, motion)
        over = np.ones(len(next(iter(motion.values()))))
        for n, (_, hi) in ranges.items():
            if n in made and not n.endswith(".steer"):
                over = np.maximum(over, np.abs(made[n]) / hi)
        motion = {n: (v / over).astype(np.float32) if n in TWIST else v for n, v in motion.items()}
    known: Points = motion | commanded(inverse, motion)
    turns = {
        n: np.rint(v / (2 * np.pi)) * (np.abs(v) > ranges[n][1]) for n, v in known.items() if n in ranges
    }
    known = known | {n: known[n] - 2 * np.pi * t for n, t in turns.items() if n.endswith(".steer")}
    zero = np.zeros(len(over), np.float32)
    return {
        n: np.clip(known.get(n, zero), np.float32(lo), np.float32(hi)).astype(np.float32)
        for n, (lo, hi) in ranges.items()
    }
