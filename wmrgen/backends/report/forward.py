"""Section 7: from sensed joints to the twist, by least squares."""

from __future__ import annotations

from wmrgen import notation
from wmrgen.backends.report.expr import terms
from wmrgen.backends.report.markdown import aligned, code, items, math
from wmrgen.backends.report.subject import CAP, Subject, cut_note, some
from wmrgen.backends.report.tex import broken, matrix, poly, summands, total, width
from wmrgen.exact.linalg import determinant
from wmrgen.exact.poly import Poly, Row
from wmrgen.kinematics.forward import constant_normal
from wmrgen.kinematics.rigid import spread
from wmrgen.kinematics.sensing import Component, Contact, measurements
from wmrgen.kinematics.smallest import generic_rank
from wmrgen.printing import symbol_names

_TERMS = 24  # summands of a printed formula
_PSEUDO = " (as a pseudo-inverse, because it is singular: the smallest twist that explains the rates)."
_ROWS = 14  # rows of a printed H
_ENTRY = 12  # terms of an entry of H^T H: a determinant of longer ones is not worth expanding
_DET = 70  # glyphs of a printed determinant


def forward(s: Subject) -> list[str]:
    """Section 7."""
    contacts, components = measurements(s.letters)
    blocks = ["## 7 Forward kinematics"]
    if not contacts and not components:
        return [*blocks, "No joint is sensed, so nothing is known of the twist: `forward` returns 0."]
    blocks += _sources(contacts, components)
    if constant_normal(contacts, components):
        return [*blocks, *_constant(s, contacts, components)]
    if not components:
        return [*blocks, *_rigid(s, contacts)]
    return [*blocks, *_general(s, contacts, components)]


def _sources(contacts: list[Contact], components: list[Component]) -> list[str]:
    intro = (
        "What do the sensed joints say about ξ? Every row of section 2 whose joint rates are all known is one "
        "measurement, in m/s, with equal weight. Passive castors and balls say nothing."
    )
    sources = []
    if contacts:
        moving = any(c.wheel.nominal.d or c.wheel.nominal.o for c in contacts)
        speed = "v + ω ẑ × B = " + ("(r φ̇ + o ψ̇) e − d ψ̇ n" if moving else "r φ̇ e")
        sources.append(
            f"Both rows are known of {some([c.wheel for c in contacts])}. Turned into the robot's axes they say "
            f"how fast the contact point B moves: {speed}, with e the rolling direction"
            + (" and n = ẑ × e." if moving else ".")
        )
    for kind, words in (("rolling", "the rolling row"), ("sliding", "the sliding row")):
        alone = [c for c in components if c.wheel.kind.sliding_row == (kind == "sliding")]
        if alone:
            sources.append(f"Only {words} is known of {some([c.wheel for c in alone])}.")
    return [intro, *items(sources)]


def _rows(contacts: list[Contact], components: list[Component]) -> list[tuple[Row, Poly]]:
    one, zero = Poly.of(1), Poly({})
    rows: list[tuple[Row, Poly]] = []
    for c in contacts:
        rows += [((one, zero, -c.by), c.wx), ((zero, one, c.bx), c.wy)]
    return rows + [(c.row, c.value) for c in components]


def _stacked(rows: list[tuple[Row, Poly]]) -> list[str]:
    """H xi = z."""
    dots = [r"\vdots"] if len(rows) > _ROWS else []
    h = [[poly(p) for p in row] for row, _ in rows[:_ROWS]] + [dots * 3] * len(dots)
    z = [[poly(value)] for _, value in rows[:_ROWS]] + [dots] * len(dots)
    if sum(max(width(row[i]) for row in h) for i in range(3)) > 30:
        return aligned([r"H\,\xi &= z", f"H &= {matrix(h)}", f"z &= {matrix(z)}"])
    return math(rf"H\,\xi = z, \qquad H = {matrix(h)}, \qquad z = {matrix(z)}")


def _constant(s: Subject, contacts: list[Contact], components: list[Component]) -> list[str]:
    """Everything but z is known at derivation time."""
    rows = _rows(contacts, components)
    numbers = _rows(*measurements(s.numbers))
    normal = _normal(numbers)
    blocks = ["Stacked,", *_stacked(rows)]
    singular = _singular(normal)
    blocks += [
        f"{_count(len(rows), singular)}: the least-squares solution is",
        *math(r"\xi = (H^T H)^{-1} H^T z, \qquad H^T H =", matrix([[poly(p) for p in row] for row in normal])),
        _why(bool(contacts), any(c.wheel.turns for c in contacts)) + " It is inverted once, here"
        + (_PSEUDO if singular else "."),
        *([] if singular else _condition(rows)),
        "The result, as the code computes it:",
    ]  # fmt: skip
    return [*blocks, *_closed(s), *cut_note(s)]


def _count(rows: int, singular: bool) -> str:
    if singular:
        return "The rows leave a direction unseen"
    return "More rows than unknowns" if rows > 3 else "As many rows as unknowns"


def _condition(rows: list[tuple[Row, Poly]]) -> list[str]:
    """The condition on the rank, and the determinant that it is about where that is short."""
    words = "The condition is that H has full column rank 3 (Tzafestas (2.8a)), det(HᵀH) ≠ 0"
    normal = _normal(rows)
    long = max(len(p.terms) for row in normal for p in row) > _ENTRY
    det = "" if long else poly(determinant(normal))
    if long or width(det) > _DET:
        return [f"{words}."]
    return [f"{words}:", *math(rf"\det(H^T H) = {det}")]


