"""Section 7: from sensed joints to the twist, by least squares."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from wmrgen.analysis.kinematics.least_squares import Measured, normal_equations
from wmrgen.analysis.kinematics.records import substituted
from wmrgen.analysis.kinematics.rigid import spread
from wmrgen.analysis.kinematics.sensing import Contact, Measurements, generic_rank, measurements
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import XI
from wmrgen.geometry.exact.evaluate import number, parameters_in, sqrt_poly
from wmrgen.geometry.exact.linalg import Matrix, adjugate, determinant
from wmrgen.geometry.exact.lowest import Product, related, shorter, unrelated
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.number import ONE as UNIT
from wmrgen.geometry.exact.poly import Gen, Poly, dot, has_angles, triple
from wmrgen.geometry.exact.readable import with_sums_of_angles
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.geometry.printing import symbol_names
from wmrgen.geometry.symbolic import Expr, Local, expression, times
from wmrgen.report.sections.latex import (
    Factor,
    Ports,
    Term,
    alike,
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
from wmrgen.report.sections.markdown import aligned, cut_note, math, matrix, some

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


_PRODUCTS = 60  # terms of a determinant of three rows
_ROWS = 12  # of which three are chosen
_WORK = 120  # terms of a numerator and of the determinant, times the number of their generators: 0.1 s
_WIDEST = 900  # glyphs of what is printed in place of numbers
_MOST = 150  # terms of the twist: even of six glyphs each, more are wider than that
_SHORT = 300  # glyphs of what is printed beside the rule
_DIGITS = 10**6  # of numerators and denominators
_LINE = 112  # glyphs of a line of a model


def factored(p: Poly) -> str:
    """A determinant in factors, where its numbers are short: of long ones common divisors are no help to a reader.
    ``p`` may be `unrelated`."""
    if not _short([p]):
        return latex(related(p))
    angles = with_sums_of_angles(related(p))
    if len(angles.terms) < len(p.terms):
        return latex(angles)
    (own,), added = with_sums([p])
    return total(_named(terms(reduced(own, Poly.of(1))), added))


def with_sums(polys: Sequence[Poly]) -> tuple[list[Poly], dict[str, Poly]]:
    """The polynomials in sums and differences of named lengths, where those save two terms; and what these are:
    4 s^2 + 3 h^2 for 4 a^2 + 8 a b + 4 b^2 + 3 h^2, s being a + b."""
    own, added = list(polys), dict[str, Poly]()
    names = sorted({g.name for p in polys for g in p.generators if g.kind == "param"})
    for a, b in combinations(names, 2):
        for sign in (1, -1):
            total_length = Poly.gen("param", f"~{len(added)}")
            rest = total_length - Poly.gen("param", b).scale(sign)
            tried = [p.substitute({Gen("param", a): rest}.get) for p in own]
            if sum(len(p.terms) for p in tried) < sum(len(p.terms) for p in own) - 1:
                own = tried
                added[f"~{len(added)}"] = Poly.gen("param", a) + Poly.gen("param", b).scale(sign)
    return own, added


def _named(summed: Sequence[Term], added: Mapping[str, Poly]) -> list[Term]:
    """The terms with the sums of lengths written out, those below the line too."""
    sums = {notation.parameter(name): latex(p) for name, p in added.items()}

    def written(f: Factor) -> Factor:
        if f.base in sums:
            return replace(f, base=sums[f.base], order=(2, ""), compound=True)
        for mark, text in sums.items():
            f = replace(f, base=f.base.replace(mark, rf"\left({text}\right)"))
        return f

    return [replace(t, factors=tuple(map(written, t.factors))) for t in summed]


def _short(polys: Sequence[Poly]) -> bool:
    return all(max(map(abs, (*c.num, c.den))) <= _DIGITS for p in polys for c in p.terms.values())


def pair(robot: Robot) -> list[Wheel]:
    """The wheels of a differential drive, the right one first, as Siegwart (3.29) stacks them; none of other robots."""
    wheels = [w for w in robot.wheels if w.kind.directed and not w.kind.swivels]
    if len(wheels) != 2 or not all(w.kind.fixed_axle for w in wheels):
        return []
    return sorted(wheels, key=lambda w: (w.pivot / wheels[0].zero_heading).imag)


def square(d: Derivation, rows: list[Measured]) -> list[str]:
    """Three rows: no least squares, but the book's (3.29) and (3.30), or its (3.31) where all roll."""
    own = (
        len(d.constraints.rolling) == 3
        and not d.constraints.sliding
        and all(w.sensed for w in d.robot.wheels)
    )
    book = r" = J_1^{-1} J_2\,\dot{\varphi}\;\;(3.31)" if own else ""
    book = book or (r"\;\;(3.30)" if pair(d.robot) else "")
    volume = shorter(determinant([[unrelated(p) for p in row] for row, _, _ in rows]))
    det = factored(volume) if len(volume.terms) <= _PRODUCTS else ""
    shown = rf", \qquad \det H = {det}" if det and width(det) <= _LINE else ""
    return [
        "As many rows as unknowns, and H has full column rank 3 (Tzafestas (2.7)), det H ≠ 0: the solution is",
        *math(rf"\xi = H^{{-1}} z{book}{shown}"),
    ]


