"""The chained form on a sheet of paper: transformation, inputs, domain, and the check that it holds."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from wmrgen.exact.poly import Poly
from wmrgen.functions.models.posture import parameter_ports
from wmrgen.functions.models.sheet import Equation, Sheet, tidy
from wmrgen.functions.models.vector_fields import by_state, to_poly
from wmrgen.functions.trailers.chained import U
from wmrgen.functions.trailers.train import OMEGA, Train, V, last_axle, length_of, train, turned
from wmrgen.functions.trailers.verify import verify
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.symbolic import Expr, expression, local, signal

EXACT_POINTS = 3
MOST_TERMS = 40  # a derivative with more is not written out
MANY_TRAILERS = 8  # beyond, one exact point takes seconds


def chained_sheet(robot: Robot, mobility: Mobility) -> Sheet:
    """z1 ... zn and the robot's own inputs in closed form, as long as they can be written out."""
    t = train(robot, mobility, symbolic=True)
    points = EXACT_POINTS if len(robot.trailers) <= MANY_TRAILERS else 1
    checked = verify(robot, mobility, points)
    where, equations, domain = _by_heading(t) if t.by_heading else _by_position(t)
    n = t.size
    chain = ", ".join(["z1' = u1", "z2' = u2", *(f"z{k + 1}' = z{k} u1" for k in range(2, n))])
    text = f"(2,{n}) chain {chain}. Verified: {checked.text}"
    return Sheet("chained", text, t.state, U, parameter_ports(robot), where, equations, (), domain)


Parts = tuple[tuple[Equation, ...], tuple[Equation, ...], tuple[tuple[Expr, str], ...]]


def _by_heading(t: Train) -> Parts:
    """Tzafestas (2.62), (2.63)."""
    theta, (x, y) = signal("theta"), last_axle(t)
    c, s = turned(t.axle, sympy.cos(theta), sympy.sin(theta))
    u1, u2 = (signal(p.name) for p in U)
    formulas = {"z1": theta, "z2": tidy(x * c + y * s), "z3": tidy(x * s - y * c)}
    formulas |= {V.name: u2 + local("z3") * u1, OMEGA.name: u1}
    return (), tuple(Equation(name, e) for name, e in formulas.items()), ()


@dataclass(frozen=True, slots=True)
class _Path:
    """``slopes[m]``: the derivative m + 1 of y by x of the last axle; ``speed``: w_0; ``answer``: 1/(dz2/d turning)."""

    slopes: list[Poly]
    speed: Poly
    answer: Poly


def _by_position(t: Train) -> Parts:
    """Tzafestas (2.66)-(2.69); Sordalen (1993) with trailers, derivatives taken one by one."""
    where: list[Equation] = []
    domain: list[tuple[Expr, str]] = []
    bend: Expr = sympy.S.One
    s = t.axle.steering
    if s is not None:
        beta = signal(f"{s.name}.steer")
        ch, sh, x, y = (expression(p) for p in (s.ch, s.sh, s.x, s.y))
        cosine, sine = (
            ch * sympy.cos(beta) - sh * sympy.sin(beta),
            sh * sympy.cos(beta) + ch * sympy.sin(beta),
        )
        divisor = x * cosine + y * sine
        bend = divisor**2 / x
        where.append(Equation("kappa", tidy(sine / divisor)))
        domain.append((tidy(divisor), f"the steering angle of {s.name} asks for an infinite curvature"))
    path = _path(t, domain)
    equations = (*_transformation(t, path.slopes), *_inputs(t, path, bend))
    return tuple(where), equations, tuple(domain)


def _path(t: Train, domain: list[tuple[Expr, str]]) -> _Path:
    """Derivatives along the path of the last axle up to the drift of z2, as far as they can be written out."""
    theta = signal("theta")
    headings = [theta, *(signal(f"{x.name}.theta") for x in t.trailers)]
    rates: dict[str, Poly] = {}
    c, s = _circle(t, headings[-1], not t.trailers)
    domain.insert(
        0, (expression(c), "the last axle drives at a right angle to world x: turn the world frame")
    )
    slope, w, answer = s * c.inverse(), c.inverse(), c * c
    for k in range(len(t.trailers), 0, -1):
        trailer = t.trailers[k - 1]
        c, s = _circle(t, headings[k - 1] - headings[k], k == 1)
        length = length_of(t, trailer)
        rates[f"{trailer.name}.theta"] = s * c.inverse() * w * length.inverse()
        answer = answer * c * c * length * w.inverse()
        w = w * c.inverse()
        domain.append((expression(c), f"{trailer.name} is jack-knifed"))
    if t.axle.steering is not None:
        rates["theta"] = Poly.gen("local", "kappa") * w
        answer = answer * w.inverse()
    slopes = [slope]
    while len(slopes) < t.size - 1 and len(slopes[-1].terms) < MOST_TERMS:
        slopes.append(Poly.sum(by_state(slopes[-1], q) * rate for q, rate in rates.items()))
    return _Path(slopes, w, answer)


def _circle(t: Train, angle: Expr, tractor: bool) -> tuple[Poly, Poly]:
    """Cosine and sine of a heading or hitch angle; ``tractor``: from the direction of its axle."""
    c, s = sympy.cos(angle), sympy.sin(angle)
    c, s = turned(t.axle, c, s) if tractor else (c, s)
    return to_poly(c), to_poly(s)


def _transformation(t: Train, slopes: list[Poly]) -> list[Equation]:
    n = t.size
    x, y = last_axle(t)
    coordinates = {1: tidy(x), n: tidy(y)}
    for k in range(n - 1, 1, -1):
        m = n - 1 - k
        coordinates[k] = tidy(expression(slopes[m])) if m < len(slopes) else local(f"dz{k + 1}/dz1")
    return [Equation(f"z{k}", coordinates[k]) for k in sorted(coordinates)]


def _inputs(t: Train, path: _Path, bend: Expr) -> list[Equation]:
    """u1 = v / w_0; u2 = (dz2/dx) u1 + (dz2/d turning) * turning."""
    u1, u2 = (signal(p.name) for p in U)
    complete = len(path.slopes) == t.size - 1
    drift = tidy(expression(path.slopes[-1])) if complete else local("dz2/dz1")
    rate = tidy(bend) * tidy(expression(path.answer)) * (u2 - drift * u1)
    return [Equation(V.name, tidy(expression(path.speed)) * u1), Equation(t.turning.name, rate)]