def _normal(rows: list[tuple[Row, Poly]]) -> list[list[Poly]]:
    """H^T H"""
    return [[Poly.sum(r[i] * r[j] for r, _ in rows) for j in range(3)] for i in range(3)]


def _why(pairs: bool, turns: bool) -> str:
    if pairs and turns:
        return (
            "The two rows of a wheel are a rotation of [1 0 −y; 0 1 x], and a rotation drops out of HᵀH: the "
            "matrix is constant whatever the steering does."
        )
    return "The matrix does not depend on any joint angle."


def _singular(normal: list[list[Poly]]) -> bool:
    trace = Poly.sum(normal[i][i] for i in range(3))
    det, size = (float(p.constant or 0) for p in (determinant(normal), trace))
    return abs(det) < 1e-12 * max(size, 1e-30) ** 3


def _closed(s: Subject) -> list[str]:
    """The outputs of ``forward`` and what its residual means."""
    formula = s.derivation.program.formula("forward")
    ports = symbol_names(formula.inputs)
    outputs = {p.name: e for p, e in formula.outputs}
    fits = {symbol.name.removesuffix("_fit"): e for symbol, e in formula.locals}
    lines = []
    for name in ("vx", "vy", "omega"):
        parts = summands(terms(fits.get(name, outputs[name]), ports))
        shown = [*parts[:_TERMS], r"+\cdots"] if len(parts) > _TERMS else parts
        lines.append(f"{notation.port(name)} &= {broken(shown)}")
    return [*aligned(lines), *_residual(outputs["slip"], ports)]


def _residual(slip: object, ports: dict[str, str]) -> list[str]:
    summands = terms(slip, ports)
    if not summands:
        return ["The rates can never contradict each other, so the residual `slip` is 0."]
    text = total(summands)
    blocks = [
        "What no twist can explain is the residual, a signal for slip, a dead encoder or crossed wires: `slip` is "
        "the norm of z − H ξ [m/s]."
    ]
    return blocks + (math(rf"\mathrm{{slip}} = {text}") if len(text) < 420 else [])


def _rigid(s: Subject, contacts: list[Contact]) -> list[str]:
    """Rigid motion through measured contact velocities."""
    blocks = ["Contact point B and measured velocity w of each of these wheels, in the robot frame:"]
    for c in contacts[:3]:
        index = f"_{{{notation.wheel(c.wheel.name)}}}"
        b, w = matrix([[poly(c.bx)], [poly(c.by)]]), matrix([[poly(c.wx)], [poly(c.wy)]])
        wide = sum(max(map(width, map(poly, pair))) for pair in ((c.bx, c.by), (c.wx, c.wy))) > 55
        blocks += aligned(
            [f"B{index} &= {b}", f"w{index} &= {w}"] if wide else [f"B{index} &= {b}, & w{index} &= {w}"]
        )
    if len(contacts) > 3:
        blocks += [f"{', '.join(code(c.wheel.name) for c in contacts[3:CAP])} likewise."]
    if len(contacts) == 1:
        return [
            *blocks,
            "Two rows cannot determine three unknowns. The smallest twist that explains them is",
            *math(r"\omega = \frac{B \times w}{1 + |B|^2}, \qquad v = w - \omega\,\hat{z}\times B"),
            "and the residual `slip` is 0.",
        ]
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
        f"run time; {_divisor(s)} The residual `slip`, the norm of all w<sub>i</sub> − v − ω ẑ × B<sub>i</sub> "
        "[m/s], is a signal for slip, a dead encoder or crossed wires.",
    ]  # fmt: skip


def _divisor(s: Subject) -> str:
    """Why it is not by zero."""
    if spread(measurements(s.robot)[0]) is None:
        return "its denominator is kept above 10⁻¹² m²."
    return (
        "its denominator cannot vanish, for the pivots stand far enough apart. The code has both sums multiplied "
        "out, with the pivots measured from their mean: B<sub>i</sub> × w<sub>i</sub> and |B<sub>i</sub>|² then "
        "lose their products of sines."
    )


_RANK_2 = r"\xi = \frac{1}{c_2}\left(c_1\left(I - \frac{\mathrm{adj}\,M}{c_2}\right) - M\right) H^T z"
_INVARIANTS = r"M = H^T H,\quad c_1 = \mathrm{tr}\,M,\quad c_2 = \mathrm{tr}\,\mathrm{adj}\,M"


def _solution(rank: int, may_fall: bool) -> list[str]:
    """The least-squares twist from the rank that the rows have in general."""
    if rank == 1:
        return [
            "The rows see one direction only. The smallest twist that explains them is",
            *math(r"\xi = \frac{H^T z}{\mathrm{tr}\, H^T H}"),
        ]
    if rank == 2:
        return [
            "The rows leave one direction unseen. The smallest twist that explains them follows from the "
            "Moore-Penrose inverse of HᵀH,",
            *math(_RANK_2 + r",\qquad " + _INVARIANTS),
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
        *math(_RANK_2 + r",\qquad " + _INVARIANTS),
        "and Hᵀz / c₁ where a second direction is lost.",
    ]


def _general(s: Subject, contacts: list[Contact], components: list[Component]) -> list[str]:
    """Cofactors of a 3x3 matrix that moves with the steering."""
    rows = _rows(contacts, components)
    locals_ = {symbol.name for symbol, _ in s.derivation.program.formula("forward").locals}
    blocks = [
        "Stacked,",
        *_stacked(rows),
        *_solution(generic_rank(contacts, components), "over_c2" in locals_),
    ]
    return [
        *blocks,
        "The residual `slip`, the norm of z − H ξ [m/s], is a signal for slip, a dead encoder or crossed wires.",
    ]
