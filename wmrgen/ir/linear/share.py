"""Two ways of finding shared pairs of terms in the rows of a matrix.

`by_products` multiplies first (each input by each magnitude of its column), then shares signed
pairs of products. `by_ratios` shares pairs t_i + rho t_j, then factors what is left of each row.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence

from wmrgen.ir.linear.graph import Edge, Graph, Magnitudes

Row = dict[int, tuple[int, int]]  # column -> (magnitude, sign)
PairKey = tuple[int, ...]


def _merge_pairs(
    rows: Sequence[dict[int, tuple[int, int]]],
    key_of: Callable[[int, tuple[int, int], int, tuple[int, int]], PairKey | None],
    merge: Callable[[PairKey], Edge],
) -> None:
    """Greedily replace the pair of terms that most rows share, while two rows share one.

    Keys begin (column, column, ...); ties fall to the least key. ``merge`` makes the new term.
    """
    where: dict[PairKey, set[int]] = {}

    def pairs(row: dict[int, tuple[int, int]], columns: Iterable[int]) -> Iterable[PairKey]:
        for j in columns:
            for i in row:
                if i != j:
                    a, b = (i, j) if i < j else (j, i)
                    key = key_of(a, row[a], b, row[b])
                    if key is not None:
                        yield key

    for r, row in enumerate(rows):
        for key in pairs(row, row):
            where.setdefault(key, set()).add(r)
    while where:
        most = max(map(len, where.values()))
        if most < 2:
            return
        best = min((key for key, held in where.items() if len(held) == most), key=lambda k: (k[2:], k))
        users = sorted(where[best])
        i, j = best[0], best[1]
        new, flip = merge(best)
        for r in users:
            row = rows[r]
            for key in set(pairs(row, (i, j))):
                holders = where[key]
                holders.discard(r)
                if not holders:
                    del where[key]
            magnitude, sign = row.pop(i)
            row.pop(j)
            row[new] = (magnitude, sign * flip)
            for key in pairs(row, (new,)):
                where.setdefault(key, set()).add(r)


def by_products(columns: int, rows: Sequence[Row], scales: Sequence[int]) -> Graph:
    """The graph of  y_i = scales[i] * sum_j rows[i][j] t_j  that multiplies inputs first."""
    graph = Graph(columns)
    products: dict[tuple[int, int], int] = {}
    signed: list[dict[int, tuple[int, int]]] = []
    for row in rows:
        terms: dict[int, tuple[int, int]] = {}
        for column, (magnitude, sign) in row.items():
            node = products.get((column, magnitude))
            if node is None:
                node = products[column, magnitude] = graph.add([(column, 1)], magnitude)[0]
            terms[node] = (0, sign)
        signed.append(terms)
    _merge_pairs(
        signed,
        lambda i, a, j, b: (i, j, a[1] * b[1]),
        lambda key: graph.add([(key[0], 1), (key[1], key[2])]),
    )
    for terms, scale in zip(signed, scales, strict=True):
        edges = [(node, sign) for node, (_, sign) in sorted(terms.items())]
        graph.outputs.append(graph.add(edges, scale) if edges else None)
    return graph


def by_ratios(columns: int, rows: Sequence[Row], magnitudes: Magnitudes) -> Graph:
    """The graph of  y_i = sum_j rows[i][j] t_j  that shares pairs of any ratio first."""
    graph = Graph(columns)
    left = [dict(row) for row in rows]
    products: dict[tuple[int, int], int] = {}

    def product(column: int, magnitude: int) -> int:
        if magnitude and (column, magnitude) not in products:
            products[column, magnitude] = graph.add([(column, 1)], magnitude)[0]
        return products[column, magnitude] if magnitude else column

    def key_of(i: int, a: tuple[int, int], j: int, b: tuple[int, int]) -> PairKey | None:
        ratio = magnitudes.ratio(b[0], a[0])
        return None if ratio is None else (i, j, ratio[0], ratio[1] * a[1] * b[1])

    if len(left) > 1:
        _merge_pairs(left, key_of, lambda key: graph.add([(key[0], 1), (product(key[1], key[2]), key[3])]))
    uses = Counter((column, magnitude) for row in left for column, (magnitude, _) in row.items())
    for row in left:
        graph.outputs.append(_factored(graph, row, uses, product))
    return graph


def _factored(
    graph: Graph, row: Row, uses: Counter[tuple[int, int]], product: Callable[[int, int], int]
) -> Edge | None:
    """One row, its terms of equal magnitude multiplied together unless other rows share the products."""
    groups: dict[int, list[Edge]] = {}
    for column, (magnitude, sign) in sorted(row.items()):
        groups.setdefault(magnitude, []).append((column, sign))
    edges: list[Edge] = []
    for magnitude, terms in groups.items():
        if magnitude == 0:
            edges += terms
        elif sum(1 / uses[column, magnitude] for column, _ in terms) > 1 or (
            len(groups) == 1 and len(terms) > 1
        ):
            edges.append(graph.add(terms, magnitude))
        else:
            edges += [(product(column, magnitude), sign) for column, sign in terms]
    return graph.add(edges) if edges else None
