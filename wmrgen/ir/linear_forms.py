"""Linear forms: all sums of a function, as linear maps of its non-linear terms.

A row is an output or an argument of a non-linear operation. Its terms are inputs and non-linear operations, and its
coefficients are constants or geometry-only values. The search of `wmrgen.ir.linear_search` gets all rows that share
terms at once. Sums are expanded in three ways, and the cheapest result is taken: completely; down to other rows and
shared sums; and down to those and to partial sums that are known earlier than the rest of their sum, which may share
terms with earlier rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.geometry import Form, Monomial, Scalars, accumulate, geometry_only, times
from wmrgen.ir.linear_program import Coefficient, Emitter, Graph
from wmrgen.ir.linear_search import cheapest
from wmrgen.ir.nodes import Function, Op, pruned, rebuilt

Rows = dict[int, dict[int, Coefficient]]  # row's node -> term -> coefficient
_SUMS = (Op.ADD, Op.SUB)
_MANY = 700  # nodes: sums of longer functions are not expanded completely, which takes too long
_GROWTH = 3  # expanded rows may have this many times the entries of rows with shared sums [1]


def share_linear_forms(function: Function) -> Function:
    """Return ``function`` with every sum computed by the cheapest program found."""
    shape = _Shape.of(function)
    builder = Builder()
    scalars = Scalars(function, builder, shape.early)
    best: _Plan | None = None
    tried: list[Rows] = []
    limit = len(function.nodes)
    stops = shape.stops
    ways = [stops, stops | _early(function, shape, scalars, stops)]
    if len(function.nodes) <= _MANY:
        ways.append(frozenset())
    for kept in ways:
        rows = _rows(function, shape, scalars, kept, limit)
        if rows is None or rows in tried:
            continue
        tried.append(rows)
        limit = min(limit, 64 + _GROWTH * sum(len(row) for row in rows.values()))
        plan = _plan(function, rows)
        if best is None or plan.cost < best.cost:
            best = plan
    if best is None:
        return function
    return _emit(function, shape, scalars, builder, best)


class _Shape(NamedTuple):
    """The kinds of the nodes of a function."""

    early: list[bool]  # by node: whether it depends on geometry alone
    linear: list[bool]  # by node: whether it is part of a sum
    rows: list[int]  # outputs and arguments of non-linear operations that are part of a sum
    stops: frozenset[int]  # rows and shared sums

    @staticmethod
    def of(function: Function) -> _Shape:
        """Return the kinds of the nodes of ``function``."""
        early = geometry_only(function)
        nodes = function.nodes
        linear: list[bool] = []
        sums: list[bool] = []
        uses = [0] * len(nodes)
        wanted = set(function.results)
        for i, node in enumerate(nodes):
            args = node.args
            part = not early[i] and (
                node.op in _SUMS
                or node.op is Op.NEG
                or (node.op is Op.MUL and (early[args[0]] or early[args[1]]))
                or (node.op is Op.DIV and early[args[1]])
            )
            linear.append(part)
            sums.append(part and (node.op in _SUMS or any(sums[arg] for arg in args)))
            for arg in set(args):
                uses[arg] += 1
            if not part and not early[i]:
                wanted.update(args)
        rows = [i for i in sorted(wanted) if linear[i]]
        shared = frozenset(
            i for i, node in enumerate(nodes) if linear[i] and node.op in _SUMS and uses[i] > 1
        )
        return _Shape(early, linear, rows, shared.union(i for i in rows if sums[i]))


def _early(function: Function, shape: _Shape, scalars: Scalars, kept: frozenset[int]) -> frozenset[int]:
    """Return partial sums that are known earlier than the rest of their sum.

    The rest needs more non-linear operations one after the other. Only partial sums that have two terms in common with
    another row are returned, because others have nothing to share.
    """
    nodes, linear = function.nodes, shape.linear
    depth: list[int] = []
    nested: set[int] = set()
    for i, node in enumerate(nodes):
        below = max((depth[arg] for arg in node.args), default=0)
        depth.append(below + (bool(node.args) and not linear[i]))
        if linear[i] and node.op in _SUMS:
            nested.update(a for a in node.args if linear[a] and nodes[a].op in _SUMS and depth[a] < below)
    rows = _rows(function, shape, scalars, kept | nested, len(nodes)) or {}
    others = [row.keys() for i, row in rows.items() if i not in nested]

    def shares_two_terms(i: int) -> bool:
        return any(len(rows[i].keys() & row) > 1 for row in others)

    return frozenset(i for i in nested & rows.keys() if shares_two_terms(i))


def _rows(
    function: Function,
    shape: _Shape,
    scalars: Scalars,
    kept: frozenset[int],
    limit: int,
) -> Rows | None:
    """Return the coefficients of every row by term, or None if there are more than ``limit`` in all.

    A term is a node of the function, or -1 - n for node n of the builder (a geometry-only addend).
    """
    rows: Rows = {}
    size = 0
    for root in sorted(kept.union(shape.rows)):
        forms = _expand(function, shape, scalars, root, kept, limit)
        if forms is None:
            return None
        terms, constant = forms
        row = {term: scalars.coefficient(form) for term, form in sorted(terms.items()) if form}
        if constant:
            row[-1 - scalars.node_of(constant)] = Coefficient(ONE)
        rows[root] = row
        size += len(row)
        if size > limit:
            return None
    return rows


def _expand(
    function: Function, shape: _Shape, scalars: Scalars, root: int, kept: frozenset[int], limit: int
) -> tuple[dict[int, Form], Form] | None:
    """Return (coefficients by term, geometry-only addend) of the sum ``root``, or None if it takes too many steps."""
    terms: dict[int, Form] = {}
    constant: Form = {}
    stack: list[tuple[int, Exact, Monomial]] = [(root, ONE, ())]
    visits = 0
    while stack:
        i, value, monomial = stack.pop()
        visits += 1
        if visits > 4 * limit:
            return None
        if shape.early[i]:
            for m, c in scalars.form(i).items():
                accumulate(constant, times(monomial, m), value * c)
        elif not shape.linear[i] or (i != root and i in kept):
            accumulate(terms.setdefault(i, {}), monomial, value)
        else:
            stack += _parts(function, shape, scalars, i, value, monomial)
    return terms, constant


def _parts(
    function: Function, shape: _Shape, scalars: Scalars, i: int, value: Exact, monomial: Monomial
) -> list[tuple[int, Exact, Monomial]]:
    """Return the addends of linear node ``i`` times a coefficient, the last one first."""
    node = function.nodes[i]
    if node.op in _SUMS:
        a, b = node.args
        return [(b, value if node.op is Op.ADD else -value, monomial), (a, value, monomial)]
    if node.op is Op.NEG:
        return [(node.args[0], -value, monomial)]
    a, b = node.args
    if node.op is Op.DIV:
        c, m = scalars.factors(b)
        return [(a, value / c, times(monomial, m, -1))]
    scalar, other = (a, b) if shape.early[a] else (b, a)
    c, m = scalars.factors(scalar)
    return [(other, value * c, times(monomial, m))] if c else []


@dataclass(slots=True)
class _Plan:
    """The programs of all rows."""

    # (program, its coefficients, its terms) of each group of rows
    groups: list[tuple[Graph, Sequence[Coefficient], list[int]]] = field(default_factory=list)
    place: dict[int, tuple[int, int]] = field(default_factory=dict)  # (group, output) by row

    @property
    def cost(self) -> tuple[int, int]:
        """Return (additions + multiplications, multiplications) of all programs."""
        costs = [graph.cost for graph, *_ in self.groups]
        return sum(cost[0] for cost in costs), sum(cost[1] for cost in costs)


def _plan(function: Function, rows: Rows) -> _Plan:
    plan = _Plan()
    for members in _groups(function, rows):
        columns = sorted({term for root in members for term in rows[root]})
        index = {term: j for j, term in enumerate(columns)}
        matrix = []
        for i, root in enumerate(members):
            plan.place[root] = (len(plan.groups), i)
            matrix.append(tuple((index[term], c) for term, c in rows[root].items()))
        plan.groups.append((*cheapest(tuple(matrix), len(columns)), columns))
    return plan


def _groups(function: Function, rows: Rows) -> list[list[int]]:
    """Return groups of rows that share terms and have the same level of nesting, in the order of their first rows."""
    level = [0] * len(function.nodes)
    leader: dict[tuple[int, int], int] = {}
    parent: dict[int, int] = {root: root for root in rows}

    def find(root: int) -> int:
        while parent[root] != root:
            root = parent[root]
        return root

    for i, node in enumerate(function.nodes):
        row = rows.get(i)
        if row is None:
            level[i] = max((level[arg] for arg in node.args), default=0)
            continue
        below = max((level[term] for term in row if term >= 0), default=0)
        level[i] = below + (len(row) > 1)
        for term in row:
            other = leader.setdefault((below, term), i)
            a, b = sorted((find(other), find(i)))
            parent[b] = a
    grouped: dict[int, list[int]] = {}
    for root in rows:
        grouped.setdefault(find(root), []).append(root)
    return list(grouped.values())


def _emit(function: Function, shape: _Shape, scalars: Scalars, builder: Builder, plan: _Plan) -> Function:
    emitters = [Emitter(graph, factors, builder, scalars.scale) for graph, factors, _ in plan.groups]
    built: dict[int, int] = {}

    def value(i: int) -> int:
        return scalars.node_of(scalars.form(i)) if shape.early[i] else built[i]

    for i, node in enumerate(function.nodes):
        if shape.early[i]:
            continue
        if i in plan.place:
            group, k = plan.place[i]
            terms = [-1 - term if term < 0 else built.get(term, -1) for term in plan.groups[group][2]]
            built[i] = emitters[group].output(k, terms.__getitem__)
        elif node.op is Op.INPUT:
            built[i] = builder.copy(node, ())
        elif not shape.linear[i]:
            built[i] = builder.again(node, [value(arg) for arg in node.args])
    place = built | {result: value(result) for result in function.results}
    return pruned(rebuilt(function, builder.nodes, place))
