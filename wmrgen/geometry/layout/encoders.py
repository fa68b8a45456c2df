"""Encoders of joints, and a check that absolute encoders are unambiguous.

An incremental encoder counts from one step to the next, so it measures any angle, however often its counter wraps. An
absolute encoder has the same reading at angles that are modulus/turn turns apart. It is unambiguous if the range of the
joint fits between two such angles, or if they are an integer number of turns apart.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import degrees

import numpy as np

from wmrgen.errors import ErrorCollector, RobotFileError
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.expressions import Scope
from wmrgen.geometry.layout.joints import constant, positive
from wmrgen.geometry.layout.records import Encoder, Robot, Wheel
from wmrgen.geometry.ports import Reading
from wmrgen.robotfile.records import EncoderSpec, Quantity, RobotSpec

FEWEST_BITS, MOST_BITS = 8, 32  # widths of the unsigned integers that generated code reads
MOST_MODULUS = 2**31  # counts: differences of readings must fit into signed 32-bit integers
ROUNDING = 1e-9  # [rad] so that limits of half a turn, which are rounded, fit into half a turn
_COUNTS_DOWN = "Write a positive number; reversed: true says that the encoder counts down."


def encoders_of(whose: str, encoders: Iterable[EncoderSpec], scope: Scope) -> dict[str, Encoder]:
    """Return the encoders by joint.

    Args:
        whose: The name of the wheel, or "the robot", for messages.
        encoders: The entries of the robot file.
        scope: The parameters of the robot file.

    Returns:
        A mapping from joint (spin or steer) to encoder.

    Raises:
        RobotFileError: If a value is impossible for an encoder.
    """
    return {e.joint: _encoder(f"the {e.joint} encoder of {whose}", e, scope) for e in encoders}


def _encoder(what: str, e: EncoderSpec, scope: Scope) -> Encoder:
    turn = positive(f"counts of {what}", e.counts, scope, _COUNTS_DOWN)
    if e.gear is not None:
        turn = turn * positive(f"gear of {what}", e.gear, scope, _COUNTS_DOWN)
    if e.modulus is None and e.bits is None and e.offset is not None:
        modulus = _whole("counts", what, e.counts, scope, 2, MOST_MODULUS)
    elif e.modulus is not None:
        modulus = _whole("modulus", what, e.modulus, scope, 2, MOST_MODULUS)
    else:
        bits = MOST_BITS if e.bits is None else _whole("bits", what, e.bits, scope, FEWEST_BITS, MOST_BITS)
        modulus = 2**bits
    offset = None if e.offset is None else _whole("offset", what, e.offset, scope, 0, modulus - 1)
    return Encoder(-turn if e.reversed else turn, Reading(modulus, offset))


def _whole(key: str, what: str, quantity: Quantity, scope: Scope, least: int, most: int) -> int:
    value = constant(f"{key} of {what}", quantity, scope)
    if not (value.is_rational and value.parts[0].denominator == 1 and least <= value <= most):
        raise RobotFileError(
            f"{key} of {what} is {quantity.text}, not a whole number from {least} to {most}", quantity.mark,
            "A counter is read as an unsigned integer of at most 32 bits.", f"Write {key}: and such a number.",
        )  # fmt: skip
    return int(value.parts[0])


def refuse_ambiguous(spec: RobotSpec, robot: Robot) -> None:
    """Raise RobotFileError for each absolute encoder that has the same reading at two angles of its joint.

    ``spec`` gives the places for messages; ``robot`` is the layout with couplings applied.
    """
    collector = ErrorCollector()
    written: dict[str, dict[str, EncoderSpec]] = {}  # by wheel, then by joint
    for wheel in spec.wheels:
        written[wheel.name] = {e.joint: e for e in (*spec.encoders, *wheel.encoders)}
    for w in robot.wheels:
        encoder = robot.encoder_of(w, "steer")
        if encoder is None or encoder.reading.offset is None:
            continue
        offset = written[w.name]["steer"].offset
        assert offset is not None
        with collector:
            _refuse_ambiguous(robot, w, encoder, offset)
    collector.end()


def _refuse_ambiguous(robot: Robot, w: Wheel, encoder: Encoder, offset: Quantity) -> None:
    turns = Exact(encoder.reading.modulus) / abs(encoder.turn)
    limit, half = robot.limit(w, "steer"), np.pi * float(turns)
    low, high = (float(limit.low), float(limit.high)) if limit else (-np.inf, np.inf)
    if limit is None and turns.is_rational and turns.parts[0].denominator == 1:
        return
    if -half <= low + ROUNDING and high <= half + ROUNDING:
        return
    measured = f"from {degrees(-half):.6g} to {degrees(half):.6g} deg"
    range_ = f"from {degrees(low):.6g} to {degrees(high):.6g} deg" if limit else "without limits"
    raise RobotFileError(
        f"the absolute steer encoder of {w.name} measures angles {measured}, but {w.name} steers {range_}", offset.mark,
        f"Its reading repeats after {float(turns):.6g} turns of the joint.",
        "Write limits: {steer: …} inside that range, or delete offset: for an encoder that is read as incremental.",
    )  # fmt: skip
