"""Random functions of every operation that has a lemma, and points at which bounds are most likely to be wrong."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from tests.ir.bounds.observe import run
from tests.ir.bounds.oracle import Runs, decision
from tests.ir.bounds.vectors import STILL, heading_of
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Op, Port, Role

Ranges = Mapping[str, tuple[float, float]]
Points = dict[str, np.ndarray]

QUARTER = float(np.float32(np.pi / 2))
# Ends at zero of either sign, at powers of two and beside them, at quarter turns; points; large and small numbers.
RANGES = [
    (-2.0, 2.0), (0.0, 1.0), (-1.0, -0.0), (-3.0, 0.5), (1.0, 4.0), (100.0, 101.0), (-0.03125, 0.03125),
    (0.75, 0.75), (-64.0, 64.0), (float(np.nextafter(np.float32(1), np.float32(0))), 2.0),
]  # fmt: skip
ANGLES = [
    (-2 * QUARTER, 2 * QUARTER), (0.0, QUARTER), (-QUARTER, -0.0), (1.5, 1.625), (-9.0, 9.0), (QUARTER, QUARTER),
]  # fmt: skip
CONSTANTS = [Fraction(1, 3), Fraction(-7, 5), Fraction(1, 2), Fraction(3), Fraction(-1), Fraction(17, 10)]


@dataclass(frozen=True)
class Program:
    """A random function with ranges of its inputs."""

    function: Function
    ranges: Ranges
    vectors: (
        Function | None
    )  # the components of the vectors by whose lengths it may divide, one after the other
    dimensions: tuple[int, ...]  # how many components each of them has

    def shortest(self, inputs: Mapping[str, np.ndarray]) -> np.ndarray:
        """The length of the shortest of the vectors; infinite if there is none."""
        h = np.full(len(inputs["x"]), np.inf)
        if self.vectors is not None:
            values = Runs.of(self.vectors, inputs).wide()
            components = [values[k] for k in self.vectors.results]
            for dimension in self.dimensions:
                h = np.minimum(h, np.sqrt(sum(v**2 for v in components[:dimension])))
                components = components[dimension:]
        return h


def program(seed: int, steps: int = 6) -> Program:
    """A function of three numbers and an angle, made in so many random steps; its last values are its results."""
    rng = np.random.default_rng(seed)
    ranges = {n: RANGES[rng.integers(len(RANGES))] for n in "xyz"}
    ranges["a"] = ANGLES[rng.integers(len(ANGLES))]
    b = Builder()
    pool = [b.input(n) for n in ranges]
    angle = pool[3]
    vectors: list[tuple[int, ...]] = []

    def pick() -> int:
        """A value, a late one more often."""
        return pool[-1 - int(len(pool) * rng.random() ** 2)]

    def constant() -> int:
        return b.const(CONSTANTS[rng.integers(len(CONSTANTS))])

    def vector() -> tuple[int, int]:
        parts = pick(), pick()
        vectors.append(parts)
        return parts

    def heading() -> int:
        v, w = vector()
        angle_, size = heading_of(b, v, w)
        pool.append(size)
        return angle_

    def direction() -> int:
        v, w = vector()
        v = b.abs(v)
        vectors.append((w, v))
        return b.atan2(w, v)

    def tilt() -> int:
        """A slope between limits: a quotient by one component, which may vanish."""
        v, w = pick(), pick()
        vectors.append((v,))
        return b.apply(Op.CLAMP, (b.div(w, b.apply(Op.AT_LEAST, (v, b.const(STILL)))), b.const(1)))

    def rest() -> int:
        k = pick()
        return b.sub(k, b.rint(k))

    kinds = {
        "sum": lambda: b.make(Op.ADD, [pick(), pick()]),
        "difference": lambda: b.make(Op.SUB, [pick(), pick()]),
        "shifted": lambda: b.make(Op.ADD, [pick(), constant()]),
        "compensated": lambda: b.apply(Op.COMPENSATED, (pick(), pick())),
        "lost": lambda: b.apply(Op.ROUNDING_ERROR, (pick(), pick())),
        "multiple": lambda: b.make(Op.MUL, [constant(), pick()]),
        "product": lambda: b.make(Op.MUL, [pick(), pick()]),
        "square": lambda: b.square(pick()),
        "size": lambda: b.abs(pick()),
        "smaller": lambda: b.min(pick(), pick()),
        "larger": lambda: b.max(pick(), constant()),
        "choice": lambda: b.select(pick(), pick(), pick(), pick()),
        "limited": lambda: b.apply(Op.CLAMP, (pick(), b.const(abs(CONSTANTS[rng.integers(6)])))),
        "kept away": lambda: b.apply(Op.AT_LEAST, (pick(), b.const(Fraction(1, 3)))),
        "signed": lambda: b.apply(Op.WITH_SIGN_OF, (pick(), pick())),
        "sine": lambda: b.sin(angle if rng.random() < 0.5 else pick()),
        "cosine": lambda: b.cos(angle if rng.random() < 0.5 else pick()),
        "arctangent": lambda: b.atan(pick()),
        "quotient": lambda: b.div(pick(), b.apply(Op.AT_LEAST, (pick(), b.const(Fraction(2, 3))))),
        "quotient by a sum": lambda: b.div(pick(), b.add(b.const(Fraction(5, 4)), b.square(pick()))),
        "root": lambda: b.sqrt(b.add(b.const(Fraction(1, 7)), b.abs(pick()))),
        "length": lambda: b.sqrt(b.add(b.square(pick()), b.mul(b.const(Fraction(9, 5)), b.square(pick())))),
        "whole": lambda: b.rint(pick()),
        "rest": rest,
        "flipped": lambda: b.flip(pick(), b.rint(pick())),
        "heading": heading,
        "direction": direction,
        "tilt": tilt,
    }  # fmt: skip
    names = list(kinds)
    for _ in range(steps):
        pool.append(kinds[names[rng.integers(len(names))]]())
    results = list(dict.fromkeys(pool[-2:]))
    ports = tuple(Port(n, Role.STATE if n == "a" else Role.COMMAND, "1", "an input") for n in ranges)
    outputs = tuple(Port(f"o{k}", Role.COMMAND, "1", "an output") for k in range(len(results)))
    made = b.function("control", ports, outputs, results)
    parts = [k for vector in vectors for k in vector]
    components = tuple(Port(f"c{k}", Role.COMMAND, "1", "a component") for k in range(len(parts)))
    made_of = b.function("vectors", ports, components, parts) if parts else None
    return Program(made, ranges, made_of, tuple(map(len, vectors)))


def points(ranges: Ranges, count: int, seed: int) -> Points:
    """Points of the box: its corners, zeros of either sign, small and large numbers, and anywhere."""
    rng = np.random.default_rng(seed)
    found = {}
    for name, (lo, hi) in ranges.items():
        low, high = np.float32(lo), np.float32(hi)
        value = rng.uniform(lo, hi, count).astype(np.float32)
        kind = rng.random(count)
        value = np.where(kind < 0.15, low, np.where(kind < 0.3, high, value))
        small = (value * 10.0 ** rng.uniform(-9, 0, count)).astype(np.float32)
        value = np.where(kind > 0.85, small, value)
        inside = [v for v in (0.0, -0.0, 1.0, 0.5, QUARTER, -QUARTER) if lo <= v <= hi]
        if inside:
            value = np.where((kind > 0.3) & (kind < 0.4), rng.choice(np.float32(inside), count), value)
        found[name] = np.clip(value, low, high).astype(np.float32)
    return found


def beside_thresholds(function: Function, tried: Points) -> Points:
    """Neighbours on both sides of each comparison: between two points that decide differently, by halving."""
    decisions = _decisions(function, tried)
    ends: list[tuple[int, int, int]] = []
    for i, chosen in decisions.items():
        other = np.flatnonzero(chosen != chosen[0])
        same = np.flatnonzero(chosen == chosen[0])
        ends += [(i, int(same[k % len(same)]), int(q)) for k, q in enumerate(other[:20])]
    if not ends:
        return {n: v[:0] for n, v in tried.items()}
    node, first, last = (np.array(column) for column in zip(*ends, strict=True))
    p = {n: v[first].astype(np.float64) for n, v in tried.items()}
    q = {n: v[last].astype(np.float64) for n, v in tried.items()}
    at_first = np.array([decisions[i][k] for i, k in zip(node, first, strict=True)])
    for _ in range(40):
        middle = {n: (p[n] + q[n]) / 2 for n in p}
        made = _decisions(function, {n: v.astype(np.float32) for n, v in middle.items()})
        alike = np.array([made[i][k] for k, i in enumerate(node)]) == at_first
        p = {n: np.where(alike, middle[n], p[n]) for n in p}
        q = {n: np.where(alike, q[n], middle[n]) for n in p}
    return {n: np.concatenate([p[n], q[n]]).astype(np.float32) for n in p}


def _decisions(function: Function, tried: Points) -> dict[int, np.ndarray]:
    single = run(function, tried).single
    made = {i: decision(n.op, [single[k] for k in n.args]) for i, n in enumerate(function.nodes)}
    return {i: chosen for i, chosen in made.items() if chosen is not None}
