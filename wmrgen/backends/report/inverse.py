"""From a twist to every joint: the closed form of the result, and section 6 with how a steered wheel chooses."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING

from wmrgen import notation
from wmrgen.backends.report.car import circle
from wmrgen.backends.report.latex import broken, latex
from wmrgen.backends.report.markdown import (
    CAP,
    aligned,
    code,
    cut_note,
    grouped,
    in_degrees,
    listed,
    math,
)
from wmrgen.constraints import XI, along, driving_row, seen, sliding_row, symbolic_view, working_view
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.kinematics.least_squares import Projection, project
from wmrgen.kinematics.steer import NARROW, turning_points
from wmrgen.ports import TWIST_NAMES

if TYPE_CHECKING:
    from wmrgen.layout.records import Interval, Robot, Wheel
    from wmrgen.robot import Derivation

ONE, ZERO = Poly.of(1), Poly({})
_WORDS = {"vx": "v<sub>x</sub>", "vy": "v<sub>y</sub>", "omega": "ω"}


def closed_inverse(d: Derivation) -> list[str]:
    """The joint rates that a twist asks for, and of steered wheels the angle."""
    robot = seen(d.robot, symbolic_view)
    projection = project(robot, d.mobility)
    twist = _driven(projection)
    wheels = [w for w in robot.wheels[:CAP] if w.has_spin]
    if not any(w.actuated for w in robot.wheels):
        return ["No joint is driven, so there is nothing to command."]
    lines = [_spin(w, twist) for w in wheels if not w.turns]
    shown = "".join(lines)
    stars = [line for line in _projected(projection) if line.partition(" &=")[0] in shown]
    blocks = aligned([*stars, *lines]) if lines else []
    for turning in (
        [w for w in wheels if w.kind.steers],
        [w for w in wheels if w.kind.swivels and w.actuated],
    ):
        blocks += _pivots(turning, twist) if turning else []
    return [*blocks, *cut_note(robot.wheels)]


def _pivots(wheels: list[Wheel], twist: Row) -> list[str]:
    """What steered wheels or driven castors do, with the velocity of each one's pivot."""
    velocities = grouped((_velocity(w, twist), notation.wheel(w.name)) for w in wheels)
    castors = wheels[0].kind.swivels
    turned = any(w.heading for w in wheels)
    psi = r"\left(h+\psi\right)" if turned else r"\psi"
    zero = "with h its heading at ψ = 0" if turned else ""
    noun = "driven castor" if castors else "steered wheel"
    who = f"Each {noun}" if len(wheels) > 1 else f"The {noun} {code(wheels[0].name)}"
    along = rf"a\cos{psi} + b\sin{psi}"
    if castors:
        shift = r"-o\left(\omega + \dot{\psi}\right)" if any(w.nominal.o for w in wheels) else ""
        words = f"{who} has both rates from the velocity (a, b) of its pivot{f', {zero}' if zero else ''}:"
        first = rf"\dot{{\psi}} &= \frac{{1}}{{d}}\left(a\sin{psi} - b\cos{psi}\right) - \omega"
    else:
        shift = r"-o\,\omega" if any(w.nominal.o for w in wheels) else ""
        words = (
            f"{who} stands along the velocity (a, b) of its pivot{f', {zero},' if zero else ','} and rolls as fast, "
            "forwards or backwards:"
        )
        first = rf"\tan{psi} &= \frac{{b}}{{a}}"
    return [
        words,
        *aligned([
            *(f"{text} && ({', '.join(names)})" for text, names in velocities.items()),
            rf"{first}, & \dot{{\varphi}} &= \frac{{1}}{{r}}\left({along}{shift}\right)",
        ]),
    ]  # fmt: skip


def inverse(d: Derivation) -> list[str]:
    """Section 6."""
    robot = seen(d.robot, symbolic_view)
    projection = project(robot, d.mobility)
    twist = _driven(projection)
    wheels = [w for w in robot.wheels[:CAP] if w.has_spin]
    blocks = ["## 6 Inverse kinematics", *_projection(projection)]
    if not wheels:
        return [*blocks, "There is no joint to command."]
    unsteered = [w for w in wheels if not w.turns]
    passive = [w for w in wheels if w.kind.swivels and not w.actuated]
    steered = [w for w in wheels if w.kind.steers]
    if unsteered:
        blocks += ["A wheel that does not steer has its speed from its rolling equation: see the result."]
    if any(w.kind.swivels and w.actuated for w in wheels):
        blocks += [
            "A driven castor has both rates from its rows: the rolling row gives φ̇, the sliding row ψ̇."
        ]
    if passive:
        others = f", as do {listed([w.name for w in passive[1:]])}" if len(passive) > 1 else ""
        others = others.replace("as do", "as does") if len(passive) == 2 else others
        blocks += [
            f"{code(passive[0].name)} is not driven but follows: its rolling row gives φ̇, its sliding row ψ̇{others}."
        ]
        blocks += aligned([_spin(passive[0], twist), _swivel(passive[0], twist)])
    if steered:
        blocks += [*circle(d.robot), *_steering(robot, steered, twist)]
    return [*blocks, *_coupled(robot, twist), *_slip(robot, projection, twist)]


