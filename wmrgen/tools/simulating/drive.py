"""Simulate a drive: ask for commands, move the robot step by step, and record everything."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil
from types import MappingProxyType
from typing import NamedTuple, Protocol

import numpy as np

from wmrgen.analysis.mobility.basis import NEGLIGIBLE
from wmrgen.errors import UsageError
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.tools.simulating.model import NAMES, SLIDING, Model, Reals, Twist, Values

_PICO = 12  # digits of a time [s]: sums of steps of 10 ms stay round
MOST = 200_000  # steps of a drive: half an hour at 10 ms, and about 100 MB of results


_NONE: Values = MappingProxyType({})


class Order(NamedTuple):
    """What a robot does in the next step, for N starts."""

    twist: Twist  # commanded
    dt: Reals  # duration [s], (N,); 0 for a start that has arrived
    driven: Twist | None = None  # the driven twist, if it is known; None: it follows from `twist`
    joints: Values = _NONE  # commanded joints that replace the results of `inverse`
    swings: Values = _NONE  # rates [rad/s] of steered wheels that turn while the robot waits
    after: Values = _NONE  # parts of the state at the end, if they are known


class Moment(NamedTuple):
    """What a source of commands knows when it is asked, for N starts."""

    model: Model
    t: Reals  # [s], (N,)
    state: Values

    @property
    def starts(self) -> int:
        """The number N."""
        return len(self.state[NAMES[0]])


class Source(Protocol):
    """A source of commands."""

    def order(self, now: Moment) -> Order | None:
        """Return the next order; None at the end."""


def steps_of(seconds: float, step: float) -> int:
    """Return how many steps of at most ``step`` [s] a time takes. Raise UsageError for more than `MOST`."""
    count = seconds / step
    if not count <= MOST:
        raise UsageError(
            f"{seconds:g} s are more than {MOST} steps of {step:g} s. Write a shorter time, or a longer --step."
        )
    return max(1, ceil(count - NEGLIGIBLE))  # a step that fits up to rounding is not cut


@dataclass(frozen=True, slots=True)
class Drive:
    """A recorded drive of one robot, from N starts."""

    name: str  # of the robot
    model: Model
    t: Reals  # (K, N) [s]
    # (K, N) by name: x y theta, vx vy omega as driven, <wheel>.spin steer steer_rate, <trailer>.theta, slip
    columns: Mapping[str, Reals]
    arrived: Reals | None = None  # (N,) [s] at the goal, nan if it was not reached; None without a goal
    limited_by: tuple[str, ...] = ()  # functions that reduced commands of a law to the limits of the robot

    @property
    def starts(self) -> int:
        """Return the number of starts."""
        return int(self.t.shape[1])

    def pose(self, row: int, start: int) -> tuple[float, float, float]:
        """Return x, y [m] and theta [rad] at a row."""
        x, y, theta = (float(self.columns[name][row, start]) for name in NAMES)
        return x, y, theta

    @property
    def length(self) -> Reals:
        """Return the length of the path of P for each start [m], (N,)."""
        speed = np.hypot(self.columns["vx"], self.columns["vy"])[:-1]
        return np.asarray((speed * np.diff(self.t, axis=0)).sum(axis=0))

    def reversals(self, start: int) -> int:
        """Return how often the direction of travel along x changes."""
        vx = self.columns["vx"][:, start]
        signs = np.sign(vx[np.abs(vx) > SLIDING])
        return int(np.count_nonzero(np.diff(signs)))


def simulate(model: Model, state: Mapping[str, Reals], source: Source) -> Drive:
    """Return the drive from a state under the commands of a source.

    Args:
        model: the robot.
        state: from `Model.start`.
        source: the commands.

    Returns:
        The drive, with a row at the start of each step and one at the end.

    Raises:
        UsageError: if the drive leaves the range of doubles.
    """
    now = dict(state)
    count = len(now[NAMES[0]])
    t = np.zeros(count)
    rows: list[dict[str, Reals]] = []
    last: dict[str, Reals] = {}
    while (order := source.order(Moment(model, t, now))) is not None:
        joints, twist = _commanded(model, now, order)
        for wheel in model.steered:
            now[f"{wheel}.steer"] = joints[f"{wheel}.steer"]
        last = {**joints, **dict(zip(TWIST_NAMES, twist, strict=True))}
        rows.append({**last, **now, "t": t})
        after = model.moved(now, twist, order.dt) | dict(order.after)
        for name, rate in order.swings.items():
            after[name] = now[name] + rate * order.dt
        now, t = after, np.round(t + order.dt, _PICO)
        if not np.isfinite(np.array(list(now.values()))).all():
            raise UsageError(f"the motion leaves the range of doubles at {float(t.max()):.6g} s")
    if not rows:
        zero = np.zeros(count)
        last = {**model.command(now, (zero, zero, zero))[0], **dict.fromkeys(TWIST_NAMES, zero)}
    rows.append({**last, **now, "t": t})
    columns = {}
    for name in rows[0]:
        columns[name] = np.array([row[name] for row in rows])
    times = columns.pop("t")
    arrived, limited_by = getattr(source, "arrived", None), getattr(source, "limited_by", ())
    return Drive(model.robot.name, model, times, columns, arrived, limited_by)


def _commanded(model: Model, state: Values, order: Order) -> tuple[dict[str, Reals], Twist]:
    """Return the joints and the driven twist of an order."""
    joints, twist = model.command(state, order.twist)
    joints |= order.joints
    return joints, twist if order.driven is None else order.driven
