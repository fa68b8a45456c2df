"""Functions that are linear in some inputs, spins and rates say: rounding errors, one such input at a time.

Lemma. Let every value be free of the rates x or linear in them. Given the roundings of the values that are free of
them, the float program is linear in x and in its other roundings, and those are at most u |v| <= sum_k u |v_k|, where
v_k is the value with x_k alone. So results are off by at most the sum over k of what they are off with x_k alone, which
is largest where x_k is: at a number, where what cancels in a derivative is seen to cancel.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np

from wmrgen.bounds.assumptions import Format, Library
from wmrgen.bounds.shapes import terms_below_root
from wmrgen.bounds.walk import Walk
from wmrgen.ir.interval import GROW, Array, Interval, magnitude
from wmrgen.ir.nodes import Function, Node, Op, Role

_FREE, _LINEAR, _OTHER = 0, 1, 2


def errors_one_by_one(
    function: Function,
    inputs: Mapping[str, Interval],
    form: Format,
    library: Library,
    twice: Collection[int],
) -> dict[int, Array]:
    """How far results and what they are the length of may be off, by node; nothing where the lemma does not hold."""
    nodes, rates = function.nodes, _rates(function)
    degrees = _degrees(nodes, rates)
    roots = {k for k in function.results if degrees[k] == _LINEAR}
    for k in function.results:
        if degrees[k] == _OTHER:
            terms = terms_below_root(nodes, nodes[k].args[0]) if nodes[k].op is Op.SQRT else ()
            roots |= {t.base for t in terms if t.squared}
            if not terms or not all(t.squared for t in terms):
                return {}
    if not rates or not roots or any(degrees[k] != _LINEAR for k in roots):
        return {}
    count, boxes = len(rates), max(len(lo) for lo, _ in inputs.values())
    alone: dict[str, Interval] = {}
    for name, (lo, hi) in inputs.items():
        alone[name] = np.tile(lo, count), np.tile(hi, count)
        if name in rates:
            values = np.zeros((count, boxes))
            values[rates.index(name)] = magnitude((lo, hi))
            alone[name] = values.ravel(), values.ravel()
    walk = Walk(function, alone, replace(form, relative=True), library, twice).run(max(roots) + 1)
    if walk.lengths:
        return {}
    ordered = sorted(roots)
    plain = walk.errors(ordered).plain.reshape(len(ordered), count, boxes).sum(axis=1) * GROW
    return dict(zip(ordered, plain, strict=True))


def _rates(function: Function) -> list[str]:
    """Inputs of which no sine or cosine is taken and which are no geometry."""
    angles = {k for n in function.nodes if n.op in (Op.SIN, Op.COS) for k in n.args}
    used = {n.name for i, n in enumerate(function.nodes) if n.op is Op.INPUT and i not in angles}
    return [
        p.name for p in function.inputs if p.name in used and p.role not in (Role.GEOMETRY, Role.PREPARED)
    ]


def _degrees(nodes: tuple[Node, ...], rates: Collection[str]) -> list[int]:
    degrees: list[int] = []
    for node in nodes:
        args = [degrees[k] for k in node.args]
        if node.op is Op.INPUT:
            degrees.append(_LINEAR if node.name in rates else _FREE)
        elif max(args, default=_FREE) == _FREE:
            degrees.append(_FREE)
        else:
            degrees.append(_LINEAR if _is_linear(nodes, node, args) else _OTHER)
    return degrees


def _is_linear(nodes: tuple[Node, ...], node: Node, args: list[int]) -> bool:
    """Whether a node with linear arguments is linear."""
    if node.op in (Op.ADD, Op.SUB, Op.NEG):
        return all(d == _LINEAR for d in args)
    if node.op in (Op.MUL, Op.DIV):
        return sorted(args) == [_FREE, _LINEAR] and (node.op is Op.MUL or args[1] == _FREE)
    if node.op is Op.SELECT:
        sides = (d == _LINEAR or nodes[k].value == 0 for d, k in zip(args[2:], node.args[2:], strict=True))
        return args[:2] == [_FREE, _FREE] and all(sides)
    return False
