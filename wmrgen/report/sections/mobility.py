"""Sections 5 and 9: the mobility argument in words and ranks, whether rows can be integrated, and singular cases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from wmrgen.analysis.kinematics.least_squares import project
from wmrgen.analysis.mobility.basis import led
from wmrgen.analysis.mobility.ranks import numeric_rank
from wmrgen.analysis.mobility.records import Mobility, Singularity
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError
from wmrgen.functions.models.polynomials import whole
from wmrgen.functions.motion.wheel_speeds import relations
from wmrgen.geometry.constraints import XI, symbolic_view
from wmrgen.geometry.exact.evaluate import fix
from wmrgen.geometry.exact.poly import Poly, Row, dot, has_angles
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.report.sections.inverse import driven_twist, moves_as_partners
from wmrgen.report.sections.latex import (
    equation,
    gathered,
    latex,
    roots,
    short,
    summands,
    terms,
    width,
    wrapped,
)
from wmrgen.report.sections.markdown import (
    aligned,
    capitalised,
    items,
    math,
    pictures,
    plain,
    rounded,
    sentence,
    some,
)
from wmrgen.report.sections.motion import jackknives

_RELATION = 150  # glyphs of a printed compatibility condition
_PRODUCTS = 10_000  # of terms, in the brackets of trailers: half a second
_RELATIONS = 5  # of them


def analysis(d: Derivation) -> list[str]:
    """Section 5."""
    m = d.mobility
    steered = any(w.kind.steers for w in d.robot.wheels)
    meet = "meet in one ICR" if any(turn for _, _, turn in m.null_space_symbolic) else "are parallel"
    several = sum(w.kind.constrains for w in d.robot.wheels) > 1
    meet = "are one line" if m.degree_of_mobility > 1 else meet
    return [
        "## 5 Mobility",
        *items(map(sentence, m.argument), lambda k: f"{k}."),
        "So the degrees of mobility, steerability and maneuverability are"
        + f", at steering angles for which all axles {meet}," * (steered and several),
        *_degrees(m),
        *(_remark(m) if steered else []),
        *_verdicts(d),
        *integrability(d),
        *([] if d.robot.effective_track else _actuation(d)),
    ]


def _degrees(m: Mobility) -> list[str]:
    rank, total = 3 - m.degree_of_mobility, m.degree_of_maneuverability
    steering = rf"\dim\{{\xi\ \mathrm{{admissible}}\}} - \delta_m = {m.admissible.dimension} - {m.degree_of_mobility}"
    if not _couplings_cut(m) and m.degree_of_mobility:
        ranks = f"{m.rank_C1.value} - {m.rank_C1f.value}"
        steering = rf"\mathrm{{rank}}\,C_1 - \mathrm{{rank}}\,C_{{1f}} = {ranks}"
    return aligned([
        rf"\delta_m &= 3 - \mathrm{{rank}}\,C_1 = 3 - {rank} = {m.degree_of_mobility} && (3.40)",
        rf"\delta_s &= {steering} = {m.degree_of_steerability} && (3.41)",
        rf"\delta_M &= \delta_m + \delta_s = {m.degree_of_mobility} + {m.degree_of_steerability} = {total} && (3.42)",
    ])  # fmt: skip


def _couplings_cut(m: Mobility) -> bool:
    """True when couplings cut the set of admissible twists."""
    a = m.admissible
    return not a.linear or a.normal is not None or a.dimension != 3 - m.rank_C1f.value


def _remark(m: Mobility) -> list[str]:
    """Why (3.41) is not taken literally."""
    if _couplings_cut(m):
        return [
            "With couplings the ranks of (3.41) do not count what steering adds: the dimension of the set of twists "
            "that are admissible at some angles, δ<sub>m</sub> + δ<sub>s</sub>, does."
        ]
    return [
        "The book writes rank C<sub>1s</sub> in (3.41). Wheels whose axles are bound to meet in one point "
        "must not be counted twice, so the rank that steering adds to C<sub>1f</sub> is what counts."
    ]


class _Counted(NamedTuple):
    """A growth vector, what it counts, and where it holds."""

    vector: tuple[int, ...]
    states: str
    where: str


def _growth(d: Derivation) -> _Counted:
    """Without steering, trailers or coupled castors the inputs are the same twists everywhere, and so is the vector."""
    own = d.mobility.growth_vector
    steered = "steering angles" if d.mobility.degree_of_steerability else ""
    included = f", {steered} included" if steered else ""
    generic = has_angles(p for column in d.mobility.null_space for p in column)
    where = ", at generic configurations," if generic else ""
    if not d.robot.trailers:
        return _Counted(own, included, where)
    from wmrgen.functions.models.exceptional import exceptional
    from wmrgen.functions.models.growth import growing, growth

    try:
        system = growing(d.robot, d.mobility)
        found = growth(system, most=_PRODUCTS)
    except NotDerivableError:
        return _Counted(own, f"{included}, trailers left out", where)
    states = f", {f'{steered} and ' if steered else ''}trailers included"
    return _Counted(
        found.vector, states, "" if exceptional(system, found) == () else ", at generic configurations,"
    )


def _verdicts(d: Derivation) -> list[str]:
    """What follows for the motions: how many at once, how many poses, and by how many brackets."""
    m = d.mobility
    if not m.ddof:
        return ["Without slip nothing moves: DDOF = DOF = 0."]
    vector, states, where = _growth(d)
    rolling = "without slip, " if m.degenerate else ""
    velocities = ("one velocity", "two velocities", "three velocities")[m.ddof - 1]
    said = f"{rolling}{velocities} can be chosen at once".capitalize()
    return [
        f"{said} (DDOF = {m.ddof}), and poses of dimension {m.dof} can be reached "
        f"(DOF = {m.dof}). Holonomic means DDOF = DOF, omnidirectional DDOF = 3: the robot is {_called(m)}. "
        f"The growth vector ({', '.join(map(str, vector))}) counts{where} the dimensions that the inputs span, then "
        f"those with their Lie brackets, one order at a time{states}: the degree of nonholonomy is {len(vector)}."
    ]


def _called(m: Mobility) -> str:
    if m.omnidirectional:
        return "both"
    return "holonomic, but not omnidirectional" if m.holonomic else "neither"


def _actuation(d: Derivation) -> list[str]:
    """How many joints are driven for how many freedoms, and what the speeds of driven wheels have in common."""
    told = " ".join(capitalised(str(balance)) for balance in d.mobility.actuation)
    blocks = [told] if told else []
    spins = [Poly.gen("input", f"{w.name}.spin") for w in d.robot.wheels if "spin" in w.actuated]
    if len(spins) > _RELATIONS + 3:
        return blocks
    sums = [
        Poly.sum(led(d.robot, p) * spin for p, spin in zip(row, spins, strict=True))
        for row in relations(d.robot, d.mobility, symbolic_view)
    ]
    lines = [f"0 &= {wrapped(summands(gathered(terms(short(p)))))}" for p in whole(sums)]
    if not lines or max(map(width, lines)) > _RELATION or len(lines) > _RELATIONS:
        return blocks
    held = ", the steering held," if has_angles(sums) else ""
    if held and not d.mobility.degree_of_steerability:  # one angle alone is admissible, where less is asked
        return blocks
    speeds = f"peeds of driven wheels that fit each other{held}"
    satisfy = f"Where wheels may slide sideways, s{speeds} still" if d.mobility.degenerate else f"S{speeds}"
    return [
        *blocks,
        f"{satisfy} satisfy the condition{'s' * (len(lines) > 1)} of compatibility",
        *aligned(lines),
    ]


def integrability(d: Derivation) -> list[str]:
    """c . curl c of the sliding rows in world coordinates, and what all rows do together.

    c = (-sin chi, cos chi, k), chi being theta plus a constant heading, so the product is -sin^2 chi - cos^2 chi.
    """
    wheels = [w for w in d.robot.wheels if w.kind.constrains]
    if not wheels:
        return []
    held = ", the steering angle held" if any(w.kind.steers for w in wheels) else ""
    products = {-(w.nominal.ch * w.nominal.ch + w.nominal.sh * w.nominal.sh) for w in wheels}
    value = " or ".join(f"{float(v):g}" for v in sorted(products, key=float))
    return [
        f"Can the constraints be integrated? A wheel's sliding row is c(q) q̇ = 0 in the coordinates "
        f"q = (x, y, θ) of the world{held}; χ is the direction in which it rolls, seen from the world, and k the third "
        "entry. Frobenius asks for c · curl c:",
        *math(
            r"c = \begin{bmatrix} -\sin\chi & \cos\chi & k \end{bmatrix}, \qquad "
            r"c\cdot\mathrm{curl}\,c = c\cdot\begin{bmatrix} \sin\chi & -\cos\chi & 0 \end{bmatrix}"
            rf" = -\sin^2\chi - \cos^2\chi = {value}"
        ),
        f"It is not zero, so {'none of these equations alone' if len(wheels) > 1 else 'this equation by itself'} is "
        f"{'' if len(wheels) > 1 else 'not '}the derivative of a condition on the pose (Tzafestas (2.25)). "
        + _together(d.mobility),
    ]  # fmt: skip


def _together(m: Mobility) -> str:
    if m.ddof == 0:
        return "Together they forbid all motion."
    if m.holonomic:
        return (
            "Together they can be integrated all the same: the brackets of the motions left over give nothing "
            f"new, DOF = DDOF = {m.dof}."
        )
    if m.dof < 3:  # two dimensions that brackets reach are the translations
        return (
            "Together they can in part: no admissible twist turns the robot, ω = 0, which integrates to θ = const. The "
            f"rest cannot: brackets of the motions left over reach {m.dof} dimensions, x and y, while DDOF is {m.ddof}."
        )
    return (
        "Nor can all constraints together be integrated: brackets of the motions left over reach all "
        f"{m.dof} dimensions, while DDOF is {m.ddof}."
    )


def skid(d: Derivation) -> list[str]:
    """What stands for a robot that turns by skidding, in the sections that follow."""
    track = d.robot.effective_track
    if track is None:
        return []
    pivots = [w.pivot for w in d.driven.robot.wheels if w.kind.fixed_axle]
    x, y = ((min(p) + max(p)) / 2 for p in zip(*((z.real, z.imag) for z in pivots), strict=True))
    steered = any(w.kind.steers for w in d.robot.wheels)
    turning = "one does whose fixed wheels" if steered else "a differential drive does whose wheels"
    return [
        f"In a curve these wheels cannot all roll. On even ground the robot turns as {turning} stand the effective "
        "track apart on one axle, a measured length,",
        *math(" = ".join(dict.fromkeys(["T_e", latex(track.symbolic), plain(track.nominal)]))),
        f"That drive has DDOF = {d.driven.mobility.ddof} and DOF = {d.driven.mobility.dof}: it is not holonomic.",
        *_actuation(d.driven),
        f"Sections 6 to 8 are about that drive: its axle passes through ({rounded(x)}, {rounded(y)}), and the wheels "
        "of a side count as one. What the wheels slide in a curve is no part of `slip` there.",
    ]


def singular(d: Derivation) -> list[str]:
    """Section 9."""
    title = "## 9 Singular configurations" + (" and reachable twists" if "reach.svg" in d.figures else "")
    blocks = [title, *pictures(d.figures, "singular.svg", "reach.svg")]
    if not d.mobility.singularities:
        return [*blocks, *_none(d)]
    pivots = [s for s in d.mobility.singularities if s.kind == "icr_on_pivot"]
    blocks += _pivots(d, pivots) if pivots else []
    for s in d.mobility.singularities:
        if s.kind != "icr_on_pivot":
            where = " This happens where" + (", at the same time," if len(s.conditions) > 1 else "")
            said = capitalised(s.meaning)
            blocks += [said + (where if s.conditions else "")]
            blocks += _conditions(s.conditions, d.robot) if s.conditions else []
    return [*blocks, *jackknives(d)]


def _none(d: Derivation) -> list[str]:
    """What is said of a robot whose layout has no singular set, and of its forms of the model that have one."""
    trailers = jackknives(d)
    castors = has_angles(p for column in d.mobility.null_space for p in column)
    if not trailers and not castors and not any(s.domain for s in d.forms.values()):
        return [
            "No configuration is singular: no rank drops and no angle is undefined, whatever the robot does."
        ]
    layout = "Castors turn the directions in which the robot can move: ranks are those of generic angles of theirs."
    if not castors:
        layout = "No rank of the wheels' constraints drops and no steering angle is undefined, whatever the body does."
    return (
        [layout, *trailers]
        if trailers
        else [f"{layout} Section 8 says where forms of the model do not hold."]
    )


def _pivots(d: Derivation, pivots: list[Singularity]) -> list[str]:
    """Steered wheels whose pivot is the ICR."""
    wheels = [d.robot.wheel(s.wheels[0]) for s in pivots]
    turns = any(_turns_about(w, d.mobility) for w in wheels)
    when = (
        "where it is the ICR or the robot stands still"
        if turns
        else "only where the whole robot stands still"
    )
    robot = d.in_symbols.robot
    twist = driven_twist(project(robot, d.in_symbols.mobility))
    unlike = any(not moves_as_partners(robot, w, twist) for w in robot.wheels if w.kind.steers)
    shared = "; a shared angle also where Σ u w and Σ (u² − w²) of its wheels vanish together" * unlike
    return [
        f"The heading of a steered wheel ({some(wheels)}) is undefined where its pivot (x, y) stands still, "
        f"v<sub>x</sub> − y ω = 0 and v<sub>y</sub> + x ω = 0: {when}{shared}. Close by, a small change "
        "of the twist asks for a large change of the angle (section 6)."
    ]


def _turns_about(w: Wheel, m: Mobility) -> bool:
    """Whether an admissible twist turns the robot about the pivot of a wheel."""
    if not m.admissible.linear:
        return True
    turn = np.array([w.pivot.imag, -w.pivot.real, 1.0])
    return numeric_rank(np.vstack([m.admissible.basis, turn]))[0] == m.admissible.dimension


def _conditions(conditions: Sequence[Poly | Row], robot: Robot) -> list[str]:
    """Each condition as a sum that is 0, without a common factor, and the steering angles where that is so."""
    lines = []
    for c in conditions:
        p = equation(c if isinstance(c, Poly) else dot(c, XI))
        at = roots(fix(p, robot.constants))
        lines.append(f"{wrapped(summands(terms(p)))} &= 0" + (f", & {at}" if at else ""))
    return aligned(lines)