def _spin(w: Wheel, twist: Row) -> str:
    g = working_view(w)
    spin = dot(driving_row(w, g), twist) * g.rolling_radius.inverse()
    return f"{notation.port(f'{w.name}.spin')} &= {broken(spin)}"


def _swivel(w: Wheel, twist: Row) -> str:
    g = working_view(w)
    rate = -(dot(sliding_row(w, g).row, twist) * g.d.inverse())
    return f"{notation.port(f'{w.name}.steer_rate')} &= {broken(rate)}"


def _driven(projection: Projection) -> Row:
    """The twist that is driven; components that the projection changed carry a star."""
    vx, vy, omega = (
        p if p == q or not p else Poly.gen("input", f"{n}_driven")
        for p, q, n in zip(projection.twist, XI, TWIST_NAMES, strict=True)
    )
    return vx, vy, omega


def _projection(projection: Projection) -> list[str]:
    """The nearest admissible twist, where it is not the commanded one."""
    if projection.twist == XI:
        return []
    away = [n for n, p, q in zip(TWIST_NAMES, projection.twist, XI, strict=True) if p != q]
    zero = [n for n, p in zip(TWIST_NAMES, projection.twist, strict=True) if not p]
    if away == zero:
        names = notation.listed([_WORDS[n] for n in zero])
        return [f"Not every ξ is admissible: the wheels forbid {names}, which is taken away first."]
    return [
        "Not every ξ is admissible. The part that the wheels forbid is taken away first, and the rest is driven:",
        *aligned(_projected(projection)),
    ]


def _projected(projection: Projection) -> list[str]:
    """The components that change."""
    parts = zip(projection.twist, XI, TWIST_NAMES, strict=True)
    return [
        f"{notation.port(n)}^{{*}} &= {broken(p)}" for n, p, q in ((n, p, q) for p, q, n in parts) if p != q
    ]


def _steering(robot: Robot, wheels: list[Wheel], twist: Row) -> list[str]:
    """How a steered wheel chooses among the headings that roll, and what limits change."""
    shift = r"-o\,\omega" if any(w.nominal.o for w in wheels) else ""
    limited = [w for w in wheels if robot.limit(w, "steer")]
    shared = [w for w in limited if not _alike(_partners(robot, w), twist)]
    narrow = _narrow_wheels(robot, wheels, twist)
    wide = [w for w in limited if w not in shared and w not in narrow]
    return [
        *(_nearer(shift) if len(narrow) < len(wheels) else []),
        *(_wide(_turning(robot, wide)) if wide else []),
        *(_narrow(_ranges(robot, narrow), shift) if narrow else []),
        *([f"Steering is limited: {_turning(robot, shared)}. A common angle is kept up to there, "
           "cut at the limit; beyond, the opposite one is taken."] if shared else []),
    ]  # fmt: skip


def _narrow_wheels(robot: Robot, wheels: list[Wheel], twist: Row) -> list[Wheel]:
    """Wheels whose limits leave one heading at most."""
    limits = [(w, robot.limit(w, "steer")) for w in wheels if _alike(_partners(robot, w), twist)]
    return [w for w, limit in limits if limit and limit.high - limit.low <= NARROW]


