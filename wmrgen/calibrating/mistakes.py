"""Logs and truths that do not belong together, and which mistake in their columns would explain it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from wmrgen.calibrating.certainty import Fit
from wmrgen.calibrating.logs import Drive
from wmrgen.errors import UsageError

_FAR = 0.1  # of the truth's extent: where residuals stay so large, joints and truth do not belong together
_TURNED = 1.0  # [rad] the same for headings
_SURE = 5.0  # standard deviations from zero: a value that is sure
_TIMES = 4.0  # nominal values are nearer than that; units and encoders that are wrong are not
_BETTER = 0.25  # of the residual: what another reading of the columns has to come to, to be proposed


def refuse_strangers(best: Fit, drives: Sequence[Drive], fitted: Callable[[Sequence[Drive]], Fit]) -> None:
    """UsageError where no parameters bring joints and truth together, with the reading of the columns of ``drives``, as
    they were read, that would."""
    if not _strange(best):
        return
    turned, unlikely = best.rms[1] > _TURNED, _unlikely(best)
    hint = "do log and truth belong to one drive of this robot?"
    for text, other in _readings(drives[:2]):
        other_fit = fitted(other)
        better = unlikely or other_fit.rms[turned] < _BETTER * best.rms[turned]
        if better and not _strange(other_fit):
            hint = f"they would agree with {text}"
            break
    if unlikely:
        raise UsageError(f"log and truth agree only where {unlikely}: {hint}")
    if turned:
        raise UsageError(
            f"whatever the parameters are, headings stay {best.rms[1]:.2g} rad from the truth: {hint}"
        )
    raise UsageError(
        f"whatever the parameters are, positions stay {best.rms[0]:.2g} m from the truth, which extends over "
        f"{_extent(best):.2g} m: {hint}"
    )


def _strange(best: Fit) -> bool:
    """Whether joints and truth stay so far apart that they cannot belong together, or a length had to be negative,
    or another length altogether."""
    return best.rms[0] > _FAR * _extent(best) or best.rms[1] > _TURNED or bool(_unlikely(best))


def _unlikely(best: Fit) -> str:
    """The parameters whose sign is not that of their nominal value, or whose size is far from it, in words."""
    names = best.problem.increments.parameters
    rows = zip(names, best.problem.nominal, best.values, best.deviations, strict=True)
    return " and ".join(
        f"{name} is {value:.3g}, not about {nominal:g}"
        for name, nominal, value, sigma in rows
        if nominal and abs(value) > _SURE * sigma and not 1 / _TIMES < value / nominal < _TIMES
    )


def _extent(best: Fit) -> float:
    """How far [m] the truth extends along x or y; 0 where it has headings alone."""
    every = [axis for drive in best.problem.drives for axis in (drive.truth.x, drive.truth.y)]
    axes = [axis[np.isfinite(axis)] for axis in every]
    return max((float(np.ptp(axis)) for axis in axes if len(axis)), default=0.0)


def _readings(drives: Sequence[Drive]) -> Iterator[tuple[str, tuple[Drive, ...]]]:
    """Mistakes that users make with columns, in words, and the drives without them."""
    yield (
        "theta of the truth in radians, which seems to be in degrees",
        tuple(replace(d, truth=replace(d.truth, theta=np.radians(d.truth.theta))) for d in drives),
    )
    spins = [name for name in drives[0].columns if name.endswith(".spin")]
    for a, b in combinations(spins, 2):
        swapped = tuple(replace(d, columns={**d.columns, a: d.columns[b], b: d.columns[a]}) for d in drives)
        yield f"the columns of {a} and {b} exchanged", swapped
    for name in drives[0].columns:
        yield (
            f"{name} counted the other way",
            tuple(replace(d, columns={**d.columns, name: -d.columns[name]}) for d in drives),
        )
    yield (
        "x and y of the truth exchanged",
        tuple(replace(d, truth=replace(d.truth, x=d.truth.y, y=d.truth.x)) for d in drives),
    )
    yield (
        "theta of the truth counted the other way",
        tuple(replace(d, truth=replace(d.truth, theta=-d.truth.theta)) for d in drives),
    )
    yield (
        "x and y of the truth in metres, which seem to be in millimetres",
        tuple(replace(d, truth=replace(d.truth, x=d.truth.x / 1000, y=d.truth.y / 1000)) for d in drives),
    )
    yield (
        "angles of the joints in radians, which seem to be in degrees",
        tuple(replace(d, columns={k: np.radians(v) for k, v in d.columns.items()}) for d in drives),
    )
    yield (
        "angles of the joints in radians, which seem to be in turns",
        tuple(replace(d, columns={k: 2 * np.pi * v for k, v in d.columns.items()}) for d in drives),
    )
