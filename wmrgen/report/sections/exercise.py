"""Write a robot as an exercise: its layout, a motion with short numbers, and questions with blanks or with results.

The statement and the solution are the same text. In the statement, `BLANK` replaces each result.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import product
from math import cos, degrees, pi, sin
from typing import NamedTuple

from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError, UsageError
from wmrgen.geometry.constraints import ConstraintRow, Constraints, constrain, nominal_view
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.report.sections.example import product_of, value_at
from wmrgen.report.sections.markdown import (
    aligned,
    code,
    in_symbols,
    items,
    keyed,
    listed,
    math,
    matrix,
    minus,
    pictures,
    plain,
    rounded,
    sentence,
    table,
)
from wmrgen.report.sections.mobility import degrees as degrees_of_robot
from wmrgen.report.sections.overview import layout
from wmrgen.report.sections.result import NO_SLIP, read_number, six_decimals, within_limits
from wmrgen.report.sections.rows import general_rows
from wmrgen.report.wiring import admissible

FIGURES = ("layout.svg", "symbols.svg")  # figures of the statement; the other figures show results
BLANK = "…"
_BLANK_FORMULA = r"\ldots"
Values = Mapping[str, Exact]
# Components that are tried, in tenths of a unit: numbers of one digit, so that products with them are short.
_TENTHS = (
    (2, 4, 5, 8, 0, 3, 6, -2, -4, -5, 1, 7, 9),
    (0, 2, -2, 4, 3),
    (2, -2, 4, -4, 5, 1, -5, 3, -3, 6, -6, 7, -7, 0),
)
# cot ψ of a steered wheel: its sine and cosine are then short, such as 0.6 and 0.8.
_COTANGENTS = tuple(
    Fraction(*ratio) for ratio in ((4, 3), (-4, 3), (3, 4), (-3, 4), (12, 5), (-12, 5), (24, 7), (-24, 7))
)
_SCALES = (ONE, Exact(Fraction(1, 10)), Exact(Fraction(1, 100)))  # for robots with low limits
_POOL = 48  # motions with the shortest numbers: seeds 0 to 47 give different motions
_SHORT = 6  # characters of a short number, with its decimal point: 0.0889
_ERROR = ONE  # rad/s: error of one encoder


class _Motion(NamedTuple):
    """A motion of the robot without slip."""

    twist: Values  # vx, vy [m/s] and omega [rad/s]
    joints: (
        Values  # <wheel>.spin [rad/s], <wheel>.steer [rad] and <wheel>.steer_rate [rad/s]; castors start at 0
    )


class _Sheet(NamedTuple):
    """What all questions need."""

    derivation: Derivation  # of the drive that models the robot, if the robot skids
    rows: Constraints  # at nominal parameters
    motion: _Motion
    seed: int
    solved: bool

    @property
    def values(self) -> dict[str, float]:
        """The twist and the joints as numbers."""
        return {name: float(v) for name, v in {**self.motion.twist, **self.motion.joints}.items()}

    def answer(self, text: str) -> str:
        """Return a result in the solution, a blank in the statement."""
        return text if self.solved else BLANK

    def formula(self, text: str) -> str:
        """Return a result in LaTeX in the solution, a blank in the statement."""
        return text if self.solved else _BLANK_FORMULA

    def blocks(self, blocks: list[str]) -> list[str]:
        """Return blocks of results in the solution, one blank in the statement."""
        return blocks if self.solved else [BLANK]


@in_symbols
def exercise(d: Derivation, seed: int, solved: bool) -> list[str]:
    """Return the blocks of the exercise.

    Args:
        d: the derivation.
        seed: the number of the exercise, at least 0. It chooses the motion.
        solved: whether the results are in the text.

    Returns:
        Blocks of Markdown.

    Raises:
        UsageError: if the robot cannot move without slip.
    """
    own = d.driven
    pool = exercise_motions(own)
    if not pool:
        raise UsageError(
            f"there is no exercise on {d.robot.name}: it has no motion without slip within its limits."
        )
    motion = pool[seed % len(pool)]
    sheet = _Sheet(own, constrain(own.robot, nominal_view), motion, seed, solved)
    title = f"# Exercise {seed} on {code(d.robot.name)}" + (": solution" if solved else "")
    blocks = [title, *pictures(d.figures, "layout.svg"), *layout(d, in_code=False)]
    blocks += _model_of_skidding(d) if own is not d else []
    for question in (_given, _equations, _matrices, _degrees, _rates, _residual, _pose):
        blocks += question(sheet)
    return blocks


def _model_of_skidding(d: Derivation) -> list[str]:
    """Return the places of the wheels in the model of a robot that skids. Their headings and radii do not change."""
    rows = [[code(w.name), plain(w.nominal.x), plain(w.nominal.y)] for w in d.driven.robot.wheels]
    words = keyed(
        "exercise.skids",
        f"In a curve, the wheels of {code(d.robot.name)} skid. The exercise is about a model that does not: its fixed "
        "wheels are on a single axle, the effective track apart. Use these places in place of those above:",
    )
    return [words, *table(["wheel", "x", "y"], rows, "lr")]


# ---- The motion.


def exercise_motions(d: Derivation) -> list[_Motion]:
    """Return motions without slip within the limits: those in most directions first, and with the shortest numbers.

    Of motions that differ in signs only, such as a curve to the left and one to the right, one is returned.
    """
    found: dict[tuple[str, ...], _Motion] = {}
    for scale in _SCALES:
        for motion in _motions(d, scale):
            sizes = tuple(six_decimals(abs(v)) for v in motion.twist.values())
            known = found.setdefault(sizes, motion)
            if _order(motion) < _order(known):
                found[sizes] = motion
        if len(found) >= _POOL:
            break
    return sorted(found.values(), key=_order)[:_POOL]


def _order(motion: _Motion) -> tuple[int, tuple[int, int, int]]:
    """Return a key that sorts motions by how well they suit an exercise."""
    return _zeros(motion), _length(motion)


def _motions(d: Derivation, scale: Exact) -> Iterator[_Motion]:
    """Yield the motions without slip that are nearest to the twists that are tried."""
    tried = set()
    for parts in _wanted(d):
        wanted = {n: scale * v for n, v in zip(TWIST_NAMES, parts, strict=True)}
        twist = {n: read_number(six_decimals(v)) for n, v in admissible(d, wanted).items()}
        key = tuple(twist.values())
        if key in tried or not any(key):
            continue
        tried.add(key)
        joints = d.evaluate("inverse", twist)
        slip = joints.pop("slip")
        inside = all(within_limits(d, n, v) for n, v in {**twist, **joints}.items())
        if abs(float(slip)) < NO_SLIP and inside:
            yield _Motion(twist, joints)


def _wanted(d: Derivation) -> Iterator[tuple[Exact, ...]]:
    """Yield twists with short components, and twists that give a steered wheel a short sine and cosine.

    The pivot (x, y) of a wheel moves at (vx - y omega, vy + x omega).
    """
    for parts in product(*_TENTHS):
        yield tuple(Exact(Fraction(k, 10)) for k in parts)
    steered = [w.nominal for w in d.robot.wheels if w.kind.steers]
    for g, aside, turn, cotangent in product(steered[:1], *_TENTHS[1:], _COTANGENTS):
        vy, omega = Exact(Fraction(aside, 10)), Exact(Fraction(turn, 10))
        yield (vy + g.x * omega) * Exact(cotangent) + g.y * omega, vy, omega


def _zeros(motion: _Motion) -> int:
    """Return how many components of the twist are 0."""
    return sum(not v for v in motion.twist.values())


def _length(motion: _Motion) -> tuple[int, int, int]:
    """Return how many components of the twist are long, how many sines and cosines, and the characters of all."""
    twist = [float(v) for v in motion.twist.values()]
    angles = [float(v) for name, v in motion.joints.items() if name.endswith(".steer")]
    rates = [float(v) for name, v in motion.joints.items() if not name.endswith(".steer")]
    functions = [f(angle) for angle in angles for f in (cos, sin)]
    characters = sum(len(rounded(v)) for v in (*twist, *functions, *rates))
    return _long(twist), _long(functions), characters


def _long(values: Sequence[float]) -> int:
    """Return how many numbers have too many digits for a calculation by hand."""
    return sum(len(rounded(abs(v))) > _SHORT for v in values)


def _given(sheet: _Sheet) -> list[str]:
    """Return the twist, the steering angles, and the conventions of a wheel."""
    twist = ", ".join(rounded(float(sheet.motion.twist[n])) for n in TWIST_NAMES)
    lines = [f"The twist of P is constant: ξ = ({twist}), in m/s and rad/s."]
    angles = []
    for w in sheet.derivation.robot.wheels:
        name = f"{w.name}.steer"
        if w.kind.steers and name in sheet.motion.joints:
            psi = float(sheet.motion.joints[name])
            functions = f"cos ψ = {rounded(cos(psi))}, sin ψ = {rounded(sin(psi))}"
            angles.append(f"{code(w.name)}: ψ = {rounded(degrees(psi))}°, {functions}")
    castors = [w.name for w in sheet.derivation.robot.wheels if w.kind.swivels]
    blocks = ["## 2 The motion", *lines]
    if angles:
        blocks += [
            "The steering angles fit this twist, and do not change:",
            *items(angles),
        ]
    if castors:
        verb = "are" if len(castors) > 1 else "is"
        blocks.append(f"At this instant {listed(castors)} {verb} at ψ = 0.")
    return [
        *blocks,
        "e = (sin(α+β), −cos(α+β)) is the rolling direction of a wheel, and n = (cos(α+β), sin(α+β)) is across it. "
        "Write results with six significant digits.",
    ]


# ---- The questions.


def _equations(sheet: _Sheet) -> list[str]:
    """Ask for the equations of each wheel type."""
    blocks = [
        "## 3 The equations of a wheel",
        "Write the equations of each wheel type that occurs, from the velocity of the contact point: rolling, and "
        "across the rolling direction.",
    ]
    for noun in dict.fromkeys(w.kind.noun for w in sheet.derivation.robot.wheels):
        wheels = [w for w in sheet.derivation.robot.wheels if w.kind.noun == noun]
        offset = any(w.nominal.o for w in wheels)
        blocks += [f"**{noun.capitalize()}:**", *sheet.blocks(general_rows(wheels[0].kind, offset))]
    return blocks


def _numbers(rows: tuple[ConstraintRow, ...], values: Mapping[str, float]) -> str:
    """Return the matrix of rows in numbers."""
    lines = []
    for c in rows:
        lines.append([_latex(value_at(p, values)) for p in c.row])
    return matrix(lines)


def _latex(value: float) -> str:
    return rounded(round(value, 9)).replace("−", "-")


def _matrices(sheet: _Sheet) -> list[str]:
    """Ask for J1, J2 and C1 at the steering angles."""
    rolling = sheet.rows.rolling
    sliding = (*sheet.rows.sliding_fixed, *sheet.rows.sliding_steered)
    c1 = _numbers(sliding, sheet.values) if sliding else r"\left[\;\right]"
    shown = []
    if rolling:
        radii = (-value_at(dict(c.rates)[c.wheel.index, "spin"], sheet.values) for c in rolling)
        diagonal = rf"\mathrm{{diag}}\left({', '.join(map(_latex, radii))}\right)"
        shown = [
            f"J_1 = {sheet.formula(_numbers(rolling, sheet.values))}",
            f"J_2 = {sheet.formula(diagonal)}",
        ]
    shown.append(f"C_1 = {sheet.formula(c1)}")
    return [
        "## 4 The matrices",
        "Write J₁ ξ = J₂ φ̇ (3.24) and C₁ ξ = 0 (3.26) in numbers at these angles. Rows are in the order of the layout "
        "table; rows of fixed wheels are above rows of steered wheels in C₁.",
        *(block for formula in shown for block in math(formula)),
    ]


def _degrees(sheet: _Sheet) -> list[str]:
    """Ask for ranks and degrees."""
    m = sheet.derivation.mobility
    fixed, whole = (sheet.formula(str(rank.value)) for rank in (m.rank_C1f, m.rank_C1))
    meet = ", at steering angles for which all axles meet" if m.degree_of_steerability else ""
    blank = aligned([rf"\delta_{k} &= {_BLANK_FORMULA}" for k in "msM"])
    words = f"Omnidirectional: {sheet.answer(_yes(m.omnidirectional))}. Holonomic: {sheet.answer(_yes(m.holonomic))}."
    return [
        "## 5 Mobility",
        f"Determine the ranks{meet}, and the degrees of mobility, steerability and maneuverability. "
        "Can the robot move in all directions at once? Can its constraints be integrated?",
        *math(rf"\mathrm{{rank}}\,C_{{1f}} = {fixed}, \qquad \mathrm{{rank}}\,C_1 = {whole}"),
        *(degrees_of_robot(m) if sheet.solved else blank),
        words,
        *sheet.blocks(items(map(sentence, m.argument))),
    ]


def _yes(holds: bool) -> str:
    return "yes" if holds else "no"


def _rates(sheet: _Sheet) -> list[str]:
    """Ask for the rows times the twist and the rates of joints."""
    rows = []
    for w in sheet.derivation.robot.wheels:
        own = [c for c in (*sheet.rows.rolling, *sheet.rows.sliding) if c.wheel.index == w.index]
        for c in own:
            text, value = product_of(c.row, sheet.values)
            joint = f"{w.name}.spin" if c.kind == "rolling" else f"{w.name}.steer_rate"
            rate = sheet.values.get(joint)
            symbol = "φ̇" if c.kind == "rolling" else "ψ̇"
            shown = text.replace("-", "−") + (
                "" if text == rounded(value).replace("−", "-") else f" = {rounded(value)}"
            )
            cell = f"{symbol} = {sheet.answer(rounded(round(rate, 9)))} rad/s" if rate is not None else "—"
            rows.append([code(w.name), c.kind, sheet.answer(shown), cell])
    slides = "C₁ has no rows, so the wheels allow every motion."
    if sheet.rows.sliding_fixed or sheet.rows.sliding_steered:
        slides = "The sliding rows of fixed and steered wheels times ξ are 0: no wheel slides."
    return [
        "## 6 The rates of the wheels",
        "Multiply each row by ξ, and compute the rates of the joints. Do the wheels allow the motion?",
        *table(["wheel", "row", "row · ξ in m/s", "rate"], rows, "l"),
        sheet.answer(slides),
    ]


def _residual(sheet: _Sheet) -> list[str]:
    """Ask for the twist and the residual if one encoder is wrong; [] if `forward` measures no wheel."""
    d = sheet.derivation.without_gyro
    try:
        measured = [p.name for p in d.formula("forward").inputs if p.default is None]
    except NotDerivableError:
        return []
    spins = [name for name in measured if name.endswith(".spin")]
    if not spins:
        return []
    wrong = spins[sheet.seed % len(spins)]
    joints = {name: sheet.motion.joints.get(name, ZERO) for name in measured}
    joints[wrong] += _ERROR
    outputs = {name: rounded(round(float(v), 9)) for name, v in d.evaluate("forward", joints).items()}
    twist = ", ".join(outputs[n] for n in TWIST_NAMES)
    weights = keyed("exercise.weights", ", with the weights of the table") if d.measured.weighted else ""
    error = rounded(float(_ERROR))
    shows = "The residual shows that a measurement is wrong."
    if outputs["slip"] == "0":
        shows = "The rows still agree with each other, so the residual does not show the error."
    return [
        "## 7 An encoder is wrong",
        f"Measured are {listed(measured)}. They have the values of sections 2 and 6, but the encoder of "
        f"{code(wrong.removesuffix('.spin'))} shows {error} rad/s too much. Compute ξ by least squares from all "
        f"rolling and sliding rows whose rates are measured, in m/s{weights}, and the norm of the residual z − H ξ. "
        "Does it show the error?",
        f"ξ = {sheet.answer(f'({twist})')}, |z − H ξ| = {sheet.answer(outputs['slip'])} m/s",
        sheet.answer(shows),
    ]


def _pose(sheet: _Sheet) -> list[str]:
    """Ask for the pose after a quarter turn, whose coordinates are short, or after a time without rotation."""
    omega = float(sheet.motion.twist["omega"])
    seconds = pi / (2 * abs(omega)) if omega else 1.0
    dt = Exact(Fraction(seconds))
    pose = {
        n: float(v)
        for n, v in sheet.derivation.evaluate("odometry", {**sheet.motion.twist, "dt": dt}).items()
    }
    x, y, theta = (sheet.answer(rounded(round(v, 9))) for v in (pose["x"], pose["y"], degrees(pose["theta"])))
    goal = "the pose after 1 s"
    time, centre = "", ""
    if omega:
        goal = "the time in which the robot turns by 90°, its pose then, and the instantaneous centre of rotation"
        vx, vy = (float(sheet.motion.twist[n]) for n in ("vx", "vy"))
        time = f"Δt = {sheet.answer(rounded(seconds))} s, "
        point = f"({rounded(-vy / omega)}, {rounded(vx / omega)})"
        centre = f", ICR = {sheet.answer(point)} m"
    return [
        "## 8 The pose",
        f"The robot starts at (0, 0, 0) and keeps ξ. Compute {goal}.",
        minus(f"{time}x = {x} m, y = {y} m, θ = {theta}°{centre}"),
    ]
