"""Section 2: each wheel's rolling and sliding equation, from the book's formula to numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wmrgen import notation
from wmrgen.backends.report.markdown import aligned, code, listed, math
from wmrgen.backends.report.subject import CAP, Subject, grouped
from wmrgen.backends.report.tex import WIDE, broken, pieces, poly, summands, terms_of, width
from wmrgen.constraints import ConstraintRow, along, rolling_direction, symbolic_view
from wmrgen.exact.poly import Poly, Row, dot

if TYPE_CHECKING:
    from wmrgen.layout.records import Wheel
    from wmrgen.wheels import WheelType

TWIST: Row = (Poly.gen("input", "vx"), Poly.gen("input", "vy"), Poly.gen("input", "omega"))


def wheel_rows(s: Subject) -> list[str]:
    """All wheel types that occur, in file order."""
    blocks = [
        "## 2 What each wheel demands",
        "Each wheel gives one equation along its rolling direction and, unless it slides freely, one across it.",
    ]
    for name in dict.fromkeys(w.type for w in s.robot.wheels):
        wheels = [w for w in s.robot.wheels if w.type == name]
        kind = wheels[0].kind
        title = kind.noun[0].upper() + kind.noun[1:]
        blocks += [f"### {title}s: {listed([w.name for w in wheels])}", _intro(kind, wheels)]
        blocks += [*_general(kind, wheels), *([kind.words.note] if kind.words.note else [])]
        if kind.directed:
            blocks += _worked(s, kind, wheels)
    return blocks


def _intro(kind: WheelType, wheels: list[Wheel]) -> str:
    offset = any(w.nominal.o for w in wheels)
    return kind.words.offset_intro if offset and kind.words.offset_intro else kind.words.intro


def _general(kind: WheelType, wheels: list[Wheel]) -> list[str]:
    """The book's equations, the lateral offset added where it occurs."""
    first, second = (rf" && (3.{n})" for n in kind.words.equations) if kind.words.equations else ("", "")
    if kind.rollers:
        a, turned = r"\alpha+\beta+\gamma", r"(\beta+\gamma)"
        along_it = _row(rf"\sin({a})", rf"-\cos({a})", rf"-l\cos{turned}")
        rolling = rf"{along_it} &= r\,\dot{{\varphi}}\cos\gamma"
        across = _row(rf"\cos({a})", rf"\sin({a})", rf"l\sin{turned}") + r" + r\,\dot{\varphi}\sin\gamma"
        return aligned([f"{rolling}{first}", rf"{across} &= r_{{sw}}\,\dot{{\varphi}}_{{sw}}{second}"])
    b = r"\beta(t)" if kind.turns else r"\beta"
    a = rf"\alpha+{b}"
    third, rate = ("-o", r" + o\,\dot{\psi}") if any(w.nominal.o for w in wheels) else ("", "")
    slide, swivel = ("d+", r" + d\,\dot{\psi}") if kind.swivels else ("", "")
    rolling = _row(rf"\sin({a})", rf"-\cos({a})", rf"-l\cos{b}{third}")
    sliding = _row(rf"\cos({a})", rf"\sin({a})", rf"{slide}l\sin{b}")
    both = [rf"{rolling} &= r\,\dot{{\varphi}}{rate}{first}", rf"{sliding}{swivel} &= 0{second}"]
    return aligned(both if kind.has_spin or not kind.sliding_row else both[1:])


def _row(*entries: str) -> str:
    return rf"\begin{{bmatrix}} {' & '.join(entries)} \end{{bmatrix}}\xi"


def _worked(s: Subject, kind: WheelType, wheels: list[Wheel]) -> list[str]:
    """The first wheel step by step, then all of them."""
    shown = wheels[:CAP]
    index = {w.index for w in shown}
    rolling = [c for c in s.rows.rolling if c.wheel.index in index]
    sliding = [c for c in s.rows.sliding if c.wheel.index in index]
    first = shown[0]
    blocks = [f"For {code(first.name)} the sum of angles gives", *_plugged(first)]
    only = f"{code(first.name)}" if len(wheels) == 1 else "every wheel"
    which = "rolling" if rolling else "sliding"
    blocks += [
        f"and with its pivot's coordinates, x = l cos α and y = l sin α, the {which} equation of {only} reads"
    ]
    blocks += aligned(_equations(rolling or sliding))
    if kind.rollers:
        blocks += ["The rollers turn with", *_rollers(first)]
    if rolling and sliding:
        blocks += ["and the sliding equation"]
        blocks += aligned(_equations(sliding))
    if len(wheels) > CAP:
        blocks += [f"({len(wheels) - CAP} more wheels follow the same pattern; they stand in `model.json`.)"]
    return blocks


def _plugged(w: Wheel) -> list[str]:
    """sin and cos of alpha + beta (+ gamma): e = (sin, -cos)."""
    ex, ey = rolling_direction(w, symbolic_view(w))
    a, b = r"\alpha+\beta", r"(t)" if w.turns else ""
    if w.kind.rollers:
        a += r"+\gamma"
    return math(rf"\sin({a}{b}) = {poly(ex)}, \qquad \cos({a}{b}) = {poly(-ey)}")


def _equations(rows: list[ConstraintRow]) -> list[str]:
    """Equal equations once, with the names of all wheels that give them; long ones turned round, to be broken."""
    sides = [_sides(c) for c in rows]
    long = any(sum(map(width, left)) > WIDE for left, _ in sides)
    texts = [f"{right} &= {broken(left)}" if long else f"{broken(left)} &= {right}" for left, right in sides]
    wheels = grouped(zip(texts, (notation.wheel(c.wheel.name) for c in rows), strict=True))
    return [text if who[0] in text else f"{text} && ({', '.join(who)})" for text, who in wheels.items()]


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
    c, s = rolling_direction(w, g)
    across = dot(along((-s, c), g), TWIST) + g.r * g.sg * Poly.gen("input", f"{w.name}.spin")
    rate = rf"\dot{{\varphi}}_{{sw,{notation.wheel(w.name)}}}"
    radius = poly(g.r_sw) if g.r_sw else "r_{sw}"
    return aligned([rf"{radius}\,{rate} &= {broken(summands(terms_of(across)))}"])