def _nearer(shift: str) -> list[str]:
    return [
        "A steered wheel has to point along the velocity (a, b) of its pivot, a = v<sub>x</sub> − y ω and "
        "b = v<sub>y</sub> + x ω. Seen from the wheel as it stands, at angle ψ, that velocity has a component u along "
        "the wheel and w across it, where h is the wheel's heading at ψ = 0. Two headings roll, half a turn apart. The "
        "nearer one is at most 90° away; it is reached by driving backwards when u < 0:",
        *aligned([
            r"u &= a\cos(h+\psi) + b\sin(h+\psi), & w &= b\cos(h+\psi) - a\sin(h+\psi)",
            rf"\Delta &= \mathrm{{atan2}}\left(\pm w, |u|\right), & \psi^{{+}} &= \psi + \Delta, \qquad "
            rf"\dot{{\varphi}} = \frac{{\pm\sqrt{{a^2+b^2}}{shift}}}{{r}}, \qquad "
            r"\pm = \begin{cases} - & u < 0 \\ + & u \ge 0 \end{cases}",
        ]),
        "With a = b = 0 the pivot is the ICR and any heading rolls: atan2(0, 0) = 0 holds the present one.",
    ]  # fmt: skip


def _velocity(w: Wheel, twist: Row) -> str:
    """The components of the pivot's velocity, aligned."""
    g = working_view(w)
    a, b = dot(along((ONE, ZERO), g), twist), dot(along((ZERO, ONE), g), twist)
    return f"a &= {latex(a)}, & b &= {latex(b)}"


def _partners(robot: Robot, w: Wheel) -> list[Wheel]:
    """The wheels that turn with it, itself among them."""
    group = robot.steer_group
    return [v for v in robot.wheels if group[v.index] == group[w.index]]


def _alike(wheels: list[Wheel], twist: Row) -> bool:
    """One velocity and one zero heading: each single solution is the common one."""
    return len({(_velocity(w, twist), w.nominal.ch, w.nominal.sh) for w in wheels}) == 1


def _wide(ranges: str) -> list[str]:
    return [
        f"Steering is limited: {ranges}. Up to there ψ⁺ is kept, cut at the limit, so that noise at a stop does not "
        "swing the wheel to the other one and back; beyond, the opposite heading ψ⁺ ± π is taken, cut likewise. A "
        "wheel ends at most 5° further from its line than it must. The rate then is that of the pivot's "
        "velocity along the wheel so turned, u cos Δ + w sin Δ with Δ = ψ⁺ − ψ, in place of the root."
    ]


def _narrow(ranges: str, shift: str) -> list[str]:
    return [
        f"Steering is limited to less than a quarter turn: {ranges}. At most one of the two headings "
        "that roll lies inside, and the wheel takes the angle inside at which it slides least. Seen from the "
        "middle m of the limits, which are 2ρ apart, the pivot's velocity (a, b) is p along the wheel and q across it, "
        "h being the wheel's heading at ψ = 0:",
        *aligned([
            r"p &= a\cos(h+m) + b\sin(h+m), & q &= b\cos(h+m) - a\sin(h+m)",
            r"t &= \min\left(\max\left(\frac{q}{p}, -\tan\rho\right), \tan\rho\right), & "
            r"\psi^{+} &= m + \arctan t, & "
            rf"\dot{{\varphi}} &= \frac{{1}}{{r}}\left(\frac{{p + q\,t}}{{\sqrt{{1+t^2}}}}{shift}\right)",
        ]),
        "With p = q = 0 the present angle is held.",
    ]  # fmt: skip


def _turning(robot: Robot, wheels: list[Wheel]) -> str:
    """Steering limits and turning points."""

    def ends(limits: Interval) -> str:
        points = turning_points(limits)
        return f", turning back below {in_degrees(points.low)} and above {in_degrees(points.high)},"

    return _ranges(robot, wheels, ends)


def _ranges(robot: Robot, wheels: list[Wheel], more: Callable[[Interval], str] = lambda _: "") -> str:
    """The steering limits of wheels, equal ones together."""
    limits = [(robot.limit(w, "steer"), w.name) for w in wheels]
    texts = grouped(
        (f"{in_degrees(r.low)} ≤ ψ ≤ {in_degrees(r.high)}{more(r)}", name) for r, name in limits if r
    )
    return "; ".join(f"{text} for {listed(who)}" for text, who in texts.items())


def _coupled(robot: Robot, twist: Row) -> list[str]:
    """What couplings change."""
    blocks, same = [], []
    for joint, members in robot.couplings:
        wheels = [robot.wheel(n) for n in members]
        if joint == "spin":
            blocks += [
                f"{listed(members)} turn at one speed: they share the least-squares rate Σ r·(r φ̇) / Σ r² of the "
                f"single solutions above.{_way(robot, wheels)}"
            ]
        elif _alike(wheels, twist):
            same.append(listed(members))
        else:
            blocks += [
                f"{listed(members)} share one angle that need not suit all: the one that leaves least sliding "
                "turns by half of atan2(Σ 2 u w, Σ (u² − w²)), the sums over the wheels seen from the first of "
                "them."
            ]
    if same:
        blocks += [f"{'; '.join(same)} share one angle, and the formula gives the same ψ⁺ for each."]
    return blocks


