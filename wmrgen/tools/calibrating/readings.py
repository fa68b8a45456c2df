"""Other readings of the columns of a log and its truth: mistakes that users make with them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from wmrgen.tools.calibrating.logs import Drive, Truth
from wmrgen.tools.calibrating.path import Reals

Change = Callable[[Drive], Drive]


def readings(drive: Drive, farther: float) -> Iterator[tuple[str, Change]]:
    """Mistakes that users make with columns as those of ``drive``, in words, and what a drive is without them; the
    truth goes so many times ``farther`` than nominal odometry has it."""
    names, spins, steers = list(drive.columns), _ending(drive, ".spin"), _ending(drive, ".steer")
    steering = [name for name in names if ".steer" in name]
    for a, b in [*combinations(spins, 2), *combinations(steers, 2)]:
        ends = [name.removeprefix(a) for name in names if name.startswith(a)]
        both = {f"{c}{end}": (f"{d}{end}", 1.0) for c, d in ((a, b), (b, a)) for end in ends}
        yield f"the columns of {a} and {b} exchanged", _with_joints(both)
    for name in (*spins, *steers):
        yield f"{name} counted the other way", _scaled([n for n in names if n.startswith(name)], -1)
    if len(spins) > 1:
        yield "every wheel counted the other way", _scaled(spins, -1)
    if len(steers) > 1:
        yield "every steering angle counted the other way", _scaled(steering, -1)
    yield "theta of the truth counted the other way", _with_truth(theta=-1)
    yield (
        "x and y of the truth exchanged, or one of them counted the other way",
        lambda d: replace(d, truth=replace(d.truth, x=d.truth.y, y=d.truth.x)),
    )
    north = "as with x north, y east and theta clockwise"
    yield f"y and theta of the truth counted the other way, {north}", _with_truth(y=-1, theta=-1)
    for unit, size in (("millimetres", 1e-3), ("centimetres", 1e-2), ("inches", 0.0254), ("feet", 0.3048)):
        yield f"x and y of the truth in metres, which seem to be in {unit}", _with_truth(x=size, y=size)
    encoder = f", or counts of an encoder, about {2 * np.pi / farther:.0f} to a turn" if farther > 0 else ""
    yield (
        "theta of the truth in radians, which seems to be in degrees, clockwise",
        _with_truth(theta=-np.pi / 180),
    )
    yield (
        f"y of the truth counted the other way, theta in degrees, {north}",
        _with_truth(y=-1, theta=-np.pi / 180),
    )
    for unit, size, more in (("degrees", np.pi / 180, encoder), ("turns", 2 * np.pi, "")):
        yield f"theta of the truth in radians, which seems to be in {unit}", _with_truth(theta=size)
        yield f"angles of the wheels in radians, which seem to be in {unit}{more}", _scaled(spins, size)
        if steers:
            yield f"steering angles in radians, which seem to be in {unit}", _scaled(steering, size)
            yield f"angles of the joints in radians, which seem to be in {unit}", _scaled(names, size)
    yield "speeds of the wheels in rad/s, which seem to be in rpm", _scaled(spins, 2 * np.pi / 60)
    yield (
        "angles of the wheels in columns that are called <wheel>.spin, and should be <wheel>.angle",
        lambda d: replace(d, columns={**d.columns, **{n: _turned(d, n) for n in spins}}),
    )
    yield (
        "speeds of the wheels in columns that are called <wheel>.angle, and should be <wheel>.spin",
        lambda d: replace(d, columns={**d.columns, **{n: _driven(d, n) for n in spins}}),
    )
    yield (
        "angles of each step in columns that are called <wheel>.spin, which should be summed up in <wheel>.angle",
        lambda d: replace(d, columns={**d.columns, **{n: d.columns[n] / np.diff(d.t) for n in spins}}),
    )
    yield (
        "angles of the wheels summed up, which seem to be those of each step alone",
        lambda d: replace(d, columns={**d.columns, **{n: np.cumsum(d.columns[n]) for n in spins}}),
    )
    yield "times of the truth that last as long as the log: which t is not in seconds?", _as_long


def counts(drive: Drive, farther: float) -> tuple[str, Change]:
    """The reading under which all wheels turn so many times as far."""
    what = f"counts of an encoder, about {2 * np.pi / farther:.0f} to a turn"
    what = "metres at the rim" if farther > 1 else what
    text = f"wheels that turn {farther:.3g} times as far: are these {what}, or is a gear another?"
    return text, _scaled(_ending(drive, ".spin"), farther)


def _turned(drive: Drive, spin: str) -> Reals:
    """Increments of angles that were read for speeds."""
    return np.diff(drive.columns[spin] / np.diff(drive.t), prepend=0.0)


def _driven(drive: Drive, spin: str) -> Reals:
    """Increments of a wheel that stands at first, whose speeds were read for angles."""
    speed = np.cumsum(drive.columns[spin])
    return (speed - drive.columns[spin] / 2) * np.diff(drive.t)


def _as_long(drive: Drive) -> Drive:
    """A drive whose truth begins and ends with the log."""
    t, at = drive.t, drive.truth.t
    times = t[0] + (at - at[0]) * (np.ptp(t) / np.ptp(at))
    return replace(drive, truth=replace(drive.truth, t=times))


def _ending(drive: Drive, end: str) -> list[str]:
    """The joints whose name ends so."""
    return [name for name in drive.columns if name.endswith(end)]


def _with_joints(changed: Mapping[str, tuple[str, float]]) -> Change:
    """A drive with each column that is named from another, times a factor."""
    return lambda d: replace(
        d, columns={**d.columns, **{n: f * d.columns[other] for n, (other, f) in changed.items()}}
    )


def _scaled(names: Sequence[str], factor: float) -> Change:
    """A drive whose joints ``names`` turn so many times as far."""
    return _with_joints({name: (name, factor) for name in names})


def _with_truth(x: float = 1, y: float = 1, theta: float = 1) -> Change:
    """A drive whose truth is so many times as large."""
    return lambda d: replace(d, truth=Truth(d.truth.t, x * d.truth.x, y * d.truth.y, theta * d.truth.theta))
