"""The search for a cheap program of a linear map: several strategies, of which the cheapest result is taken.

`by_products` multiplies first (each input by each magnitude of its column), then shares signed pairs of products.
`by_ratios` shares pairs t_i + rho t_j, then factors the rest of each row. `by_products` finds common scalings of
inputs, normalised rows those of outputs, and both are exchanged on the transposed problem.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import combinations

from wmrgen.ir.linear_program import Coefficient, Edge, Graph, Magnitudes, transpose

Matrix = tuple[tuple[tuple[int, Coefficient], ...], ...]  # rows of (column, coefficient)
Row = dict[int, tuple[int, int]]  # column -> (magnitude, sign)
PairKey = tuple[int, ...]
Pairs = Iterable[tuple[int, int]]
KeyOf = Callable[[int, tuple[int, int], int, tuple[int, int]], PairKey | None]


def _shared(
    rows: Sequence[Row], pairs: Iterable[tuple[int, Pairs]], key_of: KeyOf
) -> dict[PairKey, set[int]]:
    """Return the rows that have each pair of columns, by its key, for pairs that at least two rows have."""
    where: dict[PairKey, set[int]] = {}
    for r, columns in pairs:
        row = rows[r]
        for i, j in columns:
            key = key_of(i, row[i], j, row[j])
            if key is not None:
                where.setdefault(key, set()).add(r)
    return {key: users for key, users in where.items() if len(users) > 1}


def _merge_pairs(rows: Sequence[Row], key_of: KeyOf, merge: Callable[[PairKey], Edge]) -> None:
    """Replace the pair of terms that most rows share by a new term, until no two rows share a pair.

    Keys start with the two columns; among equally common pairs the least key is taken. ``merge`` makes the new term,
    which becomes the last column. A pair that only one row has cannot become shared later, because rows only get pairs
    with new terms.
    """
    where = _shared(rows, ((r, combinations(sorted(row), 2)) for r, row in enumerate(rows)), key_of)
    while where:
        most = max(map(len, where.values()))
        best = min((key for key, holders in where.items() if len(holders) == most), key=lambda k: (k[2:], k))
        users = where[best]
        i, j, *_ = best
        new, flip = merge(best)
        where = {
            key: rest
            for key, holders in where.items()
            if len(rest := holders - users if i in key[:2] or j in key[:2] else holders) > 1
        }
        added = []
        for r in users:
            magnitude, sign = rows[r].pop(i)
            del rows[r][j]
            added.append((r, [(column, new) for column in rows[r]]))
            rows[r][new] = (magnitude, sign * flip)
        where |= _shared(rows, added, key_of)


def by_products(columns: int, rows: Sequence[Row], scales: Sequence[int]) -> Graph:
    """Return a graph of  y_i = scales[i] * sum_j rows[i][j] t_j  that multiplies inputs first.

    Args:
        columns: the number of inputs t_j.
        rows: (magnitude, sign) by column, of each output.
        scales: the magnitude that each output is multiplied by.

    Returns:
        The graph.
    """
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
    """Return a graph of  y_i = sum_j rows[i][j] t_j  that first shares pairs of terms in any ratio.

    Args:
        columns: the number of inputs t_j.
        rows: (magnitude, sign) by column, of each output.
        magnitudes: the coefficients that magnitudes stand for.

    Returns:
        The graph.
    """
    graph = Graph(columns)
    rest = [dict(row) for row in rows]
    products: dict[tuple[int, int], int] = {}

    def product(column: int, magnitude: int) -> int:
        if magnitude and (column, magnitude) not in products:
            products[column, magnitude] = graph.add([(column, 1)], magnitude)[0]
        return products[column, magnitude] if magnitude else column

    def key_of(i: int, a: tuple[int, int], j: int, b: tuple[int, int]) -> PairKey | None:
        ratio = magnitudes.ratio(b[0], a[0])
        return None if ratio is None else (i, j, ratio[0], ratio[1] * a[1] * b[1])

    if len(rest) > 1:
        _merge_pairs(rest, key_of, lambda key: graph.add([(key[0], 1), (product(key[1], key[2]), key[3])]))
    graph.outputs += (_factored(graph, row, product) for row in rest)
    return graph


def _factored(graph: Graph, row: Row, product: Callable[[int, int], int]) -> Edge | None:
    """Return one row; terms of equal magnitude are added before they are multiplied."""
    groups: dict[int, list[Edge]] = {}
    for column, (magnitude, sign) in sorted(row.items()):
        groups.setdefault(magnitude, []).append((column, sign))
    edges: list[Edge] = []
    for magnitude, terms in groups.items():
        if magnitude and len(terms) > 1:
            edges.append(graph.add(terms, magnitude))
        else:
            edges += [(product(column, magnitude), sign) for column, sign in terms]
    return graph.add(edges) if edges else None


# The same matrix occurs in several functions, and when sums are expanded differently.
@lru_cache(maxsize=1024)
def cheapest(matrix: Matrix, columns: int) -> tuple[Graph, Sequence[Coefficient]]:
    """Return the cheapest graph found of  y_i = sum_j matrix[i][j] t_j  of ``columns`` terms, and its coefficients."""
    magnitudes = Magnitudes()
    whole = [{j: magnitudes.split(c) for j, c in sorted(row) if c.value} for row in matrix]
    distinct, copies = _distinct(whole, magnitudes)
    graph = min(_candidates(distinct, columns, magnitudes), key=lambda graph: graph.cost)
    return _with_copies(graph, copies), magnitudes.table


def _distinct(rows: Sequence[Row], magnitudes: Magnitudes) -> tuple[list[Row], list[tuple[int, int, int]]]:
    """Return rows of which no two are proportional, and each row as (index, magnitude, sign) times one of them."""
    kept: list[Row] = []
    lead: dict[tuple[tuple[int, int, int], ...], tuple[int, int, int]] = {}
    copies: list[tuple[int, int, int]] = []
    for row in rows:
        first = next(iter(row.values()), (0, 1))
        shape: list[tuple[int, int, int]] = []
        for j, (magnitude, sign) in row.items():
            ratio = magnitudes.ratio(magnitude, first[0]) if len(row) > 1 else (magnitude, 1)
            if ratio is None:  # not a coefficient: only equal rows match
                ratio = (-1 - magnitude, 1)
            shape.append((j, ratio[0], ratio[1] * sign * first[1]))
        key = tuple(shape)
        if any(magnitude < 0 for _, magnitude, _ in key):
            key = (*key, (-1, first[0], 0))
        if key not in lead:
            lead[key] = (len(kept), first[0], first[1])
            kept.append(row)
            copies.append((len(kept) - 1, 0, 1))
            continue
        k, magnitude, sign = lead[key]
        by = magnitudes.ratio(first[0], magnitude) if len(row) > 1 else (0, 1)
        if by is None:
            kept.append(row)
            copies.append((len(kept) - 1, 0, 1))
        else:
            copies.append((k, by[0], by[1] * first[1] * sign))
    return kept, copies


def _transposed(rows: Sequence[Row], columns: int) -> list[Row]:
    turned: list[Row] = [{} for _ in range(columns)]
    for i, row in enumerate(rows):
        for j, entry in row.items():
            turned[j][i] = entry
    return turned


def _pairs(rows: Sequence[Row]) -> int:
    return sum(len(row) * (len(row) - 1) // 2 for row in rows)


_MOST_PAIRS = 2500  # pairs of terms in a map that is searched: more take too long


def _candidates(rows: Sequence[Row], columns: int, magnitudes: Magnitudes) -> Iterator[Graph]:
    """Return programs of the map and of its transpose.

    If one of them has many more pairs than the other, it is not searched. If both have too many, the rows are computed
    as they are.
    """
    if len(rows) == 1:  # nothing to share; only equal magnitudes to factor
        yield by_ratios(columns, rows, magnitudes)
        return
    turned = _transposed(rows, columns)
    straight, across = _pairs(rows), _pairs(turned)
    if min(straight, across) > _MOST_PAIRS:
        yield by_products(columns, rows, [0] * len(rows))
    if straight <= min(8 * across + 64, _MOST_PAIRS):
        yield from _one_side(rows, columns, magnitudes)
    if across <= min(8 * straight + 64, _MOST_PAIRS):
        merged, copies = _distinct(turned, magnitudes)
        for graph in _one_side(merged, len(rows), magnitudes):
            yield transpose(_with_copies(graph, copies))


def _with_copies(graph: Graph, copies: Sequence[tuple[int, int, int]]) -> Graph:
    """Return ``graph`` with an output for every row; proportional rows are multiples of one output."""
    outputs: list[Edge | None] = []
    scaled: dict[tuple[int, int], Edge] = {}
    for k, magnitude, sign in copies:
        edge = graph.outputs[k]
        if edge is not None and magnitude:
            edge = scaled[k, magnitude] = scaled.get((k, magnitude)) or graph.add([edge], magnitude)
        outputs.append(None if edge is None else (edge[0], edge[1] * sign))
    graph.outputs = outputs
    return graph


def _one_side(rows: Sequence[Row], columns: int, magnitudes: Magnitudes) -> Iterator[Graph]:
    plain = list(rows), [0] * len(rows)
    divided = _divided(rows, magnitudes)
    yield by_products(columns, *plain)
    if divided != plain:
        yield by_products(columns, *divided)
    yield by_ratios(columns, rows, magnitudes)


def _commonest(row: Row) -> int:
    counts = Counter(magnitude for magnitude, _ in row.values())
    return max(counts, key=lambda m: (counts[m], -m)) if len(row) > 1 else 0


def _divided(rows: Sequence[Row], magnitudes: Magnitudes) -> tuple[list[Row], list[int]]:
    """Return the rows divided by their most common magnitudes, and these magnitudes."""
    out: list[Row] = []
    scales: list[int] = []
    for row in rows:
        scale, divided = _commonest(row), Row()
        for j, (magnitude, sign) in row.items():
            ratio = magnitudes.ratio(magnitude, scale)
            if ratio is None:
                break
            divided[j] = (ratio[0], ratio[1] * sign)
        whole = len(divided) == len(row)
        out.append(divided if whole else row)
        scales.append(scale if whole else 0)
    return out, scales
