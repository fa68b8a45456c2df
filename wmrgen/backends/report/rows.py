"""Sections 2 to 4: each wheel's equations from the book's formula to numbers, their matrices, the null space of C1."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from wmrgen import notation
from wmrgen.backends.report.angles import readable, whole
from wmrgen.backends.report.latex import WIDE, broken, latex, matrix, pieces, terms, width, wrapped
from wmrgen.backends.report.markdown import CAP, aligned, code, cut_note, grouped, items, listed, math
from wmrgen.constraints import (
    XI,
    ConstraintRow,
    along,
    constrain,
    nominal_view,
    pfaffian,
    rolling_direction,
    symbolic_view,
    working_view,
)  # fmt: skip
from wmrgen.exact.poly import Poly, Row, dot

if TYPE_CHECKING:
    from wmrgen.layout.records import Wheel
    from wmrgen.robot import Derivation
    from wmrgen.wheels import WheelType

_MATRIX = 12  # rows of a printed matrix
_PFAFFIAN = 9  # columns of a printed Pfaffian matrix
_CHECK = 66  # glyphs of a printed product C1 N


def wheel_rows(d: Derivation) -> list[str]:
    """Section 2: all wheel types that occur, in file order."""
    blocks = [
        "## 2 What each wheel demands",
        "Each wheel gives one equation along its rolling direction and, unless it slides freely, one across it.",
    ]
    for name in dict.fromkeys(w.type for w in d.robot.wheels):
        wheels = [w for w in d.robot.wheels if w.type == name]
        kind, offset = wheels[0].kind, any(w.nominal.o for w in wheels)
        title = kind.noun[0].upper() + kind.noun[1:]
        intro = kind.words.offset_intro if offset and kind.words.offset_intro else kind.words.intro
        blocks += [f"### {title}s: {listed([w.name for w in wheels])}", intro, *general_rows(kind, offset)]
        blocks += [kind.words.note] if kind.words.note else []
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
    """The first wheel step by step, then all of them."""
    shown = {w.index for w in wheels[:CAP]}
    rolling = [c for c in d.constraints.rolling if c.wheel.index in shown]
    sliding = [c for c in d.constraints.sliding if c.wheel.index in shown]
    first = wheels[0]
    only = code(first.name) if len(wheels) == 1 else "every wheel"
    blocks = [
        f"For {code(first.name)} the sum of angles gives",
        *_plugged(first),
        f"and with its pivot's coordinates, x = l cos α and y = l sin α, the {'rolling' if rolling else 'sliding'} "
        f"equation of {only} reads",
        *_equations(rolling or sliding),
    ]
    if first.kind.rollers:
        blocks += ["The rollers turn with", *_rollers(first)]
    if rolling and sliding:
        blocks += ["and the sliding equation", *_equations(sliding)]
    return blocks + cut_note(wheels)


def _plugged(w: Wheel) -> list[str]:
    """sin and cos of alpha + beta (+ gamma): e = (sin, -cos)."""
    ex, ey = rolling_direction(w, symbolic_view(w))
    angle = r"\alpha+\beta" + (r"+\gamma" if w.kind.rollers else "") + ("(t)" if w.turns else "")
    return math(rf"\sin({angle}) = {latex(ex)}, \qquad \cos({angle}) = {latex(-ey)}")


def _equations(rows: list[ConstraintRow]) -> list[str]:
    """Equal equations once, with the names of all wheels that give them; long ones turned round, to be broken."""
    sides = [_sides(c) for c in rows]
    long = any(sum(map(width, left)) > WIDE for left, _ in sides)
    texts = [
        f"{right} &= {wrapped(left)}" if long else f"{wrapped(left)} &= {right}" for left, right in sides
    ]
    wheels = grouped(zip(texts, (notation.wheel(c.wheel.name) for c in rows), strict=True))
    return aligned(
        text if who[0] in text else f"{text} && ({', '.join(who)})" for text, who in wheels.items()
    )


def _sides(c: ConstraintRow) -> tuple[list[str], str]:
    """``v_x - l omega`` and ``r phi``; a sliding row's own rate stays on the left."""
    ports = {"spin": f"{c.wheel.name}.spin", "steer": f"{c.wheel.name}.steer_rate"}
    rates = Poly.sum(k * Poly.gen("input", ports[joint]) for (_, joint), k in c.rates)
    left = pieces(terms(dot(c.row, XI)))
    if c.kind == "rolling":
        return left, latex(-rates)
    return ([*left, *pieces(terms(rates))] if rates else left), "0"


