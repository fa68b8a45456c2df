"""Sections 3 and 4: the rows as matrices, and the null space of C1."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from wmrgen import notation
from wmrgen.backends.report.markdown import aligned, items, math
from wmrgen.backends.report.subject import Subject
from wmrgen.backends.report.tex import WIDE, matrix, poly, rows, width
from wmrgen.constraints import constrain, working_view
from wmrgen.exact.poly import Poly, Row, dot

if TYPE_CHECKING:
    from wmrgen.constraints import ConstraintRow

_CAP = 12  # rows of a printed matrix
_PFAFFIAN = 9  # columns of a printed Pfaffian matrix


def matrices(s: Subject) -> list[str]:
    """Section 3."""
    c = s.rows
    blocks = [
        "## 3 The matrices",
        "The rolling equations stacked are J₁ ξ = J₂ φ̇ (3.24), the sliding equations of fixed and steered wheels "
        "are C₁ ξ = 0 with C<sub>1f</sub> above C<sub>1s</sub> (3.26). Rows follow the order of the layout table.",
    ]
    if c.rolling:
        blocks += _shown("J_1", c.rolling, s.values.rolling)
        blocks += _diagonal([poly(-dict(r.rates)[r.wheel.index, "spin"]) for r in c.rolling])
    for label, absent, letters, numbers in (
        ("C_{1f}", "There is no fixed wheel, so C<sub>1f</sub>", c.sliding_fixed, s.values.sliding_fixed),
        (
            "C_{1s}",
            "There is no steered wheel, so C<sub>1s</sub>",
            c.sliding_steered,
            s.values.sliding_steered,
        ),
    ):
        blocks += _shown(label, letters, numbers) if letters else [f"{absent} has no rows."]
    return blocks + _pfaffian(s)


def _diagonal(spins: list[str]) -> list[str]:
    """J2 = diag(r cos gamma), as a multiple of the identity where all are equal."""
    if len(spins) > 1 and len(set(spins)) == 1:
        return math(rf"J_2 = {spins[0]}\,I_{{{len(spins)}}}")
    more = [r"\ldots"] if len(spins) > _CAP else []
    return math(rf"J_2 = \mathrm{{diag}}\left({', '.join([*spins[:_CAP], *more])}\right)")


def _shown(label: str, symbolic: Sequence[ConstraintRow], nominal: Sequence[ConstraintRow]) -> list[str]:
    """A matrix in letters and, where letters occur, in numbers."""
    blocks = math(f"{label} = {_capped([c.row for c in symbolic])}")
    if any(a.row != b.row for a, b in zip(symbolic, nominal, strict=True)):
        blocks += ["With the values of section 1:", *math(f"{label} = {_capped([c.row for c in nominal])}")]
    return blocks


def _capped(values: Sequence[Row]) -> str:
    entries = [[poly(p) for p in row] for row in values[:_CAP]]
    if len(values) > _CAP:
        entries.append([r"\vdots"] * 3)
    return matrix(entries)


def _pfaffian(s: Subject) -> list[str]:
    """All velocities in one vector: A(q) q' = 0."""
    c = s.rows
    joints = c.joints
    if not joints:
        return []
    ports = [f"{s.robot.wheels[i].name}.{'spin' if j == 'spin' else 'steer_rate'}" for i, j in joints]
    blocks = [
        "With every joint rate in one vector the same equations are the Pfaffian form A(q) q̇ = 0, the starting "
        "point of any test of integrability."
    ]
    if 3 + len(joints) > _PFAFFIAN:
        return [
            *blocks,
            f"(A has {len(c.rolling) + len(c.sliding)} rows and {3 + len(joints)} columns here.)",
        ]
    entries = []
    for r in (*c.rolling, *c.sliding):
        rates = dict(r.rates)
        entries.append([poly(p) for p in (*r.row, *(rates.get(j, Poly({})) for j in joints))])
    vector = ", ".join(["v_x", "v_y", r"\omega", *(notation.port(p) for p in ports)])
    size = sum(max(width(row[i]) for row in entries) for i in range(3 + len(joints))) + 3 * len(joints)
    if size > WIDE:
        return [*blocks, f"(A is too wide to print: {len(entries)} rows and {3 + len(joints)} columns.)"]
    return [*blocks, *aligned([rf"\dot{{q}} &= \left({vector}\right)^T", rf"A &= {matrix(entries)}"])]


