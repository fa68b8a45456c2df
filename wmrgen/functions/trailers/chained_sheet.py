"""The chained form on one page: transformation, inputs, domain, and the check that it is correct.

The check takes exact derivatives at rational points. The rates of the state come from the posture model and the
trailers, which do not use the chained form. The rates of z come from differentiating the formula `chained` along them.
Equality is decided in exact arithmetic, without a tolerance.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Formula, parameter_ports, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.inputs import eta_motion
from wmrgen.functions.models.sheet import Equation, Sheet, tidy
from wmrgen.functions.models.vector_fields import at_point, by_state, to_poly
from wmrgen.functions.registry import Reason, UnderivableError
from wmrgen.functions.system import Domain
from wmrgen.functions.trailers.chained import U, chained, chained_input, chained_rates
from wmrgen.functions.trailers.trailer import towing_system
from wmrgen.functions.trailers.train import OMEGA, Train, V, last_axle, links_of, train
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import POSE, Port
from wmrgen.geometry.symbolic import AtLeast, Expr, expression, local, rotated, signal

POINTS = 3  # rational points of a check
MANY_TRAILERS = 8  # with more trailers one exact point takes seconds
MOST_TERMS = 40  # a derivative with more terms is not written out: it fills a page


def chained_sheet(robot: Robot, mobility: Mobility) -> Sheet:
    """Return the page: z1 ... zn and the robot's own inputs in closed form, as far as they are short enough."""
    t = train(robot, mobility, symbolic=True)
    checked = verify(robot, mobility, POINTS if len(robot.trailers) <= MANY_TRAILERS else 1)
    where, equations, domain = ([], _by_heading(t), []) if t.by_heading else _by_position(t)
    chain = ", ".join(["z1' = u1", "z2' = u2", *(f"z{k + 1}' = z{k} u1" for k in range(2, t.size))])
    text = f"(2,{t.size}) chain {chain}. Verified: {checked.text}"
    return Sheet(
        "chained", text, t.state, U, parameter_ports(robot), tuple(where), tuple(equations), (), tuple(domain)
    )


def _by_heading(t: Train) -> list[Equation]:
    """Return the equations if z1 is the heading: Tzafestas (2.62), (2.63)."""
    theta, (x, y) = signal("theta"), last_axle(t)
    c, s = t.axle.turned(sympy.cos(theta), sympy.sin(theta))
    u1, u2 = (signal(p.name) for p in U)
    formulas = {"z1": theta, "z2": tidy(x * c + y * s), "z3": tidy(x * s - y * c)}
    formulas |= {V.name: u2 + local("z3") * u1, OMEGA.name: u1}
    return [Equation(name, e) for name, e in formulas.items()]


def _by_position(t: Train) -> tuple[list[Equation], list[Equation], list[Domain]]:
    """Return the equations for a car or trailers: Tzafestas (2.66)-(2.69); Sordalen (1993)."""
    path, domain = _path(t)
    where = []
    bend: Expr = sympy.S.One  # dbeta/dkappa
    s = t.steering
    if s is not None:
        beta = signal(f"{s.name}.steer")
        ch, sh, x, y = (expression(p) for p in (s.ch, s.sh, s.x, s.y))
        cosine, sine = rotated(sympy.cos(beta), sympy.sin(beta), ch, sh)
        divisor = x * cosine + y * sine
        bend = divisor**2 / x
        where.append(Equation("kappa", tidy(sine / divisor)))
        lost = f"the steering angle of `{s.name}` gives an infinite curvature"
        domain.insert(1, Domain(tidy(divisor), lost))
    return where, [*_transformation(t, path.slopes), *_inputs(t, path, bend)], domain


class _Path(NamedTuple):
    """Derivatives along the path of the last axle."""

    slopes: list[Poly]  # ``slopes[m]``: derivative m + 1 of y by x of the last axle
    speed: Poly  # w_0
    inverse_gain: Poly  # 1/(dz2/d turning)


