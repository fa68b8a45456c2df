"""Section 6: from a twist to every joint; which way a steered wheel turns, also when limits leave little room."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping

from wmrgen.analysis.kinematics.least_squares import Projection, project
from wmrgen.analysis.kinematics.pivots import pivot
from wmrgen.analysis.kinematics.steer import NARROW, turning_points
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import XI, castor_rate, driving_row, working_view
from wmrgen.geometry.exact.evaluate import fix, sqrt_poly
from wmrgen.geometry.exact.poly import Gen, Poly, Row, dot
from wmrgen.geometry.exact.readable import with_sines_squared
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.report.sections.latex import (
    WIDE,
    alike,
    broken,
    latex,
    multiples,
    squares,
    summands,
    terms,
    total,
    width,
    with_tangents,
    wrapped,
)
from wmrgen.report.sections.markdown import (
    CAP,
    aligned,
    code,
    cut_note,
    grouped,
    in_degrees,
    listed,
    math,
    minus,
    some,
)
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


def closed_inverse(d: Derivation) -> list[str]:
    """The joint rates that a twist asks for, and of steered wheels the angle."""
    robot = d.in_symbols.robot
    projection = project(robot, d.in_symbols.mobility)
    twist = driven_twist(projection)
    wheels = [w for w in robot.wheels[:CAP] if w.has_spin]
    if not any(w.actuated for w in robot.wheels):
        return ["No joint is driven, so there is nothing to command."]
    lines = [spin_rate(w, rim) for w, rim in _rims([w for w in wheels if not w.turns], robot, twist)]
    turning = (
        [w for w in wheels if w.kind.steers],
        [w for w in wheels if w.kind.swivels and w.actuated],
    )
    spun = {name for names in turned_apart(robot, twist) for name in names}
    pivots = []
    for group in filter(None, turning):
        tied = any(w.name in spun or not moves_as_partners(robot, w, twist) for w in group)
        pivots += _pivots(group, twist, tied)
    shown = "".join([*lines, *pivots])
    stars = [line for line in projected(projection) if line.partition(" &=")[0] in shown]
    blocks = aligned([*stars, *lines]) if stars or lines else []
    if apart := [w.name for w in wheels if not w.turns and w.name in spun]:
        alone = "itself" if len(apart) == 1 else "themselves"
        blocks += [f"{listed(apart)} would turn so by {alone}; section 6 says what couplings make of that."]
    return [*blocks, *pivots, *cut_note(robot.wheels)]


def rim_speed(w: Wheel, twist: Row) -> Poly:
    """Speed [m/s] of the rim of a wheel that does not turn."""
    return dot(driving_row(w, working_view(w)), twist)


def _rims(wheels: list[Wheel], robot: Robot, twist: Row) -> Iterator[tuple[Wheel, Poly]]:
    """Rim speeds; of wheels that turn together those at their common least-squares rate."""
    own = {w.name: rim_speed(w, twist) for w in wheels}
    shares = {w.name: robot.per_turn(w, working_view(w)) for w in wheels}
    groups = {w.name: group for group in robot.together("spin", wheels) for w in group}
    for w in wheels:
        names = [v.name for v in groups[w.name]]
        if len({own[n] * shares[n].inverse() for n in names}) == 1:
            yield w, own[w.name]
        else:
            squares = Poly.sum(shares[n] * shares[n] for n in names)
            yield w, Poly.sum(shares[n] * own[n] for n in names) * squares.inverse() * shares[w.name]


def _pivots(wheels: list[Wheel], twist: Row, tied: bool) -> list[str]:
    """What steered wheels or driven castors do, with the velocity of each one's pivot. ``tied``: couplings keep some of
    them from what each would do by itself."""
    pairs = alike([p for w in wheels for p in pivot(w, twist)])
    texts = (f"v_{{Ax}} &= {a}, & v_{{Ay}} &= {b}" for a, b in zip(pairs[::2], pairs[1::2], strict=True))
    velocities = grouped(zip(texts, (notation.wheel(w.name) for w in wheels), strict=True))
    castors = wheels[0].kind.swivels
    turned = any(w.heading for w in wheels)
    psi = r"\left(h+\psi\right)" if turned else r"\psi"
    zero = ", with h its heading at ψ = 0" if turned else ""
    noun = "driven castor" if castors else "steered wheel"
    who = f"Each {noun}" if len(wheels) > 1 else f"The {noun} {code(wheels[0].name)}"
    views = [working_view(w) for w in wheels]
    r, d, o = (_of_all(own, name) for name, own in (
        ("r", [g.r for g in views]), ("d", [g.d for g in views]), ("o", [g.o for g in views])
    ))  # fmt: skip
    rim, across = rf"v_{{Ax}}\cos{psi} + v_{{Ay}}\sin{psi}", rf"v_{{Ax}}\sin{psi} - v_{{Ay}}\cos{psi}"
    velocity = "velocity (v<sub>Ax</sub>, v<sub>Ay</sub>) of its pivot A"
    instead = "; section 6 says what couplings make of that" * tied
    if castors:
        shift = rf" - {o}\left(\omega + \dot{{\psi}}\right)" if o != "0" else ""
        words = f"{who} {'would by itself have' if tied else 'has'} both rates from the {velocity}{zero}{instead}:"
        first = rf"\dot{{\psi}} &= {_over(across, d)} - \omega"
    else:
        shift = rf" - {o}\,\omega" if o != "0" else ""
        fast = "as fast as its contact point moves" if shift else "as fast"
        does = ("would by itself stand along", "roll") if tied else ("stands along", "rolls")
        words = f"{who} {does[0]} the {velocity}{zero}, and {does[1]} {fast}, forwards or backwards{instead}:"
        first = rf"\tan{psi} &= \frac{{v_{{Ay}}}}{{v_{{Ax}}}}"
    return [
        words,
        *aligned([
            *(f"{text} && ({', '.join(names)})" for text, names in velocities.items()),
            rf"{first}, & \dot{{\varphi}} &= {_over(rim + shift.replace('- -', '+ '), r)}",
        ]),
    ]  # fmt: skip


def _of_all(lengths: list[Poly], letter: str) -> str:
    """A length that all wheels have; the letter of the layout table where they differ, for a sum and a fraction."""
    first, *others = lengths
    own = latex(first) if all(p == first for p in others) and len(first.terms) < 2 else letter
    return letter if own.startswith(r"\frac") else own


def _over(above: str, below: str) -> str:
    """A fraction with its sign before it."""
    length = below.removeprefix("-")
    return rf"{'-' * (length != below)}\frac{{{above}}}{{{length}}}"


def spin_rate(w: Wheel, rim: Poly) -> str:
    """The rim's speed over the radius, which a number leaves below the line."""
    g = working_view(w)
    rim *= g.r * g.rolling_radius.inverse()
    above, radius = total(with_tangents(terms(rim))), g.r.constant
    below = notation.terminating(radius.parts[0]) if radius and radius.is_rational else None
    one_line = len(rim.terms) > 1 and width(above) <= WIDE
    spin = (
        _over(above, below)
        if below and one_line
        else wrapped(summands(with_tangents(terms(rim * g.r.inverse()))))
    )
    return f"{notation.port(f'{w.name}.spin')} &= {spin}"


