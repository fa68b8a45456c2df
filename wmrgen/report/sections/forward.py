"""Write section 7 and the forward kinematics of the result: from measured joints to the twist, by least squares.

Section 7 explains the measurements H ξ = z and their solution. The result shows the twist itself: in the named lengths
of the robot file if that is short, else with the numbers of this robot, else as the rule that gives it.
"""

from __future__ import annotations

import operator
from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import combinations

from wmrgen.analysis.kinematics.least_squares import Measured, normal_equations
from wmrgen.analysis.kinematics.records import substituted
from wmrgen.analysis.kinematics.rigid import spread
from wmrgen.analysis.kinematics.sensing import Measurements, generic_rank, measurements
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import XI
from wmrgen.geometry.exact.evaluate import number, parameters_in, sqrt_poly
from wmrgen.geometry.exact.linalg import Matrix, adjugate, determinant
from wmrgen.geometry.exact.lowest import common_divisor, divided, quotient, related, shorter, unrelated
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly, dot, has_angles, triple
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.geometry.printing import symbol_names
from wmrgen.geometry.symbolic import Expr, Local, expression, times
from wmrgen.report.sections.latex import (
    PAGE,
    WIDE,
    Term,
    latex,
    multiples,
    pulled_out,
    reduced,
    squares,
    summands,
    terms,
    total,
    width,
    with_tangents,
    wrapped,
)
from wmrgen.report.sections.markdown import aligned, cut_note, keyed, math, matrix, packed, some, titled

_ROWS = 12  # rows of a printed H; a matrix of more rows does not fit on a screen
_SHOWN = 2  # contact points that are written out; the others follow in the same way
_STACK = 62  # visible characters of H and z side by side: 900 px; clearpath_do100 has more
_ALONE = 90  # visible characters of a single matrix with its denominator: 900 px; textbook_tricycle has 88
_ENTRY = 12  # terms of an entry of H^T H; determinants of longer entries take seconds to expand
_SUM = 24  # summands of a printed sum; a robot with 64 wheels has more
_TWIST = (
    900  # visible characters of the twist in named lengths: 4 lines for each component, as in agilex_ranger
)
_MOST = 150  # terms of the twist; more than that never fit into `_TWIST` characters
_SHORT = 300  # visible characters of the twist that follows a rule, as in ackermann_car
_DIGITS = 10**6  # numerators and denominators above this are sines of general angles: no help to a reader

_RANK_2 = r"\xi = \frac{1}{c_2}\left(c_1\left(I - \frac{\mathrm{adj}\,M}{c_2}\right) - M\right) H^T z"
_INVARIANTS = r"M = H^T H,\quad c_1 = \mathrm{tr}\,M,\quad c_2 = \mathrm{tr}\,\mathrm{adj}\,M"
_NEAREST = (
    r"\omega = \frac{\sum_i (B_i-\bar{B})\times(w_i-\bar{w})}{\sum_i |B_i-\bar{B}|^2}, \qquad "
    r"v = \bar{w} - \omega\,\hat{z}\times\bar{B}"
)
_SMALLEST = r"\omega = \frac{B \times w}{1 + |B|^2}, \qquad v = w - \omega\,\hat{z}\times B"
_WEIGHTS = keyed(
    "forward.weights",
    "The wheels have weights. A row counts in proportion to its weight divided by the largest weight. With W the "
    "diagonal matrix of these weights, HᵀH and Hᵀz below stand for Hᵀ W H and Hᵀ W z; means and sums over wheels and "
    "the norm of the residual are weighted, too.",
)
_BY_WEIGHT = keyed(
    "forward.weighted_result",
    "Wheels count by their weights: means, sums, HᵀH and Hᵀz are weighted, as in section 7.",
)
_SIGNAL = "It signals slip, a dead encoder or crossed wires."


# ---- Section 7.


def forward(d: Derivation) -> list[str]:
    """Return section 7."""
    measured = _in_order_of_the_book(d.measured, d.robot)
    title = "## 7 Forward kinematics"
    if not measured.rows:
        return [
            title,
            keyed(
                "forward.nothing_sensed",
                "Sensors measure all joint rates of no row of section 2, so no row is known.",
            ),
        ]
    blocks = [title, *_sources(measured)]
    if measured.rigid and (not measured.constant_normal or _as_rigid_motion(d)):
        return [*blocks, *_rigid(d, measured)]
    rows = distinct(measured)
    once = " (an equation that several wheels give is listed once)" if len(rows) < len(measured.rows) else ""
    if measured.constant_normal or any(c.wheel.turns for c in measured.contacts):
        blocks += [f"Stacked{once}, the rows are", *_stacked(rows)]
    else:
        blocks[-1] += (
            " H consists of these rows of section 3. In z, a rolling row has r φ̇ and a sliding row has 0."
        )
    if measured.constant_normal:
        solved = _constant(d, measured, rows)
        return [*blocks, *solved, *titled("Residual", _residual(d, measured)), *cut_note(d.robot.wheels)]
    locals_ = {symbol.name for symbol, _ in d.formula("forward").locals}
    return [
        *blocks,
        *solution_by_rank(generic_rank(measured), "over_c2" in locals_),
        *_three(d, measured),
        f"**Residual.** `slip` is the norm of z − H ξ [m/s]. {_SIGNAL}",
    ]


