"""Write exact polynomials and sympy formulas as LaTeX.

Both are first split into terms; a term is a number times factors. The terms are then arranged as one would by hand:
terms with the same velocity are collected, common factors are pulled out, addition theorems are applied, and long sums
are broken into lines. Short numbers are exact (fractions, roots, decimals); other numbers are rounded to six digits.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import atan2, lcm, pi

import sympy

from wmrgen.functions.models.polynomials import whole, without_lengths
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import XI
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Gen, Monomial, Poly, Row, each, triple
from wmrgen.geometry.notation import Style
from wmrgen.geometry.symbolic import Expr, Parameter, expression
from wmrgen.ir.lower import number_of


@dataclass(frozen=True, slots=True)
class Factor:
    """One factor of a term: base**power."""

    base: str  # LaTeX
    power: int
    rank: int  # 0: parameter, 1: function such as a sine, 2: velocity; sums collect velocities
    order: tuple[int, str]  # sorts factors of one rank
    compound: bool = False  # whether the base is a sum and needs brackets

    def shown(self) -> str:
        """Return the factor as LaTeX, with the absolute value of its power."""
        n = abs(self.power)
        base = rf"\left({self.base}\right)" if self.compound else self.base
        if n == 1:
            return base
        for f in (r"\cos", r"\sin"):
            if base.startswith(f) and not base.startswith(f + "("):
                return f"{f}^{{{n}}}{base.removeprefix(f)}"
        return f"{{{base}}}^{{{n}}}"


@dataclass(frozen=True, slots=True)
class Term:
    """One summand: a number times factors."""

    number: Exact
    factors: tuple[Factor, ...]
    style: Style = ""  # how all terms of this sum write their numbers, see `notation.magnitude`


def merged(factors: Iterable[Factor]) -> tuple[Factor, ...]:
    """Combine factors with the same base by adding their powers."""
    by_base: dict[str, Factor] = {}
    for f in factors:
        by_base[f.base] = replace(f, power=f.power + by_base[f.base].power) if f.base in by_base else f
    return tuple(f for f in by_base.values() if f.power)


# ---- The width of LaTeX, and line breaks in long sums.

_COMMAND, _UNSEEN = re.compile(r"\\[A-Za-z]+"), re.compile(r"[{}^_ \\,]")
WIDE = 80  # visible characters of a line: a longer sum is broken
PAGE = 112  # visible characters of a formula that is not broken: 900 px


def width(text: str) -> int:
    """Estimate how many characters of the LaTeX are visible."""
    return len(_UNSEEN.sub("", _COMMAND.sub("x", text)))


def wrapped(parts: Sequence[str], limit: int = WIDE) -> str:
    """Join signed summands, inside ``aligned``, into lines of at most ``limit`` characters that begin with a sign."""
    texts, used = [""], 0
    for part in parts:
        size = width(part)
        if used and used + size > limit:
            texts.append("")
            used = 0
        texts[-1] += part
        used += size
    texts[0] = texts[0].removeprefix("+")
    return "\\\\\n&\\qquad ".join(texts) or "0"


COMMON = 12  # largest denominator that is pulled out of a sum whose denominators differ: 1/6 in synchro_drive
Ports = Mapping[str, str]  # name of a symbol -> name of its input or output
_LEADS = {"vx": 0, "vy": 1, "omega": 2, "vx_driven": 0, "vy_driven": 1, "omega_driven": 2}
_TWIST = {notation.port(n) for n in _LEADS}
_SPACE = "\\;"
_FUNCTION = re.compile(r"\\(cos|sin|tan|cot|mathrm)")


def latex(value: Poly | Expr, ports: Ports | None = None) -> str:
    """Return a polynomial or a formula as LaTeX on one line."""
    return total(terms(value, ports))


def broken(value: Poly | Expr, ports: Ports | None = None) -> str:
    """Return a polynomial or a formula as LaTeX, on several lines if it is long."""
    return wrapped(summands(terms(value, ports)))


# ---- From polynomials and formulas to terms.


def terms(value: Poly | Expr, ports: Ports | None = None) -> list[Term]:
    """Split a polynomial or a formula into terms. ``ports`` names the symbols of a formula."""
    if isinstance(value, Poly):
        return [_term(c, m) for m, c in value.terms.items()]
    summed: list[Term] = []
    for arg in sympy.Add.make_args(value):
        number, factors, inner = ONE, [], None
        for factor in _factors(arg):
            own = number_of(factor)
            if own is not None:
                number = number * own
            elif isinstance(factor, sympy.Add) and inner is None:
                inner = factor
            else:
                factors.append(_factor(factor, ports or {}))
        if inner is None:
            summed.append(Term(number, tuple(factors)))
        else:
            summed += [Term(t.number * number, merged((*t.factors, *factors))) for t in terms(inner, ports)]
    return [t for t in summed if t.number]


def _term(number: Exact, monomial: Monomial) -> Term:
    """Return a summand of a polynomial. A divisor 1 - 100 a / 11 is written as a - 0.11, as lengths in the file."""
    factors = []
    for g, power in monomial:
        if g.kind == "inv":
            scale = _leading(g.args[0]).inverse()
            number *= scale**power
            g = Gen("inv", "", (g.args[0].scale(scale),))
        factors.append(_generator(g, power))
    return Term(number, tuple(factors))


def _leading(p: Poly) -> Exact:
    """Return the smallest coefficient of the products of most lengths; 1 if there are no lengths."""
    lengths = {}
    for m in p.terms:
        lengths[m] = sum(e for g, e in m if g.kind == "param")
    most = max(lengths.values())
    return min((c for m, c in p.terms.items() if lengths[m] == most), key=abs) if most > 0 else ONE


def _factors(expr: Expr) -> list[Expr]:
    """Return the factors of a product; nested products are flattened."""
    return [factor for arg in expr.args for factor in _factors(arg)] if expr.is_Mul else [expr]


def reduced(above: Poly, below: Poly) -> Expr:
    """Return above / below in lowest terms: factored, and without a root in the denominator."""
    return sympy.factor(sympy.radsimp(expression(above) / expression(below)))


def _generator(gen: Gen, power: int) -> Factor:
    match gen.kind:
        case "param":
            return Factor(notation.parameter(gen.name), power, 0, (0, notation.sort_key(gen.name)))
        case "pi":
            return Factor(r"\pi", power, 0, (0, ""))
        case "cos" | "sin":
            angle = notation.port(f"{gen.name}.steer")
            return Factor(rf"\{gen.kind}{angle}", power, 1, (0, gen.name + gen.kind))
        case "input" | "local":
            late = 3 if gen.name.endswith(".spin") else 4  # after the twist, spins before steering rates
            return Factor(notation.port(gen.name), power, 2, (_LEADS.get(gen.name, late), ""))
        case "inv":
            return Factor(latex(gen.args[0]), -power, 0, (1, gen.key), True)
        case "sqrt":
            return Factor(rf"\sqrt{{{latex(gen.args[0])}}}", power, 0, (1, gen.key))
    arguments = ", ".join(latex(a) for a in gen.args)
    head = r"\mathrm{atan2}" if gen.kind == "atan2" else "\\" + gen.kind.removesuffix("f")
    if [g.alone for g in gen.args[0].generators] == list(gen.args):
        return Factor(f"{head}{' ' * arguments[0].isalpha()}{arguments}", power, 1, (1, gen.key))
    return Factor(rf"{head}\left({arguments}\right)", power, 1, (1, gen.key))


def _name(symbol: Expr) -> str:
    return notation.parameter(symbol.name) if isinstance(symbol, Parameter) else notation.symbol(symbol.name)


def _factor(expr: Expr, ports: Ports) -> Factor:
    base, power = (expr.base, expr.exp) if isinstance(expr, sympy.Pow) else (expr, sympy.S.One)
    if power.is_Rational and power.q == 2:
        return Factor(rf"\sqrt{{{latex(base, ports)}}}", int(power.p), 2, (8, ""))
    n = int(power)
    if isinstance(base, Parameter):
        return Factor(notation.parameter(base.name), n, 0, (0, notation.sort_key(base.name)))
    if isinstance(base, sympy.Symbol):
        port = ports.get(base.name, base.name.removesuffix("_fit"))
        order = list(ports).index(base.name) if base.name in ports else -1
        return Factor(notation.port(port), n, 2, (_LEADS.get(port, 3 + order), ""))
    if base is sympy.pi:
        return Factor(r"\pi", n, 0, (0, "pi"))
    if isinstance(base, sympy.Abs):
        return Factor(rf"\left|{latex(base.args[0], ports)}\right|", n, 2, (8, ""))
    if isinstance(base, sympy.cos | sympy.sin | sympy.tan | sympy.atan):
        head, angle = rf"\{base.func.__name__.replace('atan', 'arctan')}", base.args[0]
        if not isinstance(angle, sympy.Symbol):
            return Factor(rf"{head}\left({latex(angle, ports)}\right)", n, 1, (0, head))
        shown = notation.port(ports[angle.name]) if angle.name in ports else _name(angle)
        return Factor(f"{head}{' ' * shown[0].isalpha()}{shown}", n, 1, (0, head))
    if isinstance(base, sympy.atan2):
        y, x = (latex(a, ports) for a in base.args)
        return Factor(rf"\mathrm{{atan2}}\left({y},\, {x}\right)", n, 1, (8, ""))
    return Factor(latex(base, ports), n, 0, (2, ""), True)


# ---- From terms to LaTeX.


def total(terms: Sequence[Term]) -> str:
    """Return the sum of terms as LaTeX."""
    return "".join(pieces(terms)).removeprefix("+").strip() or "0"


def pieces(terms: Sequence[Term]) -> list[str]:
    """Return the summands of a sum; each begins with + or -."""
    if len(terms) < 2:
        return [_product(t.number, t.factors, style=t.style) for t in terms]
    number, common, rest = pulled_out(terms)
    if common or number != 1:
        return [_product(number, common, total(rest), terms[0].style)]
    terms = _in_one_style(terms)
    groups: dict[str, list[Term]] = {}
    for t in sorted(terms, key=_key):
        groups.setdefault(_lead(t), []).append(t)
    if not any(groups):
        return sorted(_by_angles(terms), key=lambda piece: piece.startswith("-"))
    signed: list[str] = []
    for lead, members in _with_equal_factors(groups):
        if len(members) > 1 and len(set(map(_lead, members))) > 1:
            number, common, rest = pulled_out(members)
            if common or number != ONE:
                signed.append(_product(number, common, total(rest), members[0].style))
            else:
                signed += [_product(t.number, t.factors, style=t.style) for t in members]
            continue
        if not lead or len(members) == 1:
            signed += [_product(t.number, t.factors, style=t.style) for t in members]
            continue
        rest = [_without(lead, t) for t in members]
        inside = pieces(rest)
        one = inside[0] if len(inside) == 1 else rf"+\left({total(rest)}\right)"
        signed.append(f"{one}{lead}" if one.endswith(")") else f"{one}{_SPACE}{lead}")
    two_joints = len(signed) == 2 and not any(lead in _TWIST for lead in groups)
    return sorted(signed, key=lambda piece: two_joints and piece.startswith("-"))


def _with_equal_factors(groups: Mapping[str, list[Term]]) -> list[tuple[str, list[Term]]]:
    """Collect joint rates with equal factors: a x - a y + b z becomes a (x - y) + b z."""
    collected: dict[object, tuple[str, list[Term]]] = {}
    for lead, members in groups.items():
        first = members[0]
        factors = tuple(f for f in first.factors if f.base != lead)
        alone = not lead or lead in _TWIST or len(members) > 1
        key = lead if alone else (abs(first.number), factors)
        collected.setdefault(key, (lead, []))[1].extend(members)
    return list(collected.values())


def _by_angles(terms: Sequence[Term]) -> list[str]:
    """Return the summands of a sum without velocities. Terms with the same sines and cosines are collected,
    as (b_x² + b_y²) sin psi in tidybot2, or terms with one of two in common, as in sums where all have it in common."""
    shared = _shared_angle(terms)
    if shared is not None:
        inside = [t for t in terms if shared in t.factors]
        outside = [t for t in terms if shared not in t.factors]
        number, common, rest = pulled_out(inside)
        return [_product(number, common, total(rest), inside[0].style), *pieces(outside)]
    groups: dict[tuple[Factor, ...], list[Term]] = {}
    for t in sorted(terms, key=_key):
        groups.setdefault(_angles(t), []).append(t)
    signed: list[str] = []
    for angles, members in groups.items():
        if not angles or len(members) == 1:
            signed += [_product(t.number, t.factors, style=t.style) for t in members]
            continue
        rest = [_without_angles(t) for t in members]
        number, common, inner = pulled_out(rest)
        signed.append(_product(number, (*common, *angles), total(inner), members[0].style))
    return signed


def _shared_angle(terms: Sequence[Term]) -> Factor | None:
    """Return the sine or cosine that most terms share, if all terms are different products of two; else None."""
    angles = list(map(_angles, terms))
    if any(len(a) != 2 for a in angles) or len(set(angles)) < len(terms):
        return None
    counts = Counter(f for pair in angles for f in pair)
    shared = min(counts, key=lambda f: (-counts[f], f.order))
    return shared if counts[shared] > 1 else None


def _without(base: str, t: Term) -> Term:
    """Return a term without its factors of this base."""
    return replace(t, factors=tuple(f for f in t.factors if f.base != base))


def _angles(t: Term) -> tuple[Factor, ...]:
    """Return the sines and cosines of a term."""
    return tuple(f for f in t.factors if f.rank == 1)


def _without_angles(t: Term) -> Term:
    """Return a term without its sines and cosines."""
    return replace(t, factors=tuple(f for f in t.factors if f.rank != 1))


def _in_one_style(terms: Sequence[Term]) -> Sequence[Term]:
    """Return the terms such that all write their numbers in the same style, fractions or decimals."""
    style = "" if any(t.style for t in terms) else notation.style_of([t.number for t in terms])
    return [replace(t, style=style) for t in terms] if style else terms


def summands(terms: Sequence[Term]) -> list[str]:
    """Return the summands like `pieces`, but split a long bracket too, so that `wrapped` can break lines inside it."""
    parts = pieces(terms)
    if len(parts) != 1 or len(terms) < 2 or width(parts[0]) <= WIDE:
        return parts
    number, common, rest = pulled_out(terms)
    inside = pieces(rest)
    if len(inside) < 2:
        return parts
    head, bracket, after = _product(number, common, total(rest)).partition(rf"\left({total(rest)}\right)")
    head = head if bracket else _product(number, common)
    return [rf"{head}\Bigl({inside[0].removeprefix('+')}", *inside[1:-1], rf"{inside[-1]}\Bigr){after}"]


def _lead(t: Term) -> str:
    return next((f.base for f in t.factors if f.rank == 2 and f.power == 1), "")


def _key(t: Term) -> tuple[object, ...]:
    leads = tuple(f.order for f in t.factors if f.rank == 2)
    plain = not any(f.rank == 1 for f in t.factors)
    return leads or ((9, ""),), plain, tuple((f.rank, *f.order) for f in t.factors)


def _power(base: str, t: Term) -> int:
    """Return the power of this base in a term; 0 if no factor has it."""
    return next((f.power for f in t.factors if f.base == base), 0)


def pulled_out(terms: Sequence[Term]) -> tuple[Exact, tuple[Factor, ...], list[Term]]:
    """Return the number and the factors that all terms share, and the terms without them."""
    shared = []
    for f in terms[0].factors:
        powers = [_power(f.base, t) for t in terms]
        if all(p > 0 for p in powers) or all(p < 0 for p in powers):
            shared.append(replace(f, power=min(powers, key=abs)))
    common = {f.base: f.power for f in shared}
    # The common magnitude. It is negative if all terms are negative and none contains the twist.
    first = abs(terms[0].number)
    negative = all(t.number.sign < 0 for t in terms) and _TWIST.isdisjoint(map(_lead, terms))
    size = first if all(abs(t.number) == first for t in terms) else _over_common(terms)
    number = -size if negative else size
    if not shared and number == ONE:
        return ONE, (), list(terms)
    rest = []
    for t in terms:
        reduced = (replace(f, power=f.power - common.get(f.base, 0)) for f in t.factors)
        rest.append(Term(t.number / number, tuple(f for f in reduced if f.power), t.style))
    return number, tuple(shared), rest


def _over_common(terms: Sequence[Term]) -> Exact:
    """Return a common number to pull out: 1/6 if the terms have halves and thirds, a root if all terms have it,
    else 1."""
    first = abs(terms[0].number)
    alike = all((t.number / first).is_rational for t in terms)
    if alike and not first.is_rational and not notation.magnitude(first)[2]:
        return first
    below = [notation.magnitude(t.number)[1] for t in terms]
    common = lcm(*map(int, below)) if all(below) else 1
    return Exact(1) / Exact(common if common <= COMMON or len(set(below)) == 1 else 1)


def _product(number: Exact, factors: Iterable[Factor], inner: str = "", style: notation.Style = "") -> str:
    """Return one signed summand as LaTeX. ``inner`` is a sum by which it is multiplied."""
    sign = "-" if number.sign < 0 else "+"
    ordered = sorted(factors, key=lambda f: (f.rank, f.order))
    head, divisor, is_sum = notation.magnitude(number, style)
    above = [f.shown() for f in ordered if f.power > 0 and f.rank < 2]
    leads = "".join(f"{_SPACE}{f.shown()}" for f in ordered if f.power > 0 and f.rank == 2)
    below = [f for f in ordered if f.power < 0]
    bottom = [divisor] if divisor else []
    if len(below) == 1 and not bottom and below[0].power == -1:
        bottom = [below[0].base]
    else:
        bottom += [f.shown() for f in below]
    after = ""
    if inner and not leads and not _FUNCTION.search(inner):  # (a + b) cos psi: "cos psi (a + b)" is ambiguous
        last = [f.shown() for f in ordered if f.power > 0 and f.rank == 1]
        above, after = above[: len(above) - len(last)], _times(last)
    if inner and bottom and not (above or head):
        return rf"{sign}\frac{{{inner}}}{{{_times(bottom)}}}{after}{leads}"
    leads += rf"\left({inner}\right){after}" if inner else ""
    if is_sum and (above if bottom else above or leads or sign == "-"):
        head = rf"\left({head}\right)"
    top = _times([head, *above] if head else above)
    if bottom:
        if not top and leads and not inner:
            return rf"{sign}\frac{{{leads.removeprefix(_SPACE)}}}{{{_times(bottom)}}}"
        return rf"{sign}\frac{{{top or '1'}}}{{{_times(bottom)}}}{leads}"
    return sign + (f"{top}{leads}" if top else leads.removeprefix(_SPACE) or "1")


def _times(parts: Sequence[str]) -> str:
    return r"\,".join(parts)


def squares(forms: Iterable[Poly]) -> Counter[str]:
    """Return how often each square occurs in a sum of squares."""
    return Counter(rf"{latex(p)}^2" if p in XI else rf"\left({latex(p)}\right)^2" for p in forms)


def multiples(counts: Mapping[str, int], each: int = 1) -> list[str]:
    """Return the summands with their counts divided by ``each`` as coefficients; a coefficient 1 is omitted."""
    return [text if n == each else rf"{n}\,{text}" for text, n in counts.items()]


def upright(column: Row) -> Row:
    """Scale a column of N, whose length is arbitrary, so that it reads well.

    The third entry (yaw rate) becomes 1, or the sine of a sum of angles. If this puts a fraction before a named length
    (agilex_ranger), the column is multiplied by the common denominator instead.
    """
    turn = column[2]
    sizes = {abs(c) for c in turn.terms.values()}
    if len(sizes) == 1:
        rate = next(iter(turn.terms.values())) if len(turn.terms) == 1 else sizes.pop()
        once = each(column, lambda p: p.scale(rate.inverse()))
        if not _halves_a_length(once):
            return once
    return triple(whole(column))


def _halves_a_length(column: Row) -> bool:
    """Return whether a named length has a fraction as coefficient."""
    for p in column:
        for monomial, c in p.terms.items():
            if c.den > 1 and any(g.kind == "param" for g, _ in monomial):
                return True
    return False


def readable(p: Poly) -> str:
    """Return a polynomial as LaTeX, with addition theorems applied."""
    return total(gathered(terms(p)))


def gathered(summed: Sequence[Term]) -> list[Term]:
    """Apply the addition theorems: sin a cos b ± cos a sin b and cos a cos b ± sin a sin b become one term."""
    rest = list(summed)
    done: list[Term] = []
    while rest:
        first = rest.pop(0)
        for other in rest:
            joined = _joined(first, other)
            if joined is not None:
                rest.remove(other)
                first = joined
                break
        done.append(first)
    return done


def over(above: Sequence[Term], below: Term) -> list[Term]:
    """Divide a sum by a term: common factors cancel, and cos a / sin a becomes cot a."""
    turned = [replace(f, power=-f.power) for f in below.factors]
    quotients = [Term(t.number / below.number, merged((*t.factors, *turned))) for t in above]
    return [Term(t.number, _by_one_name(t.factors, r"\cos", r"\sin", r"\cot")) for t in quotients]


def with_tangents(summed: Sequence[Term]) -> list[Term]:
    """Write sin a / cos a as tan a."""
    return [Term(t.number, _by_one_name(t.factors, r"\sin", r"\cos", r"\tan")) for t in summed]


def _by_one_name(factors: tuple[Factor, ...], above: str, below: str, name: str) -> tuple[Factor, ...]:
    """Replace each quotient of functions, above(a) / below(a), by name(a)."""
    for top in (f for f in factors if f.power == 1 and f.base.startswith(above)):
        angle = top.base.removeprefix(above)
        bottom = next((f for f in factors if f.power == -1 and f.base == below + angle), None)
        if bottom:
            rest = tuple(f for f in factors if f not in (top, bottom))
            return _by_one_name((*rest, replace(top, base=name + angle)), above, below, name)
    return factors


def _joined(s: Term, t: Term) -> Term | None:
    """Return the sum of two terms as one term if an addition theorem applies to them, else None."""
    if abs(s.number) != abs(t.number):
        return None
    own = [f for f in s.factors if f not in t.factors]
    others = [f for f in t.factors if f not in s.factors]
    if len(own) != 2 or len(others) != 2 or any(f.power != 1 or f.rank != 1 for f in (*own, *others)):
        return None
    heads, angles = zip(*((f.base[:4], f.base[4:]) for f in own), strict=True)
    if angles[0] == angles[1] or {f.base for f in others} != {
        (r"\sin" if h == r"\cos" else r"\cos") + a for h, a in zip(heads, angles, strict=True)
    }:
        return None
    rest = tuple(f for f in s.factors if f not in own)
    alike = s.number == t.number
    if heads[0] == heads[1]:  # cos a cos b + sin a sin b = cos(a - b)
        number = s.number if heads[0] == r"\cos" or alike else -s.number
        return Term(number, (*rest, _of_two(own[0], r"\cos", angles, "-" if alike else "+")))
    if alike:
        return Term(s.number, (*rest, _of_two(own[0], r"\sin", angles, "+")))
    if heads[0] == r"\cos":  # sin b cos a - cos b sin a = sin(b - a)
        angles = angles[::-1]
    if s.number.sign < 0:
        return Term(-s.number, (*rest, _of_two(own[0], r"\sin", angles[::-1], "-")))
    return Term(s.number, (*rest, _of_two(own[0], r"\sin", angles, "-")))


def _of_two(like: Factor, head: str, angles: Sequence[str], sign: str) -> Factor:
    return replace(like, base=rf"{head}\left({angles[0]}{sign}{angles[1]}\right)")


def equation(p: Poly) -> Poly:
    """Normalise the left-hand side of p = 0: without a common number or length, and with mostly positive terms."""
    p = without_lengths(p)
    numbers = list(p.terms.values())
    least = min(map(abs, numbers))
    ratios = [c / least for c in numbers]
    simple = all(max(map(abs, (*q.num, q.den))) <= COMMON for q in ratios)
    size = least if simple else Exact(1)
    negative = sum(c.sign for c in numbers) < 0 or (numbers[0].sign < 0 and sum(c.sign for c in numbers) == 0)
    return p.scale((-size if negative else size).inverse())


def roots(p: Poly) -> str:
    """Return the angles [deg] at which p = a cos psi + b sin psi is 0, as LaTeX; "" if p has another form."""
    numbers: dict[Gen, float] = {}
    for monomial, c in p.terms.items():
        if len(monomial) != 1 or monomial[0][0].kind not in ("cos", "sin") or monomial[0][1] != 1:
            return ""
        numbers[monomial[0][0]] = float(c)
    joints = {g.name for g in numbers}
    if len(joints) != 1:
        return ""
    (joint,) = joints
    a, b = (numbers.get(Gen(kind, joint), float(ZERO)) for kind in ("cos", "sin"))
    angle = atan2(-a, b) * 180 / pi
    low, high = sorted((angle % 180 - 180, angle % 180)) if angle % 180 else (0.0, 180.0)
    psi = notation.port(f"{joint}.steer")
    return rf"{psi} = {_degrees(low)}\;\mathrm{{or}}\;{_degrees(high)}"


def _degrees(angle: float) -> str:
    return rf"{round(angle, 4) + 0.0:.7g}^{{\circ}}"