def swivel_rate(w: Wheel, twist: Row) -> str:
    return f"{notation.port(f'{w.name}.steer_rate')} &= {broken(castor_rate(w, working_view(w), twist))}"


def driven_twist(projection: Projection) -> Row:
    """The twist that is driven; components that the projection changed carry a star."""
    return projection.named(lambda name, _: Poly.gen("input", name))


def projected(projection: Projection) -> list[str]:
    """The components that change."""
    parts = zip(projection.twist, XI, TWIST_NAMES, strict=True)
    return [
        f"{notation.port(n)}^{{*}} &= {broken(with_sines_squared(p))}"
        for n, p, q in ((n, p, q) for p, q, n in parts)
        if p != q
    ]


def moves_as_partners(robot: Robot, w: Wheel, twist: Row) -> bool:
    """Whether all wheels that steer as one with it move alike."""
    return move_alike(robot.partners(w), twist)


def move_alike(wheels: list[Wheel], twist: Row) -> bool:
    """One velocity and one zero heading, turned the same way: each single solution is the common one."""
    return len({(*pivot(w, twist), w.nominal.ch, w.nominal.sh, w.steer_sign) for w in wheels}) == 1


def turned_apart(robot: Robot, twist: Row) -> list[list[str]]:
    """Coupled wheels whose common spin or swivel rate may leave something to sliding (see `turned_unlike`)."""
    castors = robot.together("steer", (w for w in robot.wheels if w.kind.swivels))
    spun = [
        wheels
        for wheels in robot.together("spin", (w for w in robot.wheels if w.has_spin))
        if any(w.turns for w in wheels)
        and not (all(w in robot.partners(wheels[0]) for w in wheels) and move_alike(wheels, twist))
    ]
    return [[w.name for w in wheels] for wheels in (*castors, *spun) if len(wheels) > 1]


