"""Draw an example motion: in the robot frame with its ICR and velocities, in the world frame with its path."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import atan2, cos, degrees, hypot, pi, sin, sqrt

from wmrgen.derivation.facade import Derivation
from wmrgen.functions.models.axle import leading_axle
from wmrgen.geometry.constraints import nominal_view
from wmrgen.geometry.layout.records import Robot
from wmrgen.report.figures.example import Example, Twist, example, extent
from wmrgen.report.figures.figure import (
    RIGHT,
    Figure,
    Group,
    Pose,
    View,
    attribute,
    figure,
    fitted,
    moved,
    panel,
)
from wmrgen.report.figures.instant import FAR, instant, number
from wmrgen.report.figures.marks import body, chassis, extremes, frame, icr_mark, placed, towed
from wmrgen.report.figures.paper import (
    FIRM,
    Box,
    Paper,
    Point,
    along,
    arrow,
    bounds,
    circle,
    distance,
    line,
    lines,
    wrapped,
)

FILE = "motion.svg"
_LEFT: Box = (8.0, 24.0, 236.0, 268.0)  # px: the panel of the robot frame, in the left half of the page
_RIGHT: Box = (248.0, 24.0, 472.0, 268.0)  # px: the panel of the world frame, as high as the left one


def motion(derivation: Derivation) -> Figure | None:
    """Return ``motion.svg``; None if the robot cannot move. A robot with an effective track turns while sliding."""
    shown = example(derivation.robot, derivation.driven.mobility)
    if shown is None:
        return None
    return drawn(
        derivation.robot, shown, _train(derivation, shown.twist) if derivation.robot.trailers else ()
    )


def drawn(robot: Robot, shown: Example, train: Sequence[_Towed] = ()) -> Figure:
    """Return the figure of a motion.

    Args:
        robot: the robot.
        shown: the motion.
        train: the trailers at its end, in the robot frame.

    Returns:
        The figure.
    """
    where, path = "at infinity: the robot translates", "a straight line"
    if shown.icr:
        where, path = f"at ({number(shown.icr[0])}, {number(shown.icr[1])}) m", "an arc about it"
    values = (
        f"{number(v)}{FIRM}{unit}" for v, unit in zip(shown.twist, ("m/s", "m/s", "rad/s"), strict=True)
    )
    words = ", ".join(f"{name}{FIRM}{value}" for name, value in zip(("vx", "vy", "ω"), values, strict=True))
    alt = (
        f"{robot.name} moving. Left: the instantaneous centre of rotation {where}. Right: the same motion in the "
        f"world, {path}."
    )
    below = wrapped(f"{words}{', wheels slide' if robot.effective_track else ''}", 222)
    groups = [*instant(robot, shown, _LEFT, "robot frame", below), *world(robot, shown, _RIGHT, train)]
    return figure(FILE, alt, _LEFT[3] + 6 + 15 * len(below), groups)


# ---- The world frame.

START, TURN = 0.4, 1.75  # rad: heading at the start of the arc, and its largest rotation
_PATH = 2.4  # largest length of the arc, in sizes of the robot
_PIECES = 24  # segments of the path; more are not visible


# Axle in front, coupling and axle of a trailer in the robot frame [m].
_Towed = tuple[Point, Point, Point]
_HALF = 9.0  # px: half the axle of a trailer, whose width is not in the file


def _train(derivation: Derivation, twist: Twist) -> list[_Towed]:
    """Place the trailers on the steady circle that the twist leads to, see `wmrgen.functions.trailers.trailer`.

    The result is [] if the robot does not pull its trailers forward, or if they have no steady circle.
    """
    robot = derivation.driven.robot
    ex, ey, x, y = leading_axle(robot, derivation.driven.mobility, nominal_view).nominal
    vx, vy, omega = twist
    speed = ex * (vx - y * omega) + ey * (vy + x * omega)
    if speed <= 0:
        return []
    kappa, pull, heading = omega / speed, 1.0, atan2(ey, ex)
    train: list[_Towed] = []
    for t in robot.trailers:
        hitch, length = float(t.hitch.nominal), float(t.length.nominal)
        square = pull**2 + kappa**2 * (hitch**2 - length**2)
        if square <= 0:
            return []
        coupling = (x - hitch * cos(heading), y - hitch * sin(heading))
        heading -= atan2(length * kappa, sqrt(square)) + atan2(hitch * kappa, pull)
        axle = (coupling[0] - length * cos(heading), coupling[1] - length * sin(heading))
        train.append(((x, y), coupling, axle))
        (x, y), pull = axle, sqrt(square)
    return train


def world(robot: Robot, shown: Example, area: Box, train: Sequence[_Towed] = ()) -> list[Group]:
    """Draw two poses in the world frame, x to the right, and the path of P between them.

    Args:
        robot: the robot.
        shown: the motion.
        area: area on paper [px].
        train: trailers at the second pose, in the robot frame.

    Returns:
        Groups of SVG elements.
    """
    _, size = extent(robot.wheels)
    omega, time = shown.twist[2], _time(shown, size)
    poses = [_after(shown.twist, k * time / _PIECES) for k in range(_PIECES + 1)]
    outline = [p for w in robot.wheels for p in extremes(w, shown.headings[w.name])] + [(0.0, 0.0)]
    points = [moved(p, pose) for pose in (poses[0], poses[-1]) for p in outline] + [
        (x, y) for x, y, _ in poses
    ]
    placed_train = [[moved(p, poses[-1]) for p in towed_by] for towed_by in train]
    points += [axle for *_, axle in placed_train]
    icr = moved(shown.icr, poses[0]) if shown.icr and hypot(*shown.icr) < FAR * size else None
    points += [icr] if icr else []
    view = fitted(points, (area[0] + 30, area[1] + 16, area[2] - 16, area[3] - 30), RIGHT)
    paper = Paper(area)
    turn = f"turn ωΔt = {number(degrees(omega * time))}°" if shown.icr else "straight on"
    elements = [
        paper.write((area[0], area[1] - 8), "world frame", "title"),
        paper.write((area[0], area[3] + 14), f"{turn} in {number(time)} s"),
        *frame(View(1.0, (area[0] + 10, area[3] - 10), RIGHT), ("x", "y", ""), paper, 44.0),
    ]
    path = [view.on((x, y)) for x, y, _ in poses]
    paper.segments += list(pairwise(path))
    trailers: list[str] = []
    for places in placed_train:
        a, b, c = (view.on(p) for p in places)
        elements_of_trailer, ends = towed(a, b, c, _HALF)
        trailers += elements_of_trailer
        paper.boxes += [bounds(list(ends), 6), bounds([b, c], 3)]
    return [
        (panel(view), _body(robot, shown, view, poses[0])),
        (' class="ghost"', _wheels(robot, shown, view, poses[0])),
        *([(attribute("train", robot.name), trailers)] if trailers else []),
        ("", [*_body(robot, shown, view, poses[-1]), *_wheels(robot, shown, view, poses[-1])]),
        ("", [*_path(path, icr and view.on(icr), view, paper), *elements]),
    ]


def _path(path: list[Point], icr: Point | None, view: View, paper: Paper) -> list[str]:
    """Draw the path with its ends, the heading at its start and the ICR."""
    first, last = path[0], path[-1]
    paper.boxes += [bounds([p], 4) for p in (first, last)]
    elements = [line(first, along(first, view.way(k * START), 40.0), "help") for k in (0, 1)]
    elements += view.around(first, 30.0, 0.0, START, "angle")
    elements += paper.put("θ", bounds([along(first, view.way(START / 2), 34.0)], 1), first, "letter")
    if icr:
        paper.boxes.append(bounds([icr], 6))
        elements += [line(icr, first, "help"), line(icr, last, "help"), *icr_mark(icr)]
        elements += paper.put("ICR", bounds([icr], 6), first)
    if distance(first, last) > 6:
        elements += [lines(path, "course"), *arrow(path[-3], last, "course", 4.5)[1:]]
    for p, other in ((first, last), (last, first)):
        elements += [circle(p, 2.2, "dot"), *paper.put("P", bounds([p], 4), other, "letter")]
    return elements


def _time(shown: Example, size: float) -> float:
    """Return the duration of the motion [s], limited by the length of its path and by its rotation."""
    vx, vy, omega = shown.twist
    most = [_PATH * size / hypot(vx, vy)] if vx or vy else []
    return min([*most, TURN / abs(omega)] if shown.icr else most)


def _after(twist: Twist, time: float) -> Pose:
    """Return the pose after ``time`` [s] at a constant twist, from (0, 0, START)."""
    vx, vy, omega = twist
    half = omega * time / 2
    k = time * (sin(half) / half if abs(half) > 1e-6 else 1.0)
    x, y = moved((k * vx, k * vy), (0.0, 0.0, START + half))
    return x, y, START + 2 * half


def _body(robot: Robot, shown: Example, view: View, pose: Pose) -> list[str]:
    return chassis([placed(w, shown.headings[w.name], view, pose).pivot for w in robot.wheels])


def _wheels(robot: Robot, shown: Example, view: View, pose: Pose) -> list[str]:
    """Draw the wheels, and the axes of the robot frame."""
    p = view.on((pose[0], pose[1]))
    tips = [along(p, view.way(pose[2] + k * pi / 2), 20.0) for k in (0, 1)]
    wheels = [
        e for w in robot.wheels for e in body(placed(w, shown.headings[w.name], view, pose), fine=False)
    ]
    return [*wheels, *(e for tip in tips for e in arrow(p, tip, "frame", 3.5))]
