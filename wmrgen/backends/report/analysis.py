"""Section 5: the mobility argument in words and ranks, and whether the sliding equations can be integrated."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from wmrgen.backends.report.markdown import aligned, items, sentence, table
from wmrgen.backends.report.subject import Subject, some
from wmrgen.exact.evaluate import fix
from wmrgen.exact.number import ZERO, Exact
from wmrgen.exact.poly import Poly
from wmrgen.mobility.ranks import decide
from wmrgen.mobility.records import TOLERANCE

if TYPE_CHECKING:
    from wmrgen.constraints import ConstraintRow
    from wmrgen.layout.records import Wheel
    from wmrgen.mobility.records import Mobility, Rank


def analysis(s: Subject) -> list[str]:
    """Section 5."""
    m = s.mobility
    blocks = ["## 5 Mobility", "The argument:"]
    blocks += items(map(sentence, m.reasons), lambda k: f"{k}.")
    steered = any(w.kind.steers for w in s.robot.wheels)
    blocks += [
        "In ranks" + (", taken at a steering for which all axles agree on one ICR:" if steered else ":")
    ]
    blocks += table(
        ["matrix", "rank", "rank in exact arithmetic", "singular values", "margin"],
        [_rank("C<sub>1f</sub>", m.rank_C1f), _rank("C₁", m.rank_C1)],
        "lr",
    )
    blocks += [
        f"Rows are scaled to m/s. A singular value counts when it exceeds {TOLERANCE:g} of the largest; the margin "
        "says how many times over the smallest of those does.",
        *_degrees(m),
        *_remark(s),
        *_generic(s),
        "What follows:",
        *_verdicts(m),
        *_integrability(s),
    ]
    blocks += ["Actuation:", *items(f"{sentence(a)}." for a in m.actuation)]
    return blocks


def _rank(name: str, r: Rank) -> list[str]:
    values = ", ".join("0" if v < 1e-12 else f"{v:.4g}" for v in r.singular_values) or "no rows"
    exact = "not decided exactly (coupled steering)" if r.exact is None else str(r.exact)
    return [name, str(r.value), exact, values, f"{r.margin:.2g}" if r.value else "—"]


def _degrees(m: Mobility) -> list[str]:
    rank, total = 3 - m.degree_of_mobility, m.degree_of_maneuverability
    return aligned([
        rf"\delta_m &= 3 - \mathrm{{rank}}\,C_1 = 3 - {rank} = {m.degree_of_mobility} && (3.40)",
        rf"\delta_s &= {_steering(m)} = {m.degree_of_steerability} && (3.41)",
        rf"\delta_M &= \delta_m + \delta_s = {m.degree_of_mobility} + {m.degree_of_steerability} = {total} && (3.42)",
    ])  # fmt: skip


def _plain_steering(m: Mobility) -> bool:
    """True when no coupling cuts the admissible set."""
    return (
        m.admissible.linear and m.admissible.normal is None and m.admissible.dimension == 3 - m.rank_C1f.value
    )


def _steering(m: Mobility) -> str:
    if _plain_steering(m) and m.degree_of_mobility:
        return rf"\mathrm{{rank}}\,C_1 - \mathrm{{rank}}\,C_{{1f}} = {m.rank_C1.value} - {m.rank_C1f.value}"
    return rf"\dim\{{\xi\ \mathrm{{admissible}}\}} - \delta_m = {m.admissible.dimension} - {m.degree_of_mobility}"


def _remark(s: Subject) -> list[str]:
    """Why (3.41) is not taken literally."""
    if not any(w.kind.steers for w in s.robot.wheels):
        return []
    if _plain_steering(s.mobility):
        return [
            "The book writes rank C<sub>1s</sub> in (3.41). Wheels whose axles are bound to meet in one point "
            "must not be counted twice, so the rank that steering adds to C<sub>1f</sub> is what counts."
        ]
    return [
        "The couplings cut the set of admissible twists; its dimension is what steering and driving share between "
        "them, and takes the place of rank C<sub>1s</sub> in (3.41)."
    ]


def _generic(s: Subject) -> list[str]:
    """Where the values of the parameters make a rank that other values would not."""
    if not s.robot.parameters or s.more:
        return []
    values: dict[str, Poly] = {}
    for k, p in enumerate(s.robot.parameters):
        free = p.symbolic.constant is not None
        values[p.name] = Poly.of(p.nominal * Fraction(101 + 7 * k, 97)) if free else p.symbolic
    blocks = []
    pairs = [("C<sub>1f</sub>", s.rows.sliding_fixed, s.values.sliding_fixed)]
    if not any(w.turns for w in s.robot.wheels):
        pairs.append(("J₁", s.rows.rolling, s.values.rolling))
    for name, letters, numbers in pairs:
        other, here = (decide(r).value for r in (_numbers(letters, values), _numbers(numbers, {})))
        if other != here:
            blocks += [
                f"The rank of {name} is {here} for the values given, but {other} for parameters in general: two "
                "lengths happen to be equal."
            ]
    return blocks


def _numbers(rows: Sequence[ConstraintRow], values: dict[str, Poly]) -> list[tuple[Exact, ...]]:
    return [tuple(fix(p, values).constant or ZERO for p in r.row) for r in rows]


def _verdicts(m: Mobility) -> list[str]:
    yes = {True: "yes", False: "no"}
    kind = f"({m.degree_of_mobility}, {m.degree_of_steerability})"
    growth = "(" + ", ".join(str(n) for n in m.growth_vector) + ")"
    rows = [
        ["differentiable degrees of freedom", str(m.ddof),
         "DDOF = δ<sub>m</sub>: velocities that can be chosen at once"],
        ["degrees of freedom", str(m.dof),
         "dimension of the Lie algebra of all admissible twists: poses that can be reached"],
        ["growth vector", growth, "dimensions spanned by the inputs, then with their brackets, one order at a time"],
        ["degree of nonholonomy", str(m.degree_of_nonholonomy),
         "bracket orders needed to reach everything, 1 being none"],
        ["holonomic", yes[m.holonomic], "DDOF = DOF"],
        ["omnidirectional", yes[m.omnidirectional], "DDOF = 3"],
        ["type (δ<sub>m</sub>, δ<sub>s</sub>)", kind, "degenerate" if m.degenerate else "one of Campion's five"],
    ]  # fmt: skip
    return table(["property", "value", "meaning"], rows, "l")


def _integrability(s: Subject) -> list[str]:
    """c . curl c of the sliding rows in world coordinates, and what all rows do together."""
    wheels = [w for w in s.robot.wheels if w.kind.constrains]
    if not wheels:
        return []
    held = ", the steering angle held" if any(w.kind.steers for w in wheels) else ""
    values = {curl_product(w) for w in wheels}
    value = " or ".join(f"{float(v):g}" for v in sorted(values, key=float))
    return [
        "Integrability:",
        f"The sliding row of {some(wheels)} is c(q) q̇ = 0 in the coordinates q = (x, y, θ) of the world{held}, "
        "with h the wheel's heading and k the third entry of its row. Frobenius asks for c · curl c:",
        *aligned([
            r"c &= \begin{bmatrix} -\sin(\theta+h) & \cos(\theta+h) & k \end{bmatrix}",
            r"\mathrm{curl}\,c &= \begin{bmatrix} \sin(\theta+h) & -\cos(\theta+h) & 0 \end{bmatrix}",
            rf"c\cdot\mathrm{{curl}}\,c &= -\sin^2(\theta+h) - \cos^2(\theta+h) = {value}",
        ]),
        "It is not zero, so none of these equations alone is the derivative of a condition on the pose (Tzafestas "
        "(2.25)). " + _together(s),
    ]  # fmt: skip


def curl_product(w: Wheel) -> Exact:
    """c . curl c of a wheel's sliding row, exact: c = R(theta)^T (-sin h, cos h) and its third entry is constant."""
    g = w.nominal
    return -(g.ch * g.ch + g.sh * g.sh)


def _together(s: Subject) -> str:
    m = s.mobility
    if m.ddof == 0:
        return "Together they forbid all motion."
    if m.holonomic:
        return (
            "Together they can be integrated all the same: the brackets of the motions left over give nothing "
            f"new, DOF = DDOF = {m.dof}."
        )
    return f"Nor can they together: brackets of the motions left over reach {m.dof} dimensions, DDOF is {m.ddof}."
