"""Sections 7 and 8: from sensed joints to the twist, by least squares; odometry and the posture model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from wmrgen import notation
from wmrgen.backends.report.latex import (
    broken,
    latex,
    matrix,
    summands,
    terms,
    width,
    wrapped,
)
from wmrgen.backends.report.letters import approximate, factored, in_letters, in_wheel_speeds, square
from wmrgen.backends.report.markdown import CAP, aligned, code, cut_note, items, math, some
from wmrgen.constraints import nominal_view, seen, symbolic_view
from wmrgen.exact.linalg import determinant
from wmrgen.exact.poly import Poly
from wmrgen.kinematics.forward import nominal_rank, normal_equations
from wmrgen.kinematics.pose import SWITCH, WORST_ERROR
from wmrgen.kinematics.rigid import spread
from wmrgen.kinematics.sensing import Contact, Measured, Measurements, generic_rank, measurements
from wmrgen.ports import TWIST_NAMES
from wmrgen.printing import symbol_names

if TYPE_CHECKING:
    from wmrgen.robot import Derivation

_TERMS = 24  # summands of a printed formula
_ROWS = 14  # rows of a printed H
_ENTRY = 12  # terms of an entry of H^T H: a determinant of longer ones is not worth expanding
_DET = 70  # glyphs of a printed determinant
_SLIP = 420  # characters of a printed residual
_RANK_2 = r"\xi = \frac{1}{c_2}\left(c_1\left(I - \frac{\mathrm{adj}\,M}{c_2}\right) - M\right) H^T z"
_WEIGHTS = (
    "Below, a row counts as often as its weight over the largest weight says: HᵀH and Hᵀz are Hᵀ W H and Hᵀ W z, means "
    "and sums over wheels are weighted, and so is the norm of the residual, W being the diagonal matrix of the weights."
)
_INVARIANTS = r"M = H^T H,\quad c_1 = \mathrm{tr}\,M,\quad c_2 = \mathrm{tr}\,\mathrm{adj}\,M"


def forward(d: Derivation) -> list[str]:
    """Section 7."""
    measured = measurements(seen(d.robot, symbolic_view))
    blocks = ["## 7 Forward kinematics"]
    if not measured.rows:
        return [*blocks, "No joint is sensed, so nothing is known of the twist: `forward` returns 0."]
    blocks += _sources(measured)
    if not measured.constant_normal and not measured.components:
        return [*blocks, *_rigid(d, measured.contacts)]
    blocks += ["Stacked,", *_stacked(measured.rows)]
    if measured.constant_normal:
        return [*blocks, *_constant(d, measured.rows), *_closed(d), *cut_note(d.robot.wheels)]
    locals_ = {symbol.name for symbol, _ in d.program.formula("forward").locals}
    return [
        *blocks,
        *_solution(generic_rank(measured), "over_c2" in locals_),
        "The residual `slip`, the norm of z − H ξ [m/s], is a signal for slip, a dead encoder or crossed wires.",
    ]


def _sources(measured: Measurements) -> list[str]:
    """Which rows are known of which wheels."""
    sources = []
    if measured.contacts:
        wheels = [c.wheel for c in measured.contacts]
        moving = any(w.nominal.d or w.nominal.o for w in wheels)
        sources.append(
            f"{some(wheels)} give{'' if len(wheels) > 1 else 's'} both rows. Turned into the robot's axes they say "
            "how fast the contact point B moves: v + ω ẑ × B = "
            + ("(r φ̇ + o ψ̇) e − d ψ̇ n" if moving else "r φ̇ e")
            + ", with e the rolling direction"
            + (" and n = ẑ × e." if moving else ".")
        )
    for kind in ("rolling", "sliding"):
        alone = [c.wheel for c in measured.components if c.wheel.kind.sliding_row == (kind == "sliding")]
        if alone:
            sources.append(f"{some(alone)} give{'' if len(alone) > 1 else 's'} the {kind} row alone.")
    return [
        "Every row of section 2 whose joint rates are all sensed is one measurement of ξ, in m/s, with "
        f"{'the weight of its wheel' if measured.weighted else 'equal weight'}. Passive castors and balls give none.",
        *items(sources),
        *([_WEIGHTS] if measured.weighted else []),
    ]


def _stacked(rows: list[Measured]) -> list[str]:
    """H xi = z."""
    dots = [r"\vdots"] if len(rows) > _ROWS else []
    h = [[latex(p) for p in row] for row, _, _ in rows[:_ROWS]] + [dots * 3] * len(dots)
    z = [[latex(value)] for _, value, _ in rows[:_ROWS]] + [dots] * len(dots)
    if sum(max(map(width, column)) for column in zip(*h, strict=True)) > 30:
        return aligned([r"H\,\xi &= z", f"H &= {matrix(h)}", f"z &= {matrix(z)}"])
    return math(rf"H\,\xi = z, \qquad H = {matrix(h)}, \qquad z = {matrix(z)}")


def _constant(d: Derivation, rows: list[Measured]) -> list[str]:
    """Everything but z is known at derivation time."""
    measured = measurements(seen(d.robot, nominal_view))
    normal, _ = normal_equations(measured.rows)
    singular = nominal_rank(measured.rows, d.robot).value < 3
    why = "The matrix does not depend on any joint angle."
    if any(c.wheel.turns for c in measured.contacts):
        why = (
            "The two rows of a wheel are a rotation of [1 0 −y; 0 1 x], and a rotation drops out of HᵀH: the "
            "matrix is constant whatever the steering does."
        )
    if singular:
        return [
            "The rows leave a direction unseen, so that HᵀH is singular. Of all twists that explain the rates best the "
            "smallest is, with the Moore-Penrose inverse of HᵀH,",
            *math(r"\xi = (H^T H)^{+} H^T z, \qquad H^T H =", matrix(normal)),
            f"{why} Its Moore-Penrose inverse was computed once, for this page. The result, as the code computes it:",
        ]
    if len(rows) == 3:
        return [*square(d, rows), *in_letters(d, rows), "The result, as the code computes it:"]
    return [
        "More rows than unknowns: the least-squares solution is",
        *math(r"\xi = (H^T H)^{-1} H^T z, \qquad H^T H =", matrix(normal)),
        f"{why} It was inverted once, for this page.",
        *_condition(rows),
        *in_letters(d, rows),
        "The result, as the code computes it:",
    ]


def _condition(rows: list[Measured]) -> list[str]:
    """The condition on the rank, and the determinant that it is about where that is short."""
    words = "The condition is that H has full column rank 3 (Tzafestas (2.8a)), det(HᵀH) ≠ 0"
    normal, _ = normal_equations(rows)
    long = max(len(p.terms) for row in normal for p in row) > _ENTRY
    det = "" if long else factored(determinant(normal))
    if long or width(det) > _DET:
        return [f"{words}."]
    return [f"{words}:", *math(rf"\det(H^T H) = {det}")]


def _closed(d: Derivation) -> list[str]:
    """The outputs of ``forward`` and what its residual means."""
    formula = d.program.formula("forward")
    ports = symbol_names(formula.inputs)
    results = {result for call in formula.calls for result in call.results}
    vectors = {symbol: e for symbol, e in formula.locals if symbol in results}
    outputs = {p.name: e.xreplace(vectors) for p, e in formula.outputs}
    fits = {symbol.name.removesuffix("_fit"): e.xreplace(vectors) for symbol, e in formula.locals}
    lines = []
    for name in TWIST_NAMES:
        summed = terms(fits.get(name, outputs[name]), ports)
        parts = summands(summed)
        shown = [*parts[:_TERMS], r"+\cdots"] if len(parts) > _TERMS else parts
        lines.append(f"{notation.port(name)} &= {wrapped(shown)}{approximate(summed)}")
    slip = latex(outputs["slip"], ports)
    if slip == "0":
        return [*aligned(lines), "The rates can never contradict each other, so the residual `slip` is 0."]
    return [
        *aligned(lines),
        "What no twist can explain is the residual, a signal for slip, a dead encoder or crossed wires: `slip` is "
        "the norm of z − H ξ [m/s].",
        *(math(rf"\mathrm{{slip}} = {slip}") if len(slip) < _SLIP else []),
    ]


def _rigid(d: Derivation, contacts: Sequence[Contact]) -> list[str]:
    """Rigid motion through measured contact velocities."""
    blocks = ["Contact point B and measured velocity w of each of these wheels, in the robot frame:"]
    for c in contacts[:3]:
        index = f"_{{{notation.wheel(c.wheel.name)}}}"
        b, w = matrix([[c.bx], [c.by]]), matrix([[c.wx], [c.wy]])
        wide = sum(max(width(latex(p)) for p in pair) for pair in ((c.bx, c.by), (c.wx, c.wy))) > 55
        both = [f"B{index} &= {b}", f"w{index} &= {w}"]
        blocks += aligned(both if wide else [", & ".join(both)])
    if len(contacts) > 3:
        blocks += [f"{', '.join(code(c.wheel.name) for c in contacts[3:CAP])} likewise."]
    if len(contacts) == 1:
        return [
            *blocks,
            "Two rows cannot determine three unknowns. The smallest twist that explains them is",
            *math(r"\omega = \frac{B \times w}{1 + |B|^2}, \qquad v = w - \omega\,\hat{z}\times B"),
            "and the residual `slip` is 0.",
        ]
    divisor = (
        "its denominator cannot vanish, for the pivots stand far enough apart. The code has both sums multiplied "
        "out, with the pivots measured from their mean: B<sub>i</sub> × w<sub>i</sub> and |B<sub>i</sub>|² then "
        "lose their products of sines."
    )
    if spread(measurements(d.robot).contacts) is None:
        divisor = "its denominator is kept above 10⁻¹² m²."
    return [
        *blocks,
        "The rigid motion nearest to them is found as if by hand: take the means away, fit the rotation to what "
        "is left, then the translation to the means.",
        *aligned([
            r"\bar{B} &= \frac{1}{n}\sum_i B_i, \qquad \bar{w} = \frac{1}{n}\sum_i w_i",
            r"\omega &= \frac{\sum_i (B_i-\bar{B})\times(w_i-\bar{w})}{\sum_i |B_i-\bar{B}|^2}",
            r"v &= \bar{w} - \omega\,\hat{z}\times\bar{B}",
        ]),
        "This needs two contact points apart from each other, H of rank 3 (Kelly Box 4.2). Here n = "
        f"{len(contacts)} and a × b = aₓ b<sub>y</sub> − a<sub>y</sub> bₓ. One division is all that is left for "
        f"run time; {divisor} The residual `slip`, the norm of all w<sub>i</sub> − v − ω ẑ × B<sub>i</sub> "
        "[m/s], is a signal for slip, a dead encoder or crossed wires.",
    ]  # fmt: skip


def _solution(rank: int, may_fall: bool) -> list[str]:
    """The least-squares twist from the rank that the rows have in general."""
    if rank == 1:
        return [
            "The rows see one direction only. The smallest twist that explains them is",
            *math(r"\xi = \frac{H^T z}{\mathrm{tr}\, H^T H}"),
        ]
    smallest = math(_RANK_2 + r",\qquad " + _INVARIANTS)
    if rank == 2:
        return [
            "The rows leave one direction unseen. The smallest twist that explains them follows from the "
            "Moore-Penrose inverse of HᵀH,",
            *smallest,
            "and is Hᵀz / c₁ where a second direction is lost.",
        ]
    blocks = [
        "HᵀH moves with the steering, so it is inverted at run time, by cofactors:",
        *math(r"\xi = \frac{\mathrm{adj}(H^T H)\,H^T z}{\det(H^T H)}"),
    ]
    if not may_fall:
        return [
            *blocks,
            "The rows that do not steer have rank 3 by themselves, so H keeps the full column rank 3 that this "
            "needs (Tzafestas (2.8a)): det(HᵀH) cannot vanish.",
        ]
    return [
        *blocks,
        "This needs H of full column rank 3 (Tzafestas (2.8a)). Where the rows leave a direction unseen, det(HᵀH) "
        "vanishes (a singular value under a thousandth of the largest counts as none). There the smallest twist "
        "is taken, by the Moore-Penrose inverse",
        *smallest,
        "and Hᵀz / c₁ where a second direction is lost.",
    ]


def motion(d: Derivation) -> list[str]:
    """Section 8."""
    switch = rf"\frac{{{SWITCH.numerator}}}{{{SWITCH.denominator}}}"
    return [
        "## 8 Odometry and the posture model",
        "A constant twist moves P along an arc. Its chord points along the heading half-way through, and is "
        "shorter than the arc by the factor sin σ / σ. With σ = ω Δt / 2 the pose after Δt is exactly",
        *aligned([
            r"x' &= x + \Delta t\,\mathrm{sinc}(\sigma)\left(v_x\cos(\theta+\sigma) - v_y\sin(\theta+\sigma)\right)",
            r"y' &= y + \Delta t\,\mathrm{sinc}(\sigma)\left(v_x\sin(\theta+\sigma) + v_y\cos(\theta+\sigma)\right)",
            r"\theta' &= \theta + \omega\,\Delta t",
        ]),
        "Near σ = 0 its series takes the place of the quotient, which makes the step smooth through ω = 0:",
        *math(
            r"\mathrm{sinc}(\sigma) = \begin{cases} 1 - \frac{\sigma^2}{6} + \frac{\sigma^4}{120}",
            rf"- \frac{{\sigma^6}}{{5040}} & |\sigma| < {switch} \\[4pt]",
            r"\frac{\sin\sigma}{\sigma} & \mathrm{else} \end{cases}",
        ),
        "The first term left out is σ⁸/9!, so the worst error is",
        *math(rf"\frac{{1}}{{9!}}\left({switch}\right)^8 = {notation.decimal(float(f'{WORST_ERROR:.2e}'))},"),
        "less than one unit in the last place of a double just below 1, 2⁻⁵³.",
        *_posture(d),
    ]  # fmt: skip


def _posture(d: Derivation) -> list[str]:
    columns = d.mobility.null_space
    if not columns:
        return ["Nothing can move without sliding, so the posture model is empty: all rates are 0."]
    etas = [Poly.gen("input", f"eta{k}") for k in range(1, len(columns) + 1)]
    rates = [Poly.sum(c[i] * eta for c, eta in zip(columns, etas, strict=True)) for i in range(3)]
    steering = " and ".join(code(n) for n in d.mobility.basis_wheels)
    general = [
        "The continuous model that a predictive controller integrates (`dynamics`) takes the coordinates η of the "
        "twist in the null space" + (" and the steering rates" if steering else "") + " as inputs:",
        *math(r"\frac{d}{dt}\begin{bmatrix} x \\ y \\ \theta \end{bmatrix} = R(\theta)^T N\,\eta"
              + (r", \qquad \frac{d}{dt}\psi_i = \dot{\psi}_i" if steering else "")),
    ]  # fmt: skip
    in_eta = [
        "With the values of section 1, each column scaled as in `dynamics`:",
        *aligned(f"{notation.port(n)} &= {broken(p)}" for n, p in zip(TWIST_NAMES, rates, strict=True)),
    ]
    states = (
        f"where the steering of {steering} is the state; any other steered wheel follows through `inverse`."
    )
    return [*general, *(in_wheel_speeds(d) or in_eta), *([states] if steering else [])]
