"""Exact polynomials as LaTeX, straight from their terms.

A term is a number and factors; sums collect what multiplies the same velocity and pull common factors out.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from wmrgen import notation
from wmrgen.backends.report.numbers import magnitude
from wmrgen.exact.number import ONE, Exact
from wmrgen.exact.poly import Gen, Poly, Row

_LEADS = {"vx": 0, "vy": 1, "omega": 2, "vx_driven": 0, "vy_driven": 1, "omega_driven": 2}
_SPACE = "\\;"
_TWIST = {notation.port(n) for n in _LEADS}
WIDE = 80  # characters of a line before a sum is broken


@dataclass(frozen=True, slots=True)
class Factor:
    """base**power. ``rank``: parameters 0, functions 1, velocities 2 (collected). ``order``: within a rank."""

    base: str
    power: int
    rank: int
    order: tuple[int, str]
    compound: bool = False  # the base is a sum

    def shown(self) -> str:
        """The factor with a positive power."""
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
    """number * product of factors"""

    number: Exact
    factors: tuple[Factor, ...]


def poly(value: Poly) -> str:
    """A polynomial."""
    return total(terms_of(value))


def terms_of(value: Poly) -> list[Term]:
    """The terms of a polynomial."""
    return [Term(c, tuple(_factor(g, e) for g, e in m)) for m, c in value.terms.items()]


def _factor(gen: Gen, power: int) -> Factor:
    match gen.kind:
        case "param":
            return Factor(notation.parameter(gen.name), power, 0, (0, gen.name))
        case "pi":
            return Factor(r"\pi", power, 0, (0, ""))
        case "cos" | "sin":
            return Factor(
                rf"\{gen.kind}{notation.port(gen.name + '.steer')}", power, 1, (0, gen.name + gen.kind)
            )
        case "input" | "local":
            late = 3 if gen.name.endswith(".spin") else 4  # joints in file order, spins before steering rates
            return Factor(notation.port(gen.name), power, 2, (_LEADS.get(gen.name, late), ""))
        case "inv":
            return Factor(poly(gen.args[0]), -power, 0, (1, gen.key), True)
        case "sqrt":
            return Factor(rf"\sqrt{{{poly(gen.args[0])}}}", power, 0, (1, gen.key))
    arguments = ", ".join(poly(a) for a in gen.args)
    head = r"\mathrm{atan2}" if gen.kind == "atan2" else "\\" + gen.kind.removesuffix("f")
    return Factor(rf"{head}\left({arguments}\right)", power, 1, (1, gen.key))


def total(terms: Sequence[Term]) -> str:
    """The sum of terms."""
    return "".join(pieces(terms)).removeprefix("+").strip() or "0"


def pieces(terms: Sequence[Term]) -> list[str]:
    """The signed summands of a sum, each beginning with + or -."""
    if len(terms) < 2:
        return [_product(t.number, t.factors) for t in terms]
    common, number = _common(terms), _size(terms)
    if common or number != 1:
        rest = [Term(t.number / number, _without(t.factors, common)) for t in terms]
        inner = total(rest)
        return [_product(number, common, inner)]
    groups: dict[str, list[Term]] = {}
    for t in sorted(terms, key=_key):
        groups.setdefault(_lead(t), []).append(t)
    signed: list[str] = []
    for lead, members in groups.items():
        if not lead or len(members) == 1:
            signed += [_product(t.number, t.factors) for t in members]
            continue
        rest = [Term(t.number, tuple(f for f in t.factors if f.base != lead)) for t in members]
        inside = pieces(rest)
        one = inside[0] if len(inside) == 1 else rf"+\left({total(rest)}\right)"
        signed.append(f"{one}{lead}" if one.endswith(")") else f"{one}{_SPACE}{lead}")
    two_joints = len(signed) == 2 and not any(lead in _TWIST for lead in groups)
    if two_joints or not any(groups):
        return sorted(signed, key=lambda piece: piece.startswith("-"))
    return signed


def summands(terms: Sequence[Term]) -> list[str]:
    """Like ``pieces``, for a formula that may be broken: a long sum in brackets stays a list."""
    parts = pieces(terms)
    if len(parts) != 1 or len(terms) < 2 or width(parts[0]) <= WIDE:
        return parts
    common, number = _common(terms), _size(terms)
    inside = pieces([Term(t.number / number, _without(t.factors, common)) for t in terms])
    if len(inside) < 2:
        return parts
    head = _product(number, common)
    head = head[:1] if head in ("+1", "-1") else head
    return [rf"{head}\Bigl({inside[0].removeprefix('+')}", *inside[1:-1], rf"{inside[-1]}\Bigr)"]


def _lead(t: Term) -> str:
    return next((f.base for f in t.factors if f.rank == 2 and f.power == 1), "")


def _key(t: Term) -> tuple[object, ...]:
    leads = tuple(f.order for f in t.factors if f.rank == 2)
    plain = not any(f.rank == 1 for f in t.factors)
    return leads or ((9, ""),), plain, tuple((f.rank, *f.order) for f in t.factors)


def _common(terms: Sequence[Term]) -> tuple[Factor, ...]:
    """Factors that every term has, with the smallest power."""
    shared = []
    for f in terms[0].factors:
        powers = [next((g.power for g in t.factors if g.base == f.base), 0) for t in terms]
        if all(p > 0 for p in powers):
            shared.append(replace(f, power=min(powers)))
        elif all(p < 0 for p in powers):
            shared.append(replace(f, power=max(powers)))
    return tuple(shared)


def _without(factors: tuple[Factor, ...], common: tuple[Factor, ...]) -> tuple[Factor, ...]:
    taken = {f.base: f.power for f in common}
    reduced = (replace(f, power=f.power - taken.get(f.base, 0)) for f in factors)
    return tuple(f for f in reduced if f.power)


def _size(terms: Sequence[Term]) -> Exact:
    """The number to pull out: the common magnitude; negative when all terms are and nothing is collected."""
    first = abs(terms[0].number)
    negative = all(t.number.sign < 0 for t in terms) and not any(map(_lead, terms))
    sign = Exact(-1) if negative else ONE
    return sign * first if all(t.number == first or t.number == -first for t in terms) else sign


def _product(number: Exact, factors: Iterable[Factor], inner: str = "") -> str:
    """One signed summand; ``inner`` is a sum that is multiplied with it."""
    sign = "-" if number.sign < 0 else "+"
    ordered = sorted(factors, key=lambda f: (f.rank, f.order))
    m = magnitude(number)
    above = [f.shown() for f in ordered if f.power > 0 and f.rank < 2]
    leads = "".join(f"{_SPACE}{f.shown()}" for f in ordered if f.power > 0 and f.rank == 2)
    below = [f for f in ordered if f.power < 0]
    bottom = [m.below] if m.below else []
    if len(below) == 1 and not bottom and below[0].power == -1:
        bottom = [below[0].base]
    else:
        bottom += [f.shown() for f in below]
    if inner and bottom and not (above or leads or m.above):
        return rf"{sign}\frac{{{inner}}}{{{_times(bottom)}}}"
    leads += rf"\left({inner}\right)" if inner else ""
    alone = not above and not leads
    head = m.above
    if m.compound and (above if bottom else not alone):
        head = rf"\left({head}\right)"
    top = _times([head, *above] if head else above)
    if bottom:
        if not top and leads and not inner:
            return rf"{sign}\frac{{{leads.removeprefix(_SPACE)}}}{{{_times(bottom)}}}"
        return rf"{sign}\frac{{{top or '1'}}}{{{_times(bottom)}}}{leads}"
    return sign + (f"{top}{leads}" if top else leads.removeprefix(_SPACE) or "1")


def _times(parts: Sequence[str]) -> str:
    return r"\,".join(parts)


def width(text: str) -> int:
    """Roughly how many characters a reader sees."""
    count, skip = 0, False
    for i, ch in enumerate(text):
        if ch == "\\":
            skip = True
            count += text[i + 1 : i + 2].isalpha()
        elif skip and not ch.isalpha():
            skip = False
        if not skip and ch not in "{}^_ \\,":
            count += 1
    return count


def broken(parts: Sequence[str], limit: int = WIDE) -> str:
    """Signed summands on one line, or on several inside ``aligned``: each further line begins with a sign."""
    lines, used = [""], 0
    for part in parts:
        size = width(part)
        if used and used + size > limit:
            lines.append("")
            used = 0
        lines[-1] += part
        used += size
    lines[0] = lines[0].removeprefix("+")
    return "\\\\\n&\\qquad ".join(lines) or "0"


def matrix(rows: Sequence[Sequence[str]]) -> str:
    """A bracketed matrix of finished entries."""
    end = " \\\\[4pt]\n" if any("\\frac" in entry for row in rows for entry in row) else " \\\\\n"
    body = end.join(" & ".join(row) for row in rows)
    return f"\\begin{{bmatrix}}\n{body}\n\\end{{bmatrix}}"


def rows(values: Sequence[Row]) -> str:
    """A matrix of polynomials."""
    return matrix([[poly(p) for p in row] for row in values])