def _path(t: Train) -> tuple[_Path, list[Domain]]:
    """Return derivatives along the path of the last axle up to the drift of z2, as far as they are short enough."""
    last, *hitches = [tuple(map(to_poly, (x.cosine, x.sine, x.inverse_length))) for x in links_of(t)]
    c, s, _ = last
    across = "the last axle drives at a right angle to world x: turn the world frame"
    domain = [Domain(expression(c), across)]
    slope, w, inverse_gain = s * c.inverse(), c.inverse(), c * c
    rates: dict[str, Poly] = {}
    for trailer, (c, s, inverse_length) in zip(reversed(t.robot.trailers), hitches, strict=True):
        rates[f"{trailer.name}.theta"] = s * c.inverse() * w * inverse_length
        inverse_gain = inverse_gain * c * c * inverse_length.inverse() * w.inverse()
        w = w * c.inverse()
        domain.append(Domain(expression(c), f"`{trailer.name}` is jack-knifed"))
    if t.steering is not None:
        rates["theta"] = Poly.gen("local", "kappa") * w
        inverse_gain = inverse_gain * w.inverse()
    slopes = [slope]
    while len(slopes) < t.size - 1 and len(slopes[-1].terms) < MOST_TERMS:
        slopes.append(Poly.sum(by_state(slopes[-1], q) * rate for q, rate in rates.items()))
    return _Path(slopes, w, inverse_gain), domain


def _transformation(t: Train, slopes: list[Poly]) -> list[Equation]:
    """Return the equations of z1 ... zn."""
    n = t.size
    x, y = last_axle(t)
    coordinates = {1: tidy(x), n: tidy(y)}
    for k in range(n - 1, 1, -1):
        m = n - 1 - k
        coordinates[k] = tidy(expression(slopes[m])) if m < len(slopes) else local(f"dz{k + 1}/dz1")
    return [Equation(f"z{k}", coordinates[k]) for k in sorted(coordinates)]


def _inputs(t: Train, path: _Path, bend: Expr) -> list[Equation]:
    """Return the equations u1 = v / w_0; u2 = (dz2/dx) u1 + (dz2/d turning) * turning, solved for v and turning."""
    u1, u2 = (signal(p.name) for p in U)
    complete = len(path.slopes) == t.size - 1
    drift = tidy(expression(path.slopes[-1])) if complete else local("dz2/dz1")
    rate = tidy(bend) * tidy(expression(path.inverse_gain)) * (u2 - drift * u1)
    return [Equation(V.name, tidy(expression(path.speed)) * u1), Equation(t.turning.name, rate)]


class Verification(NamedTuple):
    """Differences at each point; all are exactly 0 if the formulas are correct."""

    points: int
    residuals: tuple[Exact, ...]

    @property
    def holds(self) -> bool:
        """Return whether every identity holds exactly."""
        return not any(self.residuals)

    @property
    def text(self) -> str:
        """Return what was checked, and the result."""
        verdict = "hold exactly" if self.holds else "FAIL"
        return (
            f"z1' = u1, z2' = u2, z(k+1)' = zk u1 and the inverse, chained_input, {verdict} at {self.points} "
            "rational points (exact arithmetic, rates from the posture model and the trailers)"
        )


def verify(robot: Robot, mobility: Mobility, points: int = POINTS) -> Verification:
    """Return the residuals of the chain's identities at rational points.

    Args:
        robot: The robot.
        mobility: Its mobility.
        points: How many points are checked.

    Raises:
        NotDerivableError: If the robot has no chained form, or if no exact check is possible.
    """
    t = train(robot, mobility)
    functions = tuple(build(robot, mobility) for build in (chained, chained_rates, chained_input))
    try:
        residuals = [r for seed in range(points) for r in _residuals(t, mobility, functions, seed)]
    except ValueError as error:
        raise UnderivableError(f"{robot.name}: not verifiable exactly: {error}", Reason.OTHER) from error
    return Verification(points, tuple(residuals))


