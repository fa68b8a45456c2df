"""Test vectors of a module: inputs, results of the exact formula, and how far rounding may move code from them.

Points at which rounding decides between different results are left out. The expected value is the exact one, rounded
once: from float64 if its error bound leaves no doubt, otherwise from 60 digits. Values that are certainly below
1e-12 are 0. A law is tested as well: forward after inverse gives the twist, also next to zeros of either sign.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import NO_SITE, TWIST_NAMES, Site
from wmrgen.ir.calls import inlined_calls
from wmrgen.ir.interpret import EXACT, evaluate_module
from wmrgen.ir.nodes import Function, Module, Port, contract
from wmrgen.ir.ops.analysis import Bounded
from wmrgen.ir.rounding import nearest_float32, to_float32, to_float64
from wmrgen.ir.selftest.points import BRANCH, Grid, Point, near_thresholds, points
from wmrgen.ir.selftest.rounding_bounds import UNITS, Array, bounds, rounding_of

_WORST = 2.0**13  # largest error of a test point [rounding units]: points that lose more test nothing
_SLACK = 1.05  # factor of the tolerance, for second-order terms and the rounding of the printed numbers [1]
FLOOR = 1e-12  # smaller results are expected to be 0, and part of each tolerance [SI units]
INVERSES = ("inverse", "inverse_together")
_LAWS = 6  # generic motions in the table of a law
# Numbers of a table and least number of rows; functions of tens of wheels have long rows and get fewer.
NUMBERS, LEAST_ROWS = 2400, 8
_SPARE = 20  # points of the pool that a table may take for rare branches
THERE = "there and back"
_RARE = 2  # points that each pair of outcomes of choices should have


class Vector(NamedTuple):
    """One point of a table; numbers are in the order of the table's names, in SI units."""

    text: str  # what the point is
    inputs: tuple[float, ...]
    expected: tuple[float, ...]
    tolerance: tuple[float, ...]


class Table(NamedTuple):
    """Test vectors of functions with the same inputs."""

    functions: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    vectors: tuple[Vector, ...]
    law: bool = False  # whether outputs of the first function are inputs of the second


def tables(module: Module, scalar: str, site: Site = NO_SITE, numbers: int = NUMBERS) -> tuple[Table, ...]:
    """Return a table for each function (shared by its variants), then one for each law.

    Args:
        module: the functions.
        scalar: "float" or "double", the type of the code.
        site: limits and pivots of the robot, at which functions are tested too.
        numbers: about how many numbers a table has; it has at least `LEAST_ROWS` rows.

    Returns:
        The tables, without empty ones.
    """
    module = inlined_calls(module)
    prepared = prepared_of(module, scalar)
    computed = [_table(module, group, scalar, site, prepared, numbers) for group in _groups(module)]
    laws = [_law(module, name, scalar, site, prepared) for name in INVERSES]
    return tuple(t for t in (*computed, *laws) if t is not None and t.vectors)


def _groups(module: Module) -> list[list[Function]]:
    """Return the functions in order, each with its variants that have the same inputs."""
    groups: dict[str, list[Function]] = {}
    for function in module.functions:
        if not function.outputs:
            continue
        base = function.variant_of or function.name
        if base in groups and _names(contract(groups[base][0])) == _names(contract(function)):
            groups[base].append(function)
        else:
            groups[function.name] = [function]
    return list(groups.values())


def _names(ports: Sequence[Port]) -> tuple[str, ...]:
    return tuple(port.name for port in ports)


def prepared_of(module: Module, scalar: str) -> dict[str, Bounded]:
    """Return the nominal values of tunable parameters and the results of prepare() for them, at one point."""
    ports = [port for function in module.every for port in function.inputs]
    nominal = {p.name: _nominal(p, scalar) for p in ports if p.default is not None}
    if module.prepare is not None:
        nominal |= module.prepare.outputs_of(bounds(module.prepare, nominal, scalar, 1))
    return nominal


def _nominal(port: Port, scalar: str) -> Bounded:
    value = float(port.default or 0)
    printed = nearest_float32(value) if scalar == "float" else value
    return Bounded(np.array([value]), rounding_of(value, printed))


