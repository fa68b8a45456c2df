"""What wmrgen derives from a robot file, as the truth that the texts are held against."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

import sympy

from textbook.errata.forms import symbol
from wmrgen import derive
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.layout import build
from wmrgen.geometry.symbolic import Expr, Parameter, signal
from wmrgen.robotfile.load import read_text

ONE_OF_EACH = """\
wmrgen: 1
name: one_of_each
parameters: {l: 0.7, alpha: 0.8, beta: 0.45, g: 0.6, r: 0.12, d: 0.09}
wheels:
  - {name: fixed, type: fixed, l: l, alpha: alpha, beta: beta, r: r}
  - {name: swedish, type: swedish, l: l, alpha: alpha, beta: beta, gamma: g, r: r}
  - {name: castor, type: castor, l: l, alpha: alpha, beta: beta, d: d, r: r}
  - {name: steered, type: steered, l: l, alpha: alpha, beta: beta, r: r}
"""
# The order of their rows.
_ROLLS, _SLIDES = ("fixed", "swedish", "castor", "steered"), ("fixed", "castor", "steered")
ALPHA, BETA, GAMMA = symbol(r"\alpha"), symbol(r"\beta"), symbol(r"\gamma")
L, R, D = symbol("l"), symbol("r"), symbol("d")
_NAMES = {"l": L, "alpha": ALPHA, "beta": BETA, "g": GAMMA, "r": R, "d": D}


@cache
def derived(text: str) -> Derivation:
    """The derivation of a robot file given as text."""
    return derive(build(read_text(text, "errata")))


def shown(matrix: sympy.Matrix, at: Mapping[str, Expr] = MappingProxyType({})) -> sympy.Matrix:
    """Parameters by the letters of the texts or as ``at`` says, steering joints at their zero."""
    swap: dict[Expr, Expr] = {
        s: _NAMES.get(s.name, s) for s in matrix.free_symbols if isinstance(s, Parameter)
    }
    swap |= {signal("castor.steer"): sympy.S.Zero, signal("steered.steer"): sympy.S.Zero}
    values = {_NAMES[name]: sympy.S.Zero + value for name, value in at.items()}
    return matrix.applyfunc(lambda e: e.xreplace(swap).xreplace(values))


def rolling(wheel: str, **at: Expr) -> sympy.Matrix:
    """The rolling row, 1 x 3, of a wheel at (l, alpha) with beta (and g: gamma), in symbols or as ``at`` says."""
    return shown(derived(ONE_OF_EACH).J1[_ROLLS.index(wheel), :], at)


def radius(wheel: str) -> Expr:
    """What multiplies the wheel speed in the rolling row."""
    k = _ROLLS.index(wheel)
    return shown(derived(ONE_OF_EACH).J2[k : k + 1, k : k + 1])[0]


def sliding(wheel: str, **at: Expr) -> sympy.Matrix:
    """The sliding row, 1 x 3, of a wheel at (l, alpha) with beta, in symbols or as ``at`` says."""
    d = derived(ONE_OF_EACH)
    return shown(d.pfaffian[d.J1.rows + _SLIDES.index(wheel), :3], at)


def differential(**at: Expr) -> sympy.Matrix:
    """Rolling rows of a right and a left wheel at distance l from P, and their sliding row."""
    right, left = {**at, "alpha": -sympy.pi / 2, "beta": sympy.pi}, {**at, "alpha": sympy.pi / 2, "beta": 0}
    return sympy.Matrix.vstack(rolling("fixed", **right), rolling("fixed", **left), sliding("fixed", **left))


def castor_rate() -> Expr:
    """What multiplies the castor's steering rate in its sliding row."""
    d = derived(ONE_OF_EACH)
    column = d.pfaffian_rates.index("castor.steer_rate")
    return shown(d.pfaffian[d.J1.rows + 1 : d.J1.rows + 2, column])[0]


def inverse(m: sympy.Matrix) -> sympy.Matrix:
    """The inverse by cofactors, as it stands: no pivot has to be recognised as 0."""
    return m.adjugate() / m.det(method="berkowitz")


def robot(wheels: str) -> Derivation:
    """The derivation of a robot given as ``type x y heading; ...; equal a, b``: wheels w1, w2, ... and couplings."""
    words = [part.split() for part in wheels.split("; ")]
    text = "wmrgen: 1\nname: robot\nwheels:\n"
    for k, (kind, x, y, *heading) in enumerate((w for w in words if w[0] != "equal"), 1):
        turned = f", heading: {heading[0]}, r: 0.1" if heading else ""
        text += f"  - {{name: w{k}, type: {kind}, x: {x}, y: {y}{turned}}}\n"
    equal = [f"  - {{equal: [{' '.join(w[1:])}]}}\n" for w in words if w[0] == "equal"]
    return derived(text + ("couplings:\n" + "".join(equal) if equal else ""))


def disk_curl() -> Expr:
    """c . curl c of the sliding constraint of one fixed wheel, from wmrgen's test of integrability."""
    return robot("fixed 0 0 0").integrability.row("w1").value


CARTESIAN = """\
wmrgen: 1
name: cartesian
parameters: {px: 0.7, py: 0.2, h: 0.45, r: 0.12, o: 0.06}
wheels:
  - {name: fixed, type: fixed, x: px, y: py, heading: h, r: r}
  - {name: steered, type: steered, x: px, y: py, heading: h, r: r, offset_y: o}
"""
X, Y, H, O = symbol("x"), symbol("y"), symbol("h"), symbol("o")


def wheel(x: Expr, y: Expr, heading: Expr) -> tuple[sympy.Matrix, sympy.Matrix]:
    """Rolling and sliding row of a wheel at (x, y) whose rolling direction is ``heading``."""
    d = derived(CARTESIAN)
    at = {"px": x, "py": y, "h": heading}
    swap = {s: at[s.name] for s in d.J1[0, :].free_symbols if s.name in at}
    return d.J1[0, :].xreplace(swap), d.C1f[0, :].xreplace(swap)


def offset_wheel() -> tuple[sympy.Matrix, sympy.Matrix]:
    """Rolling and sliding row of a steered wheel with axle offset o at (x, y), heading h, over
    (vx, vy, omega, steering rate)."""
    d = derived(CARTESIAN)
    column = d.pfaffian_rates.index("steered.steer_rate")
    at = {"px": X, "py": Y, "h": H, "o": O}
    rows = [d.pfaffian[k, :3].row_join(d.pfaffian[k : k + 1, column]) for k in (1, d.J1.rows + 1)]
    names = {s for row in rows for s in row.free_symbols}
    swap: dict[Expr, Expr] = {s: at[s.name] for s in names if s.name in at}
    swap[signal("steered.steer")] = sympy.S.Zero
    return rows[0].xreplace(swap), rows[1].xreplace(swap)
