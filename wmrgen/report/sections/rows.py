"""Write sections 2 to 4: the equations of each wheel type, the matrices of all wheels, and the null space of C1."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wmrgen.analysis.kinematics.least_squares import NEGLIGIBLE
from wmrgen.analysis.mobility.ranks import generic, nominal_at
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import XI, ConstraintRow, along, rolling_direction, symbolic_view
from wmrgen.geometry.exact.poly import Poly, Row, dot, each, has_angles
from wmrgen.geometry.layout.records import Wheel
from wmrgen.report.sections.latex import (
    PAGE,
    WIDE,
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
from wmrgen.report.sections.markdown import LINE, aligned, code, keyed, math, matrix, packed, pictures, some
from wmrgen.robotfile.wheel_types import WheelType

_MATRIX = 12  # rows of a printed matrix; one of more rows does not fit on a screen


def wheel_rows(d: Derivation) -> list[str]:
    """Return section 2: all wheel types that occur, in the order of the robot file."""
    blocks = ["## 2 What each wheel demands", *pictures(d.figures, "contact.svg"), *_velocity_of_a_wheel(d)]
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
                "Steering by 1 rad turns the drive joint by k, so that the wheel rolls at r (φ̇ − k ψ̇)."
            )
        blocks += _worked(d, wheels) if kind.directed else []
    return blocks


def _velocity_of_a_wheel(d: Derivation) -> list[str]:
    """Derive the velocity of a contact point along e and n, the left sides of (3.12) and (3.13)."""
    wheels = [w for w in d.robot.wheels if w.kind.directed]
    if not wheels:
        return []
    b = r"\beta(t)" if all(w.turns for w in wheels) else r"\beta"
    a = rf"(\alpha+{b})"
    blocks = [
        keyed(
            "rows.derived",
            "P moves at v = (v<sub>x</sub>, v<sub>y</sub>), and the chassis turns at ω. Hence the pivot "
            "A = (l cos α, l sin α) of a wheel moves at v<sub>A</sub> = v + ω ẑ × A. Here ẑ × A = (−l sin α, l cos α). "
            "The wheel rolls along e, and n = ẑ × e is across it:",
        ),
        *aligned([
            rf"e &= \left(\sin{a}, -\cos{a}\right), & n &= \left(\cos{a}, \sin{a}\right)",
            rf"e\cdot(\hat{{z}}\times A) &= -l\left(\sin\alpha\sin{a} + \cos\alpha\cos{a}\right) &&= -l\cos{b}",
            rf"n\cdot(\hat{{z}}\times A) &= l\left(\cos\alpha\sin{a} - \sin\alpha\cos{a}\right) &&= l\sin{b}",
        ]),
        "e · v<sub>A</sub> and n · v<sub>A</sub> are therefore the products of ξ with the brackets below.",
    ]  # fmt: skip
    blocks[-1] += _off_the_pivot(wheels)
    if any(w.kind.rollers for w in wheels):
        blocks[-1] += " Rollers let a wheel move freely across their axis, so its e and n are turned by γ."
    return blocks


def _off_the_pivot(wheels: Sequence[Wheel]) -> str:
    """Derive the terms of a contact point that is not below the pivot; "" if there is none."""
    trail, offset = any(w.nominal.d for w in wheels), any(w.nominal.o for w in wheels)
    if not (trail or offset):
        return ""
    place = " + ".join(["d e"] * trail + ["o n"] * offset)
    terms_of = " and ".join(
        ["n · v<sub>B</sub> = n · v<sub>A</sub> + d (ω + ψ̇)"] * trail
        + ["e · v<sub>B</sub> = e · v<sub>A</sub> − o (ω + ψ̇)"] * offset
    )
    return keyed(
        "rows.off_the_pivot",
        f" A contact point B = A + {place} also turns with the wheel, at ω + ψ̇. With ẑ × e = n and ẑ × n = −e, "
        f"{terms_of}.",
    )


def general_rows(kind: WheelType, offset: bool) -> list[str]:
    """Return the equations of the book for a wheel type. ``offset`` adds the lateral offset of the contact point."""
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
    if kind.has_spin != kind.sliding_row:  # a ball has neither; its equations give its motion
        return aligned(both[:1] if kind.has_spin else both[1:])
    return aligned(both)


def _row(*entries: str) -> str:
    return rf"\begin{{bmatrix}} {' & '.join(entries)} \end{{bmatrix}}\xi"


def _worked(d: Derivation, wheels: list[Wheel]) -> list[str]:
    """Return the equations of the first wheel step by step; section 3 has the matrices of all wheels."""
    first = wheels[0]
    own = [c for c in (*d.constraints.rolling, *d.constraints.sliding) if c.wheel.index == first.index]
    return [
        f"For {code(first.name)}, with x = l cos α and y = l sin α, these are",
        *_plugged(first, [*equations(own), *(_rollers(first) if first.kind.rollers else [])]),
    ]


def _plugged(w: Wheel, equations: list[str]) -> list[str]:
    """Return the sine and cosine of alpha + beta (+ gamma) above the equations that follow from them."""
    ex, ey = rolling_direction(w, symbolic_view(w))
    angle = r"\alpha+\beta" + (r"+\gamma" if w.kind.rollers else "") + ("(t)" if w.turns else "")
    sine, cosine = rf"\sin({angle}) &= {latex(ex)}", rf"\cos({angle}) = {latex(-ey)}"
    lefts = [width(e.partition("&=")[0]) for e in equations]
    if max(lefts) + width(sine) + width(cosine) > LINE:
        return [*math(rf"{sine.replace('&', '')}, \qquad {cosine}"), *aligned(equations)]
    return aligned([rf"{sine}, \qquad {cosine}", *equations])


def equations(rows: list[ConstraintRow]) -> list[str]:
    """Return the equations of a wheel. Long ones have their sides exchanged, because only a right side is broken."""
    sides = [_sides(c) for c in rows]
    if any(sum(map(width, left)) > WIDE for left, _ in sides):
        return [f"{right} &= {wrapped(left)}" for left, right in sides]
    return [f"{wrapped(left)} &= {right}" for left, right in sides]


def _sides(c: ConstraintRow) -> tuple[list[str], str]:
    """Return both sides of a row, such as v_x - l omega and r phi. The rate of a sliding row stays on the left."""
    ports = {"spin": f"{c.wheel.name}.spin", "steer": f"{c.wheel.name}.steer_rate"}
    rates = Poly.sum(k * Poly.gen("input", ports[joint]) for (_, joint), k in c.rates)
    left = pieces(terms(dot(c.row, XI)))
    if c.kind == "rolling":
        return left, latex(-rates)
    return ([*left, *pieces(terms(rates))] if rates else left), "0"


def _rollers(w: Wheel) -> list[str]:
    """Return (3.20) of one wheel: the rate of its rollers."""
    g = symbolic_view(w)
    c, s = rolling_direction(w, g)
    across = dot(along((-s, c), g), XI) + g.r * g.sg * Poly.gen("input", f"{w.name}.spin")
    rate = rf"\dot{{\varphi}}_{{sw,{notation.wheel(w.name)}}}"
    radius = latex(g.r_sw) if g.r_sw else "r_{sw}"
    return [rf"{radius}\,{rate} &= {broken(across)}"]


def matrices(d: Derivation) -> list[str]:
    """Return section 3."""
    c = d.constraints
    shown = {"1f": [r.row for r in c.sliding_fixed], "1s": [r.row for r in c.sliding_steered]}
    if not any(shown.values()):
        absent = keyed(
            "matrices.no_rows", " There is neither a fixed nor a steered wheel, so C₁ has no rows."
        )
    elif not shown["1f"]:
        absent = keyed("matrices.no_fixed", " There is no fixed wheel, so C<sub>1f</sub> has no rows.")
    elif not shown["1s"]:
        absent = keyed("matrices.no_steered", " There is no steered wheel, so C<sub>1s</sub> has no rows.")
    else:
        absent = ""
    own = [f"C_{{{name}}} = {_capped(rows)}" for name, rows in shown.items() if rows]
    if c.rolling:
        diagonal = _diagonal([latex(-dict(r.rates)[r.wheel.index, "spin"]) for r in c.rolling])
        own = [f"J_1 = {_capped([r.row for r in c.rolling])}", diagonal, *own]
    return [
        "## 3 The matrices",
        "The rolling equations of all wheels are J₁ ξ = J₂ φ̇ (3.24). The sliding equations of fixed and steered wheels "
        "are C₁ ξ = 0, with C<sub>1f</sub> above C<sub>1s</sub> (3.26). Rows are in the order of the layout table."
        + absent,
        *packed(own),
        *_pfaffian(d),
    ]


def _diagonal(spins: list[str]) -> str:
    """Return J2 = diag(r cos gamma), as a multiple of the identity if all entries are equal."""
    if len(spins) > 1 and len(set(spins)) == 1:
        return rf"J_2 = {spins[0]}\,I_{{{len(spins)}}}"
    more = [r"\ldots"] if len(spins) > _MATRIX else []
    return rf"J_2 = \mathrm{{diag}}\left({', '.join([*spins[:_MATRIX], *more])}\right)"


def _capped(rows: list[Row]) -> str:
    return matrix([*rows[:_MATRIX], *([[r"\vdots"] * 3] if len(rows) > _MATRIX else [])])


def _pfaffian(d: Derivation) -> list[str]:
    """Write the Pfaffian form A(q) q' = 0 of all velocities, by blocks."""
    c = d.constraints
    if not c.joints:
        return []
    castors = [w for w in d.robot.wheels if w.kind.swivels]
    turning = castors or [w for w in d.robot.wheels if w.nominal.steer_arm]
    offset = any(w.nominal.steer_arm for w in turning)
    geared = any(w.nominal.per_steer for w in turning)
    last = (" −O" if offset else " 0", " 0", " D") if turning else ("", "", "")
    rows = [f"J₁ −J₂{last[0]}" if c.rolling else "", f"C₁ 0{last[1]}" if c.sliding_fixed or c.sliding_steered else "",
            f"C<sub>c</sub> 0{last[2]}" if castors else ""]  # fmt: skip
    words = (
        f"With q̇ = (ξ, φ̇{', ψ̇' if turning else ''}), the same equations are the Pfaffian form A(q) q̇ = 0, "
        f"A = [{'; '.join(filter(None, rows))}]"
    )
    if castors:
        words += ". The sliding rows of the castors are C<sub>c</sub> ξ + D ψ̇ = 0, with D = diag(d)"
    return [words + (f", O = diag({'o − r k' if geared else 'o'})." if offset else ".")]


