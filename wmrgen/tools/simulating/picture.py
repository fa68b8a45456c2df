"""Draw simulated drives: the path with the robots on it, and pose and joints by time. The picture moves without script.

Robots are animated by SMIL: a browser plays the drive in real time, again and again. Programs that ignore SMIL show the
robots at the end of their paths.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import atan2, cos, degrees, sin
from typing import NamedTuple

import numpy as np

from wmrgen.geometry.layout.records import Wheel
from wmrgen.report.figures.axis import ends
from wmrgen.report.figures.figure import RIGHT, WIDTH, Figure, Group, Pose, View, figure, fitted, moved, panel
from wmrgen.report.figures.marks import body, chassis, extremes, placed
from wmrgen.report.figures.paper import COLOURS, Box, Paper, Point, bar, circle, line, lines, num, text, width
from wmrgen.tools.simulating.drive import Drive
from wmrgen.tools.simulating.model import Reals

FILE = "drive.svg"
_PATH: Box = (16.0, 26.0, WIDTH - 16.0, 330.0)  # px: the panel of the path
_PLOT = 62.0  # px: height of a plot
_GAP = 40.0  # px above a plot, for its title and the first row of its legend
_ROW = 15.0  # px from one row of a legend to the next
_LEFT, _RIGHT = 62.0, WIDTH - 16.0  # px: ends of the time axis; numbers are at its left
_FRAMES = 120  # keyframes of an animation: four a second in the longest one
_SAMPLE = 10  # keyframes between two outlines that must be inside the picture
_LONGEST = 30.0  # s: a longer drive is played faster, so that the picture takes this time
_POINTS = 800  # points of a line: two for each px of the plots, and enough for a path with many turns
_OUTLINES = 8  # robots along a path; more cover each other
_ROOM = 1.6  # distance between two robots along a path, in sizes of the robot
_CONSTANT = 1e-6  # relative: smaller changes are not visible
_WHEELBASE = 0.05  # m: size of a robot whose wheels are all at P
_DASHES = (
    "",
    ' stroke-dasharray="5 3"',
    ' stroke-dasharray="1.5 2.5"',
)  # of the first robot, the second, others
_STYLE = (
    "<style>.wmrgen .trace { fill: none; stroke-width: 1.4; stroke-linejoin: round; } "
    ".wmrgen .rest { stroke: #767676; stroke-width: 0.8; } "
    "@media (prefers-reduced-motion: reduce) { .wmrgen .moving { display: none; } }</style>"
)


class Run(NamedTuple):
    """One start of one drive."""

    drive: Drive
    number: int  # of the drive
    start: int
    colour: str

    @property
    def t(self) -> Reals:
        """Return the times [s], (K,)."""
        return self.drive.t[:, self.start]

    def column(self, name: str) -> Reals:
        """Return a quantity by time, (K,)."""
        return self.drive.columns[name][:, self.start]

    @property
    def dash(self) -> str:
        """Return the attribute of a dashed line; "" for a solid line."""
        return _DASHES[min(self.number, len(_DASHES) - 1)]


def picture(drives: Sequence[Drive], goal: tuple[float, float] | None = None) -> Figure:
    """Return the figure of one drive, or of several on the same course.

    Args:
        drives: the drives; those of several starts are drawn together.
        goal: the goal [m], if there is one.

    Returns:
        The figure.
    """
    runs: list[Run] = []
    for number, drive in enumerate(drives):
        for start in range(drive.starts):
            runs.append(Run(drive, number, start, COLOURS[len(runs) % len(COLOURS)]))
    last = max(float(run.t[-1]) for run in runs)
    groups = [("", [_STYLE]), *_course(runs, goal, last)]
    top = _PATH[3] + 16.0
    plots = [("x", "m", "x", 1.0), ("y", "m", "y", 1.0), ("θ", "°", "theta", degrees(1.0))]
    for title, unit, name, scale in plots:
        curves = [Curve(run, "", run.t, scale * run.column(name), run.colour) for run in runs]
        plot, top = _plot((title, unit), curves, top, last)
        groups += plot
    first = " of the first start" if len(runs) > len(drives) else ""
    joints = [
        ("wheel speeds", "rad/s", _joints(runs, "spin", 1.0)),
        ("steering angles", "°", _joints(runs, "steer", degrees(1.0))),
        ("hitch angles", "°", _hitches(runs)),
    ]
    for title, unit, curves in joints:
        if curves:
            plot, top = _plot((f"{title}{first}", unit), curves, top, last)
            groups += plot
    groups.append(("", _cursor(last, _PATH[3] + _GAP - 2.0, top - 18.0)))
    names = " and ".join(dict.fromkeys(run.drive.name for run in runs))
    starts = f", from {len(runs)} starts" if len(runs) > len(drives) else ""
    alt = f"{names} driving for {last:.3g} s{starts}: the path seen from above, and pose and joints by time."
    return figure(FILE, alt, top + 2.0, groups)


# ---- The path, seen from above: x to the right.


def _course(runs: Sequence[Run], goal: tuple[float, float] | None, last: float) -> list[Group]:
    """Draw the paths with the robots on them, and the moving robots."""
    points: list[Point] = [] if goal is None else [goal]
    for run in runs:
        path = _thinned(np.stack([run.column("x"), run.column("y")], axis=-1))
        points += [(float(x), float(y)) for x, y in path]
        for time in [*_stops(run, len(runs) == 1), *_frames(float(run.t[-1]))[::_SAMPLE]]:
            points += _outline(run, time)
    view = fitted(points, (_PATH[0] + 6, _PATH[1] + 6, _PATH[2] - 6, _PATH[3] - 34), RIGHT)
    paper = Paper((0.0, 0.0, WIDTH, _PATH[3]))
    elements = [paper.write((_PATH[0], 16.0), "path, seen from above", "title"), *_scale(view, paper)]
    if len(runs) > 1:
        elements += _names(runs, paper)
    paths, robots, moving = [], [], []
    for run in runs:
        path = _thinned(np.stack([run.column("x"), run.column("y")], axis=-1))
        paths.append(_line([view.on((float(x), float(y))) for x, y in path], run))
        paths.append(circle(view.on((float(run.column("x")[0]), float(run.column("y")[0]))), 2.2, "dot"))
        for time in _stops(run, len(runs) == 1):
            robots += _robot(run, view, time)
        moving += _animated(run, view, last)
    if goal is not None:
        robots.append(circle(view.on(goal), 3.5, "icr"))
    return [
        (panel(view), elements),
        (' class="ghost"', robots),
        ("", paths),
        (' class="moving"', moving),
    ]


def _outline(run: Run, time: float) -> list[Point]:
    """Return points [m] whose box contains the robot with its trailers at a time."""
    pose = _pose(run, time)
    points = _towed_axles(run, time)
    for w in run.drive.model.robot.wheels:
        points += [moved(p, pose) for p in extremes(w, w.heading + _steer(run, w, time))]
    return points


def _scale(view: View, paper: Paper) -> list[str]:
    """Draw a line of a round length, with its length."""
    longest = (_PATH[2] - _PATH[0]) / 4 / view.scale
    power = 10.0 ** np.floor(np.log10(longest))
    length = float(max(n * power for n in (1, 2, 5) if n * power <= longest * (1 + 1e-9)))
    y, x = _PATH[3] - 6, _PATH[0]
    ends = (x, y), (x + length * view.scale, y)
    return [line(*ends, "line"), paper.write((ends[1][0] + 6, y + 4), f"{length:g} m, x to the right")]


def _names(runs: Sequence[Run], paper: Paper) -> list[str]:
    """Write the names of the robots in their colours; nothing for starts of a single robot."""
    drives = {run.number: run for run in reversed(runs)}
    if len(drives) < 2:
        return []
    sizes = [width(run.drive.name) + 40 for run in drives.values()]  # with the line and two gaps
    rows = sum(sizes) > (_PATH[2] - _PATH[0]) / 2  # the title takes the other half
    elements: list[str] = []
    x, y = _PATH[2], 16.0
    for run in (drives[number] for number in sorted(drives, reverse=True)):
        if rows and elements:
            x, y = _PATH[2], y + _ROW
        x -= width(run.drive.name) + 4
        elements.append(paper.write((x, y), run.drive.name))
        x -= 26
        elements.append(_line([(x, y - 4), (x + 22, y - 4)], run))
        x -= 10
    return elements


def _stops(run: Run, alone: bool) -> list[float]:
    """Return the times [s] at which the robot is drawn: start, end, and between them if a path is ``alone``."""
    first, last = float(run.t[0]), float(run.t[-1])
    if not alone:
        return [last]
    steps = np.hypot(np.diff(run.column("x")), np.diff(run.column("y")))
    travelled = np.concatenate([[0.0], np.cumsum(steps)])
    size = max(_WHEELBASE, 2 * run.drive.model.reach)
    count = int(min(_OUTLINES, travelled[-1] / (_ROOM * size) + 1))
    times = [first]
    for k in range(1, count):
        times.append(float(np.interp(travelled[-1] * k / count, travelled, run.t)))
    return [*times, last]


def _value(run: Run, name: str, time: float) -> float:
    """Return a quantity at a time, between two rows by interpolation."""
    return float(np.interp(time, run.t, run.column(name)))


def _pose(run: Run, time: float) -> Pose:
    return _value(run, "x", time), _value(run, "y", time), _value(run, "theta", time)


def _steer(run: Run, wheel: Wheel, time: float) -> float:
    """Return the angle of a wheel from its zero heading."""
    return _value(run, f"{wheel.name}.steer", time) if wheel.turns else 0.0


def _robot(run: Run, view: View, time: float) -> list[str]:
    """Draw the robot with its trailers at a time."""
    pose = _pose(run, time)
    wheels = [placed(w, w.heading + _steer(run, w, time), view, pose) for w in run.drive.model.robot.wheels]
    elements = [e for w in wheels for e in body(w, fine=False)]
    axles = [view.on(p) for p in _towed_axles(run, time)]
    nose = view.on(moved((run.drive.model.reach, 0.0), pose))
    bars = [line(a, b, "bar") for a, b in pairwise(axles)]
    return [*chassis([w.pivot for w in wheels]), *bars, *elements, line(view.on(pose[:2]), nose, "frame")]


def _towed_axles(run: Run, time: float) -> list[Point]:
    """Return the points [m] that the bars of trailers connect: axle of the robot, coupling, axle, coupling, axle."""
    model = run.drive.model
    if not model.trailers:
        return []
    ex, ey, qx, qy = model.leading
    pose = _pose(run, time)
    points = [moved((qx, qy), pose)]
    ahead = pose[2] + atan2(ey, ex)
    for trailer in model.robot.trailers:
        heading = _value(run, f"{trailer.name}.theta", time)
        for distance, angle in ((trailer.hitch, ahead), (trailer.length, heading)):
            back = float(distance.nominal)
            x, y = points[-1]
            points.append((x - back * cos(angle), y - back * sin(angle)))
        ahead = heading
    return points


# ---- The moving robots.


def _frames(last: float) -> list[float]:
    return [last * k / _FRAMES for k in range(_FRAMES + 1)]


def _duration(last: float) -> str:
    return f'dur="{min(max(last, 0.1), _LONGEST):.3g}s" repeatCount="indefinite"'


def _animation(kind: str, values: Sequence[str], last: float) -> str:
    """Return the animation of a transform; one value for all frames needs none."""
    if len(set(values)) == 1:
        return ""
    return f'<animateTransform attributeName="transform" type="{kind}" values="{";".join(values)}" {_duration(last)}/>'


def _animated(run: Run, view: View, last: float) -> list[str]:
    """Return the robot at the end of its path, with the animation that moves it along the path."""
    if last <= 0:
        return []
    poses = [_pose(run, time) for time in _frames(last)]
    places = [" ".join(map(num, view.on((x, y)))) for x, y, _ in poses]
    turns = [num(-degrees(theta)) for *_, theta in poses]
    local = View(view.scale, (0.0, 0.0), RIGHT)
    wheels = run.drive.model.robot.wheels
    pivots = [placed(w, w.heading, local).pivot for w in wheels]
    parts = [*chassis(pivots)]
    for wheel in wheels:
        parts += _wheel(run, wheel, local, last)
    nose = local.on((run.drive.model.reach, 0.0))
    robot = [line((0.0, 0.0), nose, "frame"), circle((0.0, 0.0), 2.6, "dot")]
    return [
        *_moving_trailers(run, view, last),
        f'<g transform="translate({places[-1]})">{_animation("translate", places, last)}'
        f'<g transform="rotate({turns[-1]})">{_animation("rotate", turns, last)}',
        *parts,
        *robot,
        "</g></g>",
    ]


def _wheel(run: Run, wheel: Wheel, local: View, last: float) -> list[str]:
    """Draw a wheel in the frame of the robot; a wheel that turns is animated about its pivot."""
    drawn = placed(wheel, wheel.heading, local)
    if not wheel.turns:
        return body(drawn, fine=False)
    about = " ".join(map(num, drawn.pivot))
    turns = [f"{num(-degrees(_steer(run, wheel, time)))} {about}" for time in _frames(last)]
    return [
        f'<g transform="rotate({turns[-1]})">{_animation("rotate", turns, last)}',
        *body(drawn, fine=False),
        "</g>",
    ]


def _moving_trailers(run: Run, view: View, last: float) -> list[str]:
    """Draw the trailers at the end, each with its own animation. A trailer is as wide as the robot."""
    model = run.drive.model
    half = max([abs(w.pivot.imag) for w in model.robot.wheels], default=_WHEELBASE) * view.scale or 6.0
    elements = []
    for k, trailer in enumerate(model.trailers):
        axles = [_towed_axles(run, time)[2 * k + 2] for time in _frames(last)]
        places = [" ".join(map(num, view.on(p))) for p in axles]
        turns = [num(-degrees(_value(run, f"{trailer}.theta", time))) for time in _frames(last)]
        length = float(model.robot.trailers[k].length.nominal) * view.scale
        elements += [
            f'<g transform="translate({places[-1]})">{_animation("translate", places, last)}'
            f'<g transform="rotate({turns[-1]})">{_animation("rotate", turns, last)}',
            line((0.0, 0.0), (length, 0.0), "bar"),
            line((0.0, -half), (0.0, half), "bar"),
            *(bar((0.0, side * half), (0.3 * half, 0.12 * half), 1.0, 0.0, "trailer") for side in (-1, 1)),
            "</g></g>",
        ]
    return elements


# ---- The plots by time.


class Curve(NamedTuple):
    """A line of a plot."""

    run: Run
    name: str  # in the legend; "" for none
    t: Reals  # [s]
    values: Reals
    colour: str


def _joints(runs: Sequence[Run], joint: str, scale: float) -> list[Curve]:
    """Return the curves of a kind of joint, for the first start of each robot."""
    curves: list[Curve] = []
    for run in (run for run in runs if not run.start):
        own = [name for name in run.drive.columns if name.endswith(f".{joint}")]
        for k, name in enumerate(own):
            wheel, colour = name.removesuffix(f".{joint}"), COLOURS[k % len(COLOURS)]
            known = any((curve.name, curve.colour) == (wheel, colour) for curve in curves)
            label = "" if known else wheel
            curves.append(Curve(run, label, run.t, scale * run.column(name), colour))
    return curves


def _hitches(runs: Sequence[Run]) -> list[Curve]:
    """Return the angles from each trailer to the vehicle ahead, for the first start of each robot."""
    curves: list[Curve] = []
    for run in (run for run in runs if not run.start):
        ex, ey, _, _ = run.drive.model.leading
        ahead = run.column("theta") + atan2(ey, ex)
        for k, trailer in enumerate(run.drive.model.trailers):
            heading = run.column(f"{trailer}.theta")
            label = "" if any(curve.name == trailer for curve in curves) else trailer
            curves.append(Curve(run, label, run.t, np.degrees(ahead - heading), COLOURS[k % len(COLOURS)]))
            ahead = heading
    return curves


def _plot(
    quantity: tuple[str, str], curves: Sequence[Curve], top: float, last: float
) -> tuple[list[Group], float]:
    """Draw curves over time, with the least and the largest value at the left.

    Args:
        quantity: what is drawn, and its unit.
        curves: the curves, those with a name in a legend.
        top: where the plot starts [px].
        last: the last time [s].

    Returns:
        The plot, and where it ends [px].
    """
    low = min(float(curve.values.min()) for curve in curves)
    high = max(float(curve.values.max()) for curve in curves)
    largest = max(abs(low), abs(high))
    if high - low < _CONSTANT * max(largest, 1.0):  # a constant is in the middle
        low, high = low - (largest or 1.0), high + (largest or 1.0)
    numbers = ends(low, high, _LEFT - 6)
    title = f"{quantity[0]}{numbers.unit(quantity[1])}"
    keys, below = _legend(curves, width(title) + 34, top + _GAP - 26)
    upper = below + 8
    lower = upper + _PLOT
    paper = Paper((0.0, 0.0, WIDTH, lower + 20))

    def on(t: float, value: float) -> Point:
        x = _LEFT + (_RIGHT - _LEFT) * t / max(last, 1e-9)
        return x, lower - (lower - upper) * (value - low) / (high - low)

    elements = [
        paper.write((_PATH[0], top + _GAP - 26), title, "title"),
        line((_LEFT, lower), (_RIGHT, lower), "rest"),
        line((_LEFT, upper), (_LEFT, lower), "rest"),
        text((_LEFT - 6, upper + 8), numbers.high, "words end"),
        text((_LEFT - 6, lower + 2), numbers.low, "words end"),
        text((_RIGHT, lower + 13), f"{last:.3g} s", "words end"),
    ]
    if low < 0 < high:
        elements.append(line(on(0.0, 0.0), on(last, 0.0), "rest"))
    for curve in curves:
        rows = _thinned(np.stack([curve.t, curve.values], axis=-1))
        elements.append(_line([on(float(t), float(v)) for t, v in rows], curve.run, curve.colour))
    return [("", elements), (' class="fine"', keys)], lower + 18


def _legend(curves: Sequence[Curve], x: float, y: float) -> tuple[list[str], float]:
    """Write the names of curves in rows.

    Args:
        curves: the curves; those without a name are passed over.
        x: where the first row starts [px], behind the title.
        y: the first row [px].

    Returns:
        The elements, and the last row [px].
    """
    elements = []
    for curve in curves:
        if not curve.name:
            continue
        if x + width(curve.name) + 20 > _RIGHT:
            x, y = _LEFT, y + _ROW
        elements.append(_line([(x, y - 4), (x + 14, y - 4)], curve.run, curve.colour))
        elements.append(text((x + 18, y), curve.name, "key"))
        x += width(curve.name) + 30
    return elements, y


def _cursor(last: float, upper: float, lower: float) -> list[str]:
    """Draw the line at the present time, which moves through all plots."""
    if last <= 0:
        return []
    moving = _animation("translate", [f"{num(_LEFT - _RIGHT)} 0", "0 0"], last)
    return [f'<g class="moving">{moving}{line((_RIGHT, upper), (_RIGHT, lower), "help")}</g>']


def _line(points: Sequence[Point], run: Run, colour: str = "") -> str:
    """Return a line in the colour of a run, or in another one, dashed for the second robot."""
    plain = lines(points, "trace")
    return plain.replace("<polyline", f'<polyline stroke="{colour or run.colour}"{run.dash}', 1)


def _thinned(points: Reals) -> Reals:
    """Return at most `_POINTS` rows, the last one included."""
    stride = 1 + len(points) // _POINTS
    kept = points[::stride]
    return kept if (len(points) - 1) % stride == 0 else np.vstack([kept, points[-1:]])
