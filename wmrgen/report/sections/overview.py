"""Write the opening and section 1: the type of the robot, its layout, parameters, couplings and trailers."""

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
    keyed,
    letter_in_text,
    listed,
    minus,
    pictures,
    plain,
    rounded,
    table,
)
from wmrgen.robotfile.wheel_types import WheelType

_SKIDDING = keyed(
    "type.skids",
    " In a curve its wheels skid, and it moves like a differential drive with the effective track: with two degrees "
    "of freedom.",
)
_BESIDE_STEERED = (
    " In a curve its fixed wheels skid. The robot moves like one with its fixed wheels on a single axle, the effective "
    "track apart, of type ({m}, {s})."
)
# Letters of the book for lengths and angles of wheels, as LaTeX and as HTML.
_OF_WHEELS = {"d": "d", "l": "l", "r": "r", r"\alpha": "α", r"\beta": "β", r"\gamma": "γ"}
_NUMBERS = "no one two three four five six seven eight nine ten eleven twelve".split()


def opening(d: Derivation) -> list[str]:
    """Return the title and the description."""
    robot = d.robot
    blocks = [f"# {code(robot.name)}"]
    if robot.description:
        blocks += [escape(robot.description)]
    return blocks + ([f"Source: {escape(robot.source)}"] if robot.source else [])


def kind_of_robot(d: Derivation) -> str:
    """Return the type of the robot in a sentence."""
    robot, m = d.robot, d.mobility
    kind = "Campion's type" if m.robot_type else "a degenerate layout,"
    when = "at any instant" if m.robot_type else "without slip"  # a skid-steer robot turns, but slips
    wheels = Counter(w.kind.noun for w in robot.bodies)
    adds = _word(m.degree_of_steerability) if m.degree_of_steerability else "none"
    steering = ""
    if any(w.kind.steers for w in robot.wheels):
        steering = keyed("type.steering_adds", f", and steering adds {adds}")
    moves = f"moves with {_count(m.degree_of_mobility, 'degree')} of freedom{steering}"
    if not m.degree_of_mobility:
        moves = keyed("type.cannot_move", "cannot move")
    return (
        f"This robot has {notation.listed([_count(n, noun) for noun, n in wheels.items()])}. It is {kind} "
        f"({m.degree_of_mobility}, {m.degree_of_steerability}): {when} it {moves}."
    ) + _skidding(d)


def _skidding(d: Derivation) -> str:
    """Say how a robot with an effective track moves in a curve."""
    if not d.robot.effective_track:
        return ""
    if not any(w.kind.steers for w in d.robot.wheels):
        return _SKIDDING
    m = d.driven.mobility
    return _BESIDE_STEERED.format(m=m.degree_of_mobility, s=m.degree_of_steerability)


def _word(n: int) -> str:
    return _NUMBERS[n] if n < len(_NUMBERS) else str(n)


def _count(n: int, noun: str) -> str:
    """Return a count in words: two fixed wheels."""
    return f"{_word(n)} {noun}{'' if n == 1 else 's'}"