def pair(robot: Robot) -> list[Wheel]:
    """Return the wheels of a differential drive, the right one first as in Siegwart (3.29); [] for other robots."""
    wheels = [w for w in robot.wheels if w.kind.directed and not w.kind.swivels]
    if len(wheels) != 2 or not all(w.kind.fixed_axle for w in wheels):
        return []
    return sorted(wheels, key=lambda w: (w.pivot / wheels[0].zero_heading).imag)


def _in_order_of_the_book(measured: Measurements, robot: Robot) -> Measurements:
    """Return the measurements; those of a differential drive in the order of Siegwart (3.29)."""
    first = {w.index: k for k, w in enumerate(pair(robot))}
    contacts = sorted(measured.contacts, key=lambda c: first.get(c.wheel.index, 0))
    return measured._replace(contacts=tuple(contacts))


def distinct(measured: Measurements) -> list[Measured]:
    """Return the rows. Equal rows are merged if that leaves three rows, whose solution is the least-squares one."""
    rows = measured.rows
    if measured.weighted or not measured.constant_normal:
        return rows
    own: list[Measured] = []
    for row in rows:
        if not any(row[0] == other[0] and row[1] == other[1] for other in own):
            own.append(row)
        if len(own) > 3:
            break
    if len(own) != 3 or not determinant([list(row) for row, _, _ in own]):
        return rows
    return sorted(own, key=lambda row: not row[1])  # as the book stacks them: rolling before sliding


def rows_as_printed(d: Derivation) -> list[Measured]:
    """Return the rows of H and z in the order of section 7."""
    measured = _in_order_of_the_book(d.measured, d.robot)
    return distinct(measured) if measured.rows else []


def _sources(measured: Measurements) -> list[str]:
    """Say which wheels give which rows."""
    sources = []
    if measured.contacts:
        wheels = [c.wheel for c in measured.contacts]
        offset = any(w.nominal.steer_arm for w in wheels)
        geared = any(w.nominal.per_steer for w in wheels)
        trail = any(w.nominal.d for w in wheels)
        rate = f"(r φ̇ + {'(o − r k)' if geared else 'o'} ψ̇) e" if offset else "r φ̇ e"
        direction = "with e the rolling direction"
        sources.append(
            keyed(
                "forward.both_rows",
                f"{some(wheels)} give{'' if len(wheels) > 1 else 's'} both rows. Rotated into the axes of the robot, "
                f"they are the velocity of the contact point B: v + ω ẑ × B = {rate}{' − d ψ̇ n' if trail else ''}, "
                f"{direction}{' and n = ẑ × e' if trail else ''}.",
            )
        )
    for kind in ("rolling", "sliding"):
        alone = [c.wheel for c in measured.components if c.wheel.kind.sliding_row == (kind == "sliding")]
        if alone:
            verb = "give" if len(alone) > 1 else "gives"
            sources.append(keyed(f"forward.{kind}_only", f"{some(alone)} {verb} only the {kind} row."))
    if measured.gyro is not None:
        sources.append(
            "The gyro gives the row [0 0 1]. To compare its residual in rad/s with the other residuals, it is taken as "
            "a velocity at the mean distance of the sensed wheels from their centre: its weight is "
            f"{float(measured.gyro.weight):.4g} m²."
        )
    weight = "with the weight of its wheel" if measured.weighted else "with equal weight"
    return [
        f"Each row of section 2 whose joint rates are all sensed measures ξ, in m/s, {weight}. {' '.join(sources)}",
        *([_WEIGHTS] if measured.weighted else []),
    ]


