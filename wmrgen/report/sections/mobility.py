"""Write sections 5 and 9: the degrees of mobility, whether constraints can be integrated, and singular cases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

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
from wmrgen.geometry.printing import Reader
from wmrgen.report.sections.inverse import driven_twist, moves_as_partners
from wmrgen.report.sections.latex import (
    WIDE,
    equation,
    gathered,
    latex,
    roots,
    summands,
    terms,
    width,
    wrapped,
)
from wmrgen.report.sections.markdown import (
    aligned,
    capitalised,
    items,
    keyed,
    math,
    pictures,
    plain,
    rounded,
    sentence,
    some,
)
from wmrgen.report.sections.motion import jackknives

if TYPE_CHECKING:
    from wmrgen.functions.models.exceptional import Exceptional

_RELATIONS = (
    4  # printed compatibility conditions; more say nothing new, and five of jpl_osr fill half a screen
)
_PRODUCTS = 10_000  # products of terms in the Lie brackets of trailers: half a second


def analysis(d: Derivation) -> list[str]:
    """Return section 5."""
    m = d.mobility
    steered = any(w.kind.steers for w in d.robot.wheels)
    several = sum(w.kind.constrains for w in d.robot.wheels) > 1
    if m.degree_of_mobility > 1:
        meet = "axles_on_one_line", "are on one line"
    elif any(turn for _, _, turn in m.null_space_symbolic):
        meet = "axles_meet", "meet in one ICR"
    else:
        meet = "axles_parallel", "are parallel"
    key, words = meet
    at = keyed(f"mobility.{key}", f", at steering angles for which all axles {words},")
    return [
        "## 5 Mobility",
        *items(map(sentence, m.argument), lambda k: f"{k}."),
        "So the degrees of mobility, steerability and maneuverability are" + at * (steered and several),
        *degrees(m),
        *(_remark(m) if steered else []),
        *_verdicts(d),
        *integrability(d),
        *([] if d.robot.effective_track else _actuation(d)),
    ]


def degrees(m: Mobility) -> list[str]:
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
    """Return whether couplings restrict the set of admissible twists."""
    a = m.admissible
    return not a.linear or a.normal is not None or a.dimension != 3 - m.rank_C1f.value


def _remark(m: Mobility) -> list[str]:
    """Say why (3.41) is not taken literally."""
    if _couplings_cut(m):
        return [
            "With couplings, the ranks of (3.41) do not count the degrees of freedom that steering adds. They are "
            "counted by the dimension of the set of twists that are admissible at some steering angles, which is "
            "δ<sub>m</sub> + δ<sub>s</sub>."
        ]
    return [
        "The book writes rank C<sub>1s</sub> in (3.41). Here δ<sub>s</sub> is the rank that steering adds to "
        "C<sub>1f</sub>, because this does not count wheels twice if their axles always meet in one point."
    ]


class _Counted(NamedTuple):
    """A growth vector with words that describe it."""

    vector: tuple[int, ...]
    states: str  # which states besides the pose are counted
    where: str  # at which configurations the vector holds


def _growth(d: Derivation) -> _Counted:
    """Return the growth vector. Without steering, trailers and coupled castors it is the same everywhere."""
    own = d.mobility.growth_vector
    steered = keyed("growth.steering", "steering angles") if d.mobility.degree_of_steerability else ""
    generic = has_angles(p for column in d.mobility.null_space for p in column)
    where = " at generic configurations" if generic else ""
    if not d.robot.trailers and not generic:
        return _Counted(own, steered, where)
    from wmrgen.functions.models.exceptional import exceptional
    from wmrgen.functions.models.growth import growing, growth

    try:
        system = growing(d.robot, d.mobility)
        found = growth(system, most=_PRODUCTS)
    except NotDerivableError:
        return _Counted(own, steered, f" without its trailers{where}" if d.robot.trailers else where)
    towed = keyed("growth.trailers", "trailers") if d.robot.trailers else ""
    states = " and ".join(filter(None, (steered, towed)))
    return _Counted(found.vector, states, _where(exceptional(system, found)))


def _where(sets: Sequence[Exceptional] | None) -> str:
    """Say where a growth vector is valid.

    Args:
        sets: Where it is different; None if only generic configurations are known.
    """
    if sets is None:
        return " at generic configurations"
    if not sets:
        return " wherever the model holds"
    reader = Reader()
    known = [f"({', '.join(map(str, s.vector))}) where `{reader(s.condition)} = 0`" for s in sets if s.vector]
    other = [f"`{reader(s.condition)} = 0`" for s in sets if not s.vector]
    said = " at generic configurations"
    if known:
        said += f", and {' and '.join(known)}"
    if other:
        said += f"; where {' or '.join(other)} it may be different"
    return said


def _verdicts(d: Derivation) -> list[str]:
    """Say how many velocities are free, which poses can be reached, and with how many Lie brackets."""
    m = d.mobility
    if not m.ddof:
        return ["Without slip the robot cannot move: DDOF = DOF = 0."]
    vector, states, where = _growth(d)
    rolling = "without slip, " if m.degenerate else ""
    velocities = ("one velocity", "two velocities", "three velocities")[m.ddof - 1]
    chosen = f"{rolling}{velocities} can be chosen at once".capitalize()
    chosen = keyed("mobility.without_slip" if rolling else "mobility.velocities", chosen)
    counted = f", with {states} included" if states else ""
    return [
        f"{chosen} (DDOF = {m.ddof}), and poses of dimension {m.dof} can be reached "
        f"(DOF = {m.dof}). Holonomic means DDOF = DOF, omnidirectional means DDOF = 3: the robot is {_called(m)}. "
        f"{keyed('growth.vector', 'The growth vector is')} ({', '.join(map(str, vector))}){where}. "
        f"It counts the dimensions that the inputs and their Lie brackets span, order by order{counted}. "
        f"The degree of nonholonomy is its length, {len(vector)}."
    ]


def _called(m: Mobility) -> str:
    if m.omnidirectional:
        return keyed("mobility.both", "both")
    if m.holonomic:
        return keyed("mobility.holonomic_only", "holonomic, but not omnidirectional")
    return keyed("mobility.neither", "neither")


def _actuation(d: Derivation) -> list[str]:
    """Compare driven joints with degrees of freedom, and write the conditions between speeds of driven wheels."""
    balances = " ".join(capitalised(str(balance)) for balance in d.mobility.actuation)
    blocks = [keyed("mobility.actuation", balances)] if balances else []
    sums = conditions_of_speeds(d)
    if not sums:
        return blocks
    lines = list(map(_condition, sums))
    fixed = " at constant steering angles" if has_angles(sums) else ""
    conditions = f"the condition{'s' * (len(lines) > 1)} of compatibility{fixed}"
    if d.mobility.degenerate:
        words = keyed(
            "mobility.compatible_while_sliding",
            f"Wheels of this robot may slide sideways. The speeds of driven wheels still have to satisfy {conditions}",
        )
    else:
        words = keyed("mobility.compatible", f"The speeds of driven wheels have to satisfy {conditions}")
    return [*blocks, words, *aligned(lines)]


def conditions_of_speeds(d: Derivation) -> list[Poly]:
    """Return sums over the speeds of driven wheels that are 0; [] if they are too long or too many to be printed."""
    spins = [Poly.gen("input", f"{w.name}.spin") for w in d.robot.wheels if "spin" in w.actuated]
    if len(spins) > _RELATIONS + 3 or d.robot.effective_track:
        return []
    sums = []
    for row in relations(d.robot, d.mobility, symbolic_view):
        sums.append(Poly.sum(led(d.robot, p) * spin for p, spin in zip(row, spins, strict=True)))
    if has_angles(sums) and not d.mobility.degree_of_steerability:
        return []  # the steering angle is fixed, and fewer conditions hold at this angle
    sums = list(whole(sums))
    lines = map(_condition, sums)
    return sums if len(sums) <= _RELATIONS and all(width(line) <= 2 * WIDE for line in lines) else []


def _condition(p: Poly) -> str:
    """Return the LaTeX of a condition of compatibility."""
    return f"0 &= {wrapped(summands(gathered(terms(p))))}"


def integrability(d: Derivation) -> list[str]:
    """Write c · curl c of the sliding rows in world coordinates, and say whether all rows together can be integrated.

    c = (-sin chi, cos chi, k), where chi is theta plus a constant heading: the product is -sin^2 chi - cos^2 chi.
    """
    wheels = [w for w in d.robot.wheels if w.kind.constrains]
    if not wheels:
        return []
    fixed = ", at a constant steering angle" if any(w.kind.steers for w in wheels) else ""
    products = {-(w.nominal.ch * w.nominal.ch + w.nominal.sh * w.nominal.sh) for w in wheels}
    value = " or ".join(f"{float(v):g}" for v in sorted(products, key=float))
    return [
        "Can the constraints be integrated? In the world coordinates q = (x, y, θ), the sliding row of a wheel is "
        f"c(q) q̇ = 0{fixed}. χ is its rolling direction in the world, and k the third entry. By Frobenius's "
        "theorem, this constraint can be integrated only if c · curl c = 0:",
        *math(
            r"c = \begin{bmatrix} -\sin\chi & \cos\chi & k \end{bmatrix}, \qquad "
            r"c\cdot\mathrm{curl}\,c = c\cdot\begin{bmatrix} \sin\chi & -\cos\chi & 0 \end{bmatrix}"
            rf" = -\sin^2\chi - \cos^2\chi = {value}"
        ),
        f"It is not zero, so {'no equation alone is' if len(wheels) > 1 else 'this equation is not'} the "
        f"derivative of a condition on the pose (Tzafestas (2.25)). {_together(d.mobility)}",
    ]  # fmt: skip


def _together(m: Mobility) -> str:
    """Say whether all constraints together can be integrated."""
    if m.ddof == 0:
        return "Together they do not allow any motion."
    if m.holonomic:
        return keyed(
            "integrability.whole",
            "Together they can nevertheless be integrated: Lie brackets of the admissible motions give no new "
            f"direction, DOF = DDOF = {m.dof}.",
        )
    if m.dof < 3:  # two dimensions that brackets reach are the translations
        return keyed(
            "integrability.in_part",
            "Together they can be integrated in part: no admissible twist turns the robot, so ω = 0 integrates to "
            "θ = const. The rest cannot be integrated: Lie brackets of the admissible motions span "
            f"{m.dof} dimensions, x and y, while DDOF is {m.ddof}.",
        )
    return keyed(
        "integrability.none",
        "All constraints together cannot be integrated either: Lie brackets of the admissible motions span all "
        f"{m.dof} dimensions, while DDOF is {m.ddof}.",
    )


def skid(d: Derivation) -> list[str]:
    """Describe the drive that replaces a robot that turns by skidding in the sections that follow."""
    track = d.robot.effective_track
    if track is None:
        return []
    pivots = [w.pivot for w in d.driven.robot.wheels if w.kind.fixed_axle]
    xs, ys = [z.real for z in pivots], [z.imag for z in pivots]
    x, y = (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2
    steered = any(w.kind.steers for w in d.robot.wheels)
    model = "a robot with its fixed wheels" if steered else "a differential drive"
    return [
        f"In a curve, these wheels cannot all roll. On even ground the robot moves like {model} on a single axle. The "
        "track of this axle is the effective track, a measured length:",
        *math(" = ".join(dict.fromkeys(["T_e", latex(track.symbolic), plain(track.nominal)]))),
        keyed(
            "skid.drive",
            f"This model has DDOF = {d.driven.mobility.ddof} and DOF = {d.driven.mobility.dof}: it is not holonomic.",
        ),
        *_actuation(d.driven),
        f"Sections 6 to 8 are about this model. Its axle passes through ({rounded(x)}, {rounded(y)}), and the wheels "
        "of a side count as one wheel. `slip` does not include the sliding of wheels in a curve.",
    ]


def singular(d: Derivation) -> list[str]:
    """Return section 9."""
    title = "## 9 Singular configurations" + (" and reachable twists" if "reach.svg" in d.figures else "")
    blocks = [title, *pictures(d.figures, "singular.svg", "reach.svg")]
    if not d.mobility.singularities:
        return [*blocks, *_none(d)]
    pivots = [s for s in d.mobility.singularities if s.kind == "icr_on_pivot"]
    blocks += _pivots(d, pivots) if pivots else []
    for s in d.mobility.singularities:
        if s.kind != "icr_on_pivot":
            where = " This happens if" + (", at the same time," if len(s.conditions) > 1 else "")
            meaning = capitalised(s.meaning)
            blocks += [meaning + (where if s.conditions else "")]
            blocks += _conditions(s.conditions, d.robot) if s.conditions else []
    return [*blocks, *jackknives(d)]


def _none(d: Derivation) -> list[str]:
    """Return section 9 of a robot whose layout is never singular, although forms of its model may be."""
    trailers = jackknives(d)
    castors = has_angles(p for column in d.mobility.null_space for p in column)
    if not trailers and not castors and not any(s.domain for s in d.forms.values()):
        return [
            keyed(
                "singular.nowhere",
                "No configuration is singular: ranks are constant and all angles are defined, whatever the robot does.",
            )
        ]
    layout = (
        "Castors turn the directions in which the robot can move. The ranks hold at generic castor angles."
    )
    if not castors:
        layout = "The ranks of the constraints are constant and all steering angles defined, whatever the body does."
    return (
        [layout, *trailers]
        if trailers
        else [f"{layout} Section 8 says where forms of the model do not hold."]
    )


def _pivots(d: Derivation, pivots: list[Singularity]) -> list[str]:
    """Say where the heading of steered wheels is undefined, because the pivot is the ICR."""
    wheels = [d.robot.wheel(s.wheels[0]) for s in pivots]
    turns = any(turns_about(w, d.mobility) for w in wheels)
    if turns:
        when = keyed("singular.on_pivot", "This happens if the pivot is the ICR, or if the robot is at rest.")
    else:
        when = keyed("singular.at_standstill", "This happens only if the whole robot is at rest.")
    robot = d.in_symbols.robot
    twist = driven_twist(project(robot, d.in_symbols.mobility))
    unlike = any(not moves_as_partners(robot, w, twist) for w in robot.wheels if w.kind.steers)
    shared = ""
    if unlike:
        shared = keyed(
            "singular.shared_angle",
            " A shared angle is also undefined where Σ u w and Σ (u² − w²) of its wheels are both 0.",
        )
    return [
        "The heading of a steered wheel is undefined if its pivot (x, y) does not move: v<sub>x</sub> − y ω = 0 and "
        f"v<sub>y</sub> + x ω = 0. This concerns {some(wheels)}. {when}{shared} Near these twists, small changes of "
        "the twist need large changes of the angle."
    ]


def turns_about(w: Wheel, m: Mobility) -> bool:
    """Return whether an admissible twist turns the robot about the pivot of a wheel."""
    if not m.admissible.linear:
        return True
    turn = np.array([w.pivot.imag, -w.pivot.real, 1.0])
    return numeric_rank(np.vstack([m.admissible.basis, turn]))[0] == m.admissible.dimension


def _conditions(conditions: Sequence[Poly | Row], robot: Robot) -> list[str]:
    """Return each condition as a sum that is 0, with the steering angles that satisfy it."""
    lines = []
    for c in conditions:
        p = equation(c if isinstance(c, Poly) else dot(c, XI))
        at = roots(fix(p, robot.constants))
        lines.append(f"{wrapped(summands(terms(p)))} &= 0" + (f", & {at}" if at else ""))
    return aligned(lines)
