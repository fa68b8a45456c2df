"""Section 6, steered wheels: where each points, also when its limits leave little room."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wmrgen import notation
from wmrgen.backends.report.markdown import aligned, listed, math
from wmrgen.backends.report.numbers import in_degrees
from wmrgen.backends.report.subject import Subject, grouped
from wmrgen.backends.report.tex import poly
from wmrgen.constraints import along, working_view
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.kinematics.steer import NARROW

if TYPE_CHECKING:
    from wmrgen.layout.records import Wheel

ONE, ZERO = Poly.of(1), Poly({})


def steering(s: Subject, wheels: list[Wheel], twist: Row) -> list[str]:
    """One general solution, each wheel's pivot velocity to put into it, and what limits change."""
    shift = r"-o\,\omega" if any(w.nominal.o for w in wheels) else ""
    limited = [w for w in wheels if s.robot.limit(w, "steer")]
    shared = [w for w in limited if not alike(partners(s, w), twist)]
    narrow = [w for w in limited if w not in shared and _range(s, w) <= NARROW]
    blocks = [
        "A steered wheel has to point along the velocity (a, b) of its pivot. Seen from the wheel as it stands, "
        "at angle ψ, that velocity has a component u along the wheel and w across it:",
        *aligned([
            r"a &= v_x - y\,\omega, & b &= v_y + x\,\omega",
            r"u &= a\cos(h+\psi) + b\sin(h+\psi), & w &= b\cos(h+\psi) - a\sin(h+\psi)",
        ]),
    ]  # fmt: skip
    zero = "where h is the wheel's heading at ψ = 0."
    blocks += [zero] if len(narrow) == len(wheels) else _nearer(zero, shift)
    velocities = grouped((velocity(w, twist), notation.wheel(w.name)) for w in wheels)
    shown = aligned(f"{text} && ({', '.join(who)})" for text, who in velocities.items())
    blocks += ["The pivots' velocities:", *shown]
    roomy = [w for w in limited if w not in shared and w not in narrow]
    return [*blocks, *_roomy(s, roomy), *_narrow(s, narrow, shift), *_shared(s, shared)]


def _nearer(zero: str, shift: str) -> list[str]:
    return [
        f"{zero} Two headings roll, half a turn apart. The nearer one is at most 90° away; it is reached by "
        "driving backwards when u < 0:",
        *math(
            r"\Delta = \mathrm{atan2}\left(\pm w, |u|\right), \qquad \psi^{+} = \psi + \Delta, \qquad",
            rf"\dot{{\varphi}} = \frac{{\pm\sqrt{{a^2+b^2}}{shift}}}{{r}},",
            r"\qquad \pm = \begin{cases} - & u < 0 \\ + & u \ge 0 \end{cases}",
        ),
        "With a = b = 0 the pivot is the ICR and any heading rolls: atan2(0, 0) = 0 holds the present one.",
    ]


def velocity(w: Wheel, twist: Row) -> str:
    """The components of the pivot's velocity, aligned."""
    g = working_view(w)
    a, b = dot(along((ONE, ZERO), g), twist), dot(along((ZERO, ONE), g), twist)
    return f"a &= {poly(a)}, & b &= {poly(b)}"


def partners(s: Subject, w: Wheel) -> list[Wheel]:
    """The wheels that turn with it, itself among them."""
    group = s.robot.steer_group
    return [v for v in s.letters.wheels if group[v.index] == group[w.index]]


def alike(wheels: list[Wheel], twist: Row) -> bool:
    """One velocity and one zero heading: each single solution is the common one."""
    return len({(velocity(w, twist), w.nominal.ch, w.nominal.sh) for w in wheels}) == 1


def _roomy(s: Subject, wheels: list[Wheel]) -> list[str]:
    if not wheels:
        return []
    return [
        f"Steering is limited: {_ranges(s, wheels)}. Where ψ⁺ lies outside, the opposite heading ψ⁺ ± π is taken "
        "if that is inside; if neither is, the limit nearest to it. The rate then is that of the pivot's velocity "
        "along the wheel so turned, u cos Δ + w sin Δ with Δ = ψ⁺ − ψ, in place of the root."
    ]


def _narrow(s: Subject, wheels: list[Wheel], shift: str) -> list[str]:
    if not wheels:
        return []
    return [
        f"Steering is limited to less than a quarter turn: {_ranges(s, wheels)}. At most one of the two headings "
        "that roll lies inside, and the wheel takes the angle inside at which it slides least. Seen from the "
        "middle m of the limits, which are 2ρ apart, the velocity is p along the wheel and q across it:",
        *aligned([
            r"p &= a\cos(h+m) + b\sin(h+m), & q &= b\cos(h+m) - a\sin(h+m)",
            r"t &= \min\left(\max\left(\frac{q}{p}, -\tan\rho\right), \tan\rho\right), & "
            r"\psi^{+} &= m + \arctan t, & "
            rf"\dot{{\varphi}} &= \frac{{1}}{{r}}\left(\frac{{p + q\,t}}{{\sqrt{{1+t^2}}}}{shift}\right)",
        ]),
        "With p = q = 0 the present angle is held. Below Δ = ψ⁺ − ψ.",
    ]  # fmt: skip


def _shared(s: Subject, wheels: list[Wheel]) -> list[str]:
    if not wheels:
        return []
    return [f"Steering is limited: {_ranges(s, wheels)}. A common angle outside is cut there."]


def _range(s: Subject, w: Wheel) -> Exact:
    limit = s.robot.limit(w, "steer")
    assert limit is not None
    return limit.high - limit.low


def _ranges(s: Subject, wheels: list[Wheel]) -> str:
    limits = [(s.robot.limit(w, "steer"), w.name) for w in wheels]
    texts = grouped((f"{in_degrees(r.low)} ≤ ψ ≤ {in_degrees(r.high)}", name) for r, name in limits if r)
    return "; ".join(f"{text} for {listed(who)}" for text, who in texts.items())