def _stacked(rows: list[Measured], index: str = "") -> list[str]:
    """Return H ξ = z: as matrices if they fit on a line, else equation by equation. ``index``: index of H and z."""
    shown = rows[:_ROWS]
    dots = [r"\vdots"] if len(rows) > _ROWS else []
    h = [[latex(p) for p in row] for row, _, _ in shown]
    z = [[latex(value)] for _, value, _ in shown]
    columns = [*zip(*h, strict=True), *zip(*z, strict=True)]
    if sum(max(map(width, column)) for column in columns) <= _STACK:
        both = matrix([*h, *([dots * 3] * len(dots))]), matrix([*z, *([dots] * len(dots))])
        return math(rf"H{index}\,\xi = z{index}, \qquad H{index} = {both[0]}, \qquad z{index} = {both[1]}")
    lines = [f"{wrapped(summands(terms(dot(row, XI))))} &= {latex(value)}" for row, value, _ in shown]
    if any("\n" in line for line in lines):  # a broken sum has to be on the right side
        lines = [f"{latex(value)} &= {wrapped(summands(terms(dot(row, XI))))}" for row, value, _ in shown]
    counted = [
        line + (rf" && (\times {count})" if count > 1 else "") for line, count in Counter(lines).items()
    ]
    return aligned([*counted, *(rf"& {d}" for d in dots)])


def _constant(d: Derivation, measured: Measurements, rows: list[Measured]) -> list[str]:
    """Write the solution if everything except z is known at derivation time."""
    numbers = d.measured_at_nominal
    if len(rows) == 3 and d.determined:
        return _square(d, rows)
    plain = [(triple(map(unrelated, row)), value, weight) for row, value, weight in rows]
    entries = [[shorter(p) for p in row] for row in normal_equations(plain)[0]]
    normal, named = _normal(entries, numbers)
    at_values = "" if named else ", with the numbers of this robot"
    why = "HᵀH does not depend on any joint angle, so it needs to be inverted only once."
    if any(c.wheel.turns for c in measured.contacts):
        why = (
            "The two rows of a wheel are a rotation of [1 0 −y; 0 1 x]. A rotation cancels in HᵀH, so the matrix is "
            "constant at all steering angles, and needs to be inverted only once."
        )
    twist = twist_formulas(d)
    if not d.determined:
        return [
            keyed(
                "forward.unseen",
                "The rows do not determine one direction of the twist, so HᵀH is singular. Several twists explain the "
                f"rates equally well. The smallest of them has the Moore-Penrose inverse of HᵀH{at_values}. {why}",
            ),
            *math(r"\xi = (H^T H)^{+} H^T z, \qquad H^T H =", normal),
            *(["Multiplied out, the twist is", *twist] if twist else []),
        ]
    return [
        keyed(
            "forward.overdetermined",
            "There are more rows than unknowns. |z − H ξ|² is smallest where its gradient, −2 Hᵀ(z − H ξ), is 0, that "
            f"is at HᵀH ξ = Hᵀz{at_values}:",
        ),
        *_least_squares(d, rows, entries, normal, named),
        f"{why}{_softened(measured)}",
        *(["Multiplied out, the twist is", *twist] if twist else []),
    ]


def _softened(measured: Measurements) -> str:
    """Say why least squares may give a twist that fixed wheels forbid; "" if it cannot, or without fixed wheels."""
    if not any(c.wheel.kind.fixed_axle for c in measured.of_wheels):
        return ""
    return keyed(
        "forward.softened",
        " A sliding row of a fixed wheel counts like a measured speed of 0. If the rates contradict each other, the "
        "least total error has a part in this row too, so `forward` may return a twist that fixed wheels forbid.",
    )


def _least_squares(
    d: Derivation, rows: Sequence[Measured], entries: Matrix, normal: str, named: bool
) -> list[str]:
    """Write the least-squares solution with its matrix.

    Args:
        d: the derivation.
        rows: the rows of H, their values and weights.
        entries: HᵀH, `unrelated`.
        normal: HᵀH as LaTeX.
        named: whether ``normal`` has the named parameters.

    Returns:
        HᵀH, and its inverse or (HᵀH)⁻¹Hᵀ in lowest terms if that is short. The last formula is the solution.
    """
    shown = [r"\xi = (H^T H)^{-1} H^T z", f"H^T H =\n{normal}"]
    if named and max(len(p.terms) for row in entries for p in row) <= _ENTRY:
        det = shorter(determinant(entries))
        adj = adjugate(entries)
        inverse = _fraction_matrix(adj, det)
        h = [[unrelated(p) for p in row] for row, _, _ in rows]
        weighted = any(weight != ONE for _, _, weight in rows)
        whole = "" if weighted or has_angles_in(rows) else _fraction_matrix(_times(adj, h), det)
        if whole:
            shown.append(rf"(H^T H)^{{-1}} H^T = {whole}")
        elif inverse:
            shown.append(rf"(H^T H)^{{-1}} = {inverse}")
    return [*packed(shown), *_condition(entries)]


def _times(adj: Sequence[Sequence[Poly]], h: Sequence[Sequence[Poly]]) -> list[list[Poly]]:
    """Return the product of a matrix and the transpose of another one."""
    products = []
    for row in adj:
        products.append([Poly.sum(map(operator.mul, row, other)) for other in h])
    return products


