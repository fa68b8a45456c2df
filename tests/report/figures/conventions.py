"""The figures of docs/conventions.md: ``python -m tests.report.figures.conventions`` writes them."""

from __future__ import annotations

from math import pi

from tests.conftest import ROOT
from tests.robots import of_text
from wmrgen.report.figures.figure import RIGHT, WIDTH, Figure, View, figure
from wmrgen.report.figures.marks import body, chassis, placed
from wmrgen.report.figures.paper import Paper, along, arrow, bounds, circle, line
from wmrgen.report.figures.symbols import drawn

FOLDER = ROOT / "docs" / "figures"
WHEELS = """\
wmrgen: 1
name: wheels
angles: deg
wheels:
  - {name: fixed, type: fixed, l: 1, alpha: 58, beta: 47, r: 0.2}
  - {name: steered, type: steered, l: 1, alpha: 40, beta: 62, r: 0.2}
  - {name: castor, type: castor, l: 1, alpha: -60, beta: 140, d: -0.2, r: 0.2}
  - {name: offset, type: steered, l: 1, alpha: 40, beta: 62, offset_y: 0.1, r: 0.2}
  - {name: swedish, type: swedish, l: 1, alpha: 62, beta: 40, gamma: -40, r: 0.2}
  - {name: spherical, type: spherical, l: 1, alpha: -60, r: 0.2}
"""
PAIR = """\
wmrgen: 1
name: pair
wheels:
  - {name: left, type: fixed, x: 0, y: 0.4, heading: 0, r: 0.18}
  - {name: right, type: fixed, x: 0, y: -0.4, heading: 0, r: 0.18}
  - {name: tail, type: castor, x: -0.6, y: 0, heading: pi, d: 0.1, r: 0.1}
"""
_THETA = 0.6
_SEEN = {
    "fixed": "A fixed wheel seen from above: l and alpha from P to its pivot, beta to its axle, its heading across it.",
    "steered": "A steered wheel: as a fixed wheel at psi = 0, then turned by the steering angle psi.",
    "castor": "A castor: its contact lies d along the heading from its pivot; a negative d trails.",
    "offset": "A steered wheel whose contact stands off its pivot by o, along its axle to the left.",
    "swedish": "A Swedish wheel: gamma from its heading to the axis of the roller that touches the ground.",
    "spherical": "A spherical wheel: l and alpha from P to where it touches the ground.",
}


def figures() -> list[Figure]:
    """All of them."""
    wheels = of_text(WHEELS).robot.wheels
    return [frames(), *(drawn(f"{w.name}.svg", _SEEN[w.name], [w], values=False) for w in wheels)]


def frames() -> Figure:
    """World frame, pose and twist."""
    robot = of_text(PAIR).robot
    height = 250.0
    world, view = View(1.0, (60.0, 220.0), RIGHT), View(105.0, (275.0, 120.0), RIGHT)
    paper = Paper((0.0, 0.0, WIDTH, height))
    p, o = view.origin, world.origin
    wheels = [placed(w, w.heading, view, (0.0, 0.0, _THETA)) for w in robot.wheels]
    elements = chassis([w.pivot for w in wheels]) + [e for w in wheels for e in body(w)]
    letters = (
        ((440.0, o[1]), "x", (448.0, o[1] + 4)), ((o[0], 20.0), "y", (o[0] - 16, 28.0)),
        (None, "x", (p[0] - 4, o[1] + 18)), (None, "y", (o[0] - 16, p[1] + 5)),
    )  # fmt: skip
    for tip, name, at in letters:
        elements += [*(arrow(o, tip, "frame") if tip else []), paper.write(at, name, "letter")]
    elements.append(paper.write((o[0] + 6, o[1] + 18), "world frame"))
    elements += [line(p, (p[0], o[1]), "help"), line(p, (o[0], p[1]), "help")]
    elements += [line(p, along(p, RIGHT, 130.0), "help"), *view.around(p, 62.0, 0.0, _THETA, "angle")]
    elements += paper.put("θ", bounds([along(p, view.way(_THETA / 2), 66.0)], 1), p, "letter")
    for turn, name in ((0.0, "vx"), (pi / 2, "vy")):
        tip = along(p, view.way(_THETA + turn), 84.0)
        elements += arrow(p, tip, "velocity")
        elements += paper.put(name, bounds([tip], 2), p)
    elements += view.around(p, 34.0, _THETA + 0.5, 1.6, "course")
    elements += paper.put("ω", bounds([along(p, view.way(_THETA + 0.9), 37.0)], 1), p, "letter")
    elements += [
        circle(p, 2.4, "dot"),
        *paper.put("P", bounds([p], 3), along(p, view.way(_THETA + 0.9), 20.0), "letter"),
    ]
    alt = "The world frame with the pose x, y, theta of a robot, and the twist vx, vy, omega of P in the robot frame."
    return figure("frames.svg", alt, height, [("", elements)])


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for shown in figures():
        (FOLDER / shown.file).write_text(shown.svg, encoding="utf-8", newline="\n")
