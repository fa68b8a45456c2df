"""From what the robot file says to an exact layout."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from fractions import Fraction
from math import atan2, hypot, pi, remainder

from wmrgen.errors import RobotFileError
from wmrgen.exact.evaluate import cos_sin, fix, number, parameters_in, substituted
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly
from wmrgen.layout.couplings import common_limits, groups, refuse_unmodelled
from wmrgen.layout.expressions import PI, to_poly
from wmrgen.layout.extras import Extras
from wmrgen.layout.records import Geometry, Interval, Parameter, Robot, Wheel
from wmrgen.layout.snap import snap
from wmrgen.spec.records import Limit, Quantity, RobotSpec, WheelSpec
from wmrgen.spec.records import Parameter as ParameterSpec
from wmrgen.wheels import WHEEL_TYPES

HALF_PI = PI.scale(Fraction(1, 2))
Values = Mapping[str, Poly]


def build(spec: RobotSpec) -> Robot:
    """The exact layout of a robot file. RobotFileError where a value makes no sense."""
    parameters, values = _parameters(spec)
    tunable = frozenset(p.name for p in parameters if parameters_in(p.working))
    known = {p.name: p.working for p in parameters if not p.tunable}
    notes: list[str] = []
    wheels = tuple(
        _wheel(i, w, values, known, tunable if spec.snap else None, notes) for i, w in enumerate(spec.wheels)
    )
    _check_names(spec, parameters)
    extras = Extras(spec, values, known)
    robot = Robot(
        name=spec.name,
        description=spec.description,
        source=spec.source,
        parameters=parameters,
        wheels=wheels,
        steer_group=groups(spec, "steer"),
        spin_group=groups(spec, "spin"),
        couplings=tuple((c.joint, c.wheels) for c in spec.couplings),
        limits=_limits(spec.limits, values, known),
        notes=tuple(notes),
        virtual=extras.virtual(wheels),
        trailers=extras.trailers(),
        slip=spec.slip,
        cg=extras.point(),
        gains=extras.gains(),
        functions=tuple(f.name for f in spec.functions),
    )
    refuse_unmodelled(spec, robot)
    return common_limits(spec, robot)


def _parameters(spec: RobotSpec) -> tuple[tuple[Parameter, ...], dict[str, Poly]]:
    """Parameters, each after those it uses, and their nominal values."""
    values: dict[str, Poly] = {}
    working: dict[str, Poly] = {}
    found: list[Parameter] = []
    for p in spec.parameters:
        symbolic = to_poly(p.value, values)
        values[p.name] = substituted(symbolic, values)
        own = substituted(symbolic, working)
        if p.tunable:
            _check_independent(p, own)
            own = Poly.gen("param", p.name)
        working[p.name] = own
        found.append(Parameter(p.name, symbolic, values[p.name], own, number(symbolic, values), p.tunable))
    return tuple(found), values


def _check_independent(p: ParameterSpec, own: Poly) -> None:
    """A tunable parameter is an input: another one cannot decide its value."""
    names = sorted(parameters_in(own))
    if names:
        raise RobotFileError(
            f"parameter {p.name} is tunable and computed from {names[0]}, which is tunable too", p.value.mark,
            f"When {names[0]} changes it is not clear whether {p.name} follows or keeps its value.",
            f"Delete tunable: true of {p.name}, which then follows {names[0]}; or give {p.name} a number.",
        )  # fmt: skip


class _Reader:
    """Reads the quantities of one wheel; snaps angles and keeps the notes."""

    def __init__(self, name: str, values: Values, tunable: frozenset[str] | None) -> None:
        self.name, self.values, self.tunable = name, values, tunable
        self.notes: list[str] = []

    def plain(self, quantity: Quantity | None) -> Poly:
        """The quantity as written; 0 when left out."""
        return Poly.of(0) if quantity is None else to_poly(quantity, self.values)

    def snapped(self, angle: Poly, key: str) -> Poly:
        """The angle, or the multiple of pi/12 that it stands for."""
        if self.tunable is None:
            return angle
        angle, note = snap(angle, self.values, self.tunable, f"{self.name}.{key}")
        self.notes += [note] if note else []
        return angle

    def placement(self, w: WheelSpec) -> tuple[Poly, Poly, Poly, Poly]:
        """x, y, alpha and alpha as written. Where x and y are given, nothing goes through the angle."""
        if w.x is not None and w.y is not None:
            x, y = self.plain(w.x), self.plain(w.y)
            at_origin = not number(x, self.values) and not number(y, self.values)
            alpha = Poly.of(0) if at_origin else Poly.gen("atan2", "", y, x)
            return x, y, alpha, alpha
        written = self.plain(w.alpha)
        alpha = self.snapped(written, "alpha")
        c, s = cos_sin(alpha)
        return self.plain(w.l) * c, self.plain(w.l) * s, alpha, written

    def heading(self, w: WheelSpec, alpha: Poly, written: Poly) -> Poly:
        """The zero heading alpha + beta - pi/2.

        The sum as written is snapped first, because rounding of alpha and beta cancels in it; then the sum of
        the snapped angles.
        """
        if w.heading is not None:
            return self.snapped(self.plain(w.heading), "heading")
        if w.beta is None:
            return Poly.of(0)
        what = "heading (alpha + beta - pi/2)"
        beta = self.plain(w.beta)
        raw = written + beta - HALF_PI
        heading = self.snapped(raw, what)
        if heading == raw:
            heading = self.snapped(alpha + self.snapped(beta, "beta") - HALF_PI, what)
        return heading


def _wheel(
    index: int, w: WheelSpec, values: Values, known: Values, tunable: frozenset[str] | None, notes: list[str]
) -> Wheel:
    """One wheel. ``tunable`` is None when snapping is off."""
    read = _Reader(w.name, values, tunable)
    x, y, alpha, written = read.placement(w)
    heading = read.heading(w, alpha, written)
    gamma = read.snapped(read.plain(w.gamma), "gamma")
    notes += read.notes
    lengths = (read.plain(q) for q in (w.r, w.d, w.offset_y, w.r_sw))
    symbolic = Geometry(x, y, *cos_sin(heading), *cos_sin(gamma), *lengths)
    nominal = Geometry(*(number(getattr(symbolic, f.name), values) for f in fields(Geometry)))
    _check(w, nominal)
    return _display(
        Wheel(
            index=index, name=w.name, type=w.type, symbolic=symbolic,
            working=Geometry(*(fix(getattr(symbolic, f.name), known) for f in fields(Geometry))),
            nominal=nominal, l=0.0, alpha=float(number(alpha, values)), beta=0.0,
            gamma=float(number(gamma, values)), heading=float(number(heading, values)),
            actuated=w.actuated, sensed=w.sensed, limits=_limits(w.limits, values, known),
        )
    )  # fmt: skip


def _display(wheel: Wheel) -> Wheel:
    x, y = float(wheel.nominal.x), float(wheel.nominal.y)
    alpha = wheel.alpha if wheel.alpha else atan2(y, x)
    beta = remainder(wheel.heading + pi / 2 - alpha, 2 * pi)
    return replace(wheel, l=hypot(x, y), alpha=alpha, beta=beta)


def _check(w: WheelSpec, g: Geometry[Exact]) -> None:
    """What no value may be: r <= 0, and what the wheel's type refuses."""
    kind = WHEEL_TYPES[w.type]
    if w.r is not None and "r" in kind.required and g.r.sign <= 0:
        raise RobotFileError(f"{w.name}: wheel radius r = {w.r.text} is not positive", w.r.mark, "",
                             "Write r in metres, the radius and not the diameter, larger than 0.")  # fmt: skip
    if w.r_sw is not None and g.r_sw.sign <= 0:
        raise RobotFileError(f"{w.name}: roller radius r_sw = {w.r_sw.text} is not positive", w.r_sw.mark)
    for check in kind.checks:
        quantity = getattr(w, check.key)
        if quantity is not None and check.bad(g):
            problem = check.problem.format(name=w.name, text=quantity.text)
            raise RobotFileError(problem, quantity.mark, check.why, check.instead)


