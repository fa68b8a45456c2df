"""Section 2: each wheel's rolling and sliding equation, from the book's formula to numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wmrgen.backends.report import names
from wmrgen.backends.report.markdown import aligned, code, listed, math
from wmrgen.backends.report.subject import CAP, Subject
from wmrgen.backends.report.tex import WIDE, broken, pieces, poly, summands, terms_of, width
from wmrgen.constraints import ConstraintRow, along, heading, symbolic_view
from wmrgen.exact.poly import Poly, Row, dot

if TYPE_CHECKING:
    from wmrgen.layout.records import Wheel

TWIST: Row = (Poly.gen("input", "vx"), Poly.gen("input", "vy"), Poly.gen("input", "omega"))
_ANGLE = {
    "fixed": r"\beta",
    "steered": r"\beta(t)",
    "castor": r"\beta(t)",
    "spherical": r"\beta",
    "swedish": r"\beta",
}
_TITLES = {
    "fixed": "Fixed wheels", "steered": "Steered wheels", "castor": "Castors", "swedish": "Swedish wheels",
    "spherical": "Spherical wheels",
}  # fmt: skip
_WORDS = {
    "fixed": "A fixed wheel rolls without slip in its plane (3.12) and does not slide across it (3.13):",
    "steered": "A steered wheel obeys the same two equations with a moving β(t) = β + ψ, (3.15) and "
    "(3.16). Its contact "
    "point lies under the pivot, so ψ̇ does not occur:",
    "castor": "A castor's contact point lies off its pivot. Its rolling equation is that of a "
    "steered wheel (3.17); "
    "in the sliding equation (3.18) the swivel rate takes up whatever sideways motion the chassis "
    "has, so that it "
    "does not constrain the robot:",
    "swedish": "A Swedish wheel is driven along its wheel plane and slides freely across its rollers. Only the "
    "component along the roller axis is enforced (3.19); the second line, (3.20), gives the rollers' "
    "own speed:",
    "spherical": "A ball rolls any way. (3.21) gives its rate for the direction β that (3.22) picks; "
    "both follow the "
    "motion, neither constrains it:",
}
_OFFSET = (
    "A steered wheel obeys the same two equations with a moving β(t) = β + ψ, (3.15) and (3.16). "
    "Here the contact point "
    "stands off the pivot by o along the axle, so steering rolls the wheel; the book has no such term:"
)


def wheel_rows(s: Subject) -> list[str]:
    """All wheel types that occur, in file order."""
    lines = [
        "## 2 What each wheel demands",
        "",
        "Each wheel gives one equation along its rolling direction and, unless it slides freely, one "
        "across it.",
        "",
    ]
    for kind in dict.fromkeys(w.type for w in s.robot.wheels):
        wheels = [w for w in s.robot.wheels if w.type == kind]
        lines += [
            f"### {_TITLES[kind]}: {listed([w.name for w in wheels])}",
            "",
            _WORDS[kind],
            *_general(kind, wheels),
        ]
        lines += _errata(kind)
        if kind != "spherical":
            lines += _worked(s, kind, wheels)
    return lines


def _words(kind: str, wheels: list[Wheel]) -> str:
    return _OFFSET if kind == "steered" and any(w.nominal.o for w in wheels) else _WORDS[kind]


def _general(kind: str, wheels: list[Wheel]) -> list[str]:
    """The book's equations, the lateral offset added where it occurs."""
    b = _ANGLE[kind]
    a = rf"\alpha+{b}"
    if kind == "swedish":
        a, turned = r"\alpha+\beta+\gamma", r"(\beta+\gamma)"
        along_it = _row(rf"\sin({a})", rf"-\cos({a})", rf"-l\cos{turned}")
        rolling = rf"{along_it} &= r\,\dot{{\varphi}}\cos\gamma"
        across = _row(rf"\cos({a})", rf"\sin({a})", rf"l\sin{turned}") + r" + r\,\dot{\varphi}\sin\gamma"
        return aligned([f"{rolling} && (3.19)", rf"{across} &= r_{{sw}}\,\dot{{\varphi}}_{{sw}} && (3.20)"])
    third, rate = ("-o", r" + o\,\dot{\psi}") if any(w.nominal.o for w in wheels) else ("", "")
    slide, swivel = ("d+", r" + d\,\dot{\psi}") if kind == "castor" else ("", "")
    first, second = {"fixed": (12, 13), "steered": (15, 16), "castor": (17, 18), "spherical": (21, 22)}[kind]
    rolling = _row(rf"\sin({a})", rf"-\cos({a})", rf"-l\cos{b}{third}")
    sliding = _row(rf"\cos({a})", rf"\sin({a})", rf"{slide}l\sin{b}")
    return aligned([
        rf"{rolling} &= r\,\dot{{\varphi}}{rate} && (3.{first})",
        rf"{sliding}{swivel} &= 0 && (3.{second})",
    ])  # fmt: skip