def layout(d: Derivation, in_code: bool = True) -> list[str]:
    """Return section 1; ``in_code``: it says which parameters the generated code takes."""
    robot = d.robot
    blocks = [
        "## 1 The layout",
        "Notation and equation numbers follow Siegwart, Nourbakhsh and Scaramuzza, *Introduction to "
        "Autonomous Mobile Robots*, section 3.2. The robot frame has its origin in P, x forward and y to the left. The "
        "twist ξ = (v<sub>x</sub>, v<sub>y</sub>, ω) is the velocity of P in this frame; the book writes R(θ) "
        "ξ̇<sub>I</sub>. Lengths are in metres. Angles are counter-clockwise, in radians unless marked °. Numbers are "
        "rounded to six digits.",
        *_wheels(robot.wheels),
        *pictures(d.figures, "symbols.svg"),
        _legend(robot),
    ]
    if robot.parameters:
        named = grouped(
            (f", {_in_code(p)}" if in_code else "", f"{_named(p)} = {plain(p.nominal)}")
            for p in robot.parameters
        )
        texts = [f"{notation.listed(who)}{what}" for what, who in named.items()]
        blocks += [" ".join([f"Named parameters: {'; '.join(texts)}.", *_letters(robot)])]
    if robot.couplings:
        couplings = []
        for joint, names in robot.couplings:
            words = notation.turning if joint == "spin" else notation.steering
            couplings.append(f"{listed(names)} {minus(words(robot.ratios(joint, names)))}")
        blocks += [keyed("layout.couplings", f"Mechanical couplings: {'; '.join(couplings)}.")]
    blocks += _virtual(robot)
    if robot.trailers:
        rows = [[code(t.name), plain(t.length.nominal), plain(t.hitch.nominal)] for t in robot.trailers]
        head = ["trailer", "length from hitch to axle", "hitch behind the axle in front"]
        blocks += ["The robot tows these trailers, from front to back:", *table(head, rows, "lr")]
    notes = [*map(capitalised, robot.notes), *_remarks(robot)]
    return [*blocks, *items(notes)]


def _named(p: Parameter) -> str:
    """Return the name of a parameter, with its symbol in formulas if it has one."""
    return f"{code(p.name)} ({letter_in_text(p.symbol)})" if p.symbol else code(p.name)


def _letters(robot: Robot) -> list[str]:
    """Say which letters in formulas are parameters although they look like lengths of wheels or other symbols."""
    sentences, own = [], []
    for p in robot.parameters:
        shown = notation.parameter(p.name)
        if shown in _OF_WHEELS and not _is_length(robot, p.name, shown):
            own.append(_OF_WHEELS[shown])
    if own:
        these, quantities = (
            ("are these parameters", "are quantities")
            if len(own) > 1
            else ("is this parameter", "is a quantity")
        )
        sentences.append(
            keyed(
                "layout.letters_of_parameters",
                f"In formulas of this robot, {listed(own)} {these}. In general equations of a wheel, as in "
                f"the book, {notation.listed(own)} {quantities} of the table above.",
            )
        )
    marked = [p.name for p in robot.parameters if notation.parameter(p.name).startswith(r"\mathtt")]
    if marked:
        parameters = "parameters" if len(marked) > 1 else "a parameter"
        sentences.append(
            keyed("layout.typewriter", f"Typewriter type marks {listed(marked)} in formulas as {parameters}.")
        )
    return sentences


def _is_length(robot: Robot, name: str, letter: str) -> bool:
    """Return whether the parameter ``name`` is, wherever it is used, what the ``letter`` means for a wheel.

    r is a radius, d the offset of a castor and l a distance from P. Angles are not examined: the result is False.
    """
    parameter = Poly.gen("param", name)
    towed = (length for trailer in robot.trailers for length in (trailer.length, trailer.hitch))
    others = [length.symbolic for length in (*towed, robot.effective_track) if length]
    for w in robot.wheels:
        g = w.symbolic
        own = {"r": g.r - parameter, "d": g.d - parameter, "l": g.x * g.x + g.y * g.y - parameter * parameter}
        others += (g.x, g.y, g.r, g.d, g.o, g.r_sw) if own.get(letter, parameter) else ()
    return not any(name in parameters_in(p) for p in others)


def _virtual(robot: Robot) -> list[str]:
    """Say which virtual wheels models use."""
    wheels = []
    for v in robot.virtual:
        plural = "steering angles" if v.role == "steers" else "speeds"
        wheels.append(
            f"{code(v.name)} at ({plain(v.x.nominal)}, {plain(v.y.nominal)}), whose {plural[:-1]} represents the "
            f"{plural} of {listed(v.wheels)}"
        )
    return [keyed("layout.virtual", f"Models use virtual wheels: {'; '.join(wheels)}.")] if wheels else []


def _wheels(wheels: tuple[Wheel, ...]) -> list[str]:
    """Return the layout table. Only columns that occur are shown; — marks a wheel without the quantity."""
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
    heads = [head for head, _ in shown]
    rows = [[cell(w) or "—" for _, cell in shown] for w in wheels]
    return table(heads, rows, "lllr")