class _Place(NamedTuple):
    """A point of the state space, and its motion."""

    values: dict[str, Exact]  # symbol -> number; for an angle, the tangent of its half
    rates: dict[str, Exact]  # symbol -> rate; empty if nothing moves
    geometry: Mapping[str, Exact]

    def value(self, poly: Poly) -> Exact:
        """Return the value of a polynomial. Raise ValueError if it is not exact."""
        number = at_point(poly, self.values, self.geometry).constant
        if number is None:
            raise ValueError(f"no exact value for {expression(poly)}")
        return number

    def rate(self, expr: Expr, poly: Poly) -> Exact:
        """Return the rate of ``expr`` by the chain rule; ``poly`` is the same as a polynomial."""
        moving = sorted(s.name for s in expr.free_symbols if self.rates.get(s.name))
        return sum((self.value(by_state(poly, name)) * self.rates[name] for name in moving), ZERO)

    def outputs(self, formula: Formula) -> list[tuple[Exact, Exact]]:
        """Return value and rate of each output."""
        place = _Place(dict(self.values), dict(self.rates), self.geometry)
        for symbol, expr in formula.locals:
            place.values[symbol.name], rate = place._value_and_rate(expr)
            if self.rates:
                place.rates[symbol.name] = rate
        return [place._value_and_rate(expr) for _, expr in formula.outputs]

    def _value_and_rate(self, expr: Expr) -> tuple[Exact, Exact]:
        """Return value and rate of an expression."""
        expr = self._unguarded(expr)
        poly = to_poly(expr)
        return self.value(poly), self.rate(expr, poly)

    def _unguarded(self, expr: Expr) -> Expr:
        """Return an expression without the guard of its divisor. Raise ValueError if the guard is closed."""
        if isinstance(expr, sympy.Piecewise):
            (_, condition), (opened, _) = expr.args
            divisor, least = condition.lts.args[0], condition.gts
        elif isinstance(expr, AtLeast):
            divisor, least = expr.args
            opened = divisor
        else:
            return expr
        if abs(self.value(to_poly(divisor))) < self.value(to_poly(least)):
            raise ValueError(f"{divisor} is too small here")
        return opened


def _residuals(t: Train, mobility: Mobility, functions: tuple[Formula, ...], seed: int) -> list[Exact]:
    """Return the residuals at one point: rates of z, claimed rates, and inputs converted forth and back."""
    system = towing_system(eta_motion(t.robot, mobility, virtual=True), mobility)
    inputs = {_symbol(u): Exact(Fraction(2 * k + 3 + seed, 5 - 3 * k)) for k, u in enumerate(system.inputs)}
    geometry = {p.name: p.default for p in tunable_ports(t.robot) if p.default is not None}
    state = _generic_state(t, seed)
    driven = _Place(state | inputs, {}, geometry)
    place = _Place(
        state,
        {_symbol(q): driven.value(to_poly(e)) for q, e in zip(system.state, system.rates, strict=True)},
        geometry,
    )
    own = {"v": _speed(t, place), _symbol(t.turning): place.rates[_symbol(t.steering_port or POSE[2])]}
    z = place.outputs(functions[0])
    rates = [rate for _, rate in z]
    chain = [rates[0], rates[1], *(value * rates[0] for value, _ in z[1:-1])]
    claimed = [value for value, _ in _Place(state | own, {}, geometry).outputs(functions[1])]
    chain_inputs = {"u1": rates[0], "u2": rates[1]}
    back = dict(
        zip(
            (_symbol(p) for p, _ in functions[2].outputs),
            (value for value, _ in _Place(state | chain_inputs, {}, geometry).outputs(functions[2])),
            strict=True,
        )
    )
    residuals = [a - b for a, b in zip(rates, chain, strict=True)]
    residuals += [a - b for a, b in zip(claimed, chain, strict=True)]
    return residuals + [back[name] - value for name, value in own.items()]


def _symbol(port: Port) -> str:
    """Return the name of a port's symbol."""
    return str(signal(port.name).name)


def _generic_state(t: Train, seed: int) -> dict[str, Exact]:
    """Return a number for each symbol; for an angle, the small tangent of its half, so that no guard is near."""
    pose = {"x": Exact(Fraction(3, 5)), "y": Exact(Fraction(-9, 10 + seed))}
    return pose | {
        _symbol(p): Exact(Fraction((-1) ** k * (k % 3 + 1), 11 + 2 * k + 3 * seed))
        for k, p in enumerate(t.state[2:])
    }


def _speed(t: Train, place: _Place) -> Exact:
    """Return the speed of the axle's centre along the direction of travel, from the rates of the pose."""
    theta = signal("theta")
    c, s = place.value(to_poly(sympy.cos(theta))), place.value(to_poly(sympy.sin(theta)))
    x, y, omega = (place.rates[name] for name in ("x", "y", "theta"))
    ex, ey, qx, qy = (place.value(p) for p in (t.axle.ex, t.axle.ey, t.axle.x, t.axle.y))
    return ex * (c * x + s * y - omega * qy) + ey * (c * y - s * x + omega * qx)