def in_letters(d: Derivation) -> list[str]:
    """The twist of measured joints in the named parameters, lengths and angles, where it is short; and its numbers."""
    products = d.twist_in_symbols
    if products is None or sum(len(p.rest.terms) for p in products) > _MOST:
        return []
    ports = symbol_names(d.formula("forward").inputs)
    shorter_ones, added = _with_sums_inside(products)
    sums = [
        _named(terms(times(expression(p.factor), expression(p.rest)), ports), added) for p in shorter_ones
    ]
    shown = _written(sums, _WIDEST)
    if not shown:
        return []
    values = [number(p.factor, {q.name: q.value for q in d.robot.parameters}) for p in products]
    heading = (latex(expression(p.factor)).removeprefix("-") for p in products)
    factors = {head: abs(value) for head, value in zip(heading, values, strict=True)}
    return [*shown, *heads(d, list(zip(TWIST_NAMES, sums, strict=True)), factors)]


def _with_sums_inside(products: Sequence[Product]) -> tuple[list[Product], dict[str, Poly]]:
    """`with_sums` of products, their divisors too."""
    divisors = list({g: g.args[0] for p in products for g in p.factor.generators if g.kind == "inv"})
    own, added = with_sums([*(p.rest for p in products), *(g.args[0] for g in divisors)])
    if not added:
        return list(products), {}
    count = len(products)
    inverse = {g: below.inverse() for g, below in zip(divisors, own[count:], strict=True)}
    return [
        Product(p.factor.substitute(inverse.get), rest) for p, rest in zip(products, own[:count], strict=True)
    ], added


def by_three(d: Derivation, rows: list[Measured], nominal: list[Measured]) -> list[str]:
    """The twist that three of the rows give by themselves, by Cramer's rule, where it is short; rows without joint
    angles come first. Where all rows agree, the others add nothing."""
    order = sorted(range(min(len(rows), _ROWS)), key=lambda k: has_angles((*rows[k][0], rows[k][1])))
    three = next((t for t in combinations(order, 3) if determinant([list(nominal[k][0]) for k in t])), ())
    chosen = [rows[k] for k in three]
    h, z = [list(row) for row, _, _ in chosen], [value for _, value, _ in chosen]
    below = determinant(h)
    if (
        not three
        or not below
        or len(below.terms) > _ENTRY
        or not _short([*z, *(p for row in h for p in row)])
    ):
        return []
    above = [Poly.sum(a * b for a, b in zip(row, z, strict=True)) for row in adjugate(h)]
    if len(below.terms) > 1 and not (_one_root(below) and _easy([*above, below])):
        return []
    return _written(_quotients(above, below, symbol_names(d.formula("forward").inputs)), _SHORT)


def residual(rows: Sequence[Measured]) -> str:
    """The norm of z - H xi.

    Four rows of rank 3 leave one relation n^T H = 0, and the norm is |n^T z| / |n| where n is a multiple of numbers; it
    is the root of a sum of squares else.
    """
    if normal := _relation(rows):
        length = sqrt_poly(Poly.of(sum((c * c for c in normal), ZERO)))
        gap = Poly.sum(value.scale(c) for c, (_, value, _) in zip(normal, rows, strict=True))
        return rf"\left|{latex(gap * length.inverse())}\right|"
    gaps = [value - dot(row, XI) for row, value, _ in rows]
    forms = (-p if all(c.sign < 0 for c in p.terms.values()) else p for p in gaps)
    return rf"\sqrt{{{' + '.join(multiples(squares(forms)))}}}"


