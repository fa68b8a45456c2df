"""Inverse and forward kinematics in closed form, as the result has them: the rates of wheels, and where steered wheels
point; the twist of measured rates."""

from __future__ import annotations

from collections.abc import Iterator

from wmrgen.analysis.kinematics.least_squares import Projection, project
from wmrgen.analysis.kinematics.pivots import pivot
from wmrgen.analysis.kinematics.sensing import generic_rank
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import XI, castor_rate, driving_row, working_view
from wmrgen.geometry.exact.evaluate import parameters_in
from wmrgen.geometry.exact.number import ONE as UNIT
from wmrgen.geometry.exact.poly import Poly, Row, dot
from wmrgen.geometry.exact.readable import with_sines_squared
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.geometry.symbolic import Local
from wmrgen.report.sections.angles import with_tangents
from wmrgen.report.sections.forward import distinct, fits_of
from wmrgen.report.sections.latex import alike, broken, latex, summands, terms, total
from wmrgen.report.sections.letters import by_three, heads, in_letters
from wmrgen.report.sections.markdown import CAP, aligned, code, cut_note, grouped, listed, math
from wmrgen.report.sections.terms import WIDE, width, wrapped

ONE, ZERO = Poly.of(1), Poly({})
_TERMS = 24  # summands of a printed formula
_NEAREST = (
    r"\omega = \frac{\sum_i (B_i-\bar{B})\times(w_i-\bar{w})}{\sum_i |B_i-\bar{B}|^2}, \qquad "
    r"v = \bar{w} - \omega\,\hat{z}\times\bar{B}"
)
_BY_WEIGHT = "There wheels count by their weights: means, sums, HᵀH and Hᵀz are weighted, as in section 7."


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


def closed_forward(d: Derivation) -> list[str]:
    """The twist of measured rates: written out where the matrix is constant, else the rule that gives it."""
    measured = d.measured
    if not measured.rows:
        return ["No joint is sensed, so nothing is known of the twist: `forward` returns 0."]
    if measured.constant_normal:
        if letters := in_letters(d):
            return letters
        numbers = _closed(d)
        return [*_rule(d, numbers), *numbers]
    by = [_BY_WEIGHT] if measured.weighted else []
    if measured.rigid:
        return [*_rigid_motion(len(measured.contacts)), *(by if len(measured.contacts) > 1 else [])]
    best = "The twist that explains all measurements best, with H and z of section 7:"
    if generic_rank(measured) < 3:
        return [best, *math(r"\xi = (H^T H)^{+} H^T z"), *by]
    three = by_three(d, measured.rows, d.measured_at_nominal)
    if not three:
        return [best, *math(r"\xi = (H^T H)^{-1} H^T z"), *by]
    if len(measured.rows) == 3:
        return three
    return [
        "The twist that explains all measurements best is ξ = (HᵀH)⁻¹ Hᵀz, with H and z of section 7. Where they agree "
        "(`slip` is 0), that is",
        *three,
        *by,
    ]


def _rigid_motion(contacts: int) -> list[str]:
    """Through the velocities of measured contact points."""
    if contacts == 1:
        return [
            "The smallest twist (v, ω) that explains the velocity w of the contact point B (section 7 has both):",
            *math(r"\omega = \frac{B \times w}{1 + |B|^2}, \qquad v = w - \omega\,\hat{z}\times B"),
        ]
    return [
        "The rigid motion (v, ω) nearest to the velocities w that the wheels measure at their contact points B; a bar "
        "is a mean over the wheels, and section 7 has B and w:",
        *math(_NEAREST),
    ]


def _rule(d: Derivation, numbers: list[str]) -> list[str]:
    """What ``numbers`` come from, where they stand for named lengths and angles: of wheels that give both rows, a rigid
    motion; of others, the rows of section 7."""
    measured = d.measured
    named = {name for row, value, _ in measured.rows for p in (*row, value) for name in parameters_in(p)}
    if not (d.determined and named):
        return []
    if not measured.rigid or measured.weighted:
        square = len(distinct(measured)) == 3
        below = "; below it the same with the numbers of this robot" if numbers else ""
        return [
            f"The twist that explains all measurements best, with H and z of section 7{below}:",
            *math(r"\xi = H^{-1} z" if square else r"\xi = (H^T H)^{-1} H^T z"),
        ]
    below = "; below it the same with the lengths of this robot" if numbers else ""
    return [
        "The rigid motion (v, ω) nearest to the velocities w = r φ̇ e that the wheels measure at their contact points "
        f"B, e being the direction in which a wheel rolls and a bar a mean over the wheels{below}:",
        *math(_NEAREST),
    ]


def _in_numbers(d: Derivation) -> list[str]:
    """The twist of measured wheel speeds at the values of the robot file; nothing where it depends on angles too."""
    rates = [p for p in d.formula("forward").inputs if p.default is None]
    if any(not p.name.endswith(".spin") for p in rates):
        return []
    shown, rest = rates[:_TERMS], [r"+\cdots"] * (len(rates) > _TERMS)
    digits = 60  # far more than a report shows
    twists = [d.evaluate("forward", {p.name: UNIT}, digits) for p in shown]
    spins = [Poly.gen("input", p.name) for p in shown]
    lines = []
    for name in TWIST_NAMES:
        value = Poly.sum(spin.scale(twist[name]) for spin, twist in zip(spins, twists, strict=True))
        lines.append(f"{notation.port(name)} &= {wrapped([*summands(terms(value)), *rest])}")
    return aligned(lines)


def _closed(d: Derivation) -> list[str]:
    """The twist as the code computes it; where it does so step by step, with its numbers."""
    fits, ports = fits_of(d, *TWIST_NAMES)
    if any(fit.has(Local) for fit in fits):
        return _in_numbers(d)
    lines, sums = [], []
    for name, fit in zip(TWIST_NAMES, fits, strict=True):
        sums.append((name, terms(fit, ports)))
        parts = summands(sums[-1][1])
        shown = [*parts[:_TERMS], r"+\cdots"] if len(parts) > _TERMS else parts
        lines.append(f"{notation.port(name)} &= {wrapped(shown)}")
    return [*aligned(lines), *heads(d, sums)]
