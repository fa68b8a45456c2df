"""Draw a calibration: paths before and after with the reference, their errors by time, and the parameters.

The picture is narrow, so that its words are 10 px high at a width of 400.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite

import numpy as np

from wmrgen.report.figures.paper import Box, Point, circle, line, lines, metres, text, width
from wmrgen.tools.calibration.errors import Drawn
from wmrgen.tools.calibration.observability import Estimate
from wmrgen.tools.calibration.path import Reals

_WIDTH = 480  # of the page, in units of the drawing
_PATHS: Box = (20, 40, 460, 360)  # left, top, right, bottom
_ERRORS: Box = (72, 432, 460, 572)
_VALUES, _ROW, _MARGIN = 640, 20, 20  # where parameters begin, a row of them, the margin at the sides
_MOST = 300  # points of a line
_STYLE = """.calibration .page { fill: #ffffff; }
.calibration text { font: 12px Helvetica, Arial, sans-serif; fill: #000000; }
.calibration .end { text-anchor: end; }
.calibration .middle { text-anchor: middle; }
.calibration polyline { fill: none; stroke-width: 1.2; stroke-linejoin: round; }
.calibration .reference { stroke: #767676; stroke-width: 3; }
.calibration .before { stroke: #d55e00; stroke-dasharray: 5 3; }
.calibration .after { stroke: #0072b2; }
.calibration .axis { stroke: #000000; stroke-width: 0.8; }
.calibration .weak { stroke: #767676; stroke-width: 1.6; stroke-dasharray: 2 3; }
.calibration .sure { stroke: #0072b2; stroke-width: 1.6; }
.calibration .dot { fill: #0072b2; }
@media screen and (prefers-color-scheme: dark) {
.calibration .page { fill: #181818; }
.calibration text { fill: #e6e6e6; }
.calibration .reference, .calibration .weak { stroke: #9e9e9e; }
.calibration .after, .calibration .sure { stroke: #56b4e9; }
.calibration .axis { stroke: #e6e6e6; }
.calibration .dot { fill: #56b4e9; }
}"""


def picture(before: Sequence[Drawn], after: Sequence[Drawn], parameters: Mapping[str, Estimate]) -> str:
    """Return the text of the SVG.

    Args:
        before: Each log with nominal parameters.
        after: Each log with the fitted parameters.
        parameters: The fitted parameters, by name.
    """
    elements = [*_key(), *_paths(before, after), *_errors(before, after), *_values(parameters)]
    height = _VALUES + _ROW * len(parameters) + _MARGIN
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" class="calibration">'
    page = f'<rect width="{_WIDTH}" height="{height}" class="page"/>'
    return "\n".join([head, f"<style>\n{_STYLE}\n</style>", page, *elements, "</svg>"]) + "\n"


def _key() -> Iterable[str]:
    for k, word in enumerate(("reference", "before", "after")):
        x = 20 + 110 * k
        yield lines([(x, 20), (x + 30, 20)], word)
        yield text((x + 36, 24), word, "words")


def _paths(before: Sequence[Drawn], after: Sequence[Drawn]) -> Iterable[str]:
    """Where the tracked point was, and where odometry has it, x to the right; one scale for both axes."""
    groups = [
        ("reference", [d.seen for d in after]),
        ("before", [d.place for d in before]),
        ("after", [d.place for d in after]),
    ]
    every = np.concatenate([path for _, paths in groups for path in paths])
    if not len(every):
        yield text((_PATHS[0], 60), "no whole poses were measured", "words")
        return
    low, high = complex(every.real.min(), every.imag.min()), complex(every.real.max(), every.imag.max())
    size = max(high.real - low.real, high.imag - low.imag, 1e-6)
    scale = min(_PATHS[2] - _PATHS[0], _PATHS[3] - _PATHS[1]) / size
    for cls, paths in groups:
        for path in paths:
            seen = path[:: 1 + len(path) // _MOST]
            yield lines(
                [
                    (_PATHS[0] + scale * (z.real - low.real), _PATHS[3] - scale * (z.imag - low.imag))
                    for z in seen
                ],
                cls,
            )
    metre = float(10 ** np.floor(np.log10(size / 2)))
    below = _PATHS[3] + 14
    yield line((_PATHS[0], below), (_PATHS[0] + scale * metre, below), "axis")
    yield text((_PATHS[0] + scale * metre + 6, below + 4), f"{metre:g} m", "words")


def _errors(before: Sequence[Drawn], after: Sequence[Drawn]) -> Iterable[str]:
    """How far odometry is from the reference [m], by time since the first pose."""
    groups = [("before", before), ("after", after)]
    curves = [(cls, d.t - d.t[:1], d.distance) for cls, group in groups for d in group if len(d.t)]
    last = max((float(t[-1]) for _, t, _ in curves), default=0.0) or 1.0
    most = max((float(error.max()) for _, _, error in curves), default=0.0) or 1.0
    left, top, right, bottom = _ERRORS
    yield line((left, bottom), (right, bottom), "axis")
    yield line((left, top), (left, bottom), "axis")
    yield text((left - 6, top + 8), metres(most), "end")
    yield text((left - 6, bottom + 4), "0", "end")
    yield text((right, bottom + 16), f"{last:.3g} s", "end")
    yield text((left, top - 14), "distance of odometry from the reference", "words")
    for cls, t, error in curves:
        thin = slice(None, None, 1 + len(t) // _MOST)
        yield lines(
            _points(left + (right - left) * t[thin] / last, bottom - (bottom - top) * error[thin] / most), cls
        )


def _points(x: Reals, y: Reals) -> list[Point]:
    return list(zip(x.tolist(), y.tolist(), strict=True))


def _values(parameters: Mapping[str, Estimate]) -> Iterable[str]:
    """What each parameter is away from nominal, in percent of it (in units of 0.01 where that is zero), and three
    standard deviations each way; an interval that leaves the picture ends at its side."""
    left = min(max(map(width, parameters), default=0.0) + _MARGIN + 8, _WIDTH / 2)
    top, right, bottom = _VALUES, _WIDTH - _MARGIN, _VALUES + _ROW * len(parameters)
    shown = {n: _percent(e) for n, e in parameters.items()}
    sure = [
        abs(middle) + 3 * sigma
        for n, (middle, sigma) in shown.items()
        if parameters[n].observable and isfinite(sigma)
    ]
    most = max([*sure, *(abs(middle) for middle, _ in shown.values()), 1e-3])
    half, centre = (right - left) / 2, (left + right) / 2
    told = f"change from nominal, 3 sigma; whole width {2 * most:.2g} %"
    yield text((right, top - 12), told, "end")
    yield line((centre, top), (centre, bottom), "axis")
    for k, (name, (middle, sigma)) in enumerate(shown.items()):
        y = top + _ROW * (k + 0.5)
        low, high = (float(np.clip(middle + side * sigma, -most, most)) for side in (-3, 3))
        cls = "sure" if parameters[name].observable else "weak"
        yield line((centre + half * low / most, y), (centre + half * high / most, y), cls)
        yield circle((centre + half * middle / most, y), 3, "dot")
        yield text((left - 8, y + 4), name, "end")


def _percent(estimate: Estimate) -> tuple[float, float]:
    unit = abs(estimate.nominal) or 1.0
    sigma = 0.0 if estimate.sigma is None else estimate.sigma
    return 100 * (estimate.value - estimate.nominal) / unit, 100 * sigma / unit
