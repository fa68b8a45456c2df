"""Degrees of mobility and steerability a third way: Newton's method on the contact equations of the whole robot.

Unknowns: the angle of every steered group, the twist, the rate of every group of spins and of castors' swivels.
Equations: every rolling and sliding row. A component of solutions has dimension k + 1 or more in the twist where it
still has solutions after k random linear cuts. Castors stand at random angles, equal ones where they are coupled.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.oracle import oracle, reach

Array = NDArray[np.float64]
Layout = dict[str, Any]
SOLVED = 1e-11
LOOSE = 1e-5  # ranks at a solution, whose angles may be a double root's
CASTORS = 3  # seeds of castors' angles
STARTS = 12


@dataclass(frozen=True)
class Freedom:
    """delta_m, delta_s, the dimension of the Lie algebra of the admissible twists, whether none of them turns."""

    mobility: int
    steerability: int
    dof: int
    translates: bool = False


def castor_angles(layout: Layout, seed: int) -> dict[str, float]:
    """Random angles of castors, one for each coupled set."""
    rng = np.random.default_rng([seed, 77])
    lead = oracle.leaders(layout, "steer")
    drawn = {w["name"]: float(rng.uniform(-3, 3)) for w in layout["wheels"]}
    return {w["name"]: drawn[lead[w["name"]]] for w in layout["wheels"] if w["type"] == "castor"}


def freedom(layout: Layout) -> Freedom:
    """The component with most steering, then most motion, then most brackets, wherever the castors stand."""
    swivelling = any(w["type"] == "castor" for w in layout["wheels"])
    found = [_best(layout, seed) for seed in range(CASTORS if swivelling else 1)]
    best = max(found, key=lambda f: (f.steerability, f.mobility, f.dof))
    return (
        replace(best, dof=reach.dof(layout, castor_angles(layout, 0)))
        if _turns_with_castors(layout)
        else best
    )


def _turns_with_castors(layout: Layout) -> bool:
    """Whether two twists are admissible, and castors choose which: their angles follow from the motion."""
    one, other = (reach.free_twists(layout, castor_angles(layout, seed)) for seed in range(2))
    return one.shape[1] == other.shape[1] == 2 and np.linalg.matrix_rank(np.hstack([one, other]), LOOSE) > 2


def _best(layout: Layout, seed: int) -> Freedom:
    castors = castor_angles(layout, seed)
    rows = equations(layout, castors)
    best = Freedom(0, -1, 0)
    for cuts in (2, 1, 0):
        for start in range(STARTS):
            rng = np.random.default_rng([seed, cuts, start])
            planes = rng.normal(size=(cuts, 3))
            z = _solve(rows, planes, np.concatenate([rng.uniform(-3, 3, rows.size), rng.normal(size=3)]))
            if z is None:
                continue
            mobility = len(_still(rows, z))
            steerability = cuts + 1 - mobility
            if (steerability, mobility, 3) <= (best.steerability, best.mobility, best.dof):
                continue  # no algebra of twists has more dimensions than three
            twists = _along(rows, planes, z, rng)
            still = max(abs(t[2]) for t in twists) < LOOSE
            better = Freedom(mobility, steerability, _closure(twists), still)
            best = max(best, better, key=lambda f: (f.steerability, f.mobility, f.dof))
    return Freedom(best.mobility, max(best.steerability, 0), best.dof, best.translates)


def _along(rows: Equations, planes: Array, z: Array, rng: np.random.Generator) -> list[Array]:
    """Twists of the component that ``z`` lies on: cuts move a little, and the solution follows."""
    null = _still(rows, z)
    mobility, twists = len(null), [z[-3:], *null]
    for _ in range(5):
        new = _solve(rows, planes + rng.uniform(-0.15, 0.15, planes.shape), z)
        if new is None or min(np.abs(new[-3:] - z[-3:]).max(), np.abs(new[-3:] + z[-3:]).max()) > 0.3:
            continue
        null = _still(rows, new)
        if len(null) == mobility:  # else another component
            twists += [new[-3:], *null]
    return twists


def _still(rows: Equations, z: Array) -> Array:
    """The twists at the angles of ``z``, as rows."""
    return oracle.null(rows.matrix(z[:-3]), LOOSE).T


@dataclass(frozen=True)
class Equations:
    """(still + sum of cos(t_g) cosines_g + sin(t_g) sines_g) twist = 0, t_g the angle of a steered group.

    The rows are those of the contacts, what the joint rates can take up projected out.
    """

    still: Array
    cosines: Array
    sines: Array

    @property
    def size(self) -> int:
        """The number of angles."""
        return len(self.cosines)

    def matrix(self, angles: Array) -> Array:
        """The rows at the angles."""
        turning = np.cos(angles)[:, None, None] * self.cosines + np.sin(angles)[:, None, None] * self.sines
        return np.asarray(self.still + turning.sum(axis=0))

    def residual(self, z: Array) -> tuple[Array, Array]:
        """What the rows leave of (angles, twist), and its derivatives."""
        angles, twist = z[: self.size], z[self.size :]
        change = np.cos(angles)[:, None, None] * self.sines - np.sin(angles)[:, None, None] * self.cosines
        rows = self.matrix(angles)
        return rows @ twist, np.hstack([(change @ twist).T, rows])


def equations(layout: Layout, castors: dict[str, float]) -> Equations:
    """The equations of a layout with its castors at the angles given."""
    lead = oracle.leaders(layout, "steer")
    steered = [w["name"] for w in layout["wheels"] if w["type"] == "steered"]
    signs = {w["name"]: w.get("sign", 1) for w in layout["wheels"]}  # of the shaft's angle
    groups = list(dict.fromkeys(lead[n] for n in steered))
    rates = oracle.contact_rows(layout, castors)[1]
    left = np.eye(len(rates)) - (rates @ np.linalg.pinv(rates) if rates.size else 0.0)

    def at(angle: float, group: str) -> Array:
        turned = {n: angle * signs.get(n, 1) for n in steered if lead[n] == group}
        return np.asarray(left @ oracle.contact_rows(layout, castors | turned)[0])

    zero = at(0.0, "")
    cosines = [(zero - at(np.pi, g)) / 2 for g in groups]
    sines = [(at(np.pi / 2, g) - at(-np.pi / 2, g)) / 2 for g in groups]
    shape = (len(groups), *zero.shape)
    still = zero - sum(cosines, np.zeros_like(zero))
    return Equations(still, np.reshape(cosines, shape), np.reshape(sines, shape))


def _solve(rows: Equations, planes: Array, z: Array) -> Array | None:
    """Levenberg's method from ``z``; the twist keeps its length 1. None where it does not arrive."""

    def every(z: Array) -> tuple[Array, Array]:
        value, slope = rows.residual(z)
        twist = z[-3:]
        pad = np.zeros((len(planes) + 1, rows.size))
        more = np.hstack([pad, np.vstack([planes, 2 * twist])])
        return np.concatenate([value, planes @ twist, [twist @ twist - 1.0]]), np.vstack([slope, more])

    damping, (now, slope) = 1e-2, every(z)
    for _ in range(300):
        size = float(now @ now)
        if size < SOLVED**2:
            return z
        step = np.linalg.solve(slope.T @ slope + damping * np.eye(len(z)), slope.T @ now)
        new, steeper = every(z - step)
        if float(new @ new) < size:
            gain = float(new @ new) / size
            z, now, slope, damping = z - step, new, steeper, max(damping * 0.1, 1e-15)
            if gain > 0.9999 and size > 1e-8:
                return None
        else:
            damping *= 10
            if damping > 1e6:
                return None
    return None


def _closure(twists: list[Array]) -> int:
    """The dimension of the Lie algebra of the twists."""
    span = np.array(twists).reshape(-1, 3)
    while True:
        basis = oracle.null(oracle.null(span, LOOSE).T, LOOSE).T if len(span) else span
        brackets = [
            [-a[2] * b[1] + b[2] * a[1], a[2] * b[0] - b[2] * a[0], 0.0] for a in basis for b in basis
        ]
        grown = np.vstack([basis, *np.array(brackets).reshape(-1, 1, 3)]) if brackets else basis
        if oracle.rank(grown, LOOSE) == len(basis):
            return len(basis)
        span = grown