def _check_names(spec: RobotSpec, parameters: tuple[Parameter, ...]) -> None:
    joints = {f"{w.name}_{joint}" for w in spec.wheels for joint in ("spin", "steer", "steer_rate")}
    joints |= {f"{v.name}_{joint}" for v in spec.virtual for joint in ("steer", "steer_rate", "speed")}
    joints |= {f"{t.name}_{what}" for t in spec.trailers for what in ("theta", "theta_rate", "x", "y")}
    wheels = {w.name for w in spec.wheels} | {v.name for v in spec.virtual} | {t.name for t in spec.trailers}
    for p, read in zip(parameters, spec.parameters, strict=True):
        if p.name in joints or p.name in wheels:
            raise RobotFileError(f"parameter {p.name} has the name of a joint or wheel", read.value.mark)


def _limits(limits: tuple[Limit, ...], values: Values, known: Values) -> dict[str, Interval]:
    """The limits in SI units. RobotFileError where low is above high, and for one that a tunable parameter moves."""
    result = {}
    for limit in limits:
        high, low = (_limit(limit, end, values, known) for end in (limit.high, limit.low))
        if low > high:
            raise RobotFileError(
                f"limit {limit.name}: {limit.low.text} is above {limit.high.text}", limit.low.mark
            )
        result[limit.name] = Interval(low, high)
    return result


def _limit(limit: Limit, end: Quantity, values: Values, known: Values) -> Exact:
    symbolic = to_poly(end, values)
    names = sorted(parameters_in(substituted(symbolic, known)))
    if names:
        raise RobotFileError(
            f"limit {limit.name}: {end.text} depends on the tunable parameter {names[0]}", end.mark,
            "Limits are constants of the generated code and of its proved bounds.",
            f"Write a number, or delete tunable: true of {names[0]}.",
        )  # fmt: skip
    return number(symbolic, values)
