"""Opening and section 1: what the robot is, its picture, its layout, its parameters."""

from __future__ import annotations

from collections import Counter
from math import degrees, hypot
from typing import TYPE_CHECKING

from wmrgen.backends.report.markdown import code, escape, listed, table
from wmrgen.backends.report.numbers import plain
from wmrgen.backends.report.subject import Subject
from wmrgen.exact.evaluate import parameters_in

if TYPE_CHECKING:
    from wmrgen.layout.records import Parameter, Robot, Wheel

_NUMBERS = (
    "no",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
)


def opening(s: Subject) -> list[str]:
    """Title, description, what kind of robot this is, how to read the page."""
    robot, m = s.robot, s.mobility
    lines = [f"# {code(robot.name)}", ""]
    if robot.description:
        lines += [escape(robot.description), ""]
    if robot.source:
        lines += [f"Source of the geometry: {escape(robot.source)}", ""]
    verdict = (
        f"Campion's type ({m.degree_of_mobility}, {m.degree_of_steerability})"
        if m.robot_type
        else f"a degenerate layout, ({m.degree_of_mobility}, {m.degree_of_steerability})"
    )
    lines += [
        f"This robot has {_counted(robot)}. It is {verdict}: at any instant it has "
        f"{_freedoms(m.degree_of_mobility)} of motion, and steering opens {_word(m.degree_of_steerability)} more. "
        "This page derives that, and every formula of the generated code, from the layout alone.",
        "",
        "Notation and equation numbers are those of Siegwart, Nourbakhsh and Scaramuzza, *Introduction to "
        "Autonomous Mobile Robots*, section 3.2. The robot frame has its origin in P, x forward, y to the left, "
        "angles counter-clockwise; ξ = (v<sub>x</sub>, v<sub>y</sub>, ω) is the velocity of P in that frame, the "
        "book's R(θ) ξ̇<sub>I</sub>. Lengths are in metres, angles in radians unless marked °. Fractions, roots "
        "and short decimals are exact; decimals with six digits are rounded.",
        "",
    ]  # fmt: skip
    return lines


def _word(n: int) -> str:
    return _NUMBERS[n] if n < len(_NUMBERS) else str(n)


def _freedoms(n: int) -> str:
    return f"{_word(n)} freedom{'' if n == 1 else 's'}"


def _counted(robot: Robot) -> str:
    """two fixed wheels and one castor"""
    parts = []
    for noun, n in Counter(w.kind.noun for w in robot.wheels).items():
        parts.append(f"{_word(n)} {noun}{'' if n == 1 else 's'}")
    return parts[0] if len(parts) == 1 else ", ".join(parts[:-1]) + " and " + parts[-1]


def layout(s: Subject) -> list[str]:
    """Section 1."""
    robot = s.robot
    lines = ["## 1 The layout", "", f"![Top view of {robot.name}](layout.svg)", "", *_caption(s)]
    lines += _wheels(robot.wheels)
    lines += _legend(robot)
    if robot.parameters:
        lines += ["The named parameters:", *_parameters(robot)]
    if robot.couplings:
        lines += ["Mechanical couplings:", ""]
        joints = {"spin": "turn at one speed", "steer": "share one steering angle"}
        lines += [f"* {listed(names)} {joints[joint]}" for joint, names in robot.couplings] + [""]
    notes = [*(escape(n) for n in robot.notes), *_remarks(robot)]
    if notes:
        lines += ["Notes:", "", *(f"* {n}" for n in notes), ""]
    return lines


def _caption(s: Subject) -> list[str]:
    if any(w.kind.steers for w in s.robot.wheels):
        return ["The steered wheels are drawn at one admissible setting: all zero-motion lines agree.", ""]
    return []