def _way(robot: Robot, wheels: list[Wheel]) -> str:
    """How a steered wheel among wheels with one speed picks its heading."""
    steered = [w.name for w in wheels if w.kind.steers]
    if not steered or len(robot.together("steer", wheels)) < 2:
        return ""
    return f" Of its two headings {listed(steered)} takes the one that rolls the way the others do."


def _may_be_cut(robot: Robot, w: Wheel) -> bool:
    limits = robot.limit(w, "steer")
    return limits is not None and turning_points(limits) != limits


def _slip(robot: Robot, projection: Projection, twist: Row) -> list[str]:
    unlike = _unlike(robot, twist)
    steered = [w for w in robot.wheels if w.kind.steers]
    # Wheels whose command may differ from the heading that rolls.
    held = [w.name for w in steered if _may_be_cut(robot, w) or not _alike(_partners(robot, w), twist)]
    cut = {w.name for w in _narrow_wheels(robot, steered, twist)}
    ways = ((not cut.issuperset(held), "w cos Δ − u sin Δ with Δ = ψ⁺ − ψ"), (cut, "(q − p t) / √(1 + t²)"))
    sideways = " or ".join(text for there, text in ways if there)
    blocks = _forbidden(projection, bool(unlike), bool(steered), bool(held))
    if unlike:
        blocks += [
            f"A common rate need not suit all wheels of a coupling. Of {'; of '.join(map(listed, unlike))} the mean "
            "square of what it leaves over, r φ̇ against the rim speed of each wheel, or d β̇ against its sideways "
            "speed, is added under the root."
        ]
    if held:
        blocks += [
            f"A steered wheel that a limit or a coupling keeps from its heading slides as well, at {sideways}. "
            f"The mean square of these speeds over {listed(held)} is added under the root."
        ]
    return blocks


def _unlike(robot: Robot, twist: Row) -> list[list[str]]:
    """Coupled wheels whose common spin or swivel rate may leave something to sliding (see `turned_unlike`)."""
    castors = robot.together("steer", (w for w in robot.wheels if w.kind.swivels))
    spun = [
        wheels
        for wheels in robot.together("spin", (w for w in robot.wheels if w.has_spin))
        if any(w.turns for w in wheels)
        and not (all(w in _partners(robot, wheels[0]) for w in wheels) and _alike(wheels, twist))
    ]
    return [[w.name for w in wheels] for wheels in (*castors, *spun) if len(wheels) > 1]


def _admissible(steered: bool, held: bool) -> str:
    """No fixed axle forbids a twist."""
    if not steered:
        return "Every twist is admissible, so `slip`, the distance to the nearest admissible twist, is 0."
    unless = ", unless a limit or a coupling keeps a wheel from its angle" if held else ""
    return (
        "At given steering angles few twists are admissible, but for every twist there are angles at which it is. "
        "`inverse` asks for these, so `slip`, the distance to the nearest admissible twist, is 0"
        + unless
        + "."
    )


def _forbidden(projection: Projection, coupled: bool, steered: bool, held: bool) -> list[str]:
    """What the admissible twist leaves of the commanded one."""
    forms = [p for p in projection.residuals if p]
    if not forms and coupled:
        return []
    if not forms:
        return [_admissible(steered, held)]
    words = "`slip` is the sideways speed [m/s] that the commanded twist would force on the contact points"
    if projection.twist == XI:
        words += "; nothing is projected away here, the wheels follow as well as they can"
    if forms == [XI[1]]:
        return [words.replace("speed [m/s]", "speed |v<sub>y</sub>| [m/s]", 1) + "."]
    if len(forms) == 1:
        return [f"{words}:", *math(rf"\mathrm{{slip}} = \left|{latex(forms[0])}\right|")]
    squares = Counter(rf"\left({latex(p)}\right)^2" for p in forms)
    parts = [text if n == 1 else rf"{n}\,{text}" for text, n in squares.items()]
    mean = " + ".join([*parts[:4], *([r"\cdots"] if len(parts) > 4 else [])])
    if projection.weight != 1:
        mean = rf"{latex(Poly.of(projection.weight))}\left[ {mean} \right]"
    return [f"{words}, root mean square over the wheels:", *math(rf"\mathrm{{slip}} = \sqrt{{{mean}}}")]
