"""Sections 2 to 4: each wheel's equations from the book's formula to numbers, their matrices, the null space of C1."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import accumulate

from wmrgen.analysis.mobility.ranks import generic, nominal_at
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.models.polynomials import NEGLIGIBLE
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import XI, ConstraintRow, along, rolling_direction, symbolic_view
from wmrgen.geometry.exact.poly import Poly, Row, dot, each, has_angles
from wmrgen.geometry.layout.records import Wheel
from wmrgen.report.sections.latex import (
    WIDE,
    alike,
    broken,
    gathered,
    latex,
    over,
    pieces,
    readable,
    terms,
    total,
    upright,
    width,
    wrapped,
)
from wmrgen.report.sections.markdown import aligned, code, math, matrix, some
from wmrgen.robotfile.wheel_types import WheelType

_MATRIX = 12  # rows of a printed matrix
_ICR = 120  # glyphs of two fractions side by side
_LINE = 70  # glyphs of matrices side by side


def wheel_rows(d: Derivation) -> list[str]:
    """Section 2: all wheel types that occur, in file order."""
    blocks = ["## 2 What each wheel demands"]
    for noun in dict.fromkeys(w.kind.noun for w in d.robot.wheels):
        wheels = [w for w in d.robot.wheels if w.kind.noun == noun]
        kind, offset = wheels[0].kind, any(w.nominal.o for w in wheels)
        title = kind.noun[0].upper() + kind.noun[1:]
        intro = kind.words.offset_intro if offset and kind.words.offset_intro else kind.words.intro
        plural = "s" if len(wheels) > 1 else ""
        blocks += [f"**{title}{plural}** ({some(wheels)}). {intro}", *general_rows(kind, offset)]
        blocks += [kind.words.note] if kind.words.note else []
        if any(w.nominal.per_steer for w in wheels):
            blocks.append(
                "Steering turns the drive joint by k for 1 rad, so that the wheel rolls r (φ̇ − k ψ̇)."
            )
        blocks += _worked(d, wheels) if kind.directed else []
    return blocks


def general_rows(kind: WheelType, offset: bool) -> list[str]:
    """The book's equations, the lateral offset added where it occurs."""
    first, second = (rf" && (3.{n})" for n in kind.words.equations) if kind.words.equations else ("", "")
    if kind.rollers:
        a, turned = r"\alpha+\beta+\gamma", r"(\beta+\gamma)"
        rolling = _row(rf"\sin({a})", rf"-\cos({a})", rf"-l\cos{turned}") + r" &= r\,\dot{\varphi}\cos\gamma"
        across = _row(rf"\cos({a})", rf"\sin({a})", rf"l\sin{turned}") + r" + r\,\dot{\varphi}\sin\gamma"
        return aligned([f"{rolling}{first}", rf"{across} &= r_{{sw}}\,\dot{{\varphi}}_{{sw}}{second}"])
    b = r"\beta(t)" if kind.turns else r"\beta"
    a = rf"\alpha+{b}"
    third, rate = ("-o", r" + o\,\dot{\psi}") if offset else ("", "")
    slide, swivel = ("d+", r" + d\,\dot{\psi}") if kind.swivels else ("", "")
    rolling = _row(rf"\sin({a})", rf"-\cos({a})", rf"-l\cos{b}{third}")
    sliding = _row(rf"\cos({a})", rf"\sin({a})", rf"{slide}l\sin{b}")
    both = [rf"{rolling} &= r\,\dot{{\varphi}}{rate}{first}", rf"{sliding}{swivel} &= 0{second}"]
    if kind.has_spin != kind.sliding_row:  # a ball has neither; its equations give what it does
        return aligned(both[:1] if kind.has_spin else both[1:])
    return aligned(both)


def _row(*entries: str) -> str:
    return rf"\begin{{bmatrix}} {' & '.join(entries)} \end{{bmatrix}}\xi"


def _worked(d: Derivation, wheels: list[Wheel]) -> list[str]:
    """The first wheel step by step; the matrices of section 3 have all of them."""
    first = wheels[0]
    own = [c for c in (*d.constraints.rolling, *d.constraints.sliding) if c.wheel.index == first.index]
    return [
        f"For {code(first.name)}, with x = l cos α and y = l sin α, that is",
        *_plugged(first, [*_equations(own), *(_rollers(first) if first.kind.rollers else [])]),
    ]


def _plugged(w: Wheel, equations: list[str]) -> list[str]:
    """sin and cos of alpha + beta (+ gamma), e = (sin, -cos), above the equations that follow."""
    ex, ey = rolling_direction(w, symbolic_view(w))
    angle = r"\alpha+\beta" + (r"+\gamma" if w.kind.rollers else "") + ("(t)" if w.turns else "")
    sine, cosine = rf"\sin({angle}) &= {latex(ex)}", rf"\cos({angle}) = {latex(-ey)}"
    lefts = [width(e.partition("&=")[0]) for e in equations]
    if max(lefts) + width(sine) + width(cosine) > _LINE:
        return [*math(rf"{sine.replace('&', '')}, \qquad {cosine}"), *aligned(equations)]
    return aligned([rf"{sine}, \qquad {cosine}", *equations])


