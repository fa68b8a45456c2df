"""Build the exact layout of a robot from its robot file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from math import atan2, hypot, pi, remainder
from typing import Any, NamedTuple

from wmrgen.errors import Code, ErrorCollector, RobotFileError
from wmrgen.geometry import notation
from wmrgen.geometry.exact.evaluate import cos_sin, fix, number, parameters_in, substituted
from wmrgen.geometry.exact.linalg import mean
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.domains import needs
from wmrgen.geometry.layout.encoders import encoders_of, refuse_ambiguous
from wmrgen.geometry.layout.expressions import PI, Scope, computable, snap, to_poly
from wmrgen.geometry.layout.joints import (
    common_limits,
    constant,
    deadband_of,
    groups,
    gyro_of,
    lag_of,
    limits_of,
    noise_of,
    refuse_shared_joints,
    refuse_unmodelled,
    turn_ratios,
    weight_of,
)
from wmrgen.geometry.layout.measured import agreed, tolerance_of
from wmrgen.geometry.layout.records import (
    DEFAULT_FRAME,
    Geometry,
    Length,
    Parameter,
    Point,
    Robot,
    Trailer,
    Virtual,
    Wheel,
)
from wmrgen.geometry.layout.skid import effective_track, parallel
from wmrgen.geometry.ports import GYRO, default_range
from wmrgen.robotfile.records import (
    Neg,
    Num,
    ParameterSpec,
    Quantity,
    RobotSpec,
    TrailerSpec,
    VirtualSpec,
    WheelSpec,
)

HALF_PI = PI.scale(Fraction(1, 2))


def build(spec: RobotSpec) -> Robot:
    """Return the exact layout of a robot file. Raise RobotFileError for impossible values."""
    collector = ErrorCollector()
    parameters = _parameters(spec, collector)
    scope = Scope(
        {p.name: p.value for p in parameters}, {p.name: p.working for p in parameters if not p.tunable}
    )
    parameters = _with_ranges(spec, parameters, scope, collector)
    tunable = frozenset(p.name for p in parameters if parameters_in(p.working))
    notes: list[str] = []
    wheels: list[Wheel] = []
    for i, w in enumerate(spec.wheels):
        with collector:
            try:
                wheels.append(_wheel(i, w, _Angles(w.name, scope, tunable if spec.snap else None, notes)))
            except ZeroDivisionError:
                what = f"the wheel {w.name} has a value too small to be distinguished from zero"
                raise RobotFileError(what, w.mark, "", "Write 0, or a length.") from None
            except RobotFileError:
                rest = computable(w, scope, collector)
                if rest == w:
                    raise
                _wheel(i, rest, _Angles(w.name, scope, None, []))  # for further errors
    with collector:
        _check_directions(spec, wheels)
    _check_names(spec, collector)
    facts = _joint_facts(spec, "the robot", scope, collector)
    steer_group, spin_group = groups(spec, "steer"), groups(spec, "spin")
    with collector:
        facts["spin_ratios"] = turn_ratios(spec, "spin", spin_group, scope)
    with collector:
        signs = turn_ratios(spec, "steer", steer_group, scope)
        if len(signs) == len(wheels):
            wheels = [replace(w, steer_sign=s.sign) for w, s in zip(wheels, signs, strict=True)]
    with collector:
        facts["tolerance"] = tolerance_of(spec.tolerance, wheels, scope)
    if not collector.errors:
        wheels, facts["near"] = agreed(wheels, steer_group, facts["tolerance"])
        notes += (near.sentence(facts["tolerance"]) for near in facts["near"] if near.moves)
    for part, laid_out in _PARTS.items():
        with collector:
            facts[part] = laid_out(spec, scope, wheels)
    if not collector.errors:
        facts["needs"] = needs(spec, parameters, scope, collector)
    collector.end()
    robot = Robot(
        name=spec.name, description=spec.description, source=spec.source, parameters=parameters,
        wheels=tuple(wheels), steer_group=steer_group, spin_group=spin_group,
        couplings=tuple((c.joint, c.wheels) for c in spec.couplings), notes=tuple(notes), slip=spec.slip,
        precise=spec.precise, functions=tuple(f.name for f in spec.functions),
        frame=spec.frame or DEFAULT_FRAME, **facts,
    )  # fmt: skip
    refuse_unmodelled(spec, robot)
    refuse_shared_joints(spec, robot)
    robot = common_limits(spec, robot)
    refuse_ambiguous(spec, robot)
    return robot


def _parameters(spec: RobotSpec, collector: ErrorCollector) -> tuple[Parameter, ...]:
    """Return the parameters with their default ranges, each after those it uses."""
    values: dict[str, Poly] = {}
    working: dict[str, Poly] = {}
    parameters = []
    for p in spec.parameters:
        with collector:
            symbolic = to_poly(p.value, values)
            kept = substituted(symbolic, working)
            if p.tunable:
                _check_independent(p, kept)
            working[p.name] = Poly.gen("param", p.name) if p.tunable else kept
            values[p.name] = substituted(symbolic, values)
            nominal = number(symbolic, values)
            low, high = default_range(nominal) if p.tunable else (nominal, nominal)
            parameters.append(
                Parameter(p.name, values[p.name], working[p.name], nominal, p.tunable, low, high, p.symbol)
            )
    _check_distinct(spec.parameters, collector)
    return tuple(parameters)


def _check_distinct(parameters: Sequence[ParameterSpec], collector: ErrorCollector) -> None:
    """Collect an error for each symbol by which formulas show another parameter too."""
    shown: dict[str, str] = {}
    for p in sorted(parameters, key=lambda p: bool(p.symbol)):  # a name cannot give way, but a symbol can
        own = notation.letter(p.symbol) if p.symbol else notation.parameter(p.name)
        if p.symbol and own in shown:
            collector.add(RobotFileError(
                f"formulas show both {shown[own]} and {p.name} as {p.symbol}", p.value.mark,
                "A reader could not tell them apart.", f"Give {p.name} another symbol.", code=Code.TWICE,
            ))  # fmt: skip
        shown.setdefault(own, p.name)


def _with_ranges(
    spec: RobotSpec, parameters: tuple[Parameter, ...], scope: Scope, collector: ErrorCollector
) -> tuple[Parameter, ...]:
    """Return the parameters with the ranges from the file. Collect errors for ranges that exclude the value."""
    stated = {p.name: p.range for p in spec.parameters if p.range is not None}
    ranged = {p.name: p for p in parameters}
    for name in stated.keys() & ranged.keys():
        with collector:
            low, high = (constant(f"the range of {name}", end, scope) for end in stated[name])
            nominal, (lower, upper) = ranged[name].nominal, stated[name]
            if not low < high:
                raise RobotFileError(
                    f"the range of {name} runs from {lower.text} to {upper.text}", lower.mark,
                    "The lower end is not below the upper end.", "Write tunable: [low, high].",
                )  # fmt: skip
            if not low <= nominal <= high:
                around = ", ".join(f"{float(end):.6g}" for end in default_range(nominal))
                raise RobotFileError(
                    f"{name} is {float(nominal):.6g}, outside its range from {float(low):.6g} to {float(high):.6g}",
                    (lower if nominal < low else upper).mark,
                    "Generated code starts with the value, and rejects values outside the range.",
                    f"Write a range around the value, such as tunable: [{around}].",
                )  # fmt: skip
            ranged[name] = ranged[name]._replace(low=low, high=high)
    return tuple(ranged.values())


def _check_independent(p: ParameterSpec, working: Poly) -> None:
    """Raise RobotFileError if a tunable parameter, which is an input, is computed from another one."""
    names = sorted(parameters_in(working))
    if names:
        raise RobotFileError(
            f"parameter {p.name} is tunable and computed from {names[0]}, which is tunable too", p.value.mark,
            f"When {names[0]} changes it is not clear whether {p.name} follows or keeps its value.",
            f"Delete tunable: true of {p.name}, so that it follows {names[0]}; or give {p.name} a number.",
        )  # fmt: skip


class _Angles(NamedTuple):
    """The snapping of the angles of one wheel to multiples of pi/12."""

    name: str
    scope: Scope
    tunable: frozenset[str] | None  # names of the tunable parameters; None: no angle is snapped
    notes: list[str]  # collects a sentence for each snapped angle

    def snapped(self, angle: Poly, key: str) -> Poly:
        """Return the angle, or the multiple of pi/12 that it is close to."""
        if self.tunable is None:
            return angle
        angle, note = snap(angle, self.scope.values, self.tunable, f"`{self.name}.{key}`")
        self.notes.extend([note] if note else [])
        return angle

    def placement(self, w: WheelSpec) -> tuple[Poly, Poly, Poly, Poly]:
        """Return x, y, alpha and alpha before snapping.

        If the file gives x and y, they are used as they are, and alpha is derived from them.
        """
        scope = self.scope
        if w.x is not None and w.y is not None:
            x, y = scope.poly(w.x), scope.poly(w.y)
            at_origin = not scope.number(x) and not scope.number(y)
            alpha = Poly({}) if at_origin else Poly.gen("atan2", "", y, x)
            return x, y, alpha, alpha
        written = scope.poly(w.alpha)
        alpha = self.snapped(written, "alpha")
        c, s = cos_sin(alpha)
        return scope.poly(w.l) * c, scope.poly(w.l) * s, alpha, written

    def heading(self, w: WheelSpec, alpha: Poly, written: Poly) -> Poly:
        """Return the zero heading alpha + beta - pi/2 [rad].

        The sum of the angles before snapping is snapped first, because rounding of alpha and beta may cancel in it. If
        it is not near a multiple of pi/12, the sum of the snapped angles is snapped.

        Args:
            w: The wheel in the robot file.
            alpha: The angle of the position, snapped.
            written: The angle of the position before snapping.

        Returns:
            The heading as a polynomial in the parameters.
        """
        if w.heading is not None:
            return self.snapped(self.scope.poly(w.heading), "heading")
        if w.beta is None:
            return Poly({})
        what = "heading (alpha + beta - pi/2)"
        beta = self.scope.poly(w.beta)
        raw = written + beta - HALF_PI
        heading = self.snapped(raw, what)
        if heading == raw:
            heading = self.snapped(alpha + self.snapped(beta, "beta") - HALF_PI, what)
        return heading


def _wheel(index: int, w: WheelSpec, angles: _Angles) -> Wheel:
    scope = angles.scope
    px, py, alpha, written = angles.placement(w)
    heading = angles.heading(w, alpha, written)
    gamma = angles.snapped(scope.poly(w.gamma), "gamma")
    r, d, o, r_sw = (scope.poly(q) for q in (w.r, w.d, w.offset_y, w.r_sw))
    per_steer = ZERO if w.per_steer is None else constant(f"per_steer of {w.name}", w.per_steer, scope)
    symbolic = Geometry(px, py, *cos_sin(heading), *cos_sin(gamma), r, d, o, r_sw, Poly.of(per_steer))
    nominal = symbolic.mapped(scope.number)
    collector = ErrorCollector()
    _check(w, nominal, collector)
    facts = _joint_facts(w, w.name, scope, collector)
    with collector:
        facts["weight"] = ONE if w.weight is None else weight_of(w.name, w.weight, scope)
    collector.end()
    x, y, shown = float(nominal.x), float(nominal.y), float(scope.number(heading))
    direction = float(scope.number(alpha)) or atan2(y, x)
    return Wheel(
        index=index, name=w.name, type=w.type,
        symbolic=symbolic, working=symbolic.mapped(lambda p: fix(p, scope.constants)), nominal=nominal,
        l=hypot(x, y), alpha=direction, beta=remainder(shown + pi / 2 - direction, 2 * pi),
        gamma=float(scope.number(gamma)), heading=shown,
        actuated=w.actuated, sensed=w.sensed, ball=w.ball, joints=dict(w.joints), **facts,
    )  # fmt: skip


def _joint_facts(
    spec: RobotSpec | WheelSpec, whose: str, scope: Scope, collector: ErrorCollector
) -> dict[str, Any]:
    """Return limits, noise, encoders and lags that the file gives for one wheel, or for all wheels of the robot."""
    parts: dict[str, Callable[[], Any]] = {
        "limits": lambda: limits_of(spec.limits, scope),
        "noise": lambda: noise_of(spec.noise, scope),
        "encoders": lambda: encoders_of(whose, spec.encoders, scope),
        "lag": lambda: lag_of(whose, spec.lag, scope),
    }
    facts = {}
    for part, laid_out in parts.items():
        with collector:
            facts[part] = laid_out()
    return facts


def _check(w: WheelSpec, g: Geometry[Exact], collector: ErrorCollector) -> None:
    """Collect errors for impossible values: r <= 0, d = 0 for a castor, and the checks of the wheel type."""
    kind = w.kind
    what = f"the {kind.name} wheel {w.ball or w.name}".rstrip()
    with collector:
        if w.r is not None and "r" in kind.required and g.r.sign <= 0:
            value = w.r.text if isinstance(w.r.expr, Num | Neg) else f"{w.r.text} = {float(g.r):g}"
            raise RobotFileError(f"{what} has r = {value}, which is not positive", w.r.mark, "",
                                 "Write r in metres, the radius and not the diameter, larger than 0.")  # fmt: skip
    with collector:
        if w.d is not None and kind.swivels and not g.d:
            raise RobotFileError(
                f"{what}: a {kind.noun} with d = 0 is a steered wheel", w.d.mark,
                "With the contact point under the pivot the wheel cannot follow: it constrains the robot.",
                "Write type: steered and delete d, or give d, from pivot to contact along the rolling direction.",
            )  # fmt: skip
    for check in kind.checks:
        quantity = getattr(w, check.key)
        with collector:
            if quantity is not None and check.bad(g):
                problem = check.problem.format(what=what, text=quantity.text)
                raise RobotFileError(problem, quantity.mark, check.why, check.instead)


def _check_directions(spec: RobotSpec, wheels: Sequence[Wheel]) -> None:
    """Raise RobotFileError if the two driven directions of a ball are parallel."""
    written = {w.name: w for w in spec.wheels}
    for a, b in combinations((w for w in wheels if w.ball), 2):
        if a.ball == b.ball and parallel([a.zero_heading, b.zero_heading]):
            heading = written[b.name].heading
            mark = heading.mark if heading else None
            raise RobotFileError(
                f"the two driven directions of the ball {a.ball} are parallel", mark,
                "A ball has one speed along a line, so its two drives would act as one joint.",
                "Write one direction, or a second one across the first, such as driven: [0, 90 deg].",
            )  # fmt: skip


def _check_names(spec: RobotSpec, collector: ErrorCollector) -> None:
    """Collect an error for each parameter whose name is also the name of another input of the generated code."""
    suffixes = (
        (spec.wheels, ("_spin", "_steer", "_steer_rate")),
        (spec.virtual, ("_steer", "_steer_rate", "_speed")),
        (spec.trailers, ("_theta", "_theta_rate", "_x", "_y")),
    )
    names = {GYRO.name} if spec.gyro else set()
    for parts, endings in suffixes:
        for part in parts:
            names |= {f"{part.name}{ending}".lower() for ending in endings}
    for p in spec.parameters:
        with collector:
            if p.name.lower() in names:
                what = f"parameter {p.name} has the name of a sensed value"
                raise RobotFileError(what, p.value.mark, "", "Write another name.")


def _virtual(v: VirtualSpec, wheels: Iterable[Wheel], scope: Scope) -> Virtual:
    """Return a virtual wheel. Its default position is the mean of the real wheels that it represents."""
    members = [w for w in wheels if w.name in v.wheels]

    def place(axis: str, quantity: Quantity | None) -> Length:
        if quantity is not None:
            return scope.length(quantity)
        return scope.views(mean([getattr(w.symbolic, axis) for w in members]))

    return Virtual(v.name, v.role, v.wheels, place("x", v.x), place("y", v.y), v.mark)


def _trailer(t: TrailerSpec, scope: Scope) -> Trailer:
    """Return a trailer. Raise RobotFileError if its length is not positive."""
    length = scope.length(t.length)
    if length.nominal.sign <= 0:
        raise RobotFileError(
            f"length of {t.name} is {t.length.text}, which is not positive", t.length.mark,
            "`length` is the lever arm by which the trailer turns about its axle.",
            "Write the distance from the trailer's coupling back to its axle.",
        )  # fmt: skip
    return Trailer(t.name, length, scope.length(t.hitch), t.mark)


# Field of Robot -> function for its value.
_PARTS: dict[str, Callable[[RobotSpec, Scope, list[Wheel]], Any]] = {
    "virtual": lambda spec, scope, wheels: tuple(_virtual(v, wheels, scope) for v in spec.virtual),
    "trailers": lambda spec, scope, _: tuple(_trailer(t, scope) for t in spec.trailers),
    "gyro": lambda spec, scope, _: spec.gyro and gyro_of(spec.gyro, scope),
    "cg": lambda spec, scope, _: spec.cg and Point(*map(scope.length, (spec.cg.x, spec.cg.y, spec.cg.z))),
    "gains": lambda spec, scope, _: {name: scope.length(quantity) for name, quantity in spec.gains},
    "deadband": lambda spec, scope, _: ZERO if spec.deadband is None else deadband_of(spec.deadband, scope),
    "effective_track": lambda spec, scope, wheels: effective_track(spec.effective_track, scope, wheels),
}
