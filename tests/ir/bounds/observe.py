"""Rounding errors that occur: float32 code next to the formula in float64, which takes the same branches.

It also makes inputs for searches.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from wmrgen.ir.bounds.patterns import lengths as vectors
from wmrgen.ir.nodes import Function, Node, Op, places
from wmrgen.ir.rounding import to_float32, to_float64

Ranges = Mapping[str, tuple[float, float]]
EXACT = {
    "add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide, "neg": np.negative, "abs": np.abs,
    "sqrt": np.sqrt, "min": np.minimum, "max": np.maximum, "sin": np.sin, "cos": np.cos, "atan": np.arctan,
    "atan2": np.arctan2, "compensated": np.add, "clamp": lambda a, m: np.clip(a, -m, m),
    "rounding_error": lambda a, b: np.zeros_like(a + b),
}  # fmt: skip
# With the number of a node: an input that chooses which of the two floats around its result the library returns.
CHOICE = "library "
LIBRARY = ("sin", "cos", "atan", "atan2")  # functions whose errors are as large as proofs allow


@dataclass(frozen=True)
class Run:
    """Values by node: of the float32 code, and of the formula in float64 in the same branches."""

    single: list[np.ndarray]
    exact: list[np.ndarray]


def run(function: Function, inputs: Mapping[str, np.ndarray]) -> Run:
    """Evaluate every node at every point; float64 values take comparisons and whole numbers from float32 ones."""
    count = len(next(iter(inputs.values()))) if inputs else 1
    single: list[np.ndarray] = []
    exact: list[np.ndarray] = []
    with np.errstate(all="ignore"):
        for i, node in enumerate(function.nodes):
            a, b = [single[k] for k in node.args], [exact[k] for k in node.args]
            if node.value is not None:
                single.append(np.full(count, to_float32(node.value), np.float32))
                exact.append(np.full(count, to_float64(node.value)))
            elif node.op is Op.INPUT:
                single.append(inputs[node.name or ""])
                exact.append(inputs[node.name or ""].astype(np.float64))
            else:
                single.append(_single(node, a, inputs.get(f"{CHOICE}{i}")))
                exact.append(decided(node, a, b))
    return Run(single, exact)


def _single(node: Node, a: list[np.ndarray], choice: np.ndarray | None) -> np.ndarray:
    if node.op is Op.SELECT:
        return np.where(a[0] < a[1], a[2], a[3])
    if node.op is Op.MIN:
        return np.where(a[0] < a[1], a[0], a[1])
    if node.op is Op.MAX:
        return np.where(a[1] < a[0], a[0], a[1])
    if node.op is Op.RINT:
        return np.rint(a[0])
    if node.op is Op.FLIP:
        return np.where(a[1] % 2 == 1, -a[0], a[0])
    if node.op is Op.AT_LEAST:
        return np.where(np.abs(a[0]) < a[1], np.copysign(a[1], a[0]), a[0])
    if node.op is Op.WITH_SIGN_OF:
        return np.where(np.signbit(a[1]), -a[0], a[0])
    if node.op is Op.ROUNDING_ERROR:
        wide = a[0].astype(np.float64) + a[1].astype(np.float64)
        return (wide - wide.astype(np.float32)).astype(np.float32)
    if node.op.name in LIBRARY:
        return _faithful(EXACT[node.op.name](*(x.astype(np.float64) for x in a)), choice)
    return np.asarray(EXACT[node.op.name](*a))


def _faithful(wide: np.ndarray, choice: np.ndarray | None) -> np.ndarray:
    """Return one of the two floats around each number: the error is less than a unit in the last place.

    It is the nearer one where ``choice`` is negative. Without a choice it is either, depending on the bits.
    """
    near = wide.astype(np.float32)
    other = np.nextafter(near, np.where(near < wide, np.inf, -np.inf).astype(np.float32))
    exact = near.astype(np.float64) == wide
    worse = (
        near.view(np.uint32) * np.uint32(2654435761) >> np.uint32(31) == 1 if choice is None else choice > 0
    )
    return np.where(worse & ~exact, other, near)


def decided(node: Node, a: list[np.ndarray], b: list[np.ndarray]) -> np.ndarray:
    """Return the result for exact arguments ``b`` in the branch that the float arguments ``a`` take."""
    if node.op is Op.SELECT:
        return np.where(a[0] < a[1], b[2], b[3])
    if node.op is Op.RINT:
        return np.rint(a[0]).astype(np.float64)
    if node.op is Op.FLIP:
        return np.where(a[1] % 2 == 1, -b[0], b[0])
    if node.op is Op.AT_LEAST:
        return np.where(np.signbit(a[0]), np.minimum(b[0], -b[1]), np.maximum(b[0], b[1]))
    if node.op is Op.WITH_SIGN_OF:
        return np.where(np.signbit(a[1]), -b[0], b[0])
    return np.asarray(EXACT[node.op.name](*b))


def lengths(function: Function, found: Run, result: int) -> np.ndarray:
    """Return the length of the shortest vector whose direction a result depends on; infinite if there is none."""
    needed = places(function.nodes, [result])
    shortest = np.full(len(found.exact[result]), np.inf)
    for i, vector in vectors(function.nodes).items():
        if i in needed:
            shortest = np.minimum(shortest, vector.value(found.exact))
    return shortest


# ---- inputs


def choices(function: Function) -> dict[str, tuple[float, float]]:
    """Return inputs that choose, for each call of the library, between the two floats around its exact result."""
    return {f"{CHOICE}{i}": (-1.0, 1.0) for i, n in enumerate(function.nodes) if n.op.name in LIBRARY}


def draw(ranges: Ranges, count: int, seed: int) -> dict[str, np.ndarray]:
    """Draw points of a box: anywhere, with small numbers, and at its corners."""
    rng = np.random.default_rng(seed)
    found = []
    for lo, hi in ranges.values():
        value = rng.uniform(lo, hi, count)
        kind = rng.random(count)
        value = np.where(kind < 0.15, lo, np.where(kind < 0.3, hi, value))
        small = value * 10.0 ** rng.uniform(-7, 0, count)
        found.append(np.where(kind > 0.9, small, value))
    return _inside(np.array(found), ranges)


def bred(ranges: Ranges, parents: Mapping[str, np.ndarray], count: int, seed: int) -> dict[str, np.ndarray]:
    """Make children of some points: some inputs are from a second parent, and a few are moved.

    Rounding errors depend on the last digits of every input. So most children change one or two inputs by a few units
    in the last place, and keep the other ones.
    """
    rng = np.random.default_rng(seed)
    value, moved = _inherited(rng, ranges, parents, count)
    lo, hi = (np.broadcast_to(end, value.shape)[moved] for end in _ends(ranges))
    old = value[moved]
    kind = rng.random(len(old))
    nudged = old * (1 + rng.normal(0, 1, len(old)) * 10.0 ** rng.uniform(-7, -1, len(old)))
    near = old * (1 + rng.integers(-40, 41, len(old)) * 2.0**-24)
    end = np.where(rng.random(len(old)) < 0.5, lo, hi)
    new = np.where(kind < 0.08, end, np.where(kind < 0.15, -old, nudged))
    new = np.where((kind > 0.15) & (kind < 0.2), rng.uniform(lo, hi), new)
    value[moved] = np.where(kind > 0.6, near, new)
    return _inside(value, ranges)


def nudged(ranges: Ranges, parents: Mapping[str, np.ndarray], count: int, seed: int) -> dict[str, np.ndarray]:
    """Make children that differ from their parents by a few units in the last place, so that roundings differ."""
    rng = np.random.default_rng(seed)
    value, moved = _inherited(rng, ranges, parents, count)
    choice = np.array([[name.startswith(CHOICE)] for name in ranges])
    units = np.rint(rng.normal(0, 1, value.shape) * 2.0 ** rng.uniform(0, 8, value.shape))
    changed = np.where(choice, -value, value * (1 + units * 2.0**-23))
    return _inside(np.where(moved, changed, value), ranges)


def _inherited(
    rng: np.random.Generator, ranges: Ranges, parents: Mapping[str, np.ndarray], count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return inputs x children, inherited from one parent or two, and which of them are to be changed."""
    old = np.array([parents[name] for name in ranges], np.float64)
    first, second = rng.integers(0, old.shape[1], (2, count))
    crossed = rng.random(count) < 0.3
    often = np.where(rng.random(count) < 0.7, 1.5 / len(ranges), 0.5)
    other = crossed & (rng.random((len(old), count)) < 0.5)
    return np.take_along_axis(old, np.where(other, second, first), 1), rng.random(other.shape) < often


def _ends(ranges: Ranges) -> np.ndarray:
    """Return the ends of the ranges, as an array of (low, high) x inputs x 1."""
    return np.array([*ranges.values()]).T[:, :, None]


def _inside(values: np.ndarray, ranges: Ranges) -> dict[str, np.ndarray]:
    """Return inputs x points by name, as float32 within their ranges."""
    lo, hi = _ends(ranges).astype(np.float32)
    return dict(zip(ranges, np.clip(values.astype(np.float32), lo, hi), strict=True))