def _relation(rows: Sequence[Measured]) -> list[Exact]:
    """Numbers n with n^T H = 0, of four rows of rank 3; nothing of others, or where n has no ratio of numbers."""
    h = [list(row) for row, _, _ in rows]
    minors = [determinant([*h[:k], *h[k + 1 :]]).scale((-1) ** k) for k in range(4)] if len(h) == 4 else []
    first = next((p for p in minors if p), None)
    if first is None:
        return []
    normal = [p.ordered[0][1] / first.ordered[0][1] if p else ZERO for p in minors]
    return normal if all(p == first.scale(c) for p, c in zip(minors, normal, strict=True)) else []


def _easy(polys: Sequence[Poly]) -> bool:
    """Whether sympy finds common factors at once: few terms, few generators, rational numbers."""
    generators = {g for p in polys for g in p.generators}
    rational = all(c.is_rational for p in polys for c in p.terms.values())
    return rational and sum(len(p.terms) for p in polys) * len(generators) <= _WORK


def _one_root(below: Poly) -> bool:
    """Whether sympy clears a divisor of roots in no time: of one term, or with one root at the most."""
    return len(below.terms) == 1 or sum(g.kind == "sqrt" for g in below.generators) <= 1


def _quotients(above: Sequence[Poly], below: Poly, ports: Ports) -> list[list[Term]]:
    """above / below as sums."""
    (*above, below), added = with_sums([*above, below])
    if len(below.terms) == 1 and not added:
        order = {notation.port(name): (3 + k, "") for k, name in enumerate(ports.values())}
        return [with_tangents(_in_order(terms(p * below.inverse()), order)) for p in above]
    return [with_tangents(_named(terms(reduced(p, below), ports), added)) for p in above]


def _in_order(summed: Sequence[Term], order: Mapping[str, tuple[int, str]]) -> list[Term]:
    """The terms with the velocities in this order, where polynomials have them in that of their names."""
    return [
        replace(t, factors=tuple(replace(f, order=order.get(f.base, f.order)) for f in t.factors))
        for t in summed
    ]


def _written(sums: Sequence[Sequence[Term]], most: int) -> list[str]:
    """The components of the twist; nothing where they have more than ``most`` glyphs."""
    texts = [wrapped(summands(summed)) for summed in sums]
    if width("".join(texts)) > most:
        return []
    return aligned(f"{notation.port(n)} &= {t}" for n, t in zip(TWIST_NAMES, texts, strict=True))


def heads(
    d: Derivation, sums: Sequence[tuple[str, Sequence[Term]]], values: Mapping[str, Exact] | None = None
) -> list[str]:
    """The factors before the sums of wheel speeds as numbers: r / (4 (a + b)) = 125/4954 = 0.02523. ``values``: those
    that are known."""
    ports = {notation.port(p.name): p.name for p in d.formula("forward").inputs}
    equal: dict[str, str] = {}
    for name, summed in sums:
        number, common, rest = pulled_out(summed) if len(summed) > 1 else (ONE, (), ())
        lone = [t for t in rest if len(t.factors) == 1 and t.factors[0].base in ports and abs(t.number) == 1]
        head = total([Term(abs(number), common)])
        value = (values or {}).get(head)
        if head == "1" or not (lone or value):
            continue
        value = value or abs(d.evaluate("forward", {ports[lone[0].factors[0].base]: ONE})[name])
        shown = _worth(value, head)
        if shown:
            equal[head] = shown
    return math(r", \qquad ".join(f"{head} {value}" for head, value in equal.items())) if equal else []


def _worth(value: Exact, head: str) -> str:
    """``= 0.25``, or ``= 125/4954 = 0.0252321``, the fraction where it is short and is not what stands there."""
    above, below, _ = notation.magnitude(value)
    fraction = rf"\frac{{{above or 1}}}{{{below}}}" if below else ""
    exact = notation.terminating(value.parts[0]) if value.is_rational else None
    if exact:
        return f"= {exact}" if head not in (exact, fraction) else ""
    equal = f"= {fraction} " if value.is_rational and fraction not in ("", head) else ""
    decimal = notation.decimal(float(value))
    return rf"{equal}\approx {decimal}" if decimal != head else ""


_TERMS = 24  # summands of a printed formula
_NEAREST = (
    r"\omega = \frac{\sum_i (B_i-\bar{B})\times(w_i-\bar{w})}{\sum_i |B_i-\bar{B}|^2}, \qquad "
    r"v = \bar{w} - \omega\,\hat{z}\times\bar{B}"
)
_BY_WEIGHT = "There wheels count by their weights: means, sums, HᵀH and Hᵀz are weighted, as in section 7."