def _table(
    module: Module,
    group: Sequence[Function],
    scalar: str,
    site: Site,
    prepared: Mapping[str, Bounded],
    numbers: int,
) -> Table:
    """Return the table of functions with the same inputs; rows of a long table are left out at even distances."""
    ports = contract(group[0])
    tried = list(points(group[0], ports, site)) if ports else [("constant", np.zeros(0))]
    if ports:
        rows_, fixed = np.array([values for _, values in tried]), {n: b.value for n, b in prepared.items()}
        tried += [point for f in group for point in near_thresholds(f, ports, rows_, fixed)]
    columns = _columns(ports, tried, prepared)
    nodes_of = [bounds(function, columns, scalar, len(tried)) for function in group]
    results: dict[str, Bounded] = {}
    for function, nodes in zip(group, nodes_of, strict=True):
        for name, b in function.outputs_of(nodes).items():
            before = results.get(name, b)
            results[name] = Bounded(before.value, np.maximum(before.error, b.error))
    rows = _kept([b for nodes in nodes_of for b in nodes], tried, _sound(results.values(), scalar))

    def exactly(point: Array) -> dict[str, Exact]:
        inputs = {p.name: Exact(Fraction(x)) for p, x in zip(ports, point.tolist(), strict=True)}
        each = [evaluate_module(module, f.name, inputs, EXACT) for f in group]
        return {name: value for values in each for name, value in values.items()}

    most = max(LEAST_ROWS, numbers // (len(ports) + 2 * len(results)))
    rows = rows[:: -(-len(rows) // most)] if len(rows) > most else rows
    vectors = tuple(_vectors(tried, results, rows, scalar, exactly))
    return Table(tuple(f.name for f in group), _names(ports), tuple(results), vectors)


def _columns(
    ports: Sequence[Port], tried: Sequence[Point], prepared: Mapping[str, Bounded]
) -> dict[str, Bounded]:
    count, none = len(tried), np.zeros((2, len(tried)))
    columns = {
        name: Bounded(np.full(count, b.value[0]), np.broadcast_to(b.error, (2, count)))
        for name, b in prepared.items()
    }
    for port, column in zip(ports, np.array([values for _, values in tried]).T, strict=True):
        columns[port.name] = Bounded(column, none)
    return columns


def _sound(results: Iterable[Bounded], scalar: str) -> Array:
    """Return by point whether every output is finite and its error bound small."""
    worst = _WORST * UNITS[scalar]
    each = [np.isfinite(b.value) & (b.error[0] <= worst * (1 + np.abs(b.value))) for b in results]
    return np.logical_and.reduce(each)


def _kept(nodes: Sequence[Bounded], tried: Sequence[Point], sound: Array) -> list[int]:
    """Return the points of a table: all sound ones, and those of the pool with a rare pair of outcomes of choices."""
    choices = [b.outcome[0] for b in nodes if b.outcome is not None]
    matrix = np.array(choices).reshape(len(choices), len(tried))
    outcomes = np.concatenate([matrix == 1, matrix == -1]).T
    seen = np.zeros((outcomes.shape[1],) * 2, dtype=int)
    rows, spare = [], _SPARE
    common: set[bytes] = set()  # outcomes of points of the pool without a rare pair
    for k in np.flatnonzero(sound).tolist():
        branch, own = tried[k][0] == BRANCH, outcomes[k].tobytes()
        if branch and (not spare or own in common):
            continue
        pairs = np.outer(outcomes[k], outcomes[k])
        if branch and not (pairs & (seen < _RARE)).any():
            common.add(own)
            continue
        spare -= branch
        rows.append(k)
        seen += pairs
    return rows


def _vectors(
    tried: Sequence[Point],
    results: Mapping[str, Bounded],
    rows: Sequence[int],
    scalar: str,
    exactly: Callable[[Array], Mapping[str, Exact]],
) -> Iterator[Vector]:
    """Yield the rows of a table; the tolerance includes the rounding of the expected value."""
    value = np.array([b.value for b in results.values()])[:, rows]
    error = np.array([b.error for b in results.values()])[:, :, rows]
    expected, sure = rounded(value, error[:, 1], scalar)
    slack = _SLACK * (error[:, 0] + (UNITS[scalar] + 2.0**-53) * np.abs(value)) + FLOOR
    enter = to_float32 if scalar == "float" else to_float64
    for k, row in enumerate(rows):
        text, point = tried[row]
        wanted = expected[:, k]
        if not sure[:, k].all():
            exact = exactly(point)
            wanted = np.where(sure[:, k], wanted, [enter(exact[name]) for name in results])
        yield Vector(text, tuple(point.tolist()), tuple(wanted.tolist()), tuple(slack[:, k].tolist()))


@np.errstate(over="ignore")
def rounded(value: Array, error: Array, scalar: str) -> tuple[Array, Array]:
    """Round values to the scalar type; values that are certainly below `FLOOR` become 0.

    Args:
        value: float64 values.
        error: bounds of their errors.
        scalar: "float" or "double".

    Returns:
        The rounded values, and for each whether all numbers within ``error`` round to it.
    """
    nothing = np.abs(value) + error < FLOOR
    value = np.where(nothing, 0.0, value)
    if scalar == "double":
        return value, nothing | (error == 0)
    low, high = (value - error).astype(np.float32), (value + error).astype(np.float32)
    return value.astype(np.float32).astype(np.float64), nothing | (low == high)


def _law(module: Module, name: str, scalar: str, site: Site, prepared: Mapping[str, Bounded]) -> Table | None:
    """Return the table of forward after an inverse, for admissible twists; None if forward needs other inputs."""
    by_name = {f.name: f for f in module.functions}
    if not {name, "forward"} <= by_name.keys():
        return None
    inverse, forward = by_name[name], by_name["forward"]
    ports = contract(inverse)
    names = _names(ports)
    joints_too = {*names, *(p.name for p in inverse.outputs)}
    if not (set(TWIST_NAMES) <= set(names) and {p.name for p in contract(forward)} <= joints_too):
        return None
    tried = list(_there_and_back(ports, site))
    # The law does not distinguish zeros of either sign: which way a wheel rolls does not matter.
    columns = _columns(ports, [(text, row + 0.0) for text, row in tried], prepared)
    joints = inverse.outputs_of(bounds(inverse, columns, scalar, len(tried)))
    twists = forward.outputs_of(bounds(forward, {**columns, **joints}, scalar, len(tried)))
    results = {n: Bounded(columns[n].value, twists[n].error) for n in TWIST_NAMES}
    missed = np.logical_or.reduce([np.abs(twists[n].value - columns[n].value) > 1e-9 for n in TWIST_NAMES])
    sound = np.flatnonzero(_sound(results.values(), scalar) & ~missed).tolist()
    generic = [k for k in sound if tried[k][0] == THERE]
    picked = generic[:_LAWS] + [k for k in sound if tried[k][0] != THERE]

    def exactly(point: Array) -> dict[str, Exact]:
        return {n: Exact(Fraction(float(x))) for n, x in zip(names, point, strict=True)}

    vectors = tuple(_vectors(tried, results, picked, scalar, exactly))
    return Table((name, "forward"), names, TWIST_NAMES, vectors, law=True)


def _there_and_back(ports: Sequence[Port], site: Site) -> Iterator[Point]:
    """Yield generic and straight motions, and each command alone, the others -0, with wheels at 0 or 90 degrees."""
    names = _names(ports)
    rows = Grid(ports, site).rows[:12]
    ahead = rows[:6].copy()
    ahead[:, names.index("vy")] = 0.0
    for row in (*rows, *ahead):
        yield THERE, row
    angles = np.array([port.unit == "rad" for port in ports])
    quarter = nearest_float32(np.pi / 2)
    for command in TWIST_NAMES:
        for side, wheels in ((-1.0, 0.0), (1.0, quarter)) if angles.any() else ((-1.0, 0.0),):
            row = np.where(angles, wheels, 0.0)
            row[[names.index(n) for n in TWIST_NAMES]] = -0.0
            row[names.index(command)] = side
            yield "there and back beside -0", row
