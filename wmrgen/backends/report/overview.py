"""Opening and section 1: what the robot is, its picture, its layout, its parameters."""

from __future__ import annotations

from collections import Counter
from math import hypot
from typing import TYPE_CHECKING

from wmrgen.backends.report.markdown import code, conjoined, escape, items, listed, table
from wmrgen.backends.report.numbers import in_degrees, plain, rounded
from wmrgen.backends.report.subject import Subject
from wmrgen.exact.evaluate import parameters_in

if TYPE_CHECKING:
    from wmrgen.layout.records import Parameter, Robot, Wheel

_NUMBERS = "no one two three four five six seven eight nine ten eleven twelve".split()


def opening(s: Subject) -> list[str]:
    """Title, description, what kind of robot this is, how to read the page."""
    robot, m = s.robot, s.mobility
    blocks = [f"# {code(robot.name)}"]
    if robot.description:
        blocks += [escape(robot.description)]
    if robot.source:
        blocks += [f"Source of the geometry: {escape(robot.source)}"]
    verdict = (
        f"Campion's type ({m.degree_of_mobility}, {m.degree_of_steerability})"
        if m.robot_type
        else f"a degenerate layout, ({m.degree_of_mobility}, {m.degree_of_steerability})"
    )
    blocks += [
        f"This robot has {_counted(robot)}. It is {verdict}: at any instant it has "
        f"{_count(m.degree_of_mobility, 'freedom')} of motion, and steering opens "
        f"{_word(m.degree_of_steerability)} more. This page derives that, and every formula of the generated code, "
        "from the layout alone.",
        "Notation and equation numbers are those of Siegwart, Nourbakhsh and Scaramuzza, *Introduction to "
        "Autonomous Mobile Robots*, section 3.2. The robot frame has its origin in P, x forward, y to the left, "
        "angles counter-clockwise; ξ = (v<sub>x</sub>, v<sub>y</sub>, ω) is the velocity of P in that frame, the "
        "book's R(θ) ξ̇<sub>I</sub>. Lengths are in metres, angles in radians unless marked °. Fractions, roots "
        "and short decimals are exact; decimals with six digits are rounded.",
    ]  # fmt: skip
    return blocks


def _word(n: int) -> str:
    return _NUMBERS[n] if n < len(_NUMBERS) else str(n)


def _count(n: int, noun: str) -> str:
    return f"{_word(n)} {noun}{'' if n == 1 else 's'}"


def _counted(robot: Robot) -> str:
    """two fixed wheels and one castor"""
    return conjoined([_count(n, noun) for noun, n in Counter(w.kind.noun for w in robot.wheels).items()])


def layout(s: Subject) -> list[str]:
    """Section 1."""
    robot = s.robot
    blocks = ["## 1 The layout", f"![Top view of {robot.name}](layout.svg)", *_caption(s)]
    blocks += _wheels(robot.wheels)
    blocks += _legend(robot)
    if robot.parameters:
        blocks += ["The named parameters:", *_parameters(robot)]
    if robot.couplings:
        blocks += ["Mechanical couplings:"]
        joints = {"spin": "turn at one speed", "steer": "share one steering angle"}
        blocks += items(f"{listed(names)} {joints[joint]}" for joint, names in robot.couplings)
    notes = [*(escape(n) for n in robot.notes), *_remarks(robot)]
    if notes:
        blocks += ["Notes:", *items(notes)]
    return blocks


def _caption(s: Subject) -> list[str]:
    if any(w.kind.steers for w in s.robot.wheels):
        return ["The steered wheels are drawn at one admissible setting: all zero-motion lines agree."]
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
        row = [code(w.name), w.kind.label, ", ".join(w.actuated) or "—", plain(g.x), plain(g.y), rounded(w.l)]
        row += [
            in_degrees(w.alpha),
            *([in_degrees(w.beta), in_degrees(w.heading)] if w.kind.directed else ["—", "—"]),
        ]
        row += [in_degrees(w.gamma) if w.kind.rollers else "—"] * swedish + [plain(g.r)]
        row += [plain(g.r_sw) if g.r_sw else "—"] * rollers
        row += [plain(g.d) if w.kind.swivels else "—"] * castors
        row += [plain(g.o) if w.turns else "—"] * shifted
        rows.append(row)
    return table(head, rows, "lllr")


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
    return ["; ".join(said) + "."]


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
            f"{code(a.name)} and {code(b.name)} stand {rounded(2 * abs(float(a.nominal.y)))} m apart (the track); "
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
