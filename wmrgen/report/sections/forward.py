"""Section 7: from sensed joints to the twist, by least squares."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from wmrgen.analysis.kinematics.least_squares import Measured, normal_equations
from wmrgen.analysis.kinematics.records import substituted
from wmrgen.analysis.kinematics.rigid import spread
from wmrgen.analysis.kinematics.sensing import Contact, Measurements, generic_rank, measurements
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import XI
from wmrgen.geometry.exact.linalg import Matrix, determinant
from wmrgen.geometry.exact.lowest import shorter, unrelated
from wmrgen.geometry.exact.poly import dot, triple
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.printing import symbol_names
from wmrgen.geometry.symbolic import Expr, Local
from wmrgen.report.sections.latex import alike, latex, summands, terms
from wmrgen.report.sections.letters import factored, pair, residual, square
from wmrgen.report.sections.markdown import aligned, cut_note, math, matrix, some
from wmrgen.report.sections.terms import width, wrapped

_ROWS = 14  # rows of a printed H
_STACK = 62  # glyphs of H and z in one line
_SHOWN = 2  # contact points that are written out
_ENTRY = 12  # terms of an entry of H^T H: a determinant of longer ones is not worth expanding
_NORMAL = 50  # glyphs of a row of a printed H^T H
_DET = 70  # glyphs of a printed determinant
_SLIP = 140  # glyphs of a printed residual
_RANK_2 = r"\xi = \frac{1}{c_2}\left(c_1\left(I - \frac{\mathrm{adj}\,M}{c_2}\right) - M\right) H^T z"
_WEIGHTS = (
    "Below, a row counts as often as its weight over the largest weight says: HᵀH and Hᵀz are Hᵀ W H and Hᵀ W z, means "
    "and sums over wheels are weighted, and so is the norm of the residual, W being the diagonal matrix of the weights."
)
_INVARIANTS = r"M = H^T H,\quad c_1 = \mathrm{tr}\,M,\quad c_2 = \mathrm{tr}\,\mathrm{adj}\,M"


def forward(d: Derivation) -> list[str]:
    """Section 7."""
    measured = _stacking(d.measured, d.robot)
    blocks = ["## 7 Forward kinematics"]
    if not measured.rows:
        return [*blocks, "No row of section 2 has joint rates that are all sensed."]
    blocks += _sources(measured)
    if not measured.constant_normal and measured.rigid:
        return [*blocks, *_rigid(d, measured.contacts)]
    rows = distinct(measured)
    once = ", the same equation of several wheels once" if len(rows) < len(measured.rows) else ""
    if measured.constant_normal or any(c.wheel.turns for c in measured.contacts):
        blocks += [f"Stacked{once}, they are", *_stacked(rows)]
    else:
        blocks[-1] += " H has these rows of section 3, and z has r φ̇ for a rolling row, 0 for a sliding row."
    if measured.constant_normal:
        return [*blocks, *_constant(d, measured, rows), *_residual(d, measured), *cut_note(d.robot.wheels)]
    locals_ = {symbol.name for symbol, _ in d.formula("forward").locals}
    return [
        *blocks,
        *_solution(generic_rank(measured), "over_c2" in locals_),
        *_three(measured),
        "The residual `slip`, the norm of z − H ξ [m/s], is a signal for slip, a dead encoder or crossed wires.",
    ]


def _stacking(measured: Measurements, robot: Robot) -> Measurements:
    """The measurements, of a differential drive in the order of the book."""
    first = {w.index: k for k, w in enumerate(pair(robot))}
    contacts = sorted(measured.contacts, key=lambda c: first.get(c.wheel.index, 0))
    return measured._replace(contacts=tuple(contacts))


def distinct(measured: Measurements) -> list[Measured]:
    """The rows, equal ones once where three that can be solved are left: they give what least squares gives."""
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


def _sources(measured: Measurements) -> list[str]:
    """Which rows are known of which wheels."""
    sources = []
    if measured.contacts:
        wheels = [c.wheel for c in measured.contacts]
        offset, geared, trail = (
            any(getattr(w.nominal, key) for w in wheels) for key in ("steer_arm", "per_steer", "d")
        )
        sources.append(
            f"{some(wheels)} give{'' if len(wheels) > 1 else 's'} both rows. Turned into the robot's axes they say "
            "how fast the contact point B moves: v + ω ẑ × B = "
            + (f"(r φ̇ + {'(o − r k)' if geared else 'o'} ψ̇) e" if offset else "r φ̇ e")
            + (" − d ψ̇ n" if trail else "")
            + ", with e the rolling direction"
            + (" and n = ẑ × e." if trail else ".")
        )
    for kind in ("rolling", "sliding"):
        alone = [c.wheel for c in measured.components if c.wheel.kind.sliding_row == (kind == "sliding")]
        if alone:
            sources.append(f"{some(alone)} give{'' if len(alone) > 1 else 's'} the {kind} row alone.")
    if measured.gyro is not None:
        sources.append(
            "The gyro gives the row [0 0 1]. Its residual in rad/s is a velocity at the mean distance of the sensed "
            f"wheels from their middle, so that it has the weight {float(measured.gyro.weight):.4g} m²."
        )
    return [
        "Each row of section 2 whose joint rates are all sensed is a measurement of ξ, in m/s, with "
        f"{'the weight of its wheel' if measured.weighted else 'equal weight'}. {' '.join(sources)}",
        *([_WEIGHTS] if measured.weighted else []),
    ]


def _stacked(rows: list[Measured]) -> list[str]:
    """H xi = z, as matrices where they fit on a line, else equation by equation."""
    shown = rows[:_ROWS]
    dots = [r"\vdots"] if len(rows) > _ROWS else []
    entries = iter(alike([p for row, _, _ in shown for p in row]))
    h = [[next(entries) for _ in row] for row, _, _ in shown]
    z = [[text] for text in alike([value for _, value, _ in shown])]
    if sum(max(map(width, column)) for m in (h, z) for column in zip(*m, strict=True)) <= _STACK:
        both = matrix([*h, *([dots * 3] * len(dots))]), matrix([*z, *([dots] * len(dots))])
        return math(rf"H\,\xi = z, \qquad H = {both[0]}, \qquad z = {both[1]}")
    lines = [f"{wrapped(summands(terms(dot(row, XI))))} &= {latex(value)}" for row, value, _ in shown]
    if any("\n" in line for line in lines):
        lines = [f"{latex(value)} &= {wrapped(summands(terms(dot(row, XI))))}" for row, value, _ in shown]
    times = {n: rf" && (\times {n})" if n > 1 else "" for n in range(len(lines) + 1)}
    return aligned([*(line + times[n] for line, n in Counter(lines).items()), *(rf"& {d}" for d in dots)])


def _constant(d: Derivation, measured: Measurements, rows: list[Measured]) -> list[str]:
    """Everything but z is known at derivation time."""
    numbers = d.measured_at_nominal
    if len(rows) == 3 and d.determined:
        return square(d, rows)
    plain = [(triple(map(unrelated, row)), value, weight) for row, value, weight in rows]
    entries = [[shorter(p) for p in row] for row in normal_equations(plain)[0]]
    normal, named = _normal(entries, numbers)
    at_values = "" if named else ", with the numbers of this robot in HᵀH"
    why = "The matrix does not depend on any joint angle."
    if any(c.wheel.turns for c in measured.contacts):
        why = (
            "The two rows of a wheel are a rotation of [1 0 −y; 0 1 x], and a rotation drops out of HᵀH: the "
            "matrix is constant whatever the steering does."
        )
    if not d.determined:
        return [
            "The rows leave a direction unseen, so that HᵀH is singular. Of all twists that explain the rates best the "
            f"smallest is, with the Moore-Penrose inverse of HᵀH{at_values},",
            *math(r"\xi = (H^T H)^{+} H^T z, \qquad H^T H =", normal),
            f"{why} Its Moore-Penrose inverse was computed once, for this page.",
        ]
    return [
        f"More rows than unknowns: the least-squares solution is{at_values}",
        *math(r"\xi = (H^T H)^{-1} H^T z, \qquad H^T H =", normal),
        f"{why} It was inverted once, for this page.",
        *_condition(entries),
    ]


def _normal(normal: Matrix, numbers: list[Measured]) -> tuple[str, bool]:
    """H^T H in the named parameters where that is short, else in their values; and whether no name is lost."""
    named = any(p.constant is None for row in normal for p in row if p)
    if named and max(len(p.terms) for row in normal for p in row) <= _ENTRY:
        entries = [[factored(p) for p in row] for row in normal]
        if max(map(width, map("".join, entries))) <= _NORMAL:
            return matrix(entries), True
    return matrix(normal_equations(numbers)[0]), not named


def _condition(normal: Matrix) -> list[str]:
    """The condition on the rank, and the determinant that it is about where that is short."""
    words = "The condition is that H has full column rank 3 (Tzafestas (2.8a)), det(HᵀH) ≠ 0"
    long = max(len(p.terms) for row in normal for p in row) > _ENTRY
    det = "" if long else factored(shorter(determinant(normal)))
    if long or width(det) > _DET:
        return [f"{words}."]
    return [f"{words}:", *math(rf"\det(H^T H) = {det}")]


def fits_of(d: Derivation, *names: str) -> tuple[list[Expr], dict[str, str]]:
    """Results of ``forward``, of the twist before the residual is taken, and the names of its symbols."""
    formula = d.formula("forward")
    results = {result for call in formula.calls for result in call.results}
    vectors = {symbol: e for symbol, e in formula.locals if symbol in results}
    values = {p.name: e for p, e in formula.outputs}
    values |= {s.name.removesuffix("_fit"): e for s, e in formula.locals if s.name.endswith("_fit")}
    return [substituted(values[name], vectors, {}) for name in names], symbol_names(formula.inputs)


def _residual(d: Derivation, measured: Measurements) -> list[str]:
    """What no twist can explain."""
    if not any(value for port, value in d.formula("forward").outputs if port.name == "slip"):
        return ["The rates can never contradict each other, so the residual `slip` is 0."]
    if measured.weighted:
        (value,), ports = fits_of(d.in_symbols, "slip")
        slip = "" if value.has(Local) else latex(value, ports)
    else:
        slip = residual(measured.rows)
    return [
        "What no twist can explain is the residual, a signal for slip, a dead encoder or crossed wires: `slip` is "
        "the norm of z − H ξ [m/s].",
        *(math(rf"\mathrm{{slip}} = {slip}") if slip and width(slip) < _SLIP else []),
    ]


def _rigid(d: Derivation, contacts: Sequence[Contact]) -> list[str]:
    """Rigid motion through measured contact velocities."""
    blocks = ["Contact point B and measured velocity w of each of these wheels, in the robot frame:"]
    for c in contacts[:_SHOWN]:
        index = f"_{{{notation.wheel(c.wheel.name)}}}"
        b, w = matrix([[c.bx], [c.by]]), matrix([[c.wx], [c.wy]])
        wide = sum(max(width(latex(p)) for p in pair) for pair in ((c.bx, c.by), (c.wx, c.wy))) > 55
        both = [f"B{index} &= {b}", f"w{index} &= {w}"]
        blocks += aligned(both if wide else [", & ".join(both)])
    if len(contacts) > _SHOWN:
        blocks += [f"Those of {some([c.wheel for c in contacts[_SHOWN:]])} follow in the same way."]
    if len(contacts) == 1:
        return [
            *blocks,
            "Two rows cannot determine three unknowns: the result is the smallest twist that explains them, and the "
            "residual `slip` is 0.",
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
        "The rigid motion nearest to them is found as one would by hand: take the means away, fit the rotation to what "
        "is left, then the translation to the means.",
        "This needs two contact points apart from each other, H of rank 3 (Kelly Box 4.2). Here "
        f"p × q = pₓ q<sub>y</sub> − p<sub>y</sub> qₓ. One division is all that is left for run time; {divisor} "
        "The residual `slip`, the norm of all w<sub>i</sub> − v − ω ẑ × B<sub>i</sub> [m/s], is a signal for slip, a "
        "dead encoder or crossed wires.",
    ]  # fmt: skip


def _three(measured: Measurements) -> list[str]:
    """The determinant of three rows, where it is short."""
    if len(measured.rows) != 3 or measured.weighted:
        return []
    det = latex(determinant([list(row) for row, _, _ in measured.rows]))
    if width(det) > _DET:
        return []
    return ["Three rows make H square, and det(HᵀH) = (det H)²:", *math(rf"\det H = {det}")]


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
        "HᵀH depends on the steering angles, so it is inverted at run time, by cofactors.",
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
