"""Test vectors of a module: inputs, what the exact formula gives, and how far rounding may take code from it.

Points: standstill, each command alone in both signs, generic ones with their mirror images, very slow and very
fast ones, the centre of rotation close to and on each pivot, and whatever else takes a branch that these do not.
A point where rounding decides between different results is left out. Laws: forward after inverse gives the twist.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from wmrgen.ir.nodes import Function, Module, Op, Port, Role
from wmrgen.ir.rounding import nearest_float32
from wmrgen.ir.running import UNITS, Array, Bounded, bounds, outputs

TWIST = ("vx", "vy", "omega")
_SIZE = {"m/s": 1.5, "rad/s": 2.0, "rad": 3.0, "m": 2.0, "s": 0.25}
_GENERIC, _POOL, _ROWS = 10, 32, 64
_WORST = 2.0**13  # units of rounding: what loses more is too ill-conditioned to test anything
_SLACK = 1.05  # the printed tolerance above the bound: second-order terms, rounding of the printed numbers
_FLOOR = 1e-12


@dataclass(frozen=True, slots=True)
class Site:
    """What a robot's file says about inputs. ``limits``: contract name -> (low, high); ``pivots``: x, y [m]."""

    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    pivots: tuple[tuple[str, float, float], ...] = ()


NO_SITE = Site()


@dataclass(frozen=True, slots=True)
class Vector:
    """One point of a table, in its order of names."""

    text: str
    inputs: tuple[float, ...]
    expected: tuple[float, ...]
    tolerance: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """The vectors of ``functions``: one, or inverse and forward where outputs of the first feed the second."""

    functions: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    vectors: tuple[Vector, ...]


Point = tuple[str, Array]  # what it is, one value per port


def tables(module: Module, scalar: str, site: Site = NO_SITE) -> tuple[Table, ...]:
    """A table per function with inputs and outputs, then one for the law."""
    prepared = _prepared(module, scalar)
    found = [_table(f, scalar, site, prepared) for f in module.functions if f.outputs]
    law = _law(module, scalar, site, prepared)
    return tuple(t for t in (*found, law) if t is not None and t.vectors)


def contract(function: Function) -> tuple[Port, ...]:
    """Inputs that a caller gives at every step."""
    return tuple(port for port in function.inputs if port.role in (Role.STATE, Role.COMMAND))


def _prepared(module: Module, scalar: str) -> dict[str, Bounded]:
    """Tunable parameters at their nominal values, and what prepare() makes of them; one point."""
    ports = [p for f in (*module.functions, *([module.prepare] if module.prepare else [])) for p in f.inputs]
    known = {p.name: _nominal(p, scalar) for p in ports if p.default is not None}
    if module.prepare is not None:
        known |= outputs(module.prepare, bounds(module.prepare, known, scalar, 1))
    return known


def _nominal(port: Port, scalar: str) -> Bounded:
    value = float(port.default or 0)
    off = abs(nearest_float32(value) - value) if scalar == "float" else 0.0
    return Bounded(np.array([value]), np.array([off + 2.0**-53 * abs(value)]))


def _table(function: Function, scalar: str, site: Site, prepared: Mapping[str, Bounded]) -> Table:
    ports = contract(function)
    points = list(_points(function, ports, site)) if ports else [("constant", np.zeros(0))]
    known = bounds(function, _columns(ports, points, prepared), scalar, len(points))
    by_name = outputs(function, known)
    made = [by_name[port.name] for port in function.outputs]
    rows = _kept(known, points, _sound(made, scalar))
    names = tuple(port.name for port in function.outputs)
    return Table((function.name,), tuple(p.name for p in ports), names, _vectors(points, made, rows, scalar))


def _columns(
    ports: Sequence[Port], points: Sequence[Point], prepared: Mapping[str, Bounded]
) -> dict[str, Bounded]:
    count, none = len(points), np.zeros(len(points))
    columns = {
        name: Bounded(np.full(count, b.value[0]), np.full(count, b.error[0])) for name, b in prepared.items()
    }
    for port, column in zip(ports, np.array([values for _, values in points]).T, strict=True):
        columns[port.name] = Bounded(column, none)
    return columns


def _sound(made: Sequence[Bounded], scalar: str) -> Array:
    """Per point: every output is finite and its bound small."""
    worst = _WORST * UNITS[scalar]
    good = [np.isfinite(b.value) & (b.error <= worst * (1 + np.abs(b.value))) for b in made]
    return np.logical_and.reduce(good)


def _kept(known: list[Bounded], points: Sequence[Point], sound: Array) -> list[int]:
    """The first points that are sound, then of the pool only those that take a new branch."""
    choices = [b.taken for b in known if b.taken is not None]
    count = len(choices)
    taken = np.array(choices).reshape(count, len(points))
    seen = np.zeros((2, count), dtype=bool)
    rows = []
    for k, (text, _) in enumerate(points):
        if not sound[k]:
            continue
        now = np.array([taken[:, k] == 1, taken[:, k] == -1])
        if text != "branch" or (now & ~seen).any():
            rows.append(k)
            seen |= now
    return rows