def null_space(d: Derivation) -> list[str]:
    """Return section 4."""
    columns = [upright(c) for c in d.mobility.null_space_symbolic]
    blocks = ["## 4 The null space: the motions that are left"]
    if not columns:
        return [*blocks, "C₁ has rank 3: only at ξ = 0 does no wheel slide."]
    if len(columns) == 3:
        blocks += ["No row constrains ξ: every twist is in the null space of C₁, and N = I."]
        return [*blocks, *_meaning(d, columns)]
    blocks += [
        f"A motion is admissible if C₁ ξ = 0. The columns of N span these motions{_orthogonal(d)}. Every admissible "
        "twist is ξ = N η, with one number η per column:",
        *math(f"N = {matrix(zip(*(map(readable, column) for column in columns), strict=True))}"),
    ]
    return [*blocks, *_meaning(d, columns)]


def _orthogonal(d: Derivation) -> str:
    """Say how N follows from the rows of C1; "" if couplings constrain the twist too."""
    m = d.mobility
    if m.rank_C1.value != 3 - m.degree_of_mobility:
        return ""
    if m.degree_of_mobility == 1:
        return keyed(
            "null_space.cross", ": N is the cross product of two independent rows, without common factors"
        )
    return keyed("null_space.row", ": both are orthogonal to the one independent row")


