"""Draw designs side by side: a panel for each figure of merit, over the varied parameter or over the designs."""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.analysis.mobility.basis import NEGLIGIBLE
from wmrgen.report.figures.axis import ends
from wmrgen.report.figures.figure import WIDTH, Figure, Group, figure
from wmrgen.report.figures.paper import COLOURS, Paper, Point, circle, line, lines, text
from wmrgen.tools.designs.figures import QUALITIES, Facts, Quality

FILE = "designs.svg"
_COLUMNS, _PANEL, _GAP = 2, 76.0, 44.0  # panels in a row; px: height of a panel, and space above it
_SIDE, _NUMBERS = 12.0, 52.0  # px: margin, and room for the numbers at the left of a panel
_ACROSS = (WIDTH / _COLUMNS - _NUMBERS - 40) / 2  # px: room for a number below a panel
_ROW = 16.0  # px: height of a line of words
_MANY = 40  # designs: more dots touch each other, and are drawn as a line only
_STYLE = (
    "<style>.wmrgen .trace { fill: none; stroke-width: 1.4; } "
    ".wmrgen .rest { stroke: #767676; stroke-width: 0.8; }</style>"
)


def picture(designs: Sequence[Facts], axis: str | None) -> Figure:
    """Return the figure of designs.

    Args:
        designs: from `qualities`.
        axis: the varied parameter at the horizontal axis; None to number the designs.

    Returns:
        The figure. Qualities that are equal for all designs, or unknown, are left out.
    """
    names = list(dict.fromkeys(str(facts["name"]) for facts in designs))
    shown = differing(designs)
    groups: list[Group] = [("", [_STYLE])]
    wide = (WIDTH - 2 * _SIDE) / _COLUMNS
    top = 8.0
    for k, quality in enumerate(shown):
        left = _SIDE + wide * (k % _COLUMNS)
        groups.append(
            ("", _panel(quality, designs, names, axis, (left, top, left + wide - 14, top + _GAP + _PANEL)))
        )
        if k % _COLUMNS == _COLUMNS - 1 or k == len(shown) - 1:
            top += _GAP + _PANEL
    top += 26.0
    legend = []
    for k, name in enumerate(names):
        number = "" if axis else f"{_numbers(designs, name)}: "
        legend.append(circle((_SIDE + 5, top - 4), 4, "").replace("/>", f' fill="{_colour(k)}"/>'))
        legend.append(text((_SIDE + 16, top), f"{number}{name}", "words"))
        top += _ROW
    if axis is not None:
        places = [value for facts in designs if (value := _value(facts, axis)) is not None]
        scale = ends(min(places, default=0.0), max(places, default=0.0), _ACROSS).unit("")
        legend.append(text((_SIDE, top), f"horizontal: {axis}{scale}", "words"))
        top += _ROW
    groups.append(("", legend))
    over = f" over {axis}" if axis else ""
    alt = f"{len(designs)} designs of {', '.join(names)}{over}: {', '.join(quality.title for quality in shown)}."
    return figure(FILE, alt, top, groups)


def differing(designs: Sequence[Facts]) -> list[Quality]:
    """Return the qualities that are not equal for all designs: those that the picture draws."""
    return [quality for quality in QUALITIES if _differs(quality, designs)]


def _numbers(designs: Sequence[Facts], name: str) -> str:
    """Return the numbers of the designs of a robot, from 1."""
    own = [k for k, facts in enumerate(designs, 1) if facts["name"] == name]
    return f"{own[0]}" if len(own) == 1 else f"{own[0]}–{own[-1]}"


def _colour(k: int) -> str:
    return COLOURS[k % len(COLOURS)]


def _value(facts: Facts, name: str) -> float | None:
    value = facts.get(name)
    return None if value is None or isinstance(value, str) else float(value)


def _differs(quality: Quality, designs: Sequence[Facts]) -> bool:
    """Return whether a quality is known for some designs and not equal for all."""
    values = [value for facts in designs if (value := _value(facts, quality.name)) is not None]
    if not values:
        return False
    return max(values) - min(values) > NEGLIGIBLE * max(map(abs, values)) or len(values) < len(designs)


def _panel(
    quality: Quality,
    designs: Sequence[Facts],
    names: Sequence[str],
    axis: str | None,
    box: tuple[float, float, float, float],
) -> list[str]:
    """Draw a quality of all designs.

    Args:
        quality: the quality.
        designs: the designs.
        names: the names of the robots, each with its colour.
        axis: the parameter at the horizontal axis; None to number the designs.
        box: left, top, right and bottom of the panel with its title [px].

    Returns:
        The SVG elements.
    """
    left, upper, right, lower = box[0] + _NUMBERS, box[1] + _GAP - 12, box[2], box[3] - 12
    values = [value for facts in designs if (value := _value(facts, quality.name)) is not None]
    low, high = min(values), max(values)
    span = (high - low) or abs(high) or 1.0
    places = [float(k) if axis is None else _value(facts, axis) or 0.0 for k, facts in enumerate(designs, 1)]
    first, last = min(places), max(places)
    length = (last - first) or 1.0

    def on(place: float, value: float) -> Point:
        inset = 6.0
        x = left + inset + (right - left - 2 * inset) * (place - first) / length
        return x, lower - inset - (lower - upper - 2 * inset) * (value - low) / span

    numbers = ends(low, high, left - box[0] + 4)  # next to the panel are 14 px
    across = ends(first, last, _ACROSS)
    paper = Paper((0.0, 0.0, WIDTH, lower + 20))
    elements = [
        paper.write((box[0], box[1] + _GAP - 20), f"{quality.title}{numbers.unit(quality.unit)}", "title"),
        line((left, lower), (right, lower), "rest"),
        line((left, upper), (left, lower), "rest"),
        text((left - 5, lower - 2), numbers.low, "words end"),
        text((left + 2, lower + 13), across.low, "words"),
        text((right, lower + 13), across.high, "words end"),
    ]
    if high > low:
        elements.append(text((left - 5, upper + 9), numbers.high, "words end"))
    for k, name in enumerate(names):
        points = []
        for place, facts in zip(places, designs, strict=True):
            value = _value(facts, quality.name)
            if facts["name"] == name and value is not None:
                points.append(on(place, value))
        if axis is not None and len(points) > 1:
            elements.append(
                lines(points, "trace").replace("<polyline", f'<polyline stroke="{_colour(k)}"', 1)
            )
        if len(designs) <= _MANY or axis is None:
            dots = (circle(p, 3.0, "").replace("/>", f' fill="{_colour(k)}"/>') for p in points)
            elements += dots
    return elements