_ROOT = 100  # glyphs under a root
_MANY = 12  # lines of sums that stand under one


def narrow_wheels(robot: Robot, wheels: list[Wheel], twist: Row) -> list[Wheel]:
    """Wheels whose limits leave one heading at most."""
    limits = [(w, robot.limit(w, "steer")) for w in wheels if moves_as_partners(robot, w, twist)]
    return [w for w, limit in limits if limit and limit.high - limit.low <= NARROW]


def _may_be_cut(robot: Robot, w: Wheel) -> bool:
    limits = robot.limit(w, "steer")
    return limits is not None and turning_points(limits) != limits


def left_by_couplings(robot: Robot, twist: Row) -> dict[str, str]:
    """Squares that add to slip², and what they are of: what common rates leave to sliding."""
    unlike = turned_apart(robot, twist)
    if not unlike:
        return {}
    castors = any(robot.wheel(n).kind.swivels for names in unlike for n in names)
    swivels = ", or between d ψ̇ and its sideways speed" * castors
    return {
        r"\sum \varepsilon^2": "ε, what a common rate leaves between r φ̇ and the rim speed "
        f"of a coupled wheel{swivels}, summed over {' and over '.join(map(listed, unlike))}"
    }


def left_by_steering(robot: Robot, twist: Row) -> dict[str, str]:
    """The same of steered wheels that limits or couplings keep from their heading."""
    steered = [w for w in robot.wheels if w.kind.steers]
    limited = [w for w in steered if _may_be_cut(robot, w)]
    shared = [w for w in steered if not moves_as_partners(robot, w, twist)]
    held = [w.name for w in steered if w in limited or w in shared]
    if not held:
        return {}
    cut = {w.name for w in narrow_wheels(robot, steered, twist)}
    ways = ((not cut.issuperset(held), "w cos Δ − u sin Δ with Δ = ψ⁺ − ψ"), (cut, "(q − p t) / √(1 + t²)"))
    speed = " or ".join(text for there, text in ways if there)
    why = " or ".join(text for there, text in ((limited, "a limit"), (shared, "a coupling")) if there)
    which = code(held[0]) if len(held) == 1 else "a steered wheel"
    summed = f", summed over {listed(held)}" * (len(held) > 1)
    return {
        r"\sum v_\perp^2"
        if summed
        else r"v_\perp^2": f"v<sub>⊥</sub> = {speed}, the speed across {which} where "
        f"{why} keeps it from the heading that rolls{summed}"
    }


