"""Write section 6 and the inverse kinematics of the result: from a twist to the joints, and the `slip` of a twist.

Section 6 says which part of the twist is removed, and derives the formulas of the result from the rows of section 2.
Then it says how steered wheels choose a heading, what limits and couplings change, and what `slip` consists of. The
result shows the rates of wheels, and where steered wheels point.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

from wmrgen.analysis.kinematics.least_squares import Projection, project
from wmrgen.analysis.kinematics.pivots import pivot
from wmrgen.analysis.kinematics.steer import NARROW, turning_points
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import XI, castor_rate, driving_row, rolling_row, sliding_row, working_view
from wmrgen.geometry.exact.evaluate import fix, sqrt_poly
from wmrgen.geometry.exact.poly import Gen, Poly, Row, dot
from wmrgen.geometry.exact.readable import with_sines_squared
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.report.sections.latex import (
    PAGE,
    WIDE,
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
    keyed,
    listed,
    math,
    minus,
    some,
    titled,
)
from wmrgen.report.sections.rows import equations
from wmrgen.report.sections.texts import turning_circle

_WORDS = {"vx": "v<sub>x</sub>", "vy": "v<sub>y</sub>", "omega": "ω"}
_MANY = 12  # squares that are written out in `slip`; robots with dozens of wheels have more


# ---- Section 6.


def inverse(d: Derivation) -> list[str]:
    """Return section 6."""
    robot = d.in_symbols.robot
    projection = project(robot, d.in_symbols.mobility)
    twist = driven_twist(projection)
    wheels = [w for w in robot.wheels[:CAP] if w.has_spin]
    couplings, steering = _left_by_couplings(robot, twist), _left_by_steering(robot, twist)
    blocks = ["## 6 Inverse kinematics", *_projection(robot, projection, not (couplings or steering))]
    if not wheels:
        return [*blocks, "There is no joint to command."]
    if any(w.actuated for w in robot.wheels):
        blocks += _from_rows(robot, twist, wheels)
    steered = [w for w in wheels if w.kind.steers]
    if steered:
        blocks += [*titled("Turning circle", turning_circle(d.robot)), *_steering(robot, steered, twist)]
    return [
        *blocks,
        *_following(wheels, twist),
        *titled("Couplings", _coupled(robot, twist)),
        *titled("Slip", _slip(projection, bool(steered), couplings, steering)),
    ]


def _from_rows(robot: Robot, twist: Row, wheels: list[Wheel]) -> list[str]:
    """Derive the formulas of the result from the rows of section 2.

    Args:
        robot: the robot, its named parameters as symbols.
        twist: the twist that is driven.
        wheels: the wheels whose equations are written out.

    Returns:
        The blocks of Markdown. The last one is the last formula of the inverse kinematics of the result.
    """
    blocks = []
    rims = list(_rims([w for w in wheels if not w.turns], robot, twist))
    if rims:
        first = rims[0][0]
        blocks += [
            keyed(
                "inverse.rolling_row",
                f"The rolling row of a wheel gives its rate. For {code(first.name)} it is",
            ),
            *aligned(equations([rolling_row(first, working_view(first))])),
            _divided(rims, twist, len(rims) < len(wheels)),
            *aligned([spin_rate(w, rim) for w, rim in rims]),
        ]
    for group in _turning_groups(wheels):
        blocks += _rows_of_pivots(group)
        blocks += _formulas_of_pivots(group, twist)
    return blocks


def _divided(rims: list[tuple[Wheel, Poly]], twist: Row, some_turn: bool) -> str:
    """Say how rates follow from rolling rows.

    Args:
        rims: the wheels that do not turn, with their rim speeds.
        twist: the twist that is driven.
        some_turn: whether other wheels turn.

    Returns:
        A sentence, to be written before the rates.
    """
    radius = "r cos γ" if any(w.gamma for w, _ in rims if w.kind.rollers) else "r"
    which = f"the wheel{'s' * (len(rims) > 1)} that {'do' if len(rims) > 1 else 'does'} not steer"
    which = which if some_turn else "all wheels" if len(rims) > 1 else "the wheel"
    at = f" at the twist that is driven{_absent(twist)}" if twist != XI else ""
    mean = ""
    if any(rim != rim_speed(w, twist) for w, rim in rims):
        mean = keyed(
            "inverse.rates_in_common",
            "; wheels with one speed get the rate that fits their rows best, Σ r·(r φ̇) / Σ r² of the single rates",
        )
    return f"For {which}, division by {radius}{at} gives{mean}"


def _absent(twist: Row) -> str:
    """Return the components that are not driven, in brackets; "" if there are none."""
    zero = [f"{_WORDS[n]} = 0" for n, p in zip(TWIST_NAMES, twist, strict=True) if not p]
    return f" ({notation.listed(zero)})" if zero else ""


def _following(wheels: list[Wheel], twist: Row) -> list[str]:
    """Write the rates of castors that are not driven."""
    passive = [w for w in wheels if w.kind.swivels and not w.actuated]
    if not passive:
        return []
    follow = "is not driven; it follows" if len(passive) == 1 else "are not driven; they follow"
    first = f" For {code(passive[0].name)} these are" if len(passive) > 1 else ""
    return [
        f"**Castors.** {some(passive)} {follow}. The rolling row gives φ̇, the sliding row ψ̇.{first}",
        *aligned([spin_rate(passive[0], rim_speed(passive[0], twist)), _swivel_rate(passive[0], twist)]),
    ]


def _projection(robot: Robot, projection: Projection, alone: bool) -> list[str]:
    """Write the nearest admissible twist if it is not the commanded one.

    Args:
        robot: the robot, its named parameters as symbols.
        projection: the projection of the twist on the admissible twists.
        alone: whether `slip` comes from this projection alone, so that it can be given here.

    Returns:
        The blocks of Markdown.
    """
    if projection.twist == XI:
        return []
    away = [n for n, p, q in zip(TWIST_NAMES, projection.twist, XI, strict=True) if p != q]
    zero = [n for n, p in zip(TWIST_NAMES, projection.twist, strict=True) if not p]
    if away == zero:
        names = notation.listed([_WORDS[n] for n in zero])
        count = int(float(projection.weight))
        slip = f" `slip` is |{names}|, the speed [m/s] at which they would slide."
        if count > 1:
            slip = f" `slip` is √{count} |{names}|, the norm of the speeds [m/s] at which {count} wheels would slide."
        explained = alone and _forms(projection) in ([XI[0]], [XI[1]])
        return [f"The wheels do not allow {names}, so `inverse` first sets it to 0.{slip * explained}"]
    row = next((sliding_row(w, working_view(w)) for w in robot.wheels if w.kind.fixed_axle), None)
    along = f" The sliding row of {code(row.wheel.name)} is" if row else ""
    return [
        f"Not every ξ is admissible.{along}",
        *(aligned(equations([row])) if row else []),
        "`inverse` removes the part of ξ that the wheels do not allow, and drives the rest:",
        *aligned(projected(projection)),
    ]


def _steering(robot: Robot, wheels: list[Wheel], twist: Row) -> list[str]:
    """Say how a steered wheel chooses between the two headings that roll, and what limits change."""
    letters = _letters(wheels)
    limited = [w for w in wheels if robot.limit(w, "steer")]
    shared = [w for w in limited if not moves_as_partners(robot, w, twist)]
    narrow = _narrow_wheels(robot, wheels, twist)
    wide = [w for w in limited if w not in shared and w not in narrow]
    return [
        *(_nearer(letters) if len(narrow) < len(wheels) else []),
        *(_wide(_turning(robot, wide)) if wide else []),
        *(_narrow(_ranges(robot, narrow), letters) if narrow else []),
        *([f"**Limits.** Steering is limited: {_turning(robot, shared)}. Up to the turning points, the common angle "
           "is kept and clamped to the limits. Beyond them, the opposite heading is taken."] if shared else []),
    ]  # fmt: skip


def _nearer(letters: _Letters) -> list[str]:
    """Write the choice of the nearer heading."""
    c, s = rf"\cos{letters.psi}", rf"\sin{letters.psi}"
    shift = _minus(letters.o, r"\omega")
    return [
        "**The nearer heading.** The wheel rolls at two headings, which are half a turn apart. At the present angle ψ, "
        f"v<sub>A</sub> has a component u along the wheel and w across it{_of_zero(letters)}. The wheel takes the "
        "nearer heading, at most 90° away, and drives backwards if u < 0:",
        *aligned([
            rf"u &= v_{{Ax}}{c} + v_{{Ay}}{s}, & w &= v_{{Ay}}{c} - v_{{Ax}}{s}",
            rf"\Delta &= \mathrm{{atan2}}\left(\pm w, |u|\right), & \psi^{{+}} &= \psi + \Delta, \qquad "
            rf"\dot{{\varphi}} = \frac{{\pm\sqrt{{v_{{Ax}}^2+v_{{Ay}}^2}}{shift}}}{{{letters.r}}}, \qquad "
            r"\pm = \begin{cases} - & u < 0 \\ + & u \ge 0 \end{cases}",
        ]),
        "If v<sub>Ax</sub> = v<sub>Ay</sub> = 0, the pivot is the ICR and the wheel rolls at any heading. It keeps its "
        "present one, because atan2(0, 0) = 0.",
        *_steering_rate(letters),
    ]  # fmt: skip


def _of_zero(letters: _Letters) -> str:
    """Return the clause that says what psi_0 is; "" if formulas do not have it."""
    return "; ψ<sub>0</sub> is the heading of the wheel at ψ = 0" if "psi_0" in letters.psi else ""


def _wide(ranges: str) -> list[str]:
    return [
        f"**Limits.** Steering is limited: {ranges}. Up to the turning points, ψ⁺ is kept and clamped to the limits, "
        "so that noise at a limit does not swing the wheel to the other limit and back. Beyond them, the opposite "
        "heading ψ⁺ ± π is taken and clamped. Compared with the better of the two, a wheel is at most 5° further from "
        "the heading that rolls. For a clamped wheel, the root is replaced by the speed of the pivot along the wheel, "
        "u cos Δ + w sin Δ with Δ = ψ⁺ − ψ."
    ]


def _narrow(ranges: str, letters: _Letters) -> list[str]:
    """Write the angle of wheels with a range of less than a quarter turn."""
    sign, length = ("+", letters.o[1:]) if letters.o.startswith("-") else ("-", letters.o)
    offset = "" if length == "0" else rf" {sign} \frac{{{length}\,\omega}}{{{letters.r}}}"
    middle = letters.psi.replace(r"+\psi", "+m") if "psi_0" in letters.psi else " m"
    c, s = rf"\cos{middle}", rf"\sin{middle}"
    return [
        f"**Limits.** Steering is limited to less than a quarter turn: {ranges}. At most one of the two headings that "
        "roll is within the limits, and the wheel takes the angle at which it slides least. The limits are m ± ρ. At "
        f"the middle m, the velocity v<sub>A</sub> is p along the wheel and q across it{_of_zero(letters)}. If "
        "p = q = 0, the wheel keeps its angle:",
        *aligned([
            rf"p &= v_{{Ax}}{c} + v_{{Ay}}{s}, & q &= v_{{Ay}}{c} - v_{{Ax}}{s}",
            r"t &= \min\left(\max\left(\frac{q}{p}, -\tan\rho\right), \tan\rho\right), & "
            r"\psi^{+} &= m + \arctan t, & "
            rf"\dot{{\varphi}} &= \frac{{p + q\,t}}{{{letters.r}\,\sqrt{{1+t^2}}}}{offset}",
        ]),
        *_steering_rate(letters),
    ]  # fmt: skip


def _steering_rate(letters: _Letters) -> list[str]:
    """Say what steering adds to the rate of a wheel next to its steering axis; `inverse` does not know that rate."""
    words = keyed(
        "inverse.steering_rate",
        "These rates hold at a constant angle. While ψ changes, the wheel also turns by −o ψ̇ / r; `steer_toward` adds "
        "this.",
    )
    return [words] if letters.o != "0" else []


def _narrow_wheels(robot: Robot, wheels: list[Wheel], twist: Row) -> list[Wheel]:
    """Return the wheels whose limits contain at most one heading that rolls."""
    limits = [(w, robot.limit(w, "steer")) for w in wheels if moves_as_partners(robot, w, twist)]
    return [w for w, limit in limits if limit and limit.high - limit.low <= NARROW]


def _turning(robot: Robot, wheels: list[Wheel]) -> str:
    """Return steering limits and turning points in words."""

    def ends(limits: Interval) -> str:
        points = turning_points(limits)
        return f", with turning points at {in_degrees(points.low)} and {in_degrees(points.high)},"

    return _ranges(robot, wheels, ends)


def _ranges(robot: Robot, wheels: list[Wheel], more: Callable[[Interval], str] = lambda _: "") -> str:
    """Return the steering limits of wheels in words; equal ones are merged."""
    limits = [(robot.limit(w, "steer"), w.name) for w in wheels]
    texts = grouped(
        (f"{in_degrees(r.low)} ≤ ψ ≤ {in_degrees(r.high)}{more(r)}", name) for r, name in limits if r
    )
    return "; ".join(f"{text} for {listed(who)}" for text, who in texts.items())


# ---- Section 6: couplings.


def _coupled(robot: Robot, twist: Row) -> list[str]:
    """Say what couplings change."""
    blocks, same = [], []
    for joint, members in robot.couplings:
        wheels = [robot.wheel(n) for n in members]
        if joint == "spin":
            blocks += _coupled_spins(robot, wheels, twist)
        elif wheels[0].kind.swivels:
            rate = "the least-squares rate Σ d·(d ψ̇) / Σ d² of the rates that each alone would have"
            blocks += [keyed("inverse.one_swivel_rate", f"{listed(members)} swivel at one rate: {rate}.")]
        elif move_alike(wheels, twist):
            same.append(listed(members))
        else:
            blocks += [_compromise_angle(robot, members)]
    if same:
        blocks += [
            f"The pivots of wheels that share an angle ({'; '.join(same)}) move alike, so ψ⁺ is the same for them."
        ]
    return blocks


def _coupled_spins(robot: Robot, wheels: list[Wheel], twist: Row) -> list[str]:
    """Explain how wheels with coupled spins turn; [] if section 1 explains all of it."""
    names = [w.name for w in wheels]
    ratios = robot.ratios("spin", names)
    blocks = []
    mean = len(_rates(robot, wheels, twist)) > 1
    direction = _direction(robot, wheels)
    if mean or direction:
        blocks.append(keyed("inverse.one_speed", f"{listed(names)} {minus(notation.turning(ratios))}."))
    if mean:
        rate = "The common rate is the least-squares rate Σ r·(r φ̇) / Σ r²"
        if ratios:
            rate = "Each wheel turns at its share k of the least-squares rate Σ k r·(r φ̇) / Σ (k r)², k from the ratio"
        blocks.append(
            keyed("inverse.mean_rate", f"{rate}, where φ̇ is the rate that each wheel alone would have.")
        )
    return [" ".join([*blocks, *direction])] if blocks else []


def _direction(robot: Robot, wheels: list[Wheel]) -> list[str]:
    """Say how a steered wheel among wheels with one speed chooses its heading."""
    steered = [w.name for w in wheels if w.kind.steers]
    if not steered or len(robot.together("steer", wheels)) < 2:
        return []
    two = f"The two headings that roll differ in the sign of the speed. {listed(steered)}"
    takes = (
        "takes the heading at which it turns" if len(steered) == 1 else "take the headings at which they turn"
    )
    return [keyed("inverse.same_direction", f"{two} {takes} in the same direction as the other wheels.")]


def _compromise_angle(robot: Robot, members: tuple[str, ...]) -> str:
    """Say which angle wheels share that would need different ones."""
    ratios = robot.ratios("steer", members)
    how, sums = "share one angle", "The sums run over the wheels, each seen from the first of them"
    if ratios:
        how = minus(notation.steering(ratios)) + " by one angle"
        against = [n for n, k in zip(members, ratios, strict=True) if k.sign < 0]
        sums += f", with the opposite sign of w for {listed(against)}"
    return keyed(
        "inverse.compromise_angle",
        f"{listed(members)} {how}, although each alone may need another one. The angle changes by half of "
        f"atan2(Σ 2 u w, Σ (u² − w²)), which minimises sliding. {sums}.",
    )


def _rates(robot: Robot, wheels: list[Wheel], twist: Row) -> set[tuple[str, Poly]]:
    """Return the different speeds, per share, that coupled wheels would have alone.

    A wheel that steers has a speed of its own, unless it steers and moves with other wheels.
    """
    rates = set()
    for w in wheels:
        together = robot.partners(w)
        turns = together[0].name if move_alike(together, twist) else w.name
        rim = Poly.of(1) if w.turns else rim_speed(w, twist)
        rates.add((turns if w.turns else "", rim * robot.per_turn(w, working_view(w)).inverse()))
    return rates


def moves_as_partners(robot: Robot, w: Wheel, twist: Row) -> bool:
    """Return whether all wheels that steer as one with a wheel move alike.

    Args:
        robot: the robot.
        w: the wheel.
        twist: the velocities vx, vy [m/s] and omega [rad/s] of the robot.

    Returns:
        Whether one steering angle suits all of them, see `move_alike`.
    """
    return move_alike(robot.partners(w), twist)


def move_alike(wheels: list[Wheel], twist: Row) -> bool:
    """Return whether wheels have one pivot velocity, zero heading and sense of steering: one angle suits all."""
    return len({(*pivot(w, twist), w.nominal.ch, w.nominal.sh, w.steer_sign) for w in wheels}) == 1


def turned_apart(robot: Robot, twist: Row) -> list[list[str]]:
    """Return the coupled wheels whose common spin or swivel rate may force them to slide (see `turned_unlike`)."""
    castors = robot.together("steer", (w for w in robot.wheels if w.kind.swivels))
    spun = []
    for wheels in robot.together("spin", (w for w in robot.wheels if w.has_spin)):
        if not any(w.turns for w in wheels):
            continue
        partners = robot.partners(wheels[0])
        steered_alike = all(w in partners for w in wheels) and move_alike(wheels, twist)
        if not steered_alike:
            spun.append(wheels)
    return [[w.name for w in wheels] for wheels in (*castors, *spun) if len(wheels) > 1]


# ---- Section 6: what `slip` consists of.


def _may_be_cut(robot: Robot, w: Wheel) -> bool:
    """Return whether limits may clamp the angle of a wheel."""
    limits = robot.limit(w, "steer")
    return limits is not None and turning_points(limits) != limits


def _left_by_couplings(robot: Robot, twist: Row) -> dict[str, str]:
    """Return squares (LaTeX) that coupled rates add to slip², with their meaning."""
    unlike = turned_apart(robot, twist)
    if not unlike:
        return {}
    castors = any(robot.wheel(n).kind.swivels for names in unlike for n in names)
    swivels = ", or between d ψ̇ and its sideways speed," * castors
    return {
        r"\sum \varepsilon^2": "ε, the difference between r φ̇ and the rim speed of a coupled wheel"
        f"{swivels} summed over {' and over '.join(map(listed, unlike))}"
    }


def _left_by_steering(robot: Robot, twist: Row) -> dict[str, str]:
    """Return squares (LaTeX) that limited or coupled steering angles add to slip², with their meaning."""
    steered = [w for w in robot.wheels if w.kind.steers]
    limited = [w for w in steered if _may_be_cut(robot, w)]
    shared = [w for w in steered if not moves_as_partners(robot, w, twist)]
    names = [w.name for w in steered if w in limited or w in shared]
    if not names:
        return {}
    narrow = {w.name for w in _narrow_wheels(robot, steered, twist)}
    speeds = []
    if not narrow.issuperset(names):
        speeds.append("w cos Δ − u sin Δ with Δ = ψ⁺ − ψ")
    if narrow:
        speeds.append("(q − p t) / √(1 + t²)")
    reasons = " or ".join(["a limit"] * bool(limited) + ["a coupling"] * bool(shared))
    which = code(names[0]) if len(names) == 1 else "a steered wheel"
    summed = f", summed over {listed(names)}" * (len(names) > 1)
    square = r"\sum v_\perp^2" if summed else r"v_\perp^2"
    return {
        square: keyed(
            "slip.across",
            f"v<sub>⊥</sub> = {' or '.join(speeds)}, the speed at which {which} slides sideways if {reasons} keeps it "
            f"from the heading at which it rolls{summed}",
        )
    }


def _slip(
    projection: Projection, steered: bool, couplings: Mapping[str, str], steering: Mapping[str, str]
) -> list[str]:
    """Say what `slip` consists of.

    Args:
        projection: the projection of the twist on the admissible twists.
        steered: whether the robot has steered wheels.
        couplings: squares that coupled rates add, with their meaning.
        steering: squares that steering angles add, with their meaning.

    Returns:
        The blocks of Markdown.
    """
    forms, more = _forms(projection), {**couplings, **steering}
    forced = "that the commanded twist would force on the contact points"
    follow = ["No part of the twist is removed here: the wheels follow as well as they can."]
    blocks = follow if forms and projection.twist == XI else []
    if not forms and not couplings:
        blocks = [_admissible(steered, bool(steering))]
    if more:
        then = "In this case " if blocks and not forms else ""
        sums, mean = _mean_square(projection)
        parts = {mean: f"the sliding speed {forced}"} | more if forms else more
        return [
            *blocks,
            keyed("slip.parts", f"{then}`slip` [m/s] consists of {', and of '.join(parts.values())}:"),
            *_root(sums, " + ".join(parts)),
        ]
    # `_projection` has given the slip of a single component already.
    if not forms or (forms in ([XI[0]], [XI[1]]) and projection.twist != XI):
        return blocks
    words = f"`slip` is the sliding speed [m/s] {forced}"
    if len(forms) == 1:
        times = fix(sqrt_poly(Poly.of(projection.weight)), {})
        return [*blocks, f"{words}:", *math(rf"\mathrm{{slip}} = \left|{latex(times * forms[0])}\right|")]
    return [*blocks, f"{words}, the root of the sum of squares:", *_root(*_mean_square(projection))]


def _root(sums: list[str], total: str) -> list[str]:
    """Return slip as the root of a total, below the equations ``sums`` of its parts if these are named."""
    if not sums:
        return math(rf"\mathrm{{slip}} = \sqrt{{{total}}}")
    return aligned(
        [*sums[:_MANY], *[r"&\vdots"] * (len(sums) > _MANY), rf"\mathrm{{slip}} &= \sqrt{{{total}}}"]
    )


def _mean_square(projection: Projection) -> tuple[list[str], str]:
    """Return the square of the part of the twist that the projection removes.

    If it is too wide for a page, its parts are named; the first result has their equations.
    """
    forms, sums = _forms(projection), list[str]()
    counts = squares(forms)
    if width(" + ".join(counts)) > PAGE:
        sums = [rf"s_{{{k}}} &= {latex(p)}" for k, p in enumerate(dict.fromkeys(forms), 1)]
        counts = Counter({rf"s_{{{k}}}^2": n for k, n in enumerate(counts.values(), 1)})
    each = min(counts.values()) if len(set(counts.values())) == 1 else 1
    parts = multiples(counts, each)
    mean = " + ".join([*parts[:_MANY], *[r"\cdots"] * (len(parts) > _MANY)])
    if projection.weight * each == 1:
        return sums, mean
    factor = latex(Poly.of(projection.weight * each))
    return sums, rf"{factor}\left[ {mean} \right]" if len(parts) > 1 else rf"{factor}\,{mean}"


def _admissible(steered: bool, limited: bool) -> str:
    """Write the slip of a robot without a fixed axle. ``limited``: whether limits or couplings restrict angles."""
    if not steered:
        return keyed(
            "slip.every_twist",
            "Every twist is admissible. Hence `slip`, the distance to the nearest admissible twist, is 0.",
        )
    unless = ""
    if limited:
        unless = keyed("slip.unless_limited", ", unless a limit or a coupling keeps a wheel from its angle")
    return keyed(
        "slip.some_angles",
        "At given steering angles not every twist is admissible, but every twist is admissible at some steering "
        "angles, and `inverse` returns these. Hence `slip`, the distance to the nearest admissible twist, is "
        f"0{unless}.",
    )


def _root_of_square(g: Gen) -> Poly | None:
    """Return n x for the root of n² x², because its sign does not matter: √3 l ω in synchro_drive."""
    if g.kind != "sqrt" or len(g.args[0].terms) > 1:
        return None
    ((square, number),) = g.args[0].terms.items()
    root = sqrt_poly(Poly.of(number)).constant
    if root is None or any(e % 2 for _, e in square):
        return None
    return Poly({tuple((h, e // 2) for h, e in square): root})


def _forms(projection: Projection) -> list[Poly]:
    """Return the forms whose squares add up to slip²; no form begins with a minus sign."""
    forms = [p if len(p.terms) > 1 else p.substitute(_root_of_square) for p in projection.residuals if p]
    return [-p if latex(p).startswith("-") else p for p in forms]


# ---- Inverse kinematics in the result.


def closed_inverse(d: Derivation) -> list[str]:
    """Return the joint rates that a twist needs, and the angles of steered wheels."""
    robot = d.in_symbols.robot
    projection = project(robot, d.in_symbols.mobility)
    twist = driven_twist(projection)
    wheels = [w for w in robot.wheels[:CAP] if w.has_spin]
    if not any(w.actuated for w in robot.wheels):
        return ["No joint is driven, so there is nothing to command."]
    not_turning = [w for w in wheels if not w.turns]
    lines = [spin_rate(w, rim) for w, rim in _rims(not_turning, robot, twist)]
    spun = {name for names in turned_apart(robot, twist) for name in names}
    pivots = []
    for group in _turning_groups(wheels):
        tied = any(w.name in spun or not moves_as_partners(robot, w, twist) for w in group)
        pivots += [_words_on_pivots(group, tied), *_formulas_of_pivots(group, twist)]
    shown = "".join([*lines, *pivots])
    stars = [line for line in projected(projection) if line.partition(" &=")[0] in shown]
    blocks = aligned([*stars, *lines]) if stars or lines else []
    if apart := [w.name for w in not_turning if w.name in spun]:
        blocks += [
            keyed(
                "closed.rates_without_couplings",
                f"These are the rates of {listed(apart)} without couplings; section 6 says how couplings change them.",
            )
        ]
    return [*blocks, *pivots, *cut_note(robot.wheels)]


def rim_speed(w: Wheel, twist: Row) -> Poly:
    """Return the speed [m/s] of the rim of a wheel that does not turn about a vertical axis."""
    return dot(driving_row(w, working_view(w)), twist)


def _rims(wheels: list[Wheel], robot: Robot, twist: Row) -> Iterator[tuple[Wheel, Poly]]:
    """Yield each wheel with its rim speed. Wheels with coupled spins get their common least-squares rate."""
    own = {w.name: rim_speed(w, twist) for w in wheels}
    shares = {w.name: robot.per_turn(w, working_view(w)) for w in wheels}
    groups = {w.name: group for group in robot.together("spin", wheels) for w in group}
    for w in wheels:
        names = [v.name for v in groups[w.name]]
        if len({own[n] * shares[n].inverse() for n in names}) == 1:
            yield w, own[w.name]
        else:
            total_share = Poly.sum(shares[n] * shares[n] for n in names)
            weighted = Poly.sum(shares[n] * own[n] for n in names)
            yield w, weighted * total_share.inverse() * shares[w.name]


def _turning_groups(wheels: list[Wheel]) -> list[list[Wheel]]:
    """Return the steered wheels and the driven castors, without empty groups."""
    groups = (
        [w for w in wheels if w.kind.steers],
        [w for w in wheels if w.kind.swivels and w.actuated],
    )
    return [group for group in groups if group]


class _Letters(NamedTuple):
    """How formulas of turning wheels write the heading and lengths."""

    psi: str
    r: str
    d: str
    o: str  # "0" if the contact point is below the pivot or behind it


def _letters(wheels: list[Wheel]) -> _Letters:
    views = [working_view(w) for w in wheels]
    return _Letters(
        r"\left(\psi_0+\psi\right)" if any(w.heading for w in wheels) else r"\psi",
        _common_length([g.r for g in views], "r"),
        _common_length([g.d for g in views], "d"),
        _common_length([g.o for g in views], "o"),
    )


def _components(psi: str) -> tuple[str, str]:
    """Return the velocity of a pivot along the wheel, and to its right."""
    return rf"v_{{Ax}}\cos{psi} + v_{{Ay}}\sin{psi}", rf"v_{{Ax}}\sin{psi} - v_{{Ay}}\cos{psi}"


def _rows_of_pivots(wheels: list[Wheel]) -> list[str]:
    """Write the rows of steered wheels, or of driven castors, in the velocity of the pivot."""
    letters = _letters(wheels)
    rim, across = _components(letters.psi)
    zero = ", with the heading ψ<sub>0</sub> at ψ = 0," if any(w.heading for w in wheels) else ""
    velocity = "the velocity v<sub>A</sub> of its pivot (section 2)"
    if wheels[0].kind.swivels:
        shift = _minus(letters.o, r"\left(\omega + \dot{\psi}\right)")
        return [
            keyed(
                "inverse.castor_rows",
                f"In terms of {velocity}, the sliding and the rolling row of a driven castor are{zero}",
            ),
            *aligned([
                rf"{across} &= {letters.d}\left(\omega + \dot{{\psi}}\right)",
                rf"{rim}{shift} &= {letters.r}\,\dot{{\varphi}}",
            ]),
            "Solved for both rates, they give",
        ]  # fmt: skip
    shift = _minus(letters.o, r"\omega")
    return [
        keyed(
            "inverse.steered_rows",
            f"In terms of {velocity}, the sliding and the rolling row of a steered wheel are{zero}",
        ),
        *aligned([
            rf"{across} &= 0",
            rf"{rim}{shift} &= {letters.r}\,\dot{{\varphi}}",
        ]),
        "The sliding row gives the angle, and the rolling row gives the rate:",
    ]  # fmt: skip


def _minus(length: str, rate: str) -> str:
    """Return - length rate; "" if the length is 0."""
    return rf" - {length}\,{rate}".replace("- -", "+ ") if length != "0" else ""


def _formulas_of_pivots(wheels: list[Wheel], twist: Row) -> list[str]:
    """Write angles and rates of steered wheels, or the rates of driven castors, from the velocities of their pivots."""
    velocities = []
    for w in wheels:
        along, across = (latex(p) for p in pivot(w, twist))
        velocities.append((f"v_{{Ax}} &= {along}, & v_{{Ay}} &= {across}", notation.wheel(w.name)))
    letters = _letters(wheels)
    rim, across = _components(letters.psi)
    if wheels[0].kind.swivels:
        shift = _minus(letters.o, r"\left(\omega + \dot{\psi}\right)")
        first = rf"\dot{{\psi}} &= {_over(across, letters.d)} - \omega"
    else:
        shift = _minus(letters.o, r"\omega")
        first = rf"\tan{letters.psi} &= \frac{{v_{{Ay}}}}{{v_{{Ax}}}}"
    return aligned([
        *(f"{text} && ({', '.join(names)})" for text, names in grouped(velocities).items()),
        rf"{first}, & \dot{{\varphi}} &= {_over(rim + shift, letters.r)}",
    ])  # fmt: skip


def _words_on_pivots(wheels: list[Wheel], tied: bool) -> str:
    """Return the sentence above the formulas of steered wheels or driven castors.

    ``tied``: whether couplings change the angles and rates.
    """
    turned, offset = any(w.heading for w in wheels), _letters(wheels).o != "0"
    castors = wheels[0].kind.swivels
    noun = "driven castor" if castors else "steered wheel"
    who = f"Each {noun}" if len(wheels) > 1 else f"The {noun} {code(wheels[0].name)}"
    alone = "without couplings, " if tied else ""
    zero = ". ψ<sub>0</sub> is its heading at ψ = 0" if turned else ""
    instead = ". Section 6 says how couplings change this" if tied else ""
    velocity = "the velocity (v<sub>Ax</sub>, v<sub>Ay</sub>) of its pivot A"
    key = f"closed.{'castors' if castors else 'steered_wheels'}{'_without_couplings' if tied else ''}"
    if castors:
        return keyed(
            key, f"{who} gets both rates{', ' + alone if tied else ' '}from {velocity}{zero}{instead}:"
        )
    fast = "at the speed of its contact point" if offset else "at this speed"
    points = f"{who} {f'would, {alone}point' if tied else 'points'} along {velocity}"
    return keyed(
        key, f"{points} and {'roll' if tied else 'rolls'} {fast}, forwards or backwards{zero}{instead}:"
    )


def _common_length(lengths: list[Poly], letter: str) -> str:
    """Return a length that all wheels have; the letter of the layout table if they differ, or for a long length."""
    first, *others = lengths
    own = latex(first) if all(p == first for p in others) and len(first.terms) < 2 else letter
    return letter if own.startswith(r"\frac") else own


def _over(above: str, below: str) -> str:
    """Return a fraction with its sign before it."""
    length = below.removeprefix("-")
    return rf"{'-' * (length != below)}\frac{{{above}}}{{{length}}}"


def spin_rate(w: Wheel, rim: Poly) -> str:
    """Return the equation of the spin: rim speed over radius. A radius that is a number stays in the denominator."""
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


def _swivel_rate(w: Wheel, twist: Row) -> str:
    return f"{notation.port(f'{w.name}.steer_rate')} &= {broken(castor_rate(w, working_view(w), twist))}"


def driven_twist(projection: Projection) -> Row:
    """Return the twist that is driven; the components that the projection changes carry a star."""
    return projection.named(lambda name, _: Poly.gen("input", name))


def projected(projection: Projection) -> list[str]:
    """Return the equations of the components that the projection changes."""
    lines = []
    for name, driven, commanded in zip(TWIST_NAMES, projection.twist, XI, strict=True):
        if driven != commanded:
            lines.append(f"{notation.port(name)}^{{*}} &= {broken(with_sines_squared(driven))}")
    return lines
