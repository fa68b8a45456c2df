"""Draw the motions of a wiring check: the direction in which each driven wheel must roll."""

from __future__ import annotations

from wmrgen.analysis.mobility.basis import NEGLIGIBLE
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.layout.records import Robot
from wmrgen.report.figures.example import largest_radius
from wmrgen.report.figures.figure import WIDTH, Figure, Group, figure, fitted, panel
from wmrgen.report.figures.marks import body, chassis, extremes, frame, placed
from wmrgen.report.figures.paper import Box, Paper, along, arrow
from wmrgen.report.wiring import Joints, motions

FILE = "wiring.svg"
_HEIGHT = 190.0  # px
_ARROW, _BEYOND = 26.0, 14.0  # px: least length of an arrow, and least part beyond a large wheel


def wiring(derivation: Derivation) -> Figure | None:
    """Return ``wiring.svg``, a panel for each motion; None if the robot can drive none of them."""
    possible = [(m.title, m.joints) for m in motions(derivation) if m.joints]
    if not possible:
        return None
    wide = WIDTH / len(possible)
    groups: list[Group] = []
    for k, (title, joints) in enumerate(possible):
        groups += _panel(
            derivation.robot, joints, (k * wide + 8, 24.0, (k + 1) * wide - 8, _HEIGHT - 8), title
        )
    titles = "; ".join(title for title, _ in possible)
    return figure(
        FILE, f"{derivation.robot.name}: rolling directions of wheels for {titles}.", _HEIGHT, groups
    )


def _panel(robot: Robot, joints: Joints, area: Box, title: str) -> list[Group]:
    """Draw the robot from above, steered wheels at their angles, with an arrow along each wheel that rolls."""
    headings = {w.name: w.heading + joints.get(f"{w.name}.steer", 0.0) for w in robot.wheels}
    points = [p for w in robot.wheels for p in extremes(w, headings[w.name])] + [(0.0, 0.0)]
    inner = (area[0] + 24, area[1] + 26, area[2] - 24, area[3] - 26)
    view = fitted(points, inner, most=40.0 / largest_radius(robot.wheels))
    paper = Paper(area)
    wheels = [placed(w, headings[w.name], view) for w in robot.wheels]
    arrows: list[str] = []
    for p in wheels:
        spin = joints.get(f"{p.wheel.name}.spin", 0.0)
        if abs(spin) > NEGLIGIBLE:
            reach = max(_ARROW, p.half[0] + _BEYOND)
            tip = along(p.centre, p.ahead, reach if spin > 0 else -reach)
            arrows += arrow(p.centre, tip, "velocity", 4.0)
    signs = [*frame(view, ("x", "y", "P"), paper, 20.0), paper.write((area[0], area[1] - 8), title, "title")]
    return [
        (panel(view), chassis([p.pivot for p in wheels])),
        *(("", body(p)) for p in wheels),
        ("", [*arrows, *signs]),
    ]