def closed_forward(d: Derivation) -> list[str]:
    """The twist of measured rates: written out where the matrix is constant, else the rule that gives it."""
    measured = d.measured
    if not measured.rows:
        return ["No joint is sensed, so nothing is known of the twist: `forward` returns 0."]
    if measured.constant_normal:
        if letters := in_letters(d):
            return letters
        numbers = _closed(d)
        return [*_rule(d, numbers), *numbers]
    by = [_BY_WEIGHT] if measured.weighted else []
    if measured.rigid:
        return [*_rigid_motion(len(measured.contacts)), *(by if len(measured.contacts) > 1 else [])]
    best = "The twist that explains all measurements best, with H and z of section 7:"
    if generic_rank(measured) < 3:
        return [best, *math(r"\xi = (H^T H)^{+} H^T z"), *by]
    three = by_three(d, measured.rows, d.measured_at_nominal)
    if not three:
        return [best, *math(r"\xi = (H^T H)^{-1} H^T z"), *by]
    if len(measured.rows) == 3:
        return three
    return [
        "The twist that explains all measurements best is ξ = (HᵀH)⁻¹ Hᵀz, with H and z of section 7. Where they agree "
        "(`slip` is 0), that is",
        *three,
        *by,
    ]


def _rigid_motion(contacts: int) -> list[str]:
    """Through the velocities of measured contact points."""
    if contacts == 1:
        return [
            "The smallest twist (v, ω) that explains the velocity w of the contact point B (section 7 has both):",
            *math(r"\omega = \frac{B \times w}{1 + |B|^2}, \qquad v = w - \omega\,\hat{z}\times B"),
        ]
    return [
        "The rigid motion (v, ω) nearest to the velocities w that the wheels measure at their contact points B; a bar "
        "is a mean over the wheels, and section 7 has B and w:",
        *math(_NEAREST),
    ]


def _rule(d: Derivation, numbers: list[str]) -> list[str]:
    """What ``numbers`` come from, where they stand for named lengths and angles: of wheels that give both rows, a rigid
    motion; of others, the rows of section 7."""
    measured = d.measured
    named = {name for row, value, _ in measured.rows for p in (*row, value) for name in parameters_in(p)}
    if not (d.determined and named):
        return []
    if not measured.rigid or measured.weighted:
        square = len(distinct(measured)) == 3
        below = "; below it the same with the numbers of this robot" if numbers else ""
        return [
            f"The twist that explains all measurements best, with H and z of section 7{below}:",
            *math(r"\xi = H^{-1} z" if square else r"\xi = (H^T H)^{-1} H^T z"),
        ]
    below = "; below it the same with the lengths of this robot" if numbers else ""
    return [
        "The rigid motion (v, ω) nearest to the velocities w = r φ̇ e that the wheels measure at their contact points "
        f"B, e being the direction in which a wheel rolls and a bar a mean over the wheels{below}:",
        *math(_NEAREST),
    ]


def _in_numbers(d: Derivation) -> list[str]:
    """The twist of measured wheel speeds at the values of the robot file; nothing where it depends on angles too."""
    rates = [p for p in d.formula("forward").inputs if p.default is None]
    if any(not p.name.endswith(".spin") for p in rates):
        return []
    shown, rest = rates[:_TERMS], [r"+\cdots"] * (len(rates) > _TERMS)
    digits = 60  # far more than a report shows
    twists = [d.evaluate("forward", {p.name: UNIT}, digits) for p in shown]
    spins = [Poly.gen("input", p.name) for p in shown]
    lines = []
    for name in TWIST_NAMES:
        value = Poly.sum(spin.scale(twist[name]) for spin, twist in zip(spins, twists, strict=True))
        lines.append(f"{notation.port(name)} &= {wrapped([*summands(terms(value)), *rest])}")
    return aligned(lines)


def _closed(d: Derivation) -> list[str]:
    """The twist as the code computes it; where it does so step by step, with its numbers."""
    fits, ports = fits_of(d, *TWIST_NAMES)
    if any(fit.has(Local) for fit in fits):
        return _in_numbers(d)
    lines, sums = [], []
    for name, fit in zip(TWIST_NAMES, fits, strict=True):
        sums.append((name, terms(fit, ports)))
        parts = summands(sums[-1][1])
        shown = [*parts[:_TERMS], r"+\cdots"] if len(parts) > _TERMS else parts
        lines.append(f"{notation.port(name)} &= {wrapped(shown)}")
    return [*aligned(lines), *heads(d, sums)]
