"""Write section 8: odometry along an arc, the posture model, and its forms."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError
from wmrgen.functions.models.inputs import posture_motion
from wmrgen.functions.models.sheet import LONGEST, tidy
from wmrgen.functions.models.state_space import ignores_sliding
from wmrgen.functions.models.twist import goes_straight, where_it_slides
from wmrgen.functions.system import System
from wmrgen.functions.trailers.trailer import state_ports, turns
from wmrgen.geometry import notation
from wmrgen.geometry.exact.poly import Poly, Row
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.geometry.printing import size, symbol_names
from wmrgen.geometry.symbolic import Expr, signal
from wmrgen.report.sections.latex import (
    PAGE,
    gathered,
    pieces,
    summands,
    terms,
    total,
    width,
    with_tangents,
    wrapped,
)
from wmrgen.report.sections.markdown import aligned, code, keyed, listed, sentence

_SHORT = (
    45  # visible characters of a v_x that is written twice; longer ones (ackermann_car, jpl_osr) get a line
)
_CONDITION = 200  # operations and symbols of a singularity that is written out; longer ones are named only

_INPUTS = {
    "posture": "the rates of driven joints",
    "twist": "components of the twist",
    "eta": "the coordinates η",
}


def motion(d: Derivation) -> list[str]:
    """Return section 8."""
    return [
        "## 8 Odometry and the posture model",
        "A constant twist moves P along an arc (`odometry`). Its velocity in the world, v turned by θ + ω τ, is "
        "integrated over 0 ≤ τ ≤ Δt with sin(θ + 2σ) − sin θ = 2 sin σ cos(θ + σ). Near σ = 0 the code uses a series "
        "([numerics.md](numerics.md)). The exact pose after Δt is, with θ' wrapped to one turn,",
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
        return ["The robot cannot move without sliding, so the posture model is empty: all rates are 0."]
    etas = [Poly.gen("input", f"eta{k}") for k in range(1, len(columns) + 1)]
    rates = []
    for i in range(3):
        rates.append(Poly.sum(c[i] * eta for c, eta in zip(columns, etas, strict=True)))
    steering = bool(d.mobility.basis_wheels)
    rates_of = "dψ<sub>i</sub>/dt = ψ̇<sub>i</sub>"
    turned = d.mobility.skids or any(w.kind.steers for w in d.robot.wheels)  # the robot turns if wheels slide
    straight = (
        d.mobility.degenerate and goes_straight(d.mobility) and turned and d.robot.effective_track is None
    )
    general = [
        "The continuous model "
        + (
            keyed("motion.ideal_rolling", "of ideal rolling")
            if straight
            else keyed("motion.for_control", "that a predictive controller integrates")
        )
        + " (`dynamics`) is d(x, y, θ)/dt = R(θ)ᵀ N η"
        + (f" and {rates_of}" if steering else "")
        + ". Its inputs are the coordinates η of the twist in the null space"
        + (" and the steering rates." if steering else ".")
        + keyed(
            "motion.cannot_turn",
            " In this model no wheel slides, so the robot cannot turn: a controller integrates `twist`, below.",
        )
        * straight
    ]
    in_eta = [
        keyed(
            "motion.twist_of_eta",
            "The columns of N are scaled as in `dynamics`. Each η is a speed [m/s], or a yaw rate [rad/s] if the yaw "
            "rate of its column does not depend on angles. The twist is",
        ),
        *aligned(
            f"{notation.port(n)} &= {wrapped(summands(gathered(terms(p))))}"
            for n, p in zip(TWIST_NAMES, rates, strict=True)
        ),
    ]
    if rates == etas:
        in_eta = [keyed("motion.eta_is_twist", "Since N = I, η is the twist itself, η = ξ.")]
    driven = [*_towing(d), *_in_driven_speeds(d)]
    return [*general, *(driven or [*in_eta, *_angles(d.robot, d.mobility.basis_wheels)])]


def _towing(d: Derivation) -> list[str]:
    """Derive the yaw rates of trailers from the sliding row of their axle (Tzafestas (2.70))."""
    robot = d.robot
    if not robot.trailers:
        return []
    hitched = any(t.hitch.nominal for t in robot.trailers)
    blocks = [
        keyed(
            "motion.trailers",
            "**Trailers.** The coupling of a trailer moves at V, and the trailer turns at θ̇<sub>i</sub>. Its axle, "
            "L<sub>i</sub> behind the coupling, moves at V − L<sub>i</sub> θ̇<sub>i</sub> n<sub>i</sub>, with "
            "t<sub>i</sub> = (cos θ<sub>i</sub>, sin θ<sub>i</sub>) and n<sub>i</sub> = ẑ × t<sub>i</sub>. The axle "
            "does not slide along n<sub>i</sub>, and follows along t<sub>i</sub> at v<sub>i</sub>:",
        ),
        *aligned([
            r"n_i\cdot\left(V - L_i\,\dot{\theta}_i\,n_i\right) &= 0, \qquad "
            r"\dot{\theta}_i = \frac{n_i\cdot V}{L_i}, \qquad v_i = t_i\cdot V",
        ]),
    ]  # fmt: skip
    turn, pull = r"v_{i-1}\sin(\theta_{i-1}-\theta_i)", r"v_{i-1}\cos(\theta_{i-1}-\theta_i)"
    ahead = "v<sub>i−1</sub> t<sub>i−1</sub>"
    if hitched:
        turn += r" - b_i\,\dot{\theta}_{i-1}\cos(\theta_{i-1}-\theta_i)"
        pull += r" + b_i\,\dot{\theta}_{i-1}\sin(\theta_{i-1}-\theta_i)"
        ahead += (
            " − b<sub>i</sub> θ̇<sub>i−1</sub> n<sub>i−1</sub>, because it is b<sub>i</sub> behind that axle"
        )
    if any(w.kind.fixed_axle for w in d.driven.robot.wheels):
        blocks += [
            f"The vehicle in front moves the coupling at V = {ahead}. Vehicle 0 is the robot, with the speed and "
            "heading of its fixed axle:",
            *aligned([rf"\dot{{\theta}}_i &= \frac{{{turn}}}{{L_i}}, & v_i &= {pull}"]),
        ]
    from wmrgen.functions.trailers.flat import flatness
    from wmrgen.functions.trailers.train import (
        train,  # these load parts of sympy that robots without trailers need not
    )

    facts = []
    with suppress(NotDerivableError):
        facts.append(
            f"The position of {flatness(robot, d.mobility).outputs.removeprefix('x, y of ')} is a flat output."
        )
    with suppress(NotDerivableError):
        length = train(robot, d.mobility).size
        facts.append(f"The chained form is a (2,{length}) chain (`wmrgen model --form chained`).")
    return [*blocks, *([keyed("motion.chained", " ".join(facts))] if facts else [])]


def _angles(robot: Robot, names: Sequence[str]) -> list[str]:
    """Say which steering angles, of wheels or of virtual wheels, are part of the state, and which follow."""
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
    follows = f" The {rest} from `inverse`." if others else ""
    return [keyed("motion.steering_state", f"The steering {angles} part of the state.{follows}")]


def _virtual(robot: Robot, names: Sequence[str]) -> str:
    """Return the words before names of virtual wheels; "" for the names of other wheels."""
    virtual = {v.name for v in robot.virtual}
    return f"the virtual wheel{'s' * (len(names) > 1)} " if virtual.issuperset(names) else ""


def _in_driven_speeds(d: Derivation) -> list[str]:
    """Write the posture model, with trailers, in the speeds of driven wheels: Tzafestas (2.36), (2.46), (2.53).

    The result is [] if these speeds do not determine all rates, and if the model depends on more than one angle or is
    long.
    """
    try:
        motion = posture_motion(d.robot, d.mobility, symbolic=True)
    except NotDerivableError:
        return []
    if motion.swivels or len(motion.frame.wheels) > 1:
        return []
    inputs = [Poly.gen("input", p.name) for p in motion.inputs]
    rates = []
    for i in range(3):
        rates.append(Poly.sum(twist[i] * u for twist, u in zip(motion.twists, inputs, strict=True)))
    vx, vy, omega = rates
    towed = turns(motion, d.mobility, bool(vy)) if d.robot.trailers else ()
    if any(size(turn) > LONGEST for turn in towed):
        return []
    lines = [*_rates((vx, vy, omega), bool(towed)), *_trailers(d.robot, towed)]
    if max(map(width, lines)) > PAGE:
        return []
    named = ("speed", "spin") if motion.followers else ("speed",)
    split = [p.name.rpartition(".") for p in motion.inputs]
    drives = [owner for owner, _, joint in split if joint in named]
    speeds = "speeds of driven wheels"
    if drives:
        speeds = f"speed{'s' * (len(drives) > 1)} of {_virtual(d.robot, drives)}{listed(drives)}"
    agree = ""
    if motion.followers:
        agree = keyed("motion.followers", f", with which {listed(motion.followers)} must agree,")
    return [
        keyed("motion.in_wheel_speeds", f"In the {speeds}{agree} the model is (`wmrgen model`)"),
        *aligned(lines),
        *_angles(d.robot, [w.name for w in motion.frame.wheels]),
    ]


def _rates(twist: Row, towing: bool) -> list[str]:
    """Return the rates of the pose. v_x and v_y get their own lines if both move P, or if trailers follow."""
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
    """Return the yaw rates of trailers from the twist of P (Tzafestas (2.70)).

    sympy sorts the names in sin(a - b) by the alphabet. The headings are renamed so that a trailer comes after the
    vehicle that pulls it.
    """
    headings = {signal(p.name): f"~{k:02}" for k, p in enumerate(state_ports(robot.trailers))}
    last = {theta: signal(name) for theta, name in headings.items()}
    towed = [turn.xreplace(last) for turn in towed]
    ports = {name: p.name for name, p in zip(headings.values(), state_ports(robot.trailers), strict=True)}
    lines = []
    for trailer, turn in zip(robot.trailers, towed, strict=True):
        rate = total(terms(tidy(turn), ports))
        lines.append(rf"\dot{{\theta}}_{{{notation.wheel(trailer.name)}}} &= {rate}")
    return lines


def regular(d: Derivation) -> list[str]:
    """Describe the forms of the model: their inputs, which one is the state space, and where each holds."""
    space = d.default_state_space
    if space is None:
        return []
    systems = dict(d.forms)
    trailers = systems.pop("trailer", None)
    sliding = [form for form in systems if ignores_sliding(form, d.driven.mobility)]
    always = [form for form, system in systems.items() if form not in sliding and not system.domain]
    files = f"{code(f'{d.robot.name}_ode.casadi')}, {code('ode')} in {code(f'{d.robot.name}.py')}"
    eta = systems.get("eta")
    same = [form for form, s in systems.items() if eta and form != "eta" and s.inputs == eta.inputs]
    words = {form: f"{_INPUTS[form]} ({code(form)})" for form in systems if form not in same}
    if same:
        words["eta"] = keyed(
            "model.eta_for_few_drives",
            f"{_INPUTS['eta']} ({listed(['eta', *same])}; too few joints are driven to use their rates)",
        )
    intro = [
        keyed(
            "model.forms",
            f"`wmrgen model` prints the model q̇ = G(q) u. Its inputs u are {notation.listed([*words.values()], 'or')}.",
        ),
        keyed("model.state_space", f"{code(space.form)} is the state space ({files})."),
    ]
    if always:
        intro.append(
            keyed("model.always_holds", f"{listed(always)} hold{'s' * (len(always) == 1)} in every motion.")
        )
    if sliding:
        does = "does" if len(sliding) == 1 else "do"
        where = where_it_slides(d.driven.mobility)
        intro.append(keyed("model.while_sliding", f"{listed(sliding)} {does} not hold where {where}."))
    if trailers:
        intro.append(f"{code('trailer')} includes the trailers (section 9 says where it is singular).")
    commands = [p.name for p in space.inputs if p.name.endswith(".steer_command")]
    if commands:
        intro.append(keyed("model.lag", f"Steering angles follow {listed(commands)} at first order (`lag`)."))
    if space.at_once:
        intro.append(
            keyed("model.no_lag", f"{code(space.form)} leaves out the lag of {listed(space.at_once)}.")
        )
    if space.limits:
        intro.append(_limits_of_others(d.robot, space.form, [p.name for p in space.limits]))
    if space.limited.absent:
        intro.append(
            keyed(
                "model.limits_without_variable",
                f"{code(space.form)} has no variable for the limits of {listed(space.limited.absent)}.",
            )
        )
    shared = sum(s.kind == "shared_axle" for s in d.mobility.singularities)
    return [
        " ".join(intro),
        *(block for form, system in systems.items() for block in _exceptions(form, system, shared)),
    ]


def _limits_of_others(robot: Robot, form: str, names: Sequence[str]) -> str:
    """Say how the state space has limits of quantities that are neither its states nor its inputs."""
    one = len(names) == 1
    files = f"{code(f'{robot.name}_limits.casadi')} and {code('limits')} in {code(f'{robot.name}.py')}"
    kind = "is neither a state nor an input" if one else "are neither states nor inputs"
    return keyed(
        "model.limits_of_others",
        f"The robot file also limits {listed(names)}, which {kind} of {code(form)}. {files} express "
        f"{'it' if one else 'them'} in states and inputs; {code('model.json')} has the bounds.",
    )


def jackknives(d: Derivation) -> list[str]:
    """Say where the form with trailers is singular and the other forms are not."""
    if "trailer" not in d.forms:
        return []
    of_the_body = {domain.text for domain in d.forms["posture"].domain}
    system = d.forms["trailer"]
    own = tuple(domain for domain in system.domain if domain.text not in of_the_body)
    return _exceptions("trailer", system._replace(domain=own), 0)


def _exceptions(form: str, system: System, shared: int) -> list[str]:
    """Say where a form does not hold, and why.

    Args:
        form: the name of the form.
        system: the form.
        shared: number of conditions, from the first, that section 9 has for the form eta.

    Returns:
        The blocks of Markdown.
    """
    names = symbol_names((*system.state, *system.inputs, *system.geometry))
    blocks, reasons, equations = [], [], []
    for k, domain in enumerate(system.domain):
        why = sentence(domain.text.replace(": ", ", because ", 1))
        if form == "eta" and k < shared:
            blocks += [
                keyed(
                    "model.singular_elsewhere",
                    f"{code(form)} does not hold where {why}. Section 9 has the condition.",
                )
            ]
        elif size(domain.expression) > _CONDITION:
            blocks += [f"{code(form)} does not hold where a long expression is 0: {why}."]
        else:
            parts = summands(gathered(terms(tidy(domain.expression), names)))
            reasons.append(why)
            equations.append(f"0 &= {wrapped(parts)}")
    if equations:
        each = " (one equation each)" if len(equations) > 1 else ""
        blocks += [
            keyed("model.singular", f"{code(form)} does not hold where {'; or where '.join(reasons)}{each}:"),
            *aligned(equations),
        ]
    return blocks
