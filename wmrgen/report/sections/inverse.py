"""Section 6: from a twist to every joint; which way a steered wheel turns, also when limits leave little room."""

from __future__ import annotations

from collections.abc import Callable

from wmrgen.analysis.kinematics.least_squares import Projection, project
from wmrgen.analysis.kinematics.steer import turning_points
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import XI, working_view
from wmrgen.geometry.exact.poly import Poly, Row
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.report.sections.closed import (
    driven_twist,
    move_alike,
    moves_as_partners,
    projected,
    rim_speed,
    spin_rate,
    swivel_rate,
)
from wmrgen.report.sections.markdown import CAP, aligned, code, grouped, in_degrees, listed, minus, some
from wmrgen.report.sections.slip import forms_of, left_by_couplings, left_by_steering, narrow_wheels, slip
from wmrgen.report.sections.texts import turning_circle

_WORDS = {"vx": "v<sub>x</sub>", "vy": "v<sub>y</sub>", "omega": "ω"}


def inverse(d: Derivation) -> list[str]:
    """Section 6."""
    robot = d.in_symbols.robot
    projection = project(robot, d.in_symbols.mobility)
    twist = driven_twist(projection)
    wheels = [w for w in robot.wheels[:CAP] if w.has_spin]
    couplings, steering = left_by_couplings(robot, twist), left_by_steering(robot, twist)
    blocks = ["## 6 Inverse kinematics", *_projection(projection, not (couplings or steering))]
    if not wheels:
        return [*blocks, "There is no joint to command."]
    passive = [w for w in wheels if w.kind.swivels and not w.actuated]
    steered = [w for w in wheels if w.kind.steers]
    if any(w.kind.swivels and w.actuated for w in wheels):
        blocks += [
            "A driven castor has both rates from its rows: the rolling row gives φ̇, the sliding row ψ̇."
        ]
    if passive:
        follow = "is not driven but follows" if len(passive) == 1 else "are not driven but follow"
        first = f" Of {code(passive[0].name)} they are" if len(passive) > 1 else ""
        blocks += [f"{some(passive)} {follow}: the rolling row gives φ̇, the sliding row ψ̇.{first}"]
        blocks += aligned(
            [spin_rate(passive[0], rim_speed(passive[0], twist)), swivel_rate(passive[0], twist)]
        )
    if steered:
        blocks += [*turning_circle(d.robot), *_steering(robot, steered, twist)]
    return [*blocks, *_coupled(robot, twist), *slip(projection, bool(steered), couplings, steering)]


def _projection(projection: Projection, alone: bool) -> list[str]:
    """The nearest admissible twist, where it is not the commanded one; slip, where that is what makes it ``alone``."""
    if projection.twist == XI:
        return []
    away = [n for n, p, q in zip(TWIST_NAMES, projection.twist, XI, strict=True) if p != q]
    zero = [n for n, p in zip(TWIST_NAMES, projection.twist, strict=True) if not p]
    if away == zero:
        names = notation.listed([_WORDS[n] for n in zero])
        count = int(float(projection.weight))
        slip = f"; `slip` is |{names}|, the speed [m/s] at which they would slide"
        if count > 1:
            slip = f"; `slip` is √{count} |{names}|, the norm of the speeds [m/s] at which {count} wheels would slide"
        said = alone and forms_of(projection) in ([XI[0]], [XI[1]])
        return [f"The wheels forbid {names}, which is taken away first{slip * said}."]
    return [
        "Not every ξ is admissible. The part that the wheels forbid is taken away first, and the rest is driven:",
        *aligned(projected(projection)),
    ]


def _steering(robot: Robot, wheels: list[Wheel], twist: Row) -> list[str]:
    """How a steered wheel chooses among the headings that roll, and what limits change."""
    shift = r"-o\,\omega" if any(w.nominal.o for w in wheels) else ""
    limited = [w for w in wheels if robot.limit(w, "steer")]
    shared = [w for w in limited if not moves_as_partners(robot, w, twist)]
    narrow = narrow_wheels(robot, wheels, twist)
    wide = [w for w in limited if w not in shared and w not in narrow]
    return [
        *(_nearer(shift) if len(narrow) < len(wheels) else []),
        *(_wide(_turning(robot, wide)) if wide else []),
        *(_narrow(_ranges(robot, narrow), shift) if narrow else []),
        *([f"Steering is limited: {_turning(robot, shared)}. A common angle is kept up to there, "
           "cut at the limit; beyond, the opposite one is taken."] if shared else []),
    ]  # fmt: skip


def _nearer(shift: str) -> list[str]:
    return [
        "A steered wheel has to point along the velocity of its pivot A, v<sub>Ax</sub> = v<sub>x</sub> − y ω and "
        "v<sub>Ay</sub> = v<sub>y</sub> + x ω. Seen from the wheel as it stands, at angle ψ, that velocity has a "
        "component u along the wheel and w across it, where h is the wheel's heading at ψ = 0. Two headings roll, half "
        "a turn apart. The nearer one is at most 90° away; it is reached by driving backwards when u < 0:",
        *aligned([
            r"u &= v_{Ax}\cos(h+\psi) + v_{Ay}\sin(h+\psi), & w &= v_{Ay}\cos(h+\psi) - v_{Ax}\sin(h+\psi)",
            rf"\Delta &= \mathrm{{atan2}}\left(\pm w, |u|\right), & \psi^{{+}} &= \psi + \Delta, \qquad "
            rf"\dot{{\varphi}} = \frac{{\pm\sqrt{{v_{{Ax}}^2+v_{{Ay}}^2}}{shift}}}{{r}}, \qquad "
            r"\pm = \begin{cases} - & u < 0 \\ + & u \ge 0 \end{cases}",
        ]),
        "With v<sub>Ax</sub> = v<sub>Ay</sub> = 0 the pivot is the ICR and any heading rolls: atan2(0, 0) = 0 "
        "holds the present one.",
        *_swinging(shift),
    ]  # fmt: skip