def has_angles_in(rows: Sequence[Measured]) -> bool:
    """Return whether a row depends on a joint angle."""
    return any(has_angles(row) for row, _, _ in rows)


def _fraction_matrix(above: Sequence[Sequence[Poly]], below: Poly) -> str:
    """Return a matrix of polynomials over a common denominator, each entry in lowest terms; "" if it is wide.

    The polynomials may be `unrelated`.
    """
    below = related(below)
    polys = [[related(shorter(p)) for p in row] for row in above]
    flat = [p for row in polys for p in row]
    if not _has_short_numbers([*flat, below]) or not all(_is_easy([p, below]) for p in flat):
        return ""
    entries = [[_quotient(p, below) for p in row] for row in polys]
    if _wide(entries) > _STACK and len(entries[0]) <= 3:  # factors make it shorter, but sympy takes longer
        entries = [[total(terms(reduced(p, below))) if p else "0" for p in row] for row in polys]
    if _wide(entries) <= _STACK or len(entries[0]) > 3:
        return matrix(entries) if _wide(entries) <= _STACK else ""
    shared = common_divisor([*flat, below])
    entries = [[latex(divided(p, shared)) for p in row] for row in polys]
    det = factored(divided(below, shared))
    return rf"\frac{{1}}{{{det}}}{matrix(entries)}" if _wide(entries) + width(det) <= _ALONE else ""


def _quotient(above: Poly, below: Poly) -> str:
    """Return above / below in lowest terms as LaTeX."""
    product = quotient(above, below)
    return total(terms(times(expression(product.factor), expression(product.rest)))) if above else "0"


def _wide(entries: Sequence[Sequence[str]]) -> int:
    """Return the number of visible characters in a line of a matrix."""
    return sum(max(map(width, column)) for column in zip(*entries, strict=True))


def _square(d: Derivation, rows: list[Measured]) -> list[str]:
    """Write the solution of three rows: Siegwart (3.29) and (3.30), or (3.31) if all rows are rolling rows."""
    own = (
        len(d.constraints.rolling) == 3
        and not d.constraints.sliding
        and all(w.sensed for w in d.robot.wheels)
    )
    book = r" = J_1^{-1} J_2\,\dot{\varphi}\;\;(3.31)" if own else ""
    book = book or (r"\;\;(3.30)" if pair(d.robot) else "")
    det = factored(shorter(determinant([[unrelated(p) for p in row] for row, _, _ in rows])))
    shown = [rf"\det H = {det}"] if width(det) <= PAGE else []
    h = [[unrelated(p) for p in row] for row, _, _ in rows]
    inverse = _fraction_matrix(adjugate(h), determinant(h))
    if inverse:
        shown.append(f"H^{{-1}} = {inverse}")
    twist = twist_formulas(d)
    return [
        keyed(
            "forward.square",
            "There are as many rows as unknowns. H has full column rank 3 (Tzafestas (2.7)), that is det H ≠ 0, so the "
            "solution is",
        ),
        *math(r", \qquad ".join([rf"\xi = H^{{-1}} z{book}", *shown])),
        *(["Row by row, this is", *twist] if twist else math(r"\xi = H^{-1} z")),
    ]


def _normal(normal: Matrix, numbers: list[Measured]) -> tuple[str, bool]:
    """Return HᵀH, in the named parameters if that is short, and whether no name was replaced by its value."""
    named = any(p.constant is None for row in normal for p in row if p)
    if named and max(len(p.terms) for row in normal for p in row) <= _ENTRY:
        return matrix([[factored(p) for p in row] for row in normal]), True
    return matrix(normal_equations(numbers)[0]), not named


def _condition(normal: Matrix) -> list[str]:
    """Write the condition on the rank, with its determinant if that is short."""
    words = keyed(
        "forward.full_rank", "This needs an H of full column rank 3 (Tzafestas (2.8a)): det(HᵀH) ≠ 0"
    )
    long = max(len(p.terms) for row in normal for p in row) > _ENTRY
    det = "" if long else factored(shorter(determinant(normal)))
    if long or width(det) > WIDE:
        return [f"{words}."]
    return [f"{words}, with", *math(rf"\det(H^T H) = {det}")]


def factored(p: Poly) -> str:
    """Return a determinant as LaTeX, in factors if its numbers are short. ``p`` may be `unrelated`."""
    p = related(p)
    return total(terms(reduced(p, Poly.of(1)))) if _has_short_numbers([p]) else latex(p)


def _has_short_numbers(polys: Sequence[Poly]) -> bool:
    return all(max(map(abs, (*c.num, c.den))) <= _DIGITS for p in polys for c in p.terms.values())


