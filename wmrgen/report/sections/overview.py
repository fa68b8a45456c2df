"""Opening and section 1: what the robot is, its picture, its layout, its parameters."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from itertools import combinations
from math import hypot

from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.exact.evaluate import parameters_in
from wmrgen.geometry.exact.number import ONE
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Parameter, Robot, Wheel
from wmrgen.report.sections.markdown import (
    capitalised,
    code,
    escape,
    grouped,
    in_degrees,
    items,
    listed,
    minus,
    pictures,
    plain,
    rounded,
    table,
)
from wmrgen.robotfile.wheel_types import WheelType

_SKIDDING = (
    " In a curve its wheels skid, and it turns as a differential drive of its effective track does: with two degrees "
    "of freedom."
)
_BESIDE_STEERED = (
    " In a curve its fixed wheels skid. The robot moves as one whose fixed wheels are on one axle, the effective track "
    "apart, type ({m}, {s})."
)
_LENGTHS = ("d", "l", "r")  # of wheels, in the notation of the book
_NUMBERS = "no one two three four five six seven eight nine ten eleven twelve".split()


def opening(d: Derivation) -> list[str]:
    """Title and description."""
    robot = d.robot
    blocks = [f"# {code(robot.name)}"]
    if robot.description:
        blocks += [escape(robot.description)]
    return blocks + ([f"Source: {escape(robot.source)}"] if robot.source else [])


def kind_of_robot(d: Derivation) -> str:
    """The type in a sentence."""
    robot, m = d.robot, d.mobility
    kind = "Campion's type" if m.robot_type else "a degenerate layout,"
    when = "at any instant" if m.robot_type else "without slip"  # a skid-steer robot turns, but slips
    wheels = Counter(w.kind.noun for w in robot.bodies)
    adds = _word(m.degree_of_steerability) if m.degree_of_steerability else "none"
    adds = f", and steering adds {adds}" * any(w.kind.steers for w in robot.wheels)
    moves = f"moves with {_count(m.degree_of_mobility, 'degree')} of freedom{adds}"
    return (
        f"This robot has {notation.listed([_count(n, noun) for noun, n in wheels.items()])}. It is {kind} "
        f"({m.degree_of_mobility}, {m.degree_of_steerability}): {when} it "
        f"{moves if m.degree_of_mobility else 'cannot move'}."
    ) + _skidding(d)


def _skidding(d: Derivation) -> str:
    """How a robot with an effective track moves in a curve."""
    if not d.robot.effective_track:
        return ""
    if not any(w.kind.steers for w in d.robot.wheels):
        return _SKIDDING
    m = d.driven.mobility
    return _BESIDE_STEERED.format(m=m.degree_of_mobility, s=m.degree_of_steerability)


def _word(n: int) -> str:
    return _NUMBERS[n] if n < len(_NUMBERS) else str(n)


def _count(n: int, noun: str) -> str:
    """two fixed wheels"""
    return f"{_word(n)} {noun}{'' if n == 1 else 's'}"


def layout(d: Derivation) -> list[str]:
    """Section 1."""
    robot = d.robot
    blocks = [
        "## 1 The layout",
        "Notation and equation numbers are those of Siegwart, Nourbakhsh and Scaramuzza, *Introduction to "
        "Autonomous Mobile Robots*, section 3.2. The robot frame has its origin in P, x forward, y to the left; "
        "ξ = (v<sub>x</sub>, v<sub>y</sub>, ω) is the velocity of P in it, the book's R(θ) ξ̇<sub>I</sub>. Lengths are "
        "in metres, angles counter-clockwise, in radians unless marked °; decimals with six digits are rounded.",
        *pictures(d.figures, "symbols.svg"),
        *_wheels(robot.wheels),
        _legend(robot),
    ]
    if robot.parameters:
        named = grouped((_in_code(p), f"{code(p.name)} = {plain(p.nominal)}") for p in robot.parameters)
        texts = [f"{notation.listed(who)}, {what}" for what, who in named.items()]
        blocks += [" ".join([f"Named parameters: {'; '.join(texts)}.", *_letters(robot)])]
    if robot.couplings:
        couplings = (
            f"{listed(names)} "
            + (
                minus(
                    (notation.turning if joint == "spin" else notation.steering)(robot.ratios(joint, names))
                )
            )
            for joint, names in robot.couplings
        )
        blocks += [f"Mechanical couplings: {'; '.join(couplings)}."]
    blocks += _virtual(robot)
    if robot.trailers:
        rows = [[code(t.name), plain(t.length.nominal), plain(t.hitch.nominal)] for t in robot.trailers]
        head = ["trailer", "length from hitch to axle", "hitch behind the axle in front"]
        blocks += ["It tows, from the robot backwards:", *table(head, rows, "lr")]
    notes = [*map(capitalised, robot.notes), *_remarks(robot)]
    return [*blocks, *items(notes)]


def _letters(robot: Robot) -> list[str]:
    """Which letters in formulas are parameters, though they look like lengths of wheels or other symbols."""
    names = [p.name for p in robot.parameters]
    sentences = []
    if own := [name for name in names if name in _LENGTHS and not _is_length(robot, name)]:
        these, lengths = (
            ("are these parameters", "are lengths") if len(own) > 1 else ("is this parameter", "is a length")
        )
        sentences.append(
            f"In formulas of this robot {listed(own)} {these}; in equations for any wheel, such as the book's, "
            f"{notation.listed(own)} {lengths} of the table above."
        )
    if marked := [name for name in names if notation.parameter(name).startswith(r"\mathtt")]:
        parameters = "parameters" if len(marked) > 1 else "a parameter"
        sentences.append(f"In formulas typewriter marks {listed(marked)} as {parameters}.")
    return sentences


def _is_length(robot: Robot, name: str) -> bool:
    """Whether each wheel that the parameter r, d or l is for has it as its radius, castor offset or distance from P."""
    parameter = Poly.gen("param", name)
    towed = (length for trailer in robot.trailers for length in (trailer.length, trailer.hitch))
    others = [length.symbolic for length in (*towed, robot.effective_track) if length]
    for w in robot.wheels:
        g = w.symbolic
        own = {"r": g.r - parameter, "d": g.d - parameter, "l": g.x * g.x + g.y * g.y - parameter * parameter}
        others += (g.x, g.y, g.r, g.d, g.o, g.r_sw) if own[name] else ()
    return not any(name in parameters_in(p) for p in others)


def _virtual(robot: Robot) -> list[str]:
    """Wheels that are not there."""
    wheels = [
        f"{code(v.name)} at ({plain(v.x.nominal)}, {plain(v.y.nominal)}), whose "
        f"{'steering angle' if v.role == 'steers' else 'speed'} stands for those of {listed(v.wheels)}"
        for v in robot.virtual
    ]
    return [f"Models describe the robot by virtual wheels: {'; '.join(wheels)}."] if wheels else []


def _wheels(wheels: tuple[Wheel, ...]) -> list[str]:
    """The layout table, with the columns that occur: head, cell of a wheel (— where it has none)."""
    columns: tuple[tuple[str, bool, Callable[[Wheel], str | None]], ...] = (
        ("wheel", True, lambda w: code(w.name)),
        ("type", True, lambda w: w.kind.label),
        ("driven", True, lambda w: ", ".join(w.actuated)),
        ("x", True, lambda w: plain(w.nominal.x)),
        ("y", True, lambda w: plain(w.nominal.y)),
        ("l", True, lambda w: rounded(w.l)),
        ("α", True, lambda w: in_degrees(w.alpha)),
        ("β", True, lambda w: in_degrees(w.beta) if w.kind.directed else None),
        ("heading", True, lambda w: in_degrees(w.heading) if w.kind.directed else None),
        ("γ", any(w.kind.rollers for w in wheels), lambda w: in_degrees(w.gamma) if w.kind.rollers else None),
        ("r", True, lambda w: plain(w.nominal.r) if w.nominal.r else None),
        ("r<sub>sw</sub>", any(w.nominal.r_sw for w in wheels),
         lambda w: plain(w.nominal.r_sw) if w.nominal.r_sw else None),
        ("d", any(w.kind.swivels for w in wheels), lambda w: plain(w.nominal.d) if w.kind.swivels else None),
        ("offset o", any(w.nominal.o for w in wheels), lambda w: plain(w.nominal.o) if w.turns else None),
        ("per steer", any(w.nominal.per_steer for w in wheels),
         lambda w: plain(w.nominal.per_steer) if w.turns else None),
        ("weight", any(w.weight != ONE for w in wheels), lambda w: plain(w.weight)),
    )  # fmt: skip
    shown = [(head, cell) for head, occurs, cell in columns if occurs]
    return table([head for head, _ in shown], [[cell(w) or "—" for _, cell in shown] for w in wheels], "lllr")


def _legend(robot: Robot) -> str:
    kinds = [w.kind for w in robot.wheels]
    remarks = (
        (True, "(x, y) is the wheel's pivot A, in polar coordinates (l, α)"),
        (any(k.directed for k in kinds), "heading is the direction of positive rolling, α + β − 90°"),
        (any(k.turns for k in kinds), f"for {_turning(kinds)} β and heading hold at steering angle ψ = 0, so that the "
         "book's β(t) is β + ψ"),
        (any(k.swivels for k in kinds), "d is the distance from the pivot to the contact point, along the rolling "
         "direction"),
        (any(w.nominal.o for w in robot.wheels), "o is the lateral offset of the contact point along the axle, which "
         "the book does not have"),
        (any(w.nominal.per_steer for w in robot.wheels), "per steer, k, is the turn of the drive joint for 1 rad of "
         "steering while the wheel does not roll: the gears of the module couple them"),
        (len(robot.bodies) < len(kinds), "a ball that is driven in two directions has two rows, _1 and _2"),
        (any(k.rollers for k in kinds), "γ is the angle from the wheel plane to the axis of the roller that touches "
         "the ground"),
    )  # fmt: skip
    return "; ".join(text for concerns, text in remarks if concerns) + "."


def _turning(kinds: list[WheelType]) -> str:
    """steered wheels and castors"""
    nouns = [f"{noun}s" for noun in dict.fromkeys(k.noun for k in kinds if k.turns)]
    return notation.listed(nouns) if nouns else ""


def _in_code(p: Parameter) -> str:
    """What the generated code makes of a parameter."""
    if p.tunable:
        return f"tunable from {float(p.low):.6g} to {float(p.high):.6g}: passed to the generated code"
    names = ", ".join(code(name) for name in sorted(parameters_in(p.working)))
    return f"computed from the tunable {names}" if names else "constant in the generated code"


def _remarks(robot: Robot) -> list[str]:
    """The three things that are most often confused: half-track, rollers on top, X and O."""
    remarks = []
    if pairs := _pairs(robot):
        apart = [f"{code(a.name)} and {code(b.name)} stand {track} m" for track, (a, b) in pairs.items()]
        remarks.append(
            f"{notation.listed(apart)} apart (the track{'s' * (len(pairs) > 1)}); their y is the half-track."
        )
    swedish = [w for w in robot.wheels if w.kind.rollers]
    if any(w.nominal.sg for w in swedish):
        text = "Roller axes are given, and drawn, at the ground. Seen from above, the rollers on top lean the other way"
        patterns = {
            "O": ": this base shows an X from above and an O at the ground.",
            "X": ": this base shows an O from above and an X at the ground.",
        }
        remarks.append(text + patterns.get(_pattern(swedish), "."))
    return remarks


def _pairs(robot: Robot) -> dict[str, tuple[Wheel, Wheel]]:
    """Wheels that roll forward and mirror each other beside P, the first of each distance [m]."""
    pairs: dict[str, tuple[Wheel, Wheel]] = {}
    wheels = [w for w in robot.wheels if w.kind.constrains or w.kind.rolls_across]
    for a, b in combinations(wheels, 2):
        opposite = a.nominal.x == b.nominal.x and a.nominal.y == -b.nominal.y
        if a.type == b.type and opposite and a.nominal.y and not (a.nominal.sh or b.nominal.sh):
            pairs.setdefault(rounded(2 * abs(float(a.nominal.y))), (a, b))
    return pairs


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
