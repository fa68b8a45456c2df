"""The chained form against the robot's own model: exact derivatives at rational points.

The rates of the state come from the posture model and the trailers, which know nothing of chains; those of z by
differentiating the formula `chained` along them. Equality is decided in exact arithmetic, not to a tolerance.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from wmrgen.errors import NotDerivableError
from wmrgen.exact.evaluate import circle
from wmrgen.exact.number import ZERO, Exact
from wmrgen.functions.models.posture import eta_motion, posture_field, posture_state
from wmrgen.functions.models.rational_points import Dual, Evaluator, Place
from wmrgen.functions.system import System
from wmrgen.functions.trailers.chained import chained, chained_input, chained_rates
from wmrgen.functions.trailers.trailer import body_of, convoy, state_ports
from wmrgen.functions.trailers.train import Train, train
from wmrgen.kinematics.records import Formula, tunable_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.symbolic import Expr, expression, parameter, signal

POINTS = 3


@dataclass(frozen=True, slots=True)
class Verification:
    """Differences at each point, all of which are exactly 0 when the formulas are right."""

    points: int
    residuals: tuple[Exact, ...]

    @property
    def holds(self) -> bool:
        """True where every identity holds exactly."""
        return not any(self.residuals)

    @property
    def text(self) -> str:
        """What was checked, and the outcome."""
        verdict = "hold exactly" if self.holds else "FAIL"
        return (
            f"z1' = u1, z2' = u2, z(k+1)' = zk u1 and the way back through chained_input {verdict} at {self.points} "
            "rational points (exact arithmetic, rates from the posture model and the trailers)"
        )


def train_system(robot: Robot, mobility: Mobility) -> System:
    """Posture and trailers in null-space coordinates: the model that needs no actuation."""
    motion = eta_motion(robot, mobility, virtual=True)
    body = body_of(robot, mobility, motion.frame.view)
    fields = []
    for port, twist in zip(motion.inputs, motion.twists, strict=True):
        row = [expression(p) for p in twist]
        axles = convoy(motion, body, row, None) if robot.trailers else []
        fields.append((*posture_field(motion, port, twist), *(a.turn for a in axles)))
    state = (*posture_state(motion), *state_ports(robot.trailers))
    return System("train", motion.text, state, motion.inputs, tuple(fields), motion.geometry)


def verify(robot: Robot, mobility: Mobility, points: int = POINTS) -> Verification:
    """The chain's identities at rational points. NotDerivableError where the robot has no chained form."""
    t = train(robot, mobility)
    system = train_system(robot, mobility)
    functions = tuple(build(robot, mobility) for build in (chained, chained_rates, chained_input))
    try:
        found = [r for k in range(points) for r in _residuals(t, system, functions, k)]
    except ValueError as error:
        raise NotDerivableError(f"{robot.name}: not verifiable exactly: {error}") from error
    return Verification(points, tuple(found))


def place(t: Train, system: System, seed: int, inputs: Mapping[str, Exact]) -> Place:
    """A generic point of the state space, moving as the inputs of ``system`` say."""
    numbers: dict[Expr, Exact] = {
        signal("x"): Exact(Fraction(3, 5)),
        signal("y"): Exact(Fraction(-9, 10 + seed)),
    }
    # z1 = theta where a heading stands alone: the identities are polynomials in it beside its cosine and sine.
    numbers[signal("theta")] = Exact(Fraction(2, 7))
    numbers |= {parameter(p.name): p.default for p in tunable_ports(t.robot) if p.default is not None}
    angles = {
        signal(p.name): circle(Fraction((-1) ** k * (k % 3 + 1), 11 + 2 * k + 3 * seed))
        for k, p in enumerate(t.state[2:])
    }
    still = Evaluator(Place(angles, numbers, {}))
    rates = {}
    for i, port in enumerate(system.state):
        terms = [
            still(field[i]) * Dual(inputs[u.name])
            for field, u in zip(system.fields, system.inputs, strict=True)
        ]
        rates[signal(port.name)] = sum((d.value for d in terms), ZERO)
    return Place(angles, numbers, rates)


def _residuals(t: Train, system: System, functions: tuple[Formula, ...], seed: int) -> list[Exact]:
    inputs = {u.name: Exact(Fraction(2 * k + 3 + seed, 5 - 3 * k)) for k, u in enumerate(system.inputs)}
    here = place(t, system, seed, inputs)
    own = {"v": _speed(t, here), t.turning.name: _turning(t, here)}
    z = _values(functions[0], here, {})
    rates = [d.rate for d in z]
    said = [d.value for d in _values(functions[1], here, own)]
    chain = [rates[0], rates[1], *(z[k].value * rates[0] for k in range(1, len(z) - 1))]
    back = dict(
        zip(
            (p.name for p, _ in functions[2].outputs),
            _values(functions[2], here, {"u1": rates[0], "u2": rates[1]}),
            strict=True,
        )
    )
    found = [a - b for a, b in zip(rates, chain, strict=True)]
    found += [a - b for a, b in zip(said, chain, strict=True)]
    return found + [back[name].value - value for name, value in own.items()]


def _values(formula: Formula, here: Place, more: Mapping[str, Exact]) -> list[Dual]:
    numbers = {**here.numbers, **{signal(name): value for name, value in more.items()}}
    evaluate = Evaluator(Place(here.angles, numbers, here.rates), formula)
    return [evaluate(expr) for _, expr in formula.outputs]


def _turning(t: Train, here: Place) -> Exact:
    port = t.steering_port
    return here.rates[signal("theta" if port is None else port.name)]


def _speed(t: Train, here: Place) -> Exact:
    """The speed of the axle's centre along the direction of travel, from the rates of the pose."""
    c, s = here.angles[signal("theta")]
    x, y, omega = (here.rates[signal(n)] for n in ("x", "y", "theta"))
    evaluate = Evaluator(here)
    ex, ey, qx, qy = (evaluate(expression(p)).value for p in (t.axle.ex, t.axle.ey, t.axle.x, t.axle.y))
    return ex * (c * x + s * y - omega * qy) + ey * (c * y - s * x + omega * qx)