def _equations(rows: list[ConstraintRow]) -> list[str]:
    """A wheel's equations; long ones turned round, to be broken."""
    sides = [_sides(c) for c in rows]
    if any(sum(map(width, left)) > WIDE for left, _ in sides):
        return [f"{right} &= {wrapped(left)}" for left, right in sides]
    return [f"{wrapped(left)} &= {right}" for left, right in sides]


def _sides(c: ConstraintRow) -> tuple[list[str], str]:
    """``v_x - l omega`` and ``r phi``; a sliding row's own rate stays on the left."""
    ports = {"spin": f"{c.wheel.name}.spin", "steer": f"{c.wheel.name}.steer_rate"}
    rates = Poly.sum(k * Poly.gen("input", ports[joint]) for (_, joint), k in c.rates)
    left = pieces(terms(dot(c.row, XI)))
    if c.kind == "rolling":
        return left, latex(-rates)
    return ([*left, *pieces(terms(rates))] if rates else left), "0"


def _rollers(w: Wheel) -> list[str]:
    """(3.20) of one wheel: how its rollers turn."""
    g = symbolic_view(w)
    c, s = rolling_direction(w, g)
    across = dot(along((-s, c), g), XI) + g.r * g.sg * Poly.gen("input", f"{w.name}.spin")
    rate = rf"\dot{{\varphi}}_{{sw,{notation.wheel(w.name)}}}"
    radius = latex(g.r_sw) if g.r_sw else "r_{sw}"
    return [rf"{radius}\,{rate} &= {broken(across)}"]


def matrices(d: Derivation) -> list[str]:
    """Section 3."""
    c = d.constraints
    shown = {"1f": [r.row for r in c.sliding_fixed], "1s": [r.row for r in c.sliding_steered]}
    words = (" There is no fixed wheel", " There is no steered wheel")
    absent = [
        f"{none}, so C<sub>{name}</sub> has no rows."
        for (name, rows), none in zip(shown.items(), words, strict=True)
        if not rows
    ]
    if len(absent) == 2:
        absent = [" There is neither a fixed nor a steered wheel, so C₁ has no rows."]
    own = [f"C_{{{name}}} = {_capped(rows)}" for name, rows in shown.items() if rows]
    if c.rolling:
        diagonal = _diagonal(alike([-dict(r.rates)[r.wheel.index, "spin"] for r in c.rolling]))
        own = [f"J_1 = {_capped([r.row for r in c.rolling])}", diagonal, *own]
    return [
        "## 3 The matrices",
        "The rolling equations stacked are J₁ ξ = J₂ φ̇ (3.24), the sliding equations of fixed and steered wheels "
        "are C₁ ξ = 0 with C<sub>1f</sub> above C<sub>1s</sub> (3.26). Rows follow the order of the layout table."
        + "".join(absent),
        *_packed(own),
        *_pfaffian(d),
    ]


def _packed(matrices: list[str]) -> list[str]:
    """As many in a line as fit."""
    lines: list[list[str]] = []
    used = 0
    for m in matrices:
        size = max(map(width, m.split("\n")))
        if not lines or used + size > _LINE:
            lines.append([])
            used = 0
        lines[-1].append(m)
        used += size + 4
    return [block for line in lines for block in math(r", \qquad ".join(line))]


def _diagonal(spins: list[str]) -> str:
    """J2 = diag(r cos gamma), as a multiple of the identity where all are equal."""
    if len(spins) > 1 and len(set(spins)) == 1:
        return rf"J_2 = {spins[0]}\,I_{{{len(spins)}}}"
    more = [r"\ldots"] if len(spins) > _MATRIX else []
    return rf"J_2 = \mathrm{{diag}}\left({', '.join([*spins[:_MATRIX], *more])}\right)"


def _capped(rows: list[Row]) -> str:
    return matrix([*rows[:_MATRIX], *([[r"\vdots"] * 3] if len(rows) > _MATRIX else [])])