def fits_of(d: Derivation, *names: str) -> tuple[list[Expr], dict[str, str]]:
    """Return results of ``forward`` as formulas, and the names of their symbols.

    The twist is the one from which the residual is computed.
    """
    formula = d.formula("forward")
    results = {result for call in formula.calls for result in call.results}
    vectors = {symbol: e for symbol, e in formula.locals if symbol in results}
    values = {p.name: e for p, e in formula.outputs}
    values |= {s.name.removesuffix("_fit"): e for s, e in formula.locals if s.name.endswith("_fit")}
    return [substituted(values[name], vectors, {}) for name in names], symbol_names(formula.inputs)


def _residual(d: Derivation, measured: Measurements) -> list[str]:
    """Write the residual of the measurements."""
    if not any(value for port, value in d.formula("forward").outputs if port.name == "slip"):
        return ["The measured rates never contradict each other, so the residual `slip` is 0."]
    if measured.weighted:
        (value,), ports = fits_of(d.in_symbols, "slip")
        slip = "" if value.has(Local) else latex(value, ports)
    else:
        slip = residual(measured.rows)
    return [
        keyed(
            "forward.residual",
            f"The residual `slip` is the norm of z − H ξ [m/s], the part that no twist explains. {_SIGNAL}",
        ),
        *(math(rf"\mathrm{{slip}} = {slip}") if slip and width(slip) <= PAGE else []),
    ]


def residual(rows: Sequence[Measured]) -> str:
    """Return the norm of z − H ξ as LaTeX.

    Four rows of rank 3 have one relation nᵀH = 0. If n is a multiple of numbers, the norm is |nᵀz| / |n|. Otherwise it
    is written as the root of a sum of squares.
    """
    if normal := _relation(rows):
        length = sqrt_poly(Poly.of(sum((c * c for c in normal), ZERO)))
        gap = Poly.sum(value.scale(c) for c, (_, value, _) in zip(normal, rows, strict=True))
        return rf"\left|{latex(gap * length.inverse())}\right|"
    forms = []
    for row, value, _ in rows:
        gap = value - dot(row, XI)
        negative = all(c.sign < 0 for c in gap.terms.values())
        forms.append(-gap if negative else gap)
    return rf"\sqrt{{{' + '.join(multiples(squares(forms)))}}}"


def _relation(rows: Sequence[Measured]) -> list[Exact]:
    """Return numbers n with nᵀH = 0 for four rows of rank 3; [] otherwise, or if n is no multiple of numbers."""
    h = [list(row) for row, _, _ in rows]
    minors = [determinant([*h[:k], *h[k + 1 :]]).scale((-1) ** k) for k in range(4)] if len(h) == 4 else []
    first = next((p for p in minors if p), None)
    if first is None:
        return []
    normal = [p.ordered[0][1] / first.ordered[0][1] if p else ZERO for p in minors]
    return normal if all(p == first.scale(c) for p, c in zip(minors, normal, strict=True)) else []


def _rigid(d: Derivation, measured: Measurements) -> list[str]:
    """Write the rigid motion that is nearest to the measured contact velocities."""
    contacts = measured.contacts
    constant = measured.constant_normal
    blocks = ["In the robot frame, these wheels have the contact point B and the measured velocity w:"]
    if constant:
        blocks = ["B is the place of the wheel in section 1, and w = r φ̇ e is its measured velocity."]
    for c in [] if constant else contacts[:_SHOWN]:
        index = f"_{{{notation.wheel(c.wheel.name)}}}"
        b, w = matrix([[c.bx], [c.by]]), matrix([[c.wx], [c.wy]])
        wide_b = max(width(latex(p)) for p in (c.bx, c.by))
        wide_w = max(width(latex(p)) for p in (c.wx, c.wy))
        both = [f"B{index} &= {b}", f"w{index} &= {w}"]
        blocks += aligned(both if wide_b + wide_w > _STACK else [", & ".join(both)])
    if len(contacts) > _SHOWN and not constant:
        blocks += [f"B and w of {some([c.wheel for c in contacts[_SHOWN:]])} follow in the same way."]
    if len(contacts) == 1:
        return [
            *blocks,
            "Two rows cannot determine three unknowns. The result is the smallest twist that explains both rows, "
            "v + ω ẑ × B = w. It is ξ = Hᵀ(H Hᵀ)⁻¹ w, which gives",
            *math(_SMALLEST),
            "**Residual.** `slip` is 0.",
        ]
    numbers = twist_formulas(d) if measured.constant_normal else []
    divisor = (
        "The denominator cannot vanish, because the pivots are far enough apart. In the code both sums are multiplied "
        "out and the pivots are measured from their mean: products of sines cancel in B<sub>i</sub> × w<sub>i</sub> "
        "and |B<sub>i</sub>|²."
    )
    if spread(measurements(d.robot).contacts) is None:
        divisor = "The code keeps the denominator above 10⁻¹² m²."
    return [
        *blocks,
        "The rigid motion nearest to these velocities minimises Σ |w<sub>i</sub> − v − ω ẑ × B<sub>i</sub>|². Its "
        "derivatives by v and by ω are 0. A bar denotes the mean, and p × q = pₓ q<sub>y</sub> − p<sub>y</sub> qₓ:",
        *aligned([
            r"0 &= \sum_i \left(w_i - v - \omega\,\hat{z}\times B_i\right), \qquad v = \bar{w} - "
            r"\omega\,\hat{z}\times\bar{B}",
            r"0 &= \sum_i B_i\times\left((w_i-\bar{w}) - \omega\,\hat{z}\times(B_i-\bar{B})\right) = "
            r"\sum_i (B_i-\bar{B})\times(w_i-\bar{w}) - \omega\sum_i |B_i-\bar{B}|^2",
        ]),
        "This needs two contact points that are apart: H has rank 3 then (Kelly Box 4.2). Hence",
        *math(_NEAREST),
        *(
            [f"The denominator is constant.{_softened(measured)} In numbers, the twist is", *numbers]
            if numbers
            else [f"**Code.** Only one division is left for run time. {divisor}"]
        ),
        f"**Residual.** `slip` is the norm of all w<sub>i</sub> − v − ω ẑ × B<sub>i</sub> [m/s]. {_SIGNAL}",
    ]  # fmt: skip


