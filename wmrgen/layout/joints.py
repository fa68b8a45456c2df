"""What a robot file says of joints and commands, as exact constants: weights, deadband, noise, encoders, lag."""

from __future__ import annotations

from collections.abc import Iterable

from wmrgen.errors import RobotFileError
from wmrgen.exact.evaluate import parameters_in, substituted
from wmrgen.exact.number import ONE, ZERO, Exact
from wmrgen.layout.expressions import Scope
from wmrgen.layout.records import Encoder, Noise
from wmrgen.spec.records import EncoderSpec, NoiseSpec, Quantity

MOST_WEIGHT = 1000  # of the least: rows that count less are lost in the rounding of a float


def constant(what: str, quantity: Quantity, scope: Scope) -> Exact:
    """The value of what no tunable parameter may move."""
    symbolic = scope.poly(quantity)
    names = sorted(parameters_in(substituted(symbolic, scope.constants)))
    if names:
        raise RobotFileError(
            f"{what} is {quantity.text}, which depends on the tunable parameter {names[0]}", quantity.mark,
            "It is a constant of the generated code and of its proved bounds.",
            f"Write a number, or delete tunable: true of {names[0]}.",
        )  # fmt: skip
    return scope.number(symbolic)


def weight_of(name: str, weight: Quantity, scope: Scope) -> Exact:
    """A positive constant, not so far from the 1 of other wheels that a float loses one of them."""
    value = constant(f"weight of {name}", weight, scope)
    if not 1 <= value * MOST_WEIGHT <= MOST_WEIGHT**2:
        raise RobotFileError(
            f"weight of {name} is {weight.text}, not between 1/{MOST_WEIGHT} and {MOST_WEIGHT}", weight.mark,
            "Weights are about (noise of other wheels / noise of this one)**2; rows that count next to nothing are "
            "lost in rounding.",
            "Write a number such as 0.25; sensed: [] leaves the wheel out.",
        )  # fmt: skip
    return value


def deadband_of(share: Quantity, scope: Scope) -> Exact:
    """A share of the limits of the twist, from 0 to below 1."""
    value = constant("deadband", share, scope)
    if not ZERO <= value < ONE:
        raise RobotFileError(
            f"deadband is {share.text}, not from 0 to below 1", share.mark,
            "It is a share of the limits of vx, vy and omega; with all of them the robot would never move.",
            "Write a number such as deadband: 0.01.",
        )  # fmt: skip
    return value


def noise_of(noise: Iterable[NoiseSpec], scope: Scope) -> dict[str, Noise]:
    """Standard deviations in SI units. RobotFileError for one below 0."""

    def deviation(joint: str, part: str, quantity: Quantity | None) -> Exact:
        value = ZERO if quantity is None else constant(f"{part} of the noise of {joint}", quantity, scope)
        if quantity is not None and value.sign < 0:
            raise RobotFileError(
                f"{part} of the noise of {joint} is {quantity.text}, which is negative", quantity.mark,
                "It is a standard deviation.", "Write 0 or a positive value.",
            )  # fmt: skip
        return value

    return {
        n.joint: Noise(*(deviation(n.joint, part, getattr(n, part)) for part in ("proportional", "constant")))
        for n in noise
    }


def encoders_of(whose: str, encoders: Iterable[EncoderSpec], scope: Scope) -> dict[str, Encoder]:
    """Counters. RobotFileError for counts or a gear that are not positive, and for another width than 16 or 32."""
    return {e.joint: _encoder(f"the {e.joint} encoder of {whose}", e, scope) for e in encoders}


def _encoder(what: str, e: EncoderSpec, scope: Scope) -> Encoder:
    counts = _positive(f"counts of {what}", e.counts, scope)
    turn = counts if e.gear is None else counts * _positive(f"gear of {what}", e.gear, scope)
    bits = Exact(32) if e.bits is None else constant(f"bits of {what}", e.bits, scope)
    if e.bits is not None and bits not in (Exact(16), Exact(32)):
        raise RobotFileError(
            f"bits of {what} is {e.bits.text}, neither 16 nor 32", e.bits.mark,
            "A counter is read as an unsigned integer of that width.", "Write bits: 16 or bits: 32.",
        )  # fmt: skip
    return Encoder(-turn if e.reversed else turn, int(float(bits)))


def lag_of(whose: str, lag: Iterable[tuple[str, Quantity]], scope: Scope) -> dict[str, Exact]:
    """Time constants [s]. RobotFileError for one that is not positive."""
    instead = (
        "Write a time such as 150 ms, or delete the key: without a lag the angle is commanded by its rate."
    )
    return {j: _positive(f"{j} lag of {whose}", time, scope, instead) for j, time in lag}


_COUNTS_DOWN = "Write a positive number; reversed: true says that the encoder counts down."


def _positive(what: str, quantity: Quantity, scope: Scope, instead: str = _COUNTS_DOWN) -> Exact:
    value = constant(what, quantity, scope)
    if value.sign <= 0:
        raise RobotFileError(
            f"{what} is {quantity.text}, which is not positive", quantity.mark, "", instead
        )  # fmt: skip
    return value
