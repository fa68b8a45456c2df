"""Lengths of vectors whose components share terms: |M z| is at most the largest singular value of M times |z|.

And quotients of least squares: (a . b) / (a . a) is at most |b| / |a| (Cauchy and Schwarz).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wmrgen.bounds import interval as iv
from wmrgen.bounds.circles import UNIT
from wmrgen.bounds.interval import GROW, Array, Interval
from wmrgen.bounds.patterns import largest_of, terms_below_root
from wmrgen.ir.nodes import Node, Op

if TYPE_CHECKING:
    from wmrgen.bounds.analysis import Pass


def length(p: Pass, parts: Sequence[tuple[float, int]]) -> Array:
    """Upper bound of sqrt(sum f x x) over the parts (f, node), per box."""
    plain = np.sqrt(sum((f * iv.magnitude(p.range(k)) ** 2 for f, k in parts), np.zeros(p.boxes))) * GROW
    shared = _shared(p, parts)
    return np.asarray(plain if shared is None else np.minimum(plain, shared[1]))


def lengths(p: Pass, parts: Sequence[tuple[float, int]]) -> Interval | None:
    """Bounds of sqrt(sum f x x) where the parts (f, node) share what they are sums of; None where they do not."""
    return _shared(p, parts)


def _shared(p: Pass, parts: Sequence[tuple[float, int]]) -> Interval | None:
    """|b + M z| is |b| within the largest singular value of M times |z|."""
    atoms = sorted({atom for _, k in parts for atom in p.forms[k].terms})
    if len(parts) < 2 or not _alike(p, parts, atoms):
        return None
    place = {atom: j for j, atom in enumerate(atoms)}
    matrix, middle = np.zeros((len(parts), len(atoms))), np.zeros(len(parts))
    slack = np.zeros(p.boxes)
    for i, (f, k) in enumerate(parts):
        form = p.forms[k]
        for atom, c in form.terms.items():
            matrix[i, place[atom]] = np.sqrt(f) * c
        middle[i] = np.sqrt(f) * form.constant
        slack = slack + f * form.slack**2
    about = float(np.linalg.norm(middle))
    reach = _stretch(p, atoms, matrix) + np.sqrt(slack)
    room = (about + reach) * (GROW - 1)
    return np.maximum(about - reach - room, 0.0), about + reach + room


def _stretch(p: Pass, atoms: Sequence[int], matrix: NDArray[np.float64]) -> Array:
    """Upper bound of |M z|, z the atoms: of |M W^-1| |W z|, W such that large columns and large atoms weigh alike."""
    sizes = _sizes(p, atoms)
    total = np.zeros(p.boxes)
    for columns, size in sizes:
        most = float(size.max())
        length = float(np.linalg.norm(matrix[:, columns]))
        if most > 0 and length > 0:
            weight = np.sqrt(length / most)
            matrix[:, columns] /= weight
            total = total + (weight * size) ** 2
        else:
            matrix[:, columns] = 0.0
    return np.asarray(float(np.linalg.norm(matrix, 2)) * np.sqrt(total) * GROW)


def _alike(p: Pass, parts: Sequence[tuple[float, int]], atoms: Sequence[int]) -> bool:
    """Whether something stands in two parts: the same atom, or arms p cos x and p sin x."""
    different = {(p.arms[a].p, p.arms[a].angle) if a in p.arms else a for a in atoms}
    return len(different) < sum(len(p.forms[k].terms) for _, k in parts)


def _sizes(p: Pass, atoms: Sequence[int]) -> list[tuple[list[int], Array]]:
    """(places, length) of atoms that belong together: p cos x and p sin x are together no longer than p."""
    groups: dict[tuple[int | None, int], list[int]] = {}
    alone: list[tuple[list[int], Array]] = []
    for j, atom in enumerate(atoms):
        if atom in p.arms:
            groups.setdefault((p.arms[atom].p, p.arms[atom].angle), []).append(j)
        else:
            alone.append(([j], iv.magnitude(p.range(atom))))
    ones = np.ones(p.boxes)
    return alone + [
        (places, (ones if factor is None else iv.magnitude(p.range(factor))) * UNIT)
        for (factor, _), places in groups.items()
    ]


def least_squares(p: Pass, above: int, below: int) -> Array | None:
    """Upper bound of |N / D|, N = a . b and D = a . a or, where that is less, a constant. None for other shapes."""
    nodes = p.nodes
    total = largest_of(nodes, below)
    if total is None:
        return None
    squares = {t.base: float(t.factor) for t in terms_below_root(nodes, total) if t.squared}
    if len(squares) < 2:
        return None
    inner, products = _products(nodes, above)
    parts = []
    if not products:
        return None
    for node in products:
        for a, b in (nodes[node].args, nodes[node].args[::-1]):
            if squares.get(a):
                parts.append((1 / squares.pop(a), b))
                break
        else:
            return None
    least = np.maximum(p.range(below)[0], 0.0)
    noise = sum((p.result.noise[p.sources[k]] for k in inner if k in p.sources), np.zeros(p.boxes))
    with np.errstate(all="ignore"):
        return np.asarray((length(p, parts) / np.sqrt(least) * (1 + 1e-4) + noise / least) * GROW)


def _products(nodes: Sequence[Node], root: int) -> tuple[list[int], list[int]]:
    """Nodes of a sum of products, and the products; nothing where something else is added up."""
    inner, products, stack = [], [], [root]
    while stack:
        k = stack.pop()
        inner.append(k)
        if nodes[k].op in (Op.ADD, Op.SUB, Op.NEG):
            stack += nodes[k].args
        elif nodes[k].op is Op.MUL:
            products.append(k)
        else:
            return [], []
    return inner, products