def _wide(ranges: str) -> list[str]:
    return [
        f"Steering is limited: {ranges}. Up to there ψ⁺ is kept, cut at the limit, so that noise at a stop does not "
        "swing the wheel to the other one and back; beyond, the opposite heading ψ⁺ ± π is taken, cut likewise. A "
        "wheel ends at most 5° further from the heading that rolls than it must. The rate then is that of the pivot's "
        "velocity along the wheel so turned, u cos Δ + w sin Δ with Δ = ψ⁺ − ψ, in place of the root."
    ]


def _narrow(ranges: str, shift: str) -> list[str]:
    offset = r" - \frac{o\,\omega}{r}" if shift else ""
    return [
        f"Steering is limited to less than a quarter turn: {ranges}. At most one of the two headings "
        "that roll lies inside, and the wheel takes the angle at which it slides least. Seen from the "
        "middle m of the limits, which are 2ρ apart, the velocity (v<sub>Ax</sub>, v<sub>Ay</sub>) of its pivot "
        "A is p along the wheel and q across it, h being its heading at ψ = 0; p = q = 0 holds the present angle:",
        *aligned([
            r"p &= v_{Ax}\cos(h+m) + v_{Ay}\sin(h+m), & q &= v_{Ay}\cos(h+m) - v_{Ax}\sin(h+m)",
            r"t &= \min\left(\max\left(\frac{q}{p}, -\tan\rho\right), \tan\rho\right), & "
            r"\psi^{+} &= m + \arctan t, & "
            rf"\dot{{\varphi}} &= \frac{{p + q\,t}}{{r\,\sqrt{{1+t^2}}}}{offset}",
        ]),
        *_swinging(shift),
    ]  # fmt: skip


def _swinging(shift: str) -> list[str]:
    """What `inverse`, which knows angles and no rates of them, leaves out beside the steering axis."""
    words = (
        "These speeds are those at a constant angle: while ψ changes, the rolling row takes another −o ψ̇ / r, which "
        "`steer_toward` adds."
    )
    return [words] if shift else []


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
            ratios = robot.ratios(joint, members)
            share = "they share the least-squares rate Σ r·(r φ̇) / Σ r²"
            if ratios:
                share = "each takes its part k of it times the least-squares rate Σ k r·(r φ̇) / Σ (k r)²"
            how = f": {share} of their single solutions" * (len(_rates(robot, wheels, twist)) > 1)
            way = _way(robot, wheels)
            if how or way:  # section 1 has the coupling itself
                blocks += [f"{listed(members)} {minus(notation.turning(ratios))}{how}.{way}"]
        elif wheels[0].kind.swivels:
            shared = "they share the least-squares rate Σ d·(d ψ̇) / Σ d² of their single solutions"
            blocks += [f"{listed(members)} swivel at one rate: {shared}."]
        elif move_alike(wheels, twist):
            same.append(listed(members))
        else:
            ratios = robot.ratios(joint, members)
            how, sums = "share one angle", "the sums over the wheels seen from the first of them"
            if ratios:
                how = minus(notation.steering(ratios)) + " by one angle"
                against = [n for n, k in zip(members, ratios, strict=True) if k.sign < 0]
                sums += f", w with the other sign for {listed(against)}"
            blocks += [
                f"{listed(members)} {how} that need not suit all: the one that leaves least sliding turns by half of "
                f"atan2(Σ 2 u w, Σ (u² − w²)), {sums}."
            ]
    if same:
        blocks += [f"Pivots of wheels that share an angle ({'; '.join(same)}) move alike: ψ⁺ is the same."]
    return blocks


def _rates(robot: Robot, wheels: list[Wheel], twist: Row) -> set[tuple[str, Poly]]:
    """The different speeds per share that coupled wheels would have by themselves. One that turns has its own, but for
    those that turn with it and move as it does."""
    rates = set()
    for w in wheels:
        together = robot.partners(w)
        turns = together[0].name if move_alike(together, twist) else w.name
        rim = Poly.of(1) if w.turns else rim_speed(w, twist)
        rates.add((turns if w.turns else "", rim * robot.per_turn(w, working_view(w)).inverse()))
    return rates


def _way(robot: Robot, wheels: list[Wheel]) -> str:
    """How a steered wheel among wheels with one speed picks its heading."""
    steered = [w.name for w in wheels if w.kind.steers]
    if not steered or len(robot.together("steer", wheels)) < 2:
        return ""
    whose, take = (
        ("its", "takes the one that rolls") if len(steered) == 1 else ("their", "take those that roll")
    )
    return f" Of {whose} two headings {listed(steered)} {take} the way the others do."
