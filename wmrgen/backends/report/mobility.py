"""Sections 5 and 9: the mobility argument in words and ranks, whether rows can be integrated, and singular cases."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from wmrgen.backends.report.angles import equation, roots
from wmrgen.backends.report.latex import summands, terms, wrapped
from wmrgen.backends.report.markdown import (
    CAP,
    aligned,
    capitalised,
    code,
    grouped,
    items,
    plain,
    sentence,
    some,
    table,
)  # fmt: skip
from wmrgen.constraints import XI, constrain, nominal_view
from wmrgen.errors import NotDerivableError
from wmrgen.exact.evaluate import fix
from wmrgen.exact.number import ZERO, Exact
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.mobility.ranks import decide
from wmrgen.mobility.records import TOLERANCE

if TYPE_CHECKING:
    from wmrgen.constraints import ConstraintRow
    from wmrgen.mobility.records import Mobility, Rank, Singularity
    from wmrgen.robot import Derivation


def analysis(d: Derivation) -> list[str]:
    """Section 5."""
    m = d.mobility
    steered = any(w.kind.steers for w in d.robot.wheels)
    return [
        "## 5 Mobility",
        "The argument:",
        *items(map(sentence, m.reasons), lambda k: f"{k}."),
        "In ranks" + (", taken at a steering for which all axles agree on one ICR:" if steered else ":"),
        *table(
            ["matrix", "rank", "rank in exact arithmetic", "singular values", "margin"],
            [_rank("C<sub>1f</sub>", m.rank_C1f), _rank("C₁", m.rank_C1)],
            "lr",
        ),
        f"Rows are scaled to m/s. A singular value counts when it exceeds {TOLERANCE:g} of the largest; the margin "
        "says how many times over the smallest of those does.",
        *_degrees(m),
        *(_remark(m) if steered else []),
        *_generic(d),
        "What follows:",
        *_verdicts(d),
        *integrability(d),
        "Actuation:",
        *items(f"{sentence(a)}." for a in m.actuation),
    ]


def _rank(name: str, r: Rank) -> list[str]:
    values = ", ".join("0" if v < 1e-12 else f"{v:.4g}" for v in r.singular_values) or "no rows"
    exact = "not decided exactly (coupled steering)" if r.exact is None else str(r.exact)
    return [name, str(r.value), exact, values, f"{r.margin:.2g}" if r.value else "—"]


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
            "The couplings cut the set of admissible twists; its dimension is what steering and driving share between "
            "them, and takes the place of rank C<sub>1s</sub> in (3.41)."
        ]
    return [
        "The book writes rank C<sub>1s</sub> in (3.41). Wheels whose axles are bound to meet in one point "
        "must not be counted twice, so the rank that steering adds to C<sub>1f</sub> is what counts."
    ]


def _generic(d: Derivation) -> list[str]:
    """Where the values of the parameters make a rank that other values would not."""
    if not d.robot.parameters or len(d.robot.wheels) > CAP:
        return []
    other: dict[str, Poly] = {}
    for k, p in enumerate(d.robot.parameters):
        free = p.symbolic.constant is not None
        other[p.name] = Poly.of(p.nominal * Fraction(101 + 7 * k, 97)) if free else p.symbolic
    letters, numbers = d.constraints, constrain(d.robot, nominal_view)
    pairs = [("C<sub>1f</sub>", letters.sliding_fixed, numbers.sliding_fixed)]
    if not any(w.turns for w in d.robot.wheels):
        pairs.append(("J₁", letters.rolling, numbers.rolling))
    blocks = []
    for name, own, nominal in pairs:
        general, here = decide(_numbers(own, other)).value, decide(_numbers(nominal, {})).value
        if general != here:
            blocks += [
                f"The rank of {name} is {here} for the values given, but {general} for parameters in general: two "
                "lengths happen to be equal."
            ]
    return blocks


def _numbers(rows: Sequence[ConstraintRow], values: dict[str, Poly]) -> list[tuple[Exact, ...]]:
    return [tuple(fix(p, values).constant or ZERO for p in r.row) for r in rows]


def _growth(d: Derivation) -> tuple[tuple[int, ...], str]:
    """The growth vector, and what is said of trailers."""
    if not d.robot.trailers:
        return d.mobility.growth_vector, ""
    try:
        return tuple(d.growth.vector), ", trailers included"
    except NotDerivableError:
        return d.mobility.growth_vector, ", trailers left out"


def _verdicts(d: Derivation) -> list[str]:
    m, yes = d.mobility, {True: "yes", False: "no"}
    vector, states = _growth(d)
    rows = [
        ["differentiable degrees of freedom", str(m.ddof),
         "DDOF = δ<sub>m</sub>: velocities that can be chosen at once"],
        ["degrees of freedom", str(m.dof),
         "dimension of the Lie algebra of all admissible twists: poses that can be reached"],
        ["growth vector", f"({', '.join(map(str, vector))})",
         f"dimensions spanned by the inputs, then with their brackets, one order at a time{states}"],
        ["degree of nonholonomy", str(len(vector)),
         "bracket orders needed to reach everything, 1 being none"],
        ["holonomic", yes[m.holonomic], "DDOF = DOF"],
        ["omnidirectional", yes[m.omnidirectional], "DDOF = 3"],
        ["type (δ<sub>m</sub>, δ<sub>s</sub>)", f"({m.degree_of_mobility}, {m.degree_of_steerability})",
         "degenerate" if m.degenerate else "one of Campion's five"],
    ]  # fmt: skip
    return table(["property", "value", "meaning"], rows, "l")


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
        "Integrability:",
        f"The sliding row of {some(wheels)} is c(q) q̇ = 0 in the coordinates q = (x, y, θ) of the world{held}, "
        "with χ the direction in which the wheel rolls, seen from the world, and k the third entry of its row. "
        "Frobenius asks for c · curl c:",
        *aligned([
            r"c &= \begin{bmatrix} -\sin\chi & \cos\chi & k \end{bmatrix}",
            r"\mathrm{curl}\,c &= \begin{bmatrix} \sin\chi & -\cos\chi & 0 \end{bmatrix}",
            rf"c\cdot\mathrm{{curl}}\,c &= -\sin^2\chi - \cos^2\chi = {value}",
        ]),
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


def singular(d: Derivation) -> list[str]:
    """Section 9."""
    blocks = ["## 9 Singular configurations"]
    if not d.mobility.singularities:
        return [*blocks, "There are none: no rank drops and no angle is undefined, whatever the robot does."]
    pivots = [s for s in d.mobility.singularities if s.kind == "icr_on_pivot"]
    blocks += _pivots(d, pivots) if pivots else []
    for s in d.mobility.singularities:
        if s.kind != "icr_on_pivot":
            blocks += [capitalised(s.meaning) + (" This happens where" if s.conditions else "")]
            blocks += _conditions(s.conditions) if s.conditions else []
    return blocks


def _pivots(d: Derivation, pivots: list[Singularity]) -> list[str]:
    """A steered wheel whose pivot is the ICR."""
    wheels = [d.robot.wheel(s.wheels[0]) for s in pivots[:CAP]]
    places = grouped((f"({plain(w.nominal.x)}, {plain(w.nominal.y)})", w.name) for w in wheels)
    rows = [[", ".join(code(n) for n in who), place] for place, who in places.items()]
    blocks = [
        "A steered wheel whose pivot is the ICR stands still. Its heading is undefined there, and `inverse` holds "
        "the present angle. Close by, a small change of the twist asks for a large change of the angle. The "
        "condition is that the pivot's velocity vanishes,",
        *aligned([r"v_x - y\,\omega &= 0", r"v_y + x\,\omega &= 0"]),
        "with the ICR at",
        *table(["wheel", "(x, y)"], rows, "l"),
    ]
    return blocks + ([f"({len(pivots) - CAP} more wheels likewise.)"] if len(pivots) > CAP else [])


def _conditions(conditions: Sequence[Poly | Row]) -> list[str]:
    """Each condition as a sum that is 0, without a common number, and the steering angles where that is so."""
    lines = []
    for c in conditions:
        p = equation(c if isinstance(c, Poly) else dot(c, XI))
        at = roots(p)
        lines.append(f"{wrapped(summands(terms(p)))} &= 0" + (f", & {at}" if at else ""))
    return aligned(lines)