def _wheels(wheels: tuple[Wheel, ...]) -> list[str]:
    """The layout table, with the columns that occur."""
    swedish = any(w.kind.rollers for w in wheels)
    castors = any(w.kind.swivels for w in wheels)
    shifted = any(w.nominal.o for w in wheels)
    rollers = any(w.nominal.r_sw for w in wheels)
    head = ["wheel", "type", "driven", "x", "y", "l", "α", "β", "heading"]
    head += ["γ"] * swedish + ["r"] + ["r<sub>sw</sub>"] * rollers + ["d"] * castors + ["offset o"] * shifted
    rows = []
    for w in wheels:
        g = w.nominal
        row = [code(w.name), w.kind.label, ", ".join(w.actuated) or "—", plain(g.x), plain(g.y), _short(w.l)]
        row += [_angle(w.alpha), *([_angle(w.beta), _angle(w.heading)] if w.kind.directed else ["—", "—"])]
        row += [_angle(w.gamma) if w.kind.rollers else "—"] * swedish + [plain(g.r)]
        row += [plain(g.r_sw) if g.r_sw else "—"] * rollers
        row += [plain(g.d) if w.kind.swivels else "—"] * castors
        row += [plain(g.o) if w.turns else "—"] * shifted
        rows.append(row)
    return table(head, rows, "lllr")


def _short(value: float) -> str:
    return f"{round(value, 12) + 0.0:.6g}".replace("-", "−")


def _angle(value: float) -> str:
    return f"{round(degrees(value), 9) + 0.0:.6g}°".replace("-", "−")


def _legend(robot: Robot) -> list[str]:
    kinds = [w.kind for w in robot.wheels]
    said = ["(x, y) is the wheel's pivot A, in polar coordinates (l, α)"]
    if any(kind.directed for kind in kinds):
        said.append("heading is the direction of positive rolling, α + β − 90°")
    if any(kind.turns for kind in kinds):
        said.append(
            "for steered wheels and castors β and heading hold at steering angle ψ = 0, so that the book's β(t) "
            "is β + ψ"
        )
    if any(kind.swivels for kind in kinds):
        said.append("d is the distance from the pivot to the contact point, along the rolling direction")
    if any(w.nominal.o for w in robot.wheels):
        said.append(
            "o is the lateral offset of the contact point along the axle, which the book does not have"
        )
    if any(kind.rollers for kind in kinds):
        said.append("γ is the angle from the wheel plane to the axis of the roller that touches the ground")
    return ["; ".join(said) + ".", ""]


def _parameters(robot: Robot) -> list[str]:
    rows = [[code(p.name), plain(p.nominal), _in_code(p)] for p in robot.parameters]
    return table(["parameter", "value", "in the code"], rows, "lrl")


def _in_code(p: Parameter) -> str:
    """What the generated code makes of a parameter."""
    if p.tunable:
        return "tunable: an input of the generated code"
    names = ", ".join(code(name) for name in sorted(parameters_in(p.working)))
    return f"computed from the tunable {names}" if names else "constant"


def _remarks(robot: Robot) -> list[str]:
    """The three things that are most often confused: half-track, rollers on top, X and O."""
    remarks = []
    pair = _pair(robot)
    if pair:
        a, b = pair
        remarks.append(
            f"{code(a.name)} and {code(b.name)} stand {_short(2 * abs(float(a.nominal.y)))} m apart (the track); "
            "their y is the half-track."
        )
    swedish = [w for w in robot.wheels if w.kind.rollers]
    if swedish:
        text = "Roller axes are given, and drawn, at the ground. Seen from above, the rollers on top lean the other way"
        pattern = _pattern(swedish)
        other = {"O": "X", "X": "O"}
        text += (
            f": this base shows an {other[pattern]} from above and an {pattern} at the ground."
            if pattern
            else "."
        )
        remarks.append(text)
    return remarks


def _pair(robot: Robot) -> tuple[Wheel, Wheel] | None:
    """Two wheels that mirror each other beside P."""
    wheels = [w for w in robot.wheels if w.kind.constrains or w.kind.rollers]
    for i, a in enumerate(wheels):
        for b in wheels[i + 1 :]:
            if (
                a.type == b.type
                and a.nominal.x == b.nominal.x
                and a.nominal.y == -b.nominal.y
                and a.nominal.y
            ):
                return a, b
    return None


def _pattern(wheels: list[Wheel]) -> str:
    """The pattern of four corner wheels: X when their roller axes run towards the middle, O when around it, or ""."""
    signs = set()
    for w in wheels:
        g = w.nominal
        ax, ay = float(g.ch * g.cg - g.sh * g.sg), float(g.sh * g.cg + g.ch * g.sg)
        x, y = float(g.x), float(g.y)
        if abs(ax * ay) < 1e-6 or abs(x * y) < 1e-6 * hypot(x, y):
            return ""
        signs.add(x * y * ax * ay > 0)
    if len(wheels) != 4 or len(signs) != 1:
        return ""
    return "X" if signs.pop() else "O"