def _three(d: Derivation, measured: Measurements) -> list[str]:
    """Write the solution of three rows, if it is short: all rows of bicycle, or rows that have no angles."""
    if generic_rank(measured) < 3 or measured.weighted:
        return []
    chosen = _three_rows(d)
    twist = _solved(d, chosen)
    if not twist:
        return []
    det = latex(determinant([list(row) for row, _, _ in chosen]))
    if len(measured.rows) == 3:
        words = "Three rows make H square, and det(HᵀH) = (det H)². By Cramer's rule the solution is"
    else:
        words = (
            "If the rates agree, three independent rows determine the twist, and the other rows follow from them. "
            "H₃ and z₃ are the rows with the fewest joint angles. By Cramer's rule the solution is"
        )
    index = "" if len(measured.rows) == 3 else "_3"
    shown = [] if index or width(det) > WIDE else math(rf"\det H = {det}")
    return [keyed("forward.three_rows", words), *_stacked(chosen, index), *shown, *twist]


def solution_by_rank(rank: int, may_be_singular: bool) -> list[str]:
    """Write the least-squares twist of rows with joint angles, which is solved at run time.

    Args:
        rank: rank of H at generic joint angles.
        may_be_singular: whether the rank may be lower at some joint angles.

    Returns:
        The blocks of Markdown.
    """
    smallest = math(_RANK_2 + r",\qquad " + _INVARIANTS)
    if rank == 1:
        return [
            keyed(
                "forward.rank_one",
                "The rows measure one direction of the twist only. The smallest twist that explains them is",
            ),
            *math(r"\xi = \frac{H^T z}{\mathrm{tr}\, H^T H}"),
        ]
    if rank == 2:
        return [
            keyed(
                "forward.rank_two",
                "The rows do not determine one direction of the twist. The smallest twist that explains them follows "
                "from the Moore-Penrose inverse of HᵀH:",
            ),
            *smallest,
            "If a second direction is lost, it is Hᵀz / c₁.",
        ]
    inverted = (
        "|z − H ξ|² is smallest where its gradient, −2 Hᵀ(z − H ξ), is 0, that is at HᵀH ξ = Hᵀz. HᵀH depends on the "
        "steering angles, so it is inverted at run time, by cofactors."
    )
    solved = math(r"\xi = (H^T H)^{-1} H^T z")
    if not may_be_singular:
        return [
            inverted,
            *solved,
            keyed(
                "forward.always_regular",
                "The rows of H without steering angles have rank 3 (Tzafestas (2.8a)), so det(HᵀH) cannot be 0.",
            ),
        ]
    return [
        inverted,
        *solved,
        keyed(
            "forward.may_be_singular",
            "This needs an H of full column rank 3 (Tzafestas (2.8a)). At joint angles at which the rows do not "
            "determine one direction, det(HᵀH) vanishes; a singular value below a thousandth of the largest counts as "
            "0. There the smallest twist is taken, by the Moore-Penrose inverse:",
        ),
        *smallest,
        "If a second direction is lost, it is Hᵀz / c₁.",
    ]


# ---- Forward kinematics in the result.


