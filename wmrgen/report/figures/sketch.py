"""Draw a small top view in characters, for a terminal: x is up, and a character is twice as high as wide."""

from __future__ import annotations

from math import cos, pi, sin

from wmrgen.geometry.layout.records import Robot, Wheel

_WIDE, _HIGH = 26.0, 9.0  # characters between the outermost wheels, so that names fit beside them
_LONGEST = 20  # characters of a name; longer names are cut
_STROKES = "|\\-/"  # a wheel that rolls up, to the upper left, to the left, to the lower left
_BALL, _P = "o", "+"
Cell = tuple[int, int]  # row, column


def sketch(robot: Robot) -> list[str]:
    """Return lines of at most 80 characters: wheels as strokes along their rolling direction, P, and names."""
    pivots = [w.pivot for w in robot.wheels] + [0j]
    xs, ys = [p.real for p in pivots], [p.imag for p in pivots]
    length, wide = max(xs) - min(xs), max(ys) - min(ys)
    largest_radius = max(float(w.nominal.r) for w in robot.wheels)
    step = max(wide / _WIDE, length / _HIGH / 2, largest_radius / 3, 1e-9)
    cells: dict[Cell, str] = {(0, 0): _P, (-1, 0): "^"}
    bodies = [_body(w, step) for w in robot.wheels]
    for w, body in zip(robot.wheels, bodies, strict=True):
        cells |= dict.fromkeys(body, _stroke(w))
    for w, body in zip(robot.wheels, bodies, strict=True):
        cells |= _name(w, body, cells)
    rows, columns = zip(*cells, strict=True)
    lines = []
    for row in range(min(rows), max(rows) + 1):
        line = "".join(cells.get((row, k), " ") for k in range(min(columns), max(columns) + 1))
        lines.append(line.rstrip())
    return lines


def _body(w: Wheel, step: float) -> list[Cell]:
    """Return the cells of a tyre, one or three. ``step``: width of a character [m]."""
    b = w.contact(w.zero_heading)
    row, column = round(-b.real / (2 * step)), round(-b.imag / step)
    if w.kind.glyph.ball:
        return [(row, column)]
    down, right = round(-cos(w.heading)), round(-sin(w.heading))
    reach = 1 if float(w.nominal.r) > step else 0
    return [(row + k * down, column + k * right) for k in range(-reach, reach + 1)]


def _stroke(w: Wheel) -> str:
    return _BALL if w.kind.glyph.ball else _STROKES[round(w.heading / (pi / 4)) % 4]


def _name(w: Wheel, body: list[Cell], cells: dict[Cell, str]) -> dict[Cell, str]:
    """Place a name beside the wheel, on its outer side if possible, else above or below; {} if no place is free."""
    text = w.name if len(w.name) <= _LONGEST else f"{w.name[: _LONGEST - 3]}..."
    rows, columns = zip(*body, strict=True)
    row, column = body[len(body) // 2]
    sides = [(row, min(columns) - 1 - len(text)), (row, max(columns) + 2)]
    above = column - (len(text) - 1) // 2
    starts = [*sides[:: 1 if w.pivot.imag > 0 else -1], (min(rows) - 1, above), (max(rows) + 1, above)]
    for at, start in starts:
        place = {(at, start + k): c for k, c in enumerate(text)}
        if not cells.keys() & {*place, (at, start - 1), (at, start + len(text))}:
            return place
    return {}
