"""The search for a cheap program of a linear map: several strategies, the cheapest result.

Input scalings come with `by_products`, output scalings from normalised rows, and both swap on
the transposed problem.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from wmrgen.ir.linear.graph import Coefficient, Graph, Magnitudes, transpose
from wmrgen.ir.linear.share import Row, by_products, by_ratios

_MOST_PAIRS = 2500  # beyond, a side of the problem is left to the other one
_MOST_COLUMNS = 4  # as many normalisations by one column are tried


def cheapest(rows: Sequence[Mapping[int, Coefficient]], columns: int, magnitudes: Magnitudes) -> Graph:
    """The cheapest graph found of  y_i = sum_j rows[i][j] t_j  over ``columns`` terms."""
    whole = [{j: magnitudes.split(c) for j, c in sorted(row.items()) if c.value} for row in rows]
    distinct, copies = _distinct(whole, magnitudes)
    best: Graph | None = None
    for graph in _candidates(distinct, columns, magnitudes):
        if best is None or graph.cost < best.cost:
            best = graph
    if best is None:
        best = by_products(columns, distinct, [0] * len(distinct))
    made = best.outputs
    best.outputs = []
    scaled: dict[tuple[int, int], int] = {}
    for k, magnitude, sign in copies:
        edge = made[k]
        if edge is not None and magnitude:
            if (k, magnitude) not in scaled:
                scaled[k, magnitude] = best.add([(edge[0], 1)], magnitude)[0]
            edge = (scaled[k, magnitude], edge[1])
        best.outputs.append(None if edge is None else (edge[0], edge[1] * sign))
    return best


def _distinct(rows: Sequence[Row], magnitudes: Magnitudes) -> tuple[list[Row], list[tuple[int, int, int]]]:
    """Rows no two of which are proportional, and each row as (index, magnitude, sign) times one."""
    kept: list[Row] = []
    lead: dict[tuple[tuple[int, int, int], ...], tuple[int, int, int]] = {}
    copies: list[tuple[int, int, int]] = []
    for row in rows:
        first = next(iter(row.values()), (0, 1))
        shape: list[tuple[int, int, int]] = []
        for j, (magnitude, sign) in row.items():
            ratio = magnitudes.ratio(magnitude, first[0]) if len(row) > 1 else (magnitude, 1)
            if ratio is None:  # opaque factors differ: equal rows only
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


def _candidates(rows: Sequence[Row], columns: int, magnitudes: Magnitudes) -> Iterator[Graph]:
    if len(rows) == 1:  # nothing to share; only equal magnitudes to factor
        yield by_ratios(columns, rows, magnitudes)
        return
    turned = _transposed(rows, columns)
    straight, across = _pairs(rows), _pairs(turned)
    if straight <= _MOST_PAIRS and straight <= 8 * across + 64:
        yield from _one_side(rows, columns, magnitudes)
    if across <= _MOST_PAIRS and across <= 8 * straight + 64:
        merged, copies = _distinct(turned, magnitudes)
        for graph in _one_side(merged, len(rows), magnitudes):
            yield transpose(_with_copies(graph, copies))


def _with_copies(graph: Graph, copies: Sequence[tuple[int, int, int]]) -> Graph:
    """``graph`` with its outputs copied out to the proportional rows that it stands for."""
    made = graph.outputs
    outputs = []
    for k, magnitude, sign in copies:
        edge = made[k]
        if edge is not None:
            edge = graph.add([edge], magnitude) if magnitude else edge
            edge = (edge[0], edge[1] * sign)
        outputs.append(edge)
    graph.outputs = outputs
    return graph


def _one_side(rows: Sequence[Row], columns: int, magnitudes: Magnitudes) -> Iterator[Graph]:
    seen: list[tuple[list[Row], list[int]]] = []
    for scaled in _scalings(rows, columns, magnitudes):
        if scaled not in seen:
            seen.append(scaled)
            yield by_products(columns, *scaled)
    yield by_ratios(columns, rows, magnitudes)


def _scalings(
    rows: Sequence[Row], columns: int, magnitudes: Magnitudes
) -> Iterator[tuple[list[Row], list[int]]]:
    """The rows as they are, and divided by one of their magnitudes."""
    yield list(rows), [0] * len(rows)
    common = [_commonest(row) for row in rows]
    yield _divided(rows, common, magnitudes)
    if columns <= _MOST_COLUMNS:
        for j in range(columns):
            by = [row[j][0] if j in row and len(row) > 1 else 0 for row in rows]
            yield _divided(rows, by, magnitudes)


def _commonest(row: Row) -> int:
    counts = Counter(magnitude for magnitude, _ in row.values())
    return max(counts, key=lambda m: (counts[m], -m)) if len(row) > 1 else 0


def _divided(rows: Sequence[Row], by: Sequence[int], magnitudes: Magnitudes) -> tuple[list[Row], list[int]]:
    out: list[Row] = []
    scales: list[int] = []
    for row, scale in zip(rows, by, strict=True):
        divided: Row = {}
        for j, (magnitude, sign) in row.items():
            ratio = magnitudes.ratio(magnitude, scale)
            if ratio is None:
                break
            divided[j] = (ratio[0], ratio[1] * sign)
        whole = len(divided) == len(row)
        out.append(divided if whole else row)
        scales.append(scale if whole else 0)
    return out, scales
