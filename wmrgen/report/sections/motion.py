"""Section 8: odometry along an arc, the posture model, and its forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError
from wmrgen.functions.models.inputs import posture_motion
from wmrgen.functions.models.sheet import LONGEST, tidy
from wmrgen.functions.models.state_space import rolls_alone
from wmrgen.functions.models.twist import goes_straight, where_it_slides
from wmrgen.functions.system import System
from wmrgen.functions.trailers.trailer import state_ports, turns
from wmrgen.geometry import notation
from wmrgen.geometry.exact.number import ONE
from wmrgen.geometry.exact.poly import Poly, Row
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.geometry.printing import size, symbol_names
from wmrgen.geometry.symbolic import Expr, signal
from wmrgen.report.sections.latex import (
    gathered,
    latex,
    pieces,
    summands,
    terms,
    total,
    width,
    with_tangents,
    wrapped,
)
from wmrgen.report.sections.markdown import aligned, code, listed, sentence

_WIDEST = 90  # glyphs of a line of the model in wheel speeds
_SHORT = 45  # glyphs of v_x that is written twice

_INPUTS = {
    "posture": "the rates of driven joints",
    "twist": "components of the twist",
    "eta": "the coordinates η",
}
_CONDITION = 200  # operations and symbols of an expression that vanishes


def motion(d: Derivation) -> list[str]:
    """Section 8."""
    return [
        "## 8 Odometry and the posture model",
        "A constant twist moves P along an arc (`odometry`). Its chord has the direction in which P moves half-way "
        "through, and is shorter than the arc by the factor sinc σ, for which near σ = 0 the code has a series "
        "([numerics.md](numerics.md)). The pose after Δt is exactly, θ' less whole turns,",
        *aligned([
            r"x' &= x + \Delta t\,\mathrm{sinc}(\sigma)\left(v_x\cos(\theta+\sigma) - v_y\sin(\theta+\sigma)\right)",
            r"y' &= y + \Delta t\,\mathrm{sinc}(\sigma)\left(v_x\sin(\theta+\sigma) + v_y\cos(\theta+\sigma)\right)",
            r"\theta' &= \theta + \omega\,\Delta t, \qquad "
            r"\mathrm{sinc}(\sigma) = \frac{\sin\sigma}{\sigma}, \qquad \sigma = \frac{\omega\,\Delta t}{2}",
        ]),
        *_posture(d),
    ]  # fmt: skip


def _posture(d: Derivation) -> list[str]:
    columns = d.mobility.scaled_symbolic
    if not columns:
        return ["Nothing can move without sliding, so the posture model is empty: all rates are 0."]
    etas = [Poly.gen("input", f"eta{k}") for k in range(1, len(columns) + 1)]
    rates = [Poly.sum(c[i] * eta for c, eta in zip(columns, etas, strict=True)) for i in range(3)]
    steering = bool(d.mobility.basis_wheels)
    rates_of = "dψ<sub>i</sub>/dt = ψ̇<sub>i</sub>"
    turned = d.mobility.skids or any(w.kind.steers for w in d.robot.wheels)  # by sliding wheels
    straight = (
        d.mobility.degenerate and goes_straight(d.mobility) and turned and d.robot.effective_track is None
    )
    general = [
        "The continuous model "
        + ("of ideal rolling" if straight else "that a predictive controller integrates")
        + " (`dynamics`) is d(x, y, θ)/dt = R(θ)ᵀ N η"
        + (f" and {rates_of}" if steering else "")
        + ". Its inputs are the coordinates η of the twist in the null space"
        + (" and the steering rates." if steering else ".")
        + " In this model no wheel slides, so the robot cannot turn: a controller integrates `twist`, below."
        * straight
    ]
    in_eta = [
        "With the columns scaled as in `dynamics` each η is a speed, [m/s], or, where its column turns at a rate that "
        "no angle changes, a yaw rate, [rad/s]. The twist is",
        *aligned(
            f"{notation.port(n)} &= {wrapped(summands(gathered(terms(p))))}"
            for n, p in zip(TWIST_NAMES, rates, strict=True)
        ),
    ]
    if rates == etas:
        in_eta = ["As N = I, these are the twist itself, η = ξ."]
    driven = _in_driven_speeds(d)
    return [*general, *(driven or [*in_eta, *_angles(d.robot, d.mobility.basis_wheels)])]


def _angles(robot: Robot, names: Sequence[str]) -> list[str]:
    """Which steering angles are part of the state, of wheels or of virtual wheels, and what the others do."""
    if not names:
        return []
    virtual = _virtual(robot, names)
    others = sum(w.kind.steers for w in robot.wheels) - (0 if virtual else len(names))
    rest = f"{'' if virtual else 'other '}steered wheel{'s follow' if others > 1 else ' follows'}"
    angles = (
        f"angle of {virtual}{code(names[0])} is"
        if len(names) == 1
        else f"angles of {virtual}{listed(names)} are"
    )
    return [
        f"where the steering {angles} part of the state"
        + (f"; the {rest} through `inverse`." if others else ".")
    ]


def _virtual(robot: Robot, names: Sequence[str]) -> str:
    """What stands before the names of virtual wheels."""
    virtual = {v.name for v in robot.virtual}
    return f"the virtual wheel{'s' * (len(names) > 1)} " if virtual.issuperset(names) else ""


def _in_driven_speeds(d: Derivation) -> list[str]:
    """The posture model, with trailers, in the speeds of driven wheels: Tzafestas (2.36), (2.46), (2.53).

    Nothing where they do not drive all of it, where it depends on more than one angle, and where it is long.
    """
    try:
        motion = posture_motion(d.robot, d.mobility, symbolic=True)
    except NotDerivableError:
        return []
    if motion.swivels or len(motion.frame.wheels) > 1:
        return []
    inputs = [Poly.gen("input", p.name) for p in motion.inputs]
    vx, vy, omega = (
        Poly.sum(twist[i] * u for twist, u in zip(motion.twists, inputs, strict=True)) for i in range(3)
    )
    towed = turns(motion, d.mobility, bool(vy)) if d.robot.trailers else ()
    if any(size(turn) > LONGEST for turn in towed):
        return []
    lines = [*_rates((vx, vy, omega), bool(towed)), *_trailers(d.robot, towed)]
    if max(map(width, lines)) > _WIDEST:
        return []
    told = ("speed", "spin") if motion.followers else ("speed",)
    drives = [owner for owner, _, joint in (p.name.rpartition(".") for p in motion.inputs) if joint in told]
    speeds = "speeds of driven wheels"
    if drives:
        speeds = f"speed{'s' * (len(drives) > 1)} of {_virtual(d.robot, drives)}{listed(drives)}"
    agree = f", with which {listed(motion.followers)} must agree," if motion.followers else ""
    return [
        f"In the {speeds}{agree} it is (`wmrgen model`)",
        *aligned(lines),
        *_angles(d.robot, [w.name for w in motion.frame.wheels]),
    ]


def _rates(twist: Row, towing: bool) -> list[str]:
    """The rates of the pose; v_x and v_y by themselves where both move P or trailers follow them."""
    vx, vy, omega = (with_tangents(terms(p)) for p in twist)
    turn = (r"\dot{\theta} &= \omega = " if towing else r"\dot{\theta} &= ") + total(omega)
    ahead = total(vx) if len(pieces(vx)) == 1 else rf"\left({total(vx)}\right)"
    if vy and not vx:
        parts = [rf"v_y &= {total(vy)}", r"\dot{x} &= -v_y\sin\theta", r"\dot{y} &= v_y\cos\theta"]
        return [*parts, turn]
    if vy:
        parts = [f"{notation.port(n)} &= {total(p)}" for n, p in (("vx", vx), ("vy", vy))]
        turned = r"v_x\cos\theta - v_y\sin\theta", r"v_x\sin\theta + v_y\cos\theta"
        return [*parts, rf"\dot{{x}} &= {turned[0]}", rf"\dot{{y}} &= {turned[1]}", turn]
    if not vx and not towing:
        return [r"\dot{x} &= 0", r"\dot{y} &= 0", turn]
    named = towing or width(ahead) > _SHORT
    parts = [f"v_x &= {total(vx)}"] if named else []
    speed = "v_x" if named else ahead
    return [*parts, rf"\dot{{x}} &= {speed}\cos\theta", rf"\dot{{y}} &= {speed}\sin\theta", turn]


def _trailers(robot: Robot, towed: Sequence[Expr]) -> list[str]:
    """The yaw rates of trailers from the twist of P (Tzafestas (2.70)).

    sympy writes sin(a - b) with the name first that comes first by the alphabet: the trailers', last, in their order.
    """
    headings = {signal(p.name): f"~{k:02}" for k, p in enumerate(state_ports(robot.trailers))}
    last = {theta: signal(name) for theta, name in headings.items()}
    towed = [turn.xreplace(last) for turn in towed]
    ports = {name: p.name for name, p in zip(headings.values(), state_ports(robot.trailers), strict=True)}
    lines = []
    for trailer, turn in zip(robot.trailers, towed, strict=True):
        length = trailer.length.symbolic.constant or ONE  # a name is a divisor already
        pulled = total([replace(t, number=t.number * length) for t in terms(tidy(turn), ports)])
        over = pulled if length == ONE else rf"\frac{{{pulled}}}{{{latex(Poly.of(length))}}}"
        lines.append(rf"\dot{{\theta}}_{{{notation.wheel(trailer.name)}}} &= {over}")
    return lines


def regular(d: Derivation) -> list[str]:
    """The forms of the model, which one is the state space, and which holds where."""
    space = d.default_state_space
    if space is None:
        return []
    systems = dict(d.forms)
    trailers = systems.pop("trailer", None)
    sliding = [form for form in systems if rolls_alone(form, d.driven.mobility)]
    always = [form for form, system in systems.items() if form not in sliding and not system.domain]
    files = f"{code(f'{d.robot.name}_ode.casadi')}, {code('ode')} in {code(f'{d.robot.name}.py')}"
    eta = systems.get("eta")
    same = [form for form, s in systems.items() if eta and form != "eta" and s.inputs == eta.inputs]
    words = {form: f"{_INPUTS[form]} ({code(form)})" for form in systems if form not in same}
    if same:
        words["eta"] = (
            f"{_INPUTS['eta']} ({listed(['eta', *same])}: too few joints are driven for their rates to do)"
        )
    intro = (
        "`wmrgen model` prints the model q̇ = G(q) u, whose inputs u are "
        f"{notation.listed([*words.values()], 'or')}. {code(space.form)} is the state space ({files})."
    )
    if always:
        intro += f" {listed(always)} hold{'s' * (len(always) == 1)} in every motion."
    if sliding:
        does = "does" if len(sliding) == 1 else "do"
        intro += f" {listed(sliding)} {does} not hold where {where_it_slides(d.driven.mobility)}."
    if trailers:
        intro += f" {code('trailer')} has trailers, too (section 9: where it is singular)."
    commands = [p.name for p in space.inputs if p.name.endswith(".steer_command")]
    if commands:
        intro += f" Steering angles follow {listed(commands)} at first order (`lag`)."
    if space.at_once:
        intro += f" {code(space.form)} leaves out the lag of {listed(space.at_once)}."
    if space.limits:
        limits = (
            f"{code(f'{d.robot.name}_limits.casadi')} and {code('limits')} in {code(f'{d.robot.name}.py')}"
        )
        one = len(space.limits) == 1
        intro += (
            f" The robot file limits {listed([p.name for p in space.limits])}, too, which "
            f"{'is neither a state nor an input' if one else 'are neither states nor inputs'} of {code(space.form)}: "
            f"{limits} give {'it' if one else 'them'} in states and inputs, and {code('model.json')} has the bounds."
        )
    if space.limited.absent:
        intro += f" For the limits of {listed(space.limited.absent)} {code(space.form)} has no variable."
    shared = sum(s.kind == "shared_axle" for s in d.mobility.singularities)
    return [
        intro,
        *(block for form, system in systems.items() for block in _exceptions(form, system, shared)),
    ]


def jackknives(d: Derivation) -> list[str]:
    """Where the form with trailers is singular and the others are not."""
    if "trailer" not in d.forms:
        return []
    of_the_body = {domain.text for domain in d.forms["posture"].domain}
    system = d.forms["trailer"]
    own = tuple(domain for domain in system.domain if domain.text not in of_the_body)
    return _exceptions("trailer", system._replace(domain=own), 0)


def _exceptions(form: str, system: System, shared: int) -> list[str]:
    """Where a form does not hold, and why; of eta the first ``shared`` conditions stand elsewhere."""
    names = symbol_names((*system.state, *system.inputs, *system.geometry))
    blocks, reasons, equations = [], [], []
    for k, domain in enumerate(system.domain):
        why = sentence(domain.text.replace(": ", ", because ", 1))
        if form == "eta" and k < shared:
            blocks += [f"{code(form)} does not hold where {why}. Section 9 has the condition."]
        elif size(domain.expression) > _CONDITION:
            blocks += [f"{code(form)} does not hold where a long expression vanishes: {why}."]
        else:
            parts = summands(gathered(terms(tidy(domain.expression), names)))
            reasons.append(why)
            equations.append(f"0 &= {wrapped(parts)}")
    if equations:
        each = " (one equation each)" if len(equations) > 1 else ""
        blocks += [
            f"{code(form)} does not hold where {'; or where '.join(reasons)}{each}:",
            *aligned(equations),
        ]
    return blocks