def _pfaffian(d: Derivation) -> list[str]:
    """All velocities in one vector: A(q) q' = 0, by blocks."""
    c = d.constraints
    if not c.joints:
        return []
    castors = [w for w in d.robot.wheels if w.kind.swivels]
    turning = castors or [w for w in d.robot.wheels if w.nominal.steer_arm]
    offset, geared = (any(getattr(w.nominal, key) for w in turning) for key in ("steer_arm", "per_steer"))
    last = (" −O" if offset else " 0", " 0", " D") if turning else ("", "", "")
    rows = [f"J₁ −J₂{last[0]}" if c.rolling else "", f"C₁ 0{last[1]}" if c.sliding_fixed or c.sliding_steered else "",
            f"C<sub>c</sub> 0{last[2]}" if castors else ""]  # fmt: skip
    words = (
        f"With q̇ = (ξ, φ̇{', ψ̇' if turning else ''}) the same equations are the Pfaffian form A(q) q̇ = 0, "
        f"A = [{'; '.join(filter(None, rows))}]"
    )
    if castors:
        words += ", with the sliding rows of the castors, C<sub>c</sub> ξ + D ψ̇ = 0, and D = diag(d)"
    return [words + (f", O = diag({'o − r k' if geared else 'o'})." if offset else ".")]


def null_space(d: Derivation) -> list[str]:
    """Section 4."""
    columns = [upright(c) for c in d.mobility.null_space_symbolic]
    blocks = ["## 4 The null space: the motions that are left"]
    if not columns:
        return [*blocks, "C₁ has rank 3: no twist but ξ = 0 keeps every wheel from sliding."]
    if len(columns) == 3:
        blocks += ["No row constrains ξ: every twist lies in the null space of C₁, N = I."]
        return [*blocks, *_meaning(d, columns)]
    blocks += [
        "A motion is admissible when C₁ ξ = 0. The columns of N span these motions, cleared of common factors; every "
        "admissible twist is ξ = N η, with one number η per column:",
        *math(f"N = {matrix(zip(*(map(readable, column) for column in columns), strict=True))}"),
    ]
    return [*blocks, *_meaning(d, columns)]


def _meaning(d: Derivation, columns: Sequence[Row]) -> list[str]:
    """Which motion each column is, by what does not vanish at nominal parameters."""
    angles, zero = generic(d.robot), Poly({})
    general = columns
    columns = [
        each(c, lambda p: p if abs(nominal_at(p, d.robot, angles)) > NEGLIGIBLE else zero) for c in general
    ]
    heads = [f"Column {i + 1}" for i in range(len(columns))] if len(columns) > 1 else ["The column"]
    castors = not any(w.kind.steers for w in d.robot.wheels)
    which = "angles of the castors give" if castors else "steering angles choose"
    centre = "the ICR" if len(columns) == 1 else "a point"
    only = [
        "" if own == c else " where the parameters are nominal"
        for own, c in zip(general, columns, strict=True)
    ]
    words = (
        f"{head} {_motion(c, which, centre)}{at}." for head, c, at in zip(heads, columns, only, strict=True)
    )
    blocks = [" ".join(words)]
    vx, vy, w = columns[0]
    if len(columns) == 1 and w and any(p.constant is None for p in columns[0]):
        x, y = _quotient(-vy, w), _quotient(vx, w)
        blocks[0] += " The ICR lies at (−N₂/N₃, N₁/N₃):"
        both = rf"x_{{ICR}} = {x}, \qquad y_{{ICR}} = {y}"
        blocks += math(both) if width(both) < _ICR else aligned([f"x_{{ICR}} &= {x}", f"y_{{ICR}} &= {y}"])
    return blocks


def _quotient(above: Poly, below: Poly) -> str:
    """above / below, without a line where the sines cancel."""
    top, bottom = gathered(terms(above)), gathered(terms(below))
    if len(bottom) == 1:
        quotient = over(top, bottom[0])
        if all(f.power > 0 for t in quotient for f in t.factors):
            return total(quotient)
    if not top:
        return "0"
    shown = total(top)
    sign = "-" if shown.startswith("-") else ""  # of a product: a sum begins with what is added
    shown = shown.removeprefix(sign)
    if sign and _is_bracket(shown):
        shown = shown.removeprefix(r"\left(").removesuffix(r"\right)")
    return rf"{sign}\frac{{{shown}}}{{{total(bottom)}}}"


def _is_bracket(text: str) -> bool:
    """Whether one pair of brackets has all of it."""
    marks = re.split(r"(?=\\left|\\right)", text)
    depths = list(accumulate(mark.startswith(r"\left") - mark.startswith(r"\right") for mark in marks[1:]))
    return not marks[0] and text.endswith(r"\right)") and 0 not in depths[:-1]


def _motion(c: Row, which: str, centre: str) -> str:
    """A column in words. ``which``: what angles do; ``centre``: of a rotation."""
    vx, vy, w = c
    if not w and not vy and vx.constant is not None:
        return "is motion straight ahead"
    if not w and not vx and vy.constant is not None:
        return "is motion to the left"
    turned = has_angles(c)
    if not w:
        return f"is a translation in {f'the direction that the {which}' if turned else 'a fixed direction'}"
    if not vx and not vy:
        return "is a rotation about P"
    return f"is a rotation about {f'{centre} that the {which}' if turned else 'a fixed point'}"