def _legend(robot: Robot) -> str:
    kinds = [w.kind for w in robot.wheels]
    remarks = (
        (True, "(x, y) is the pivot A of the wheel, in polar coordinates (l, α)."),
        (any(k.directed for k in kinds), "The heading is the direction of positive rolling, α + β − 90°."),
        (any(k.turns for k in kinds), f"For {_turning(kinds)}, β and heading hold at steering angle ψ = 0; β(t) in the "
         "book is β + ψ."),
        (any(k.swivels for k in kinds), "d is the distance from the pivot to the contact point, along the rolling "
         "direction."),
        (any(w.nominal.o for w in robot.wheels), "o is the lateral offset of the contact point along the axle; the "
         "book does not have it."),
        (any(w.nominal.per_steer for w in robot.wheels), "Per steer, k, is the rotation of the drive joint for 1 rad "
         "of steering while the wheel does not roll, because the gears of the module couple them."),
        (len(robot.bodies) < len(kinds), "A ball that is driven in two directions has two rows, _1 and _2."),
        (any(k.rollers for k in kinds), "γ is the angle from the wheel plane to the axis of the roller that touches "
         "the ground."),
    )  # fmt: skip
    return " ".join(text for concerns, text in remarks if concerns)


def _turning(kinds: list[WheelType]) -> str:
    """Return the wheel types that turn about a vertical axis: steered wheels and castors."""
    nouns = dict.fromkeys(k.noun for k in kinds if k.turns)
    return notation.listed([f"{noun}s" for noun in nouns]) if nouns else ""


def _in_code(p: Parameter) -> str:
    """Say how the generated code treats a parameter."""
    if p.tunable:
        return f"tunable from {float(p.low):.6g} to {float(p.high):.6g}: passed to the generated code"
    names = ", ".join(code(name) for name in sorted(parameters_in(p.working)))
    return f"computed from the tunable {names}" if names else "constant in the generated code"


def _remarks(robot: Robot) -> list[str]:
    """Explain what is most often confused: track and half-track, rollers on top and at the ground, X and O."""
    remarks = []
    if pairs := _pairs(robot):
        apart = [f"{track} m between {code(a.name)} and {code(b.name)}" for track, (a, b) in pairs.items()]
        tracks = "tracks are" if len(pairs) > 1 else "track is"
        remarks.append(
            keyed(
                "layout.track", f"The {tracks} {notation.listed(apart)}; y of these wheels is the half-track."
            )
        )
    swedish = [w for w in robot.wheels if w.kind.rollers]
    if any(w.nominal.sg for w in swedish):
        text = "Roller axes are given, and drawn, at the ground. Seen from above, the rollers on top lean the other way"
        patterns = {
            "O": keyed("layout.x_from_above", ": this base shows an X from above and an O at the ground."),
            "X": keyed("layout.o_from_above", ": this base shows an O from above and an X at the ground."),
        }
        remarks.append(keyed("layout.rollers_lean", text + patterns.get(_pattern(swedish), ".")))
    return remarks


def _pairs(robot: Robot) -> dict[str, tuple[Wheel, Wheel]]:
    """Return pairs of wheels that roll forward and mirror each other beside P, one pair for each distance [m]."""
    pairs: dict[str, tuple[Wheel, Wheel]] = {}
    wheels = [w for w in robot.wheels if w.kind.constrains or w.kind.rolls_across]
    for a, b in combinations(wheels, 2):
        opposite = a.nominal.x == b.nominal.x and a.nominal.y == -b.nominal.y
        if a.type == b.type and opposite and a.nominal.y and not (a.nominal.sh or b.nominal.sh):
            pairs.setdefault(rounded(2 * abs(float(a.nominal.y))), (a, b))
    return pairs


def _pattern(wheels: list[Wheel]) -> str:
    """Return the pattern of four corner wheels: X if their roller axes point to the middle, O if around it, or ""."""
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