def null_space(s: Subject) -> list[str]:
    """Section 4."""
    columns = s.mobility.null_space_symbolic
    blocks = ["## 4 The null space: the motions that are left"]
    if not columns:
        return [*blocks, "C₁ has rank 3: no twist but ξ = 0 keeps every wheel from sliding."]
    if len(columns) == 3:
        blocks += ["No row constrains ξ, so the null space of C₁ is the whole plane of motions, N = I."]
        return [*blocks, *_meaning(s)]
    blocks += [
        "A motion is admissible when C₁ ξ = 0. The columns of N span these motions, cleared of common factors:",
        *math(f"N = {matrix([[poly(c[i]) for c in columns] for i in range(3)])}"),
    ]
    return [*blocks, *_check(s, columns), *_meaning(s)]


def _check(s: Subject, columns: Sequence[Row]) -> list[str]:
    """C1 N = 0, with independent rows of C1."""
    chosen, every = _independent(s)
    if any(dot(r, c) for r in chosen for c in columns):
        chosen, columns = list(s.mobility.basis_rows), s.mobility.null_space
    zeros = matrix([["0"] * len(columns)] * len(chosen))
    factor, basis = rows(chosen), matrix([[poly(c[i]) for c in columns] for i in range(3)])
    words = "Check"
    if not every:
        steered = any(w.kind.steers for w in s.robot.wheels)
        words += ", with rows of C₁ that are independent" + (
            " at a generic admissible steering" if steered else ""
        )
    size = max(sum(width(poly(p)) for p in r) for r in chosen) + max(
        sum(width(poly(c[i])) for c in columns) for i in range(3)
    )
    if size > 66:
        products = [
            rf"C_{{1,{i + 1}}}\,N &= 0, & C_{{1,{i + 1}}} &= {rows([r])}" for i, r in enumerate(chosen)
        ]
        return [f"{words}: each of them times N vanishes identically.", *aligned(products)]
    return [f"{words}:", *math(f"{factor}", f"{basis} = {zeros}")]


def _independent(s: Subject) -> tuple[list[Row], bool]:
    """The basis rows of C1 in letters where they are rows of wheels; and whether they are all rows."""
    working = constrain(s.robot, working_view).sliding
    letters = {w.row: r.row for w, r in zip(reversed(working), reversed(s.rows.sliding), strict=True)}
    basis = s.mobility.basis_rows
    count = len(s.rows.sliding_fixed) + len(s.rows.sliding_steered)
    return [letters.get(row, row) for row in basis], count == len(basis)


def _meaning(s: Subject) -> list[str]:
    """What each column does with the robot."""
    columns = s.mobility.null_space_symbolic
    heads = [f"Column {i + 1}" for i in range(len(columns))] if len(columns) > 1 else ["The column"]
    blocks = items(f"{head} {_motion(c)}" for head, c in zip(heads, columns, strict=True))
    if len(columns) == 1 and columns[0][2] and any(p.constant is None for p in columns[0]):
        vx, vy, w = columns[0]
        x, y = _ratio(-vy, w), _ratio(vx, w)
        blocks += ["The ICR lies at (−N₂/N₃, N₁/N₃):", *aligned([f"x_{{ICR}} &= {x}", f"y_{{ICR}} &= {y}"])]
    return [*blocks, "Every admissible twist is ξ = N η, with one number η per column."]


def _ratio(a: Poly, b: Poly) -> str:
    return rf"\frac{{{poly(a)}}}{{{poly(b)}}}" if a else "0"


def _motion(c: Row) -> str:
    """A column in words."""
    vx, vy, w = c
    if not w:
        if not vy and vx.constant is not None:
            return "drives straight ahead."
        if not vx and vy.constant is not None:
            return "moves to the left."
        return (
            "moves along a fixed direction without turning."
            if vx.constant is not None
            else "moves without turning."
        )
    if not vx and not vy:
        return "turns on the spot about P."
    if any(p.constant is None and any(g.kind in ("cos", "sin") for g in p.generators) for p in c):
        return "turns about the ICR that the steering angles choose."
    return "turns about a fixed point."
