"""Lengths of vectors whose components share terms: |M z| is at most the largest singular value of M times |z|.

And quotients of least squares: (a . b) / (a . a) is at most |b| / |a| (Cauchy and Schwarz).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from wmrgen.ir.nodes import Node, Op
from wmrgen.proofs import interval as iv
from wmrgen.proofs.interval import Array
from wmrgen.proofs.patterns import terms_below_root

if TYPE_CHECKING:
    from wmrgen.proofs.analysis import Pass

_GROW = 1 + 1e-9


def length(p: Pass, parts: Sequence[tuple[float, int]]) -> Array:
    """Upper bound of sqrt(sum f x x) over the parts (f, node), per box."""
    plain = np.sqrt(sum((f * iv.magnitude(p.range(k)) ** 2 for f, k in parts), np.zeros(p.boxes)))
    atoms = sorted({atom for _, k in parts for atom in p.forms[k].terms})
    if len(parts) < 2 or len(atoms) == sum(len(p.forms[k].terms) for _, k in parts):
        return np.asarray(plain * _GROW)
    place = {atom: j for j, atom in enumerate(atoms)}
    matrix = np.zeros((len(parts), len(atoms)))
    rest = np.zeros(p.boxes)
    for i, (f, k) in enumerate(parts):
        form = p.forms[k]
        for atom, c in form.terms.items():
            matrix[i, place[atom]] = np.sqrt(f) * c
        rest = rest + np.sqrt(f) * (abs(form.constant) + form.slack)
    most = float(np.linalg.norm(matrix, 2))
    return np.asarray(np.minimum(plain, most * _size(p, atoms) + rest) * _GROW)


def _size(p: Pass, atoms: Sequence[int]) -> Array:
    """The length of the vector of atoms; p cos x and p sin x together are no longer than p."""
    groups: dict[tuple[int, int], Array] = {}
    for atom in atoms:
        arm = _arm(p.nodes, p.nodes[atom])
        groups[arm or (atom, -1)] = iv.magnitude(p.range(arm[0] if arm else atom))
    return np.asarray(np.sqrt(sum((size**2 for size in groups.values()), np.zeros(p.boxes))) * _GROW)


def _arm(nodes: Sequence[Node], node: Node) -> tuple[int, int] | None:
    """(p, x) of a product p cos x or p sin x."""
    if node.op is Op.MUL:
        for wave, arm in (node.args, node.args[::-1]):
            if nodes[wave].op in (Op.SIN, Op.COS):
                return arm, nodes[wave].args[0]
    return None


def least_squares(p: Pass, above: int, below: int) -> Array | None:
    """Upper bound of |N / D|, N = a . b and D = a . a or, where that is less, a constant. None for other shapes."""
    nodes = p.nodes
    total = below
    if nodes[below].op in (Op.SELECT, Op.MAX, Op.MIN):
        choices = [k for k in nodes[below].args[-2:] if nodes[k].value is None]
        if len(choices) != 1:
            return None
        total = choices[0]
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
        return np.asarray((length(p, parts) / np.sqrt(least) * (1 + 1e-4) + noise / least) * _GROW)


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