def _rollers(w: Wheel) -> list[str]:
    """(3.20) of one wheel."""
    g = symbolic_view(w)
    c, s = rolling_direction(w, g)
    across = dot(along((-s, c), g), XI) + g.r * g.sg * Poly.gen("input", f"{w.name}.spin")
    rate = rf"\dot{{\varphi}}_{{sw,{notation.wheel(w.name)}}}"
    radius = latex(g.r_sw) if g.r_sw else "r_{sw}"
    return aligned([rf"{radius}\,{rate} &= {broken(across)}"])


def matrices(d: Derivation) -> list[str]:
    """Section 3."""
    letters, numbers = d.constraints, constrain(d.robot, nominal_view)
    blocks = [
        "## 3 The matrices",
        "The rolling equations stacked are J₁ ξ = J₂ φ̇ (3.24), the sliding equations of fixed and steered wheels "
        "are C₁ ξ = 0 with C<sub>1f</sub> above C<sub>1s</sub> (3.26). Rows follow the order of the layout table.",
    ]
    if letters.rolling:
        blocks += _shown("J_1", letters.rolling, numbers.rolling)
        blocks += _diagonal([latex(-dict(r.rates)[r.wheel.index, "spin"]) for r in letters.rolling])
    for absent, index, own, same in (
        ("There is no fixed wheel", "1f", letters.sliding_fixed, numbers.sliding_fixed),
        ("There is no steered wheel", "1s", letters.sliding_steered, numbers.sliding_steered),
    ):
        empty = f"{absent}, so C<sub>{index}</sub> has no rows."
        blocks += _shown(f"C_{{{index}}}", own, same) if own else [empty]
    return blocks + _pfaffian(d)


def _diagonal(spins: list[str]) -> list[str]:
    """J2 = diag(r cos gamma), as a multiple of the identity where all are equal."""
    if len(spins) > 1 and len(set(spins)) == 1:
        return math(rf"J_2 = {spins[0]}\,I_{{{len(spins)}}}")
    more = [r"\ldots"] if len(spins) > _MATRIX else []
    return math(rf"J_2 = \mathrm{{diag}}\left({', '.join([*spins[:_MATRIX], *more])}\right)")


def _shown(label: str, letters: Sequence[ConstraintRow], numbers: Sequence[ConstraintRow]) -> list[str]:
    """A matrix in letters and, where letters occur, in numbers."""
    rows, values = [c.row for c in letters], [c.row for c in numbers]
    blocks = math(f"{label} = {_capped(rows)}")
    if rows != values:
        blocks += ["With the values of section 1:", *math(f"{label} = {_capped(values)}")]
    return blocks


def _capped(rows: list[Row]) -> str:
    return matrix([*rows[:_MATRIX], *([[r"\vdots"] * 3] if len(rows) > _MATRIX else [])])


def _pfaffian(d: Derivation) -> list[str]:
    """All velocities in one vector: A(q) q' = 0."""
    joints = d.constraints.joints
    if not joints:
        return []
    blocks = [
        "With every joint rate in one vector the same equations are the Pfaffian form A(q) q̇ = 0, the starting "
        "point of any test of integrability."
    ]
    rows = [*d.constraints.rolling, *d.constraints.sliding]
    columns = 3 + len(joints)
    if columns > _PFAFFIAN:
        return [*blocks, f"(A has {len(rows)} rows and {columns} columns here.)"]
    entries = [[latex(p) for p in row] for row in pfaffian(d.constraints, slip=False)]
    if sum(max(map(width, column)) for column in zip(*entries, strict=True)) + 3 * len(joints) > WIDE:
        return [*blocks, f"(A is too wide to print: {len(rows)} rows and {columns} columns.)"]
    rates = {"spin": "spin", "steer": "steer_rate"}
    ports = [notation.port(f"{d.robot.wheels[i].name}.{rates[joint]}") for i, joint in joints]
    vector = ", ".join(["v_x", "v_y", r"\omega", *ports])
    return [*blocks, *aligned([rf"\dot{{q}} &= \left({vector}\right)^T", rf"A &= {matrix(entries)}"])]