def _row(*entries: str) -> str:
    return rf"\begin{{bmatrix}} {' & '.join(entries)} \end{{bmatrix}}\xi"


def _errata(kind: str) -> list[str]:
    if kind == "swedish":
        return [
            "(The book prints (3.20) with −r φ̇ sin γ. With the rollers locked, (3.19) and (3.20) "
            "must together give the "
            "velocity r φ̇ along the wheel, and only the plus sign does.)",
            "",
        ]
    return []


def _worked(s: Subject, kind: str, wheels: list[Wheel]) -> list[str]:
    """The first wheel step by step, then all of them."""
    shown = wheels[:CAP]
    index = {w.index for w in shown}
    rolling = [c for c in s.rows.rolling if c.wheel.index in index]
    sliding = [c for c in s.rows.sliding if c.wheel.index in index]
    first = shown[0]
    lines = [f"For {code(first.name)} the sum of angles gives", *_plugged(first)]
    only = f"{code(first.name)}" if len(wheels) == 1 else "every wheel"
    lines += [
        f"and with its pivot's coordinates, x = l cos α and y = l sin α, the rolling equation of {only} reads"
    ]
    lines += aligned(_equations(rolling))
    if kind == "swedish":
        lines += ["The rollers turn with", *_rollers(first)]
    if sliding:
        lines += ["and the sliding equation"]
        lines += aligned(_equations(sliding))
    if len(wheels) > CAP:
        lines += [
            f"({len(wheels) - CAP} more wheels follow the same pattern; they stand in `model.json`.)",
            "",
        ]
    return lines


def _plugged(w: Wheel) -> list[str]:
    """sin and cos of alpha + beta (+ gamma): e = (sin, -cos)."""
    ex, ey = heading(w, symbolic_view(w))
    a, b = r"\alpha+\beta", r"(t)" if w.turns else ""
    if w.kind.rollers:
        g = symbolic_view(w)
        ex, ey = ex * g.cg - ey * g.sg, ey * g.cg + ex * g.sg
        a += r"+\gamma"
    return math(rf"\sin({a}{b}) = {poly(ex)}, \qquad \cos({a}{b}) = {poly(-ey)}")


def _equations(rows: list[ConstraintRow]) -> list[str]:
    """Equal equations once, with the names of all wheels that give them; long ones turned round, to be broken."""
    sides = [_sides(c) for c in rows]
    long = any(sum(map(width, left)) > WIDE for left, _ in sides)
    found: dict[str, list[str]] = {}
    for (left, right), c in zip(sides, rows, strict=True):
        text = f"{right} &= {broken(left)}" if long else f"{broken(left)} &= {right}"
        found.setdefault(text, []).append(names.wheel(c.wheel.name))
    return [text if who[0] in text else f"{text} && ({', '.join(who)})" for text, who in found.items()]


def _sides(c: ConstraintRow) -> tuple[list[str], str]:
    """``v_x - l omega`` and ``r phi``; a sliding row's own rate stays on the left."""
    name = c.wheel.name
    ports = {"spin": f"{name}.spin", "steer": f"{name}.steer_rate"}
    rates = sum((k * Poly.gen("input", ports[joint]) for (_, joint), k in c.rates), Poly({}))
    left = pieces(terms_of(dot(c.row, TWIST)))
    if c.kind == "rolling":
        return left, poly(-rates)
    return ([*left, *pieces(terms_of(rates))] if rates else left), "0"


def _rollers(w: Wheel) -> list[str]:
    """(3.20) of one wheel."""
    g = symbolic_view(w)
    c, s = g.ch * g.cg - g.sh * g.sg, g.sh * g.cg + g.ch * g.sg
    across = dot(along((-s, c), g), TWIST) + g.r * g.sg * Poly.gen("input", f"{w.name}.spin")
    rate = rf"\dot{{\varphi}}_{{sw,{names.wheel(w.name)}}}"
    radius = poly(g.r_sw) if g.r_sw else "r_{sw}"
    return aligned([rf"{radius}\,{rate} &= {broken(summands(terms_of(across)))}"])
