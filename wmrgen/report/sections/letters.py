"""Results in the named parameters, where the code has numbers: the least-squares twist, with factors such as
r / (4 (a + b)); the forms of the model, and the functions that are one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

from wmrgen.analysis.kinematics.least_squares import Measured
from wmrgen.analysis.kinematics.records import Formula
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.models.sheet import latex as equations
from wmrgen.functions.models.sheet import sheet_of
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import XI
from wmrgen.geometry.exact.evaluate import number, sqrt_poly
from wmrgen.geometry.exact.linalg import adjugate, determinant
from wmrgen.geometry.exact.lowest import Product, related, shorter, unrelated
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Gen, Poly, dot, has_angles
from wmrgen.geometry.exact.readable import with_sums_of_angles
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.geometry.printing import symbol_names
from wmrgen.geometry.symbolic import expression, times
from wmrgen.report.sections.angles import with_tangents
from wmrgen.report.sections.latex import Ports, latex, pulled_out, reduced, summands, terms, total
from wmrgen.report.sections.markdown import aligned, listed, math
from wmrgen.report.sections.terms import Factor, Term, width, wrapped

_ENTRY = 12  # terms of an entry of H^T H and H^T z
_PRODUCTS = 60  # terms of a determinant of three rows
_ROWS = 12  # of which three are chosen
_WORK = 120  # terms of a numerator and of the determinant, times the number of their generators: 0.1 s
_WIDEST = 900  # glyphs of what is printed in place of numbers
_MOST = 150  # terms of the twist: even of six glyphs each, more are wider than that
_SHORT = 300  # glyphs of what is printed beside the rule
_DIGITS = 10**6  # of numerators and denominators
_LINE = 112  # glyphs of a line of a model
_MODELS = ("posture", "configuration", "zeta", "trailer")  # functions that `wmrgen model` writes


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


def squares(forms: Iterable[Poly]) -> Counter[str]:
    """How often each square occurs in a sum of squares."""
    return Counter(rf"{latex(p)}^2" if p in XI else rf"\left({latex(p)}\right)^2" for p in forms)


def multiples(counts: Mapping[str, int], each: int = 1) -> list[str]:
    """Summands with the numbers before them, ``each`` of them being one."""
    return [text if n == each else rf"{n}\,{text}" for text, n in counts.items()]


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


def model(d: Derivation, f: Formula) -> list[str]:
    """A function that is a model, as `wmrgen model` prints it; nothing for others and for what is too long."""
    if f.name not in _MODELS:
        return []
    text = equations(sheet_of(f.name, d.system(f.name, symbolic=True)))
    if max(map(width, text.split("\n"))) > 2 * _LINE:
        return []
    rest = [p.name for p, _ in f.outputs if not p.name.endswith(("_rate", ".spin"))]
    blocks = ["As `wmrgen model` prints it, without what guards its divisors:", *math(text)]
    return [*blocks, f"The formulas of {listed(rest)} stand in the code."] if rest else blocks