def _vectors(
    points: Sequence[Point], made: Sequence[Bounded], rows: Sequence[int], scalar: str
) -> tuple[Vector, ...]:
    """The rows of the table; the rounding of the printed expectation counts."""
    values = np.array([b.value for b in made])
    rounding = UNITS[scalar] + 2.0**-53
    slack = np.maximum(_SLACK * (np.array([b.error for b in made]) + rounding * np.abs(values)), _FLOOR)
    return tuple(
        Vector(points[k][0], *(tuple(part.tolist()) for part in (points[k][1], values[:, k], slack[:, k])))
        for k in rows
    )


# ---- points


class _Grid:
    """Generic values of some ports: row k, one value per port, multiples of 1/128 of a typical size."""

    def __init__(self, ports: Sequence[Port], site: Site) -> None:
        sizes = np.array([_size(port, site) for port in ports])
        row, column = np.ogrid[0:_ROWS, 0 : len(ports)]
        spread = (row * 37 + column * 23 + row * column * 5 + 11) % 62 - 31
        self.rows = np.rint(sizes * (spread + (spread >= 0)) * 4) / 128  # never zero
        self.single = np.maximum(np.rint(sizes * 96) / 128, 1 / 128)


def _size(port: Port, site: Site) -> float:
    """A typical size: a declared limit's where it is smaller."""
    size = 20.0 if port.name.endswith(".spin") else _SIZE.get(port.unit, 1.0)
    low, high = site.limits.get(port.name, (-size, size))
    return min(size, max(abs(low), abs(high)))


def _points(function: Function, ports: Sequence[Port], site: Site) -> Iterator[Point]:
    grid = _Grid(ports, site)
    moving = np.array([p.role is Role.COMMAND for p in ports])
    timed = np.array([p.unit == "s" for p in ports])
    yield "all zero", np.zeros(len(ports))
    yield "standstill", np.where(moving, 0.0, grid.rows[3])
    for column in np.flatnonzero(moving).tolist():
        alone = np.zeros(len(ports))
        alone[column] = grid.single[column]
        yield f"{ports[column].name} alone", alone
        if moving.sum() <= 4:
            yield f"{ports[column].name} alone, backwards", -alone
    for row in range(_GENERIC):
        yield "generic", grid.rows[row]
        if row < _GENERIC // 2:
            yield "the same backwards", np.where(moving, -grid.rows[row], grid.rows[row])
    for power, text in ((-14, "very slow"), (7, "fast"), (20, "very fast")):
        factor = np.where(moving & ~timed, 2.0**power, 1.0)
        yield text, grid.rows[17 + power] * factor
    yield from _centres(ports, site, grid)
    if any(node.op in (Op.SELECT, Op.MIN, Op.MAX) for node in function.nodes):
        for row in range(_GENERIC, _GENERIC + _POOL):
            yield "branch", grid.rows[row] * (4.0 if row % 3 else 0.125)


def _centres(ports: Sequence[Port], site: Site, grid: _Grid) -> Iterator[Point]:
    """The centre of rotation beside each pivot and on it."""
    names = [p.name for p in ports]
    if not set(TWIST) <= set(names):
        return
    where = [names.index(n) for n in TWIST]
    for row, (name, x, y) in enumerate(site.pivots):
        for off, text in ((1 / 64, "near"), (0.0, "on")):
            point = grid.rows[(row + 5) % _ROWS].copy()
            point[where] = nearest_float32(y - off / 2), -nearest_float32(x + off), 1.0
            yield f"centre of rotation {text} {name}", point


# ---- the law


def _law(module: Module, scalar: str, site: Site, prepared: Mapping[str, Bounded]) -> Table | None:
    """Forward after inverse at twists that the wheels admit; None where forward asks for more than that."""
    by_name = {f.name: f for f in module.functions}
    if not {"inverse", "forward"} <= by_name.keys():
        return None
    inverse, forward = by_name["inverse"], by_name["forward"]
    ports = contract(inverse)
    names = [p.name for p in ports]
    given = {*names, *(p.name for p in inverse.outputs)}
    if not (set(TWIST) <= set(names) and {p.name for p in contract(forward)} <= given):
        return None
    rows = _Grid(ports, site).rows[:12]
    ahead = rows[:6].copy()
    ahead[:, names.index("vy")] = 0.0
    points: list[Point] = [("there and back", row) for row in (*rows, *ahead)]
    columns = _columns(ports, points, prepared)
    there = outputs(inverse, bounds(inverse, columns, scalar, len(points)))
    back = outputs(forward, bounds(forward, {**columns, **there}, scalar, len(points)))
    made = [Bounded(columns[n].value, back[n].error) for n in TWIST]
    missed = np.logical_or.reduce([np.abs(back[n].value - columns[n].value) > 1e-9 for n in TWIST])
    picked = np.flatnonzero(_sound(made, scalar) & ~missed)[:8].tolist()
    return Table(("inverse", "forward"), tuple(names), TWIST, _vectors(points, made, picked, scalar))