def _meaning(d: Derivation, columns: Sequence[Row]) -> list[str]:
    """Say which motion each column is, from the entries that do not vanish at nominal parameters."""
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
        f"{head} is {_motion(c, which, centre)}{at}."
        for head, c, at in zip(heads, columns, only, strict=True)
    )
    blocks = [" ".join(words)]
    vx, vy, w = columns[0]
    if len(columns) == 1 and w and any(p.constant is None for p in columns[0]):
        x, y = quotient(-vy, w), quotient(vx, w)
        blocks[0] += " The ICR is at (−N₂/N₃, N₁/N₃):"
        both = rf"x_{{ICR}} = {x}, \qquad y_{{ICR}} = {y}"
        blocks += math(both) if width(both) < PAGE else aligned([f"x_{{ICR}} &= {x}", f"y_{{ICR}} &= {y}"])
    return blocks


def quotient(above: Poly, below: Poly) -> str:
    """Return above / below as LaTeX: without a fraction if the sines cancel, with a common sign before it."""
    top, bottom = gathered(terms(above)), gathered(terms(below))
    if len(bottom) == 1:
        quotient = over(top, bottom[0])
        if all(f.power > 0 for t in quotient for f in t.factors):
            return total(quotient)
    if not top:
        return "0"
    sign = ""
    if total(top).startswith("-"):  # all terms are negative: a sum begins with a positive term
        sign, top = "-", [replace(t, number=-t.number) for t in top]
    return rf"{sign}\frac{{{total(top)}}}{{{total(bottom)}}}"


def _motion(c: Row, which: str, centre: str) -> str:
    """Return the motion of a column in words.

    Args:
        c: the column.
        which: what the joint angles do, "steering angles choose".
        centre: the centre of a rotation that depends on joint angles.

    Returns:
        A noun phrase with the key of the kind of motion.
    """
    vx, vy, w = c
    if not w and not vy and vx.constant is not None:
        return keyed("column.ahead", "motion straight ahead")
    if not w and not vx and vy.constant is not None:
        return keyed("column.left", "motion to the left")
    turned = has_angles(c)
    if not w:
        direction = f"the direction that the {which}" if turned else "a fixed direction"
        return keyed("column.translation", f"a translation in {direction}")
    if not vx and not vy:
        return keyed("column.rotation_about_p", "a rotation about P")
    if not turned:
        return keyed("column.rotation_about_fixed_point", "a rotation about a fixed point")
    key = "column.rotation_about_icr" if "ICR" in centre else "column.rotation_about_point"
    return keyed(key, f"a rotation about {centre} that the {which}")