def closed_forward(d: Derivation) -> list[str]:
    """Return the twist of measured joints: written out if the matrix is constant, else the rule that gives it."""
    measured = d.measured
    if not measured.rows:
        return ["No joint is sensed, so nothing is known about the twist: `forward` returns 0."]
    if measured.constant_normal:
        if named := in_named_lengths(d):
            return named
        numbers = _in_numbers(d)
        return [*_rule(d, numbers), *numbers]
    weights = [_BY_WEIGHT] if measured.weighted and len(measured.rows) != 3 else []  # three rows fit exactly
    if measured.rigid:
        return [*_rigid_motion(len(measured.contacts)), *(weights if len(measured.contacts) > 1 else [])]
    best = "The twist that fits all measurements best, with H and z of section 7, is"
    if generic_rank(measured) < 3:
        return [best, *math(r"\xi = (H^T H)^{+} H^T z"), *weights]
    three = _from_three_rows(d)
    if not three:
        return [best, *math(r"\xi = (H^T H)^{-1} H^T z"), *weights]
    if len(measured.rows) == 3:
        return three
    return [
        keyed(
            "forward.if_consistent",
            "The twist that fits all measurements best is ξ = (HᵀH)⁻¹ Hᵀz, with H and z of section 7. If the "
            "measurements agree (`slip` is 0), this is",
        ),
        *three,
        *weights,
    ]


def twist_formulas(d: Derivation) -> list[str]:
    """Return the twist of a constant matrix as the result has it, without the values of its factors; [] if long."""
    return (in_named_lengths(d) or _in_numbers(d))[:1]


def in_named_lengths(d: Derivation) -> list[str]:
    """Return the twist in the named lengths and angles if that is short, and the values of its factors."""
    products = d.twist_in_symbols
    if products is None or sum(len(p.rest.terms) for p in products) > _MOST:
        return []
    ports = symbol_names(d.formula("forward").inputs)
    sums = [terms(times(expression(p.factor), expression(p.rest)), ports) for p in products]
    shown = _written(sums, _TWIST)
    if not shown:
        return []
    nominal = {p.name: p.value for p in d.robot.parameters}
    values = [number(p.factor, nominal) for p in products]
    heading = (latex(expression(p.factor)).removeprefix("-") for p in products)
    factors = {head: abs(value) for head, value in zip(heading, values, strict=True)}
    return [*shown, *values_of_factors(d, list(zip(TWIST_NAMES, sums, strict=True)), factors)]


def _in_numbers(d: Derivation) -> list[str]:
    """Return the twist as the code computes it; [] if the code does so in several steps."""
    fits, ports = fits_of(d, *TWIST_NAMES)
    if any(fit.has(Local) for fit in fits):
        return []
    lines, sums = [], []
    for name, fit in zip(TWIST_NAMES, fits, strict=True):
        sums.append((name, terms(fit, ports)))
        parts = summands(sums[-1][1])
        shown = [*parts[:_SUM], r"+\cdots"] if len(parts) > _SUM else parts
        lines.append(f"{notation.port(name)} &= {wrapped(shown)}")
    return [*aligned(lines), *values_of_factors(d, sums)]


def _rigid_motion(contacts: int) -> list[str]:
    """Write the rule for the rigid motion that is nearest to the velocities of contact points."""
    if contacts == 1:
        return [
            "The smallest twist (v, ω) that explains the velocity w of the contact point B (both in section 7) is",
            *math(_SMALLEST),
        ]
    return [
        "The result is the rigid motion (v, ω) nearest to the velocities w that the wheels measure at their contact "
        "points B. A bar denotes the mean over the wheels; section 7 has B and w.",
        *math(_NEAREST),
    ]


def _rule(d: Derivation, numbers: list[str]) -> list[str]:
    """Write the rule behind ``numbers`` if these hide named lengths (jpl_osr), or if there are no numbers."""
    measured = d.measured
    if numbers and not (d.determined and _has_names(measured)):
        return []
    below = " Below it is the same with the numbers of this robot." if numbers else ""
    if not d.determined:
        return [
            "The smallest twist that fits all measurements best, with H and z of section 7, is",
            *math(r"\xi = (H^T H)^{+} H^T z"),
        ]
    if not _as_rigid_motion(d):
        square = len(distinct(measured)) == 3
        return [
            f"The twist that fits all measurements best is computed from H and z of section 7.{below}",
            *math(r"\xi = H^{-1} z" if square else r"\xi = (H^T H)^{-1} H^T z"),
        ]
    return [
        keyed(
            "forward.rigid_rule",
            "The result is the rigid motion (v, ω) nearest to the velocities w = r φ̇ e that the wheels measure at "
            f"their contact points B. Here e is the rolling direction, and a bar denotes the mean over the wheels."
            f"{below}",
        ),
        *math(_NEAREST),
    ]


def _has_names(measured: Measurements) -> bool:
    """Return whether a named parameter occurs in a row."""
    return any(parameters_in(p) for row, value, _ in measured.rows for p in (*row, value))