def slip(
    projection: Projection, steered: bool, couplings: Mapping[str, str], steering: Mapping[str, str]
) -> list[str]:
    """What `slip` is made of: ``couplings`` and ``steering`` leave their parts."""
    forms, more = forms_of(projection), {**couplings, **steering}
    forced = "that the commanded twist would force on the contact points"
    follow = ["Nothing is taken away from the twist here: the wheels follow as well as they can."]
    blocks = follow if forms and projection.twist == XI else []
    if not forms and not couplings:
        blocks = [_admissible(steered, bool(steering))]
    if more:
        then = "Then " if blocks and not forms else ""
        sums, mean = _mean_square(projection)
        parts = {mean: f"the sliding speed {forced}"} | more if forms else more
        return [
            *blocks,
            f"{then}`slip` [m/s] is made of {', and of '.join(parts.values())}:",
            *_root(sums, " + ".join(parts)),
        ]
    if not forms or (forms in ([XI[0]], [XI[1]]) and projection.twist != XI):  # said where it is taken away
        return blocks
    words = f"`slip` is the sliding speed [m/s] {forced}"
    if len(forms) == 1:
        times = fix(sqrt_poly(Poly.of(projection.weight)), {})
        return [*blocks, f"{words}:", *math(rf"\mathrm{{slip}} = \left|{latex(times * forms[0])}\right|")]
    return [*blocks, f"{words}, root of the sum of squares:", *_root(*_mean_square(projection))]


def _root(sums: list[str], total: str) -> list[str]:
    """slip as the root of a total, with the lines of sums that are too wide to stand under it."""
    if not sums:
        return math(rf"\mathrm{{slip}} = \sqrt{{{total}}}")
    return aligned(
        [*sums[:_MANY], *[r"&\vdots"] * (len(sums) > _MANY), rf"\mathrm{{slip}} &= \sqrt{{{total}}}"]
    )


def _mean_square(projection: Projection) -> tuple[list[str], str]:
    """What the admissible twist leaves of the commanded one; lines that name the sums in it, where they are wide."""
    forms, sums = forms_of(projection), list[str]()
    counts = squares(forms)
    if width(" + ".join(counts)) > _ROOT:
        sums = [rf"s_{{{k}}} &= {latex(p)}" for k, p in enumerate(dict.fromkeys(forms), 1)]
        counts = Counter({rf"s_{{{k}}}^2": n for k, n in enumerate(counts.values(), 1)})
    each = min(counts.values()) if len(set(counts.values())) == 1 else 1
    parts = multiples(counts, each)
    mean = " + ".join([*parts[:_MANY], *[r"\cdots"] * (len(parts) > _MANY)])
    if projection.weight * each == 1:
        return sums, mean
    factor = latex(Poly.of(projection.weight * each))
    return sums, rf"{factor}\left[ {mean} \right]" if len(parts) > 1 else rf"{factor}\,{mean}"


def _admissible(steered: bool, held: bool) -> str:
    """No fixed axle forbids a twist."""
    if not steered:
        return "Every twist is admissible, so `slip`, the distance to the nearest admissible twist, is 0."
    unless = ", unless a limit or a coupling keeps a wheel from its angle" if held else ""
    return (
        "At given steering angles not every twist is admissible, but for every twist there are angles at which it is. "
        f"`inverse` asks for these, so `slip`, the distance to the nearest admissible twist, is 0{unless}."
    )


def _root_of_square(g: Gen) -> Poly | None:
    """n x, whose sign does not matter, for the root of n² x²."""
    if g.kind != "sqrt" or len(g.args[0].terms) > 1:
        return None
    ((square, number),) = g.args[0].terms.items()
    root = sqrt_poly(Poly.of(number)).constant
    if root is None or any(e % 2 for _, e in square):
        return None
    return Poly({tuple((h, e // 2) for h, e in square): root})


def forms_of(projection: Projection) -> list[Poly]:
    """What is squared, each with the sign that it is read with."""
    forms = [p if len(p.terms) > 1 else p.substitute(_root_of_square) for p in projection.residuals if p]
    return [-p if latex(p).startswith("-") else p for p in forms]