def null_space(d: Derivation) -> list[str]:
    """Section 4."""
    columns = [whole(c) for c in d.mobility.null_space_symbolic]
    blocks = ["## 4 The null space: the motions that are left"]
    if not columns:
        return [*blocks, "C₁ has rank 3: no twist but ξ = 0 keeps every wheel from sliding."]
    if len(columns) == 3:
        blocks += ["No row constrains ξ: every twist lies in the null space of C₁, N = I."]
        return [*blocks, *_meaning(columns)]
    blocks += [
        "A motion is admissible when C₁ ξ = 0. The columns of N span these motions, cleared of common factors:",
        *math(f"N = {matrix(zip(*map(_entries, columns), strict=True))}"),
    ]
    return [*blocks, *_check(d, columns), *_meaning(columns)]


def _entries(column: Row) -> list[str]:
    return [readable(p) for p in column]


def _check(d: Derivation, columns: Sequence[Row]) -> list[str]:
    """C1 N = 0, with independent rows of C1."""
    rows, every = _independent(d)
    if any(dot(r, c) for r in rows for c in columns):
        rows, columns = list(d.mobility.basis_rows), [whole(c) for c in d.mobility.null_space]
    words = "Check"
    if not every:
        steered = any(w.kind.steers for w in d.robot.wheels)
        words += ", with rows of C₁ that are independent" + (
            " at a generic admissible steering" if steered else ""
        )
    basis = [*zip(*map(_entries, columns), strict=True)]
    printed = [[latex(p) for p in row] for row in rows]
    if sum(max(sum(map(width, row)) for row in m) for m in (printed, basis)) > _CHECK:
        products = [rf"C_{{1,{i}}}\,N &= 0, & C_{{1,{i}}} &= {matrix([r])}" for i, r in enumerate(rows, 1)]
        return [f"{words}: each of them times N vanishes identically.", *aligned(products)]
    zeros = matrix([["0"] * len(columns)] * len(rows))
    return [f"{words}:", *math(matrix(rows), f"{matrix(basis)} = {zeros}")]


def _independent(d: Derivation) -> tuple[list[Row], bool]:
    """The basis rows of C1 in letters where they are rows of wheels; and whether they are all rows."""
    working = constrain(d.robot, working_view).sliding
    symbolic = d.constraints
    letters = {w.row: r.row for w, r in zip(reversed(working), reversed(symbolic.sliding), strict=True)}
    basis = d.mobility.basis_rows
    count = len(symbolic.sliding_fixed) + len(symbolic.sliding_steered)
    return [letters.get(row, row) for row in basis], count == len(basis)


def _meaning(columns: Sequence[Row]) -> list[str]:
    """What each column does with the robot."""
    heads = [f"Column {i + 1}" for i in range(len(columns))] if len(columns) > 1 else ["The column"]
    blocks = items(f"{head} {_motion(c)}" for head, c in zip(heads, columns, strict=True))
    vx, vy, w = columns[0]
    if len(columns) == 1 and w and any(p.constant is None for p in columns[0]):
        x, y = (rf"\frac{{{readable(a)}}}{{{readable(w)}}}" if a else "0" for a in (-vy, vx))
        blocks += ["The ICR lies at (−N₂/N₃, N₁/N₃):", *aligned([f"x_{{ICR}} &= {x}", f"y_{{ICR}} &= {y}"])]
    return [*blocks, "Every admissible twist is ξ = N η, with one number η per column."]


def _motion(c: Row) -> str:
    """A column in words."""
    vx, vy, w = c
    if not w and not vy and vx.constant is not None:
        return "drives straight ahead."
    if not w and not vx and vy.constant is not None:
        return "moves to the left."
    if not w:
        return f"moves {'without' if vx.constant is None else 'along a fixed direction without'} turning."
    if not vx and not vy:
        return "turns on the spot about P."
    if any(g.kind in ("cos", "sin") for p in c for g in p.generators):
        return "turns about the ICR that the steering angles choose."
    return "turns about a fixed point."