def _as_rigid_motion(d: Derivation) -> bool:
    """Return whether the result has the rule for the nearest rigid motion because named lengths are too long."""
    measured = d.measured
    plain = measured.constant_normal and measured.rigid and not measured.weighted
    return plain and d.determined and _has_names(measured) and not in_named_lengths(d)


def _from_three_rows(d: Derivation) -> list[str]:
    """Return the twist that three rows determine, by Cramer's rule, if it is short, as in ackermann_car."""
    return _solved(d, _three_rows(d))


def _three_rows(d: Derivation) -> list[Measured]:
    """Return three independent rows, those without joint angles first; [] if there are none.

    If all rows agree, the other rows add nothing.
    """
    rows, nominal = d.measured.rows, d.measured_at_nominal
    order = sorted(range(min(len(rows), _ROWS)), key=lambda k: has_angles((*rows[k][0], rows[k][1])))

    def are_independent(three: Sequence[int]) -> bool:
        return bool(determinant([list(nominal[k][0]) for k in three]))

    three = next(filter(are_independent, combinations(order, 3)), ())
    return [rows[k] for k in three]


def _solved(d: Derivation, chosen: Sequence[Measured]) -> list[str]:
    """Return the solution of three rows by Cramer's rule; [] if it is long."""
    h, z = [list(row) for row, _, _ in chosen], [value for _, value, _ in chosen]
    below = determinant(h)
    if not chosen or not below or not _has_short_numbers([*z, *(p for row in h for p in row)]):
        return []
    above = []
    for row in adjugate(h):
        above.append(Poly.sum(a * b for a, b in zip(row, z, strict=True)))
    ports = symbol_names(d.formula("forward").inputs)
    if len(below.terms) == 1:
        return _written([with_tangents(terms(p * below.inverse())) for p in above], _SHORT)
    if not _is_easy([*above, below]):
        return []
    return _written([with_tangents(terms(reduced(p, below), ports)) for p in above], _SHORT)


def _is_easy(polys: Sequence[Poly]) -> bool:
    """Return whether sympy finds common factors at once, as in f1tenth. With roots it takes a minute."""
    roots = any(g.kind == "sqrt" for p in polys for g in p.generators)
    rational = all(c.is_rational for p in polys for c in p.terms.values())
    return rational and not roots and sum(len(p.terms) for p in polys) <= 2 * _ENTRY


def _written(sums: Sequence[Sequence[Term]], most: int) -> list[str]:
    """Return the components of the twist; [] if they have more than ``most`` visible characters."""
    texts = [wrapped(summands(summed)) for summed in sums]
    if width("".join(texts)) > most:
        return []
    return aligned(f"{notation.port(n)} &= {t}" for n, t in zip(TWIST_NAMES, texts, strict=True))


def values_of_factors(
    d: Derivation, sums: Sequence[tuple[str, Sequence[Term]]], known: Mapping[str, Exact] | None = None
) -> list[str]:
    """Write the common factors of sums of wheel speeds as numbers: r / (4 (a + b)) = 125/4954 ≈ 0.02523.

    Args:
        d: the derivation.
        sums: component of the twist, by its name, and its terms.
        known: values of factors, by their LaTeX. Other values are evaluated.

    Returns:
        A formula with one equation for each factor, or [] if there is none.
    """
    ports = {notation.port(p.name): p.name for p in d.formula("forward").inputs}
    equal: dict[str, str] = {}
    for name, summed in sums:
        size, common, rest = pulled_out(summed) if len(summed) > 1 else (ONE, (), ())
        lone = [t for t in rest if len(t.factors) == 1 and t.factors[0].base in ports and abs(t.number) == 1]
        head = total([Term(abs(size), common)])
        value = (known or {}).get(head)
        if head == "1" or not (lone or value):
            continue
        value = value or abs(d.evaluate("forward", {ports[lone[0].factors[0].base]: ONE})[name])
        shown = _equal_to(value, head)
        if shown:
            equal[head] = shown
    return math(r", \qquad ".join(f"{head} {value}" for head, value in equal.items())) if equal else []


def _equal_to(value: Exact, head: str) -> str:
    """Return ``= 0.25`` or ``= 125/4954 ≈ 0.0252321``, to be written after ``head``; "" if it repeats ``head``."""
    above, below, _ = notation.magnitude(value)
    fraction = rf"\frac{{{above or 1}}}{{{below}}}" if below else ""
    exact = notation.terminating(value.parts[0]) if value.is_rational else None
    if exact:
        return f"= {exact}" if head not in (exact, fraction) else ""
    equal = f"= {fraction} " if value.is_rational and fraction not in ("", head) else ""
    decimal = notation.decimal(float(value))
    return rf"{equal}\approx {decimal}" if decimal != head else ""
