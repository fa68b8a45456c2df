"""Least costs of unknowns that all drives share and of those that each has for itself, and the matrix of both.

Drives meet in the shared unknowns alone, so the matrix is an arrowhead: a block for each drive and a border. What a
drive has of its own is eliminated drive by drive, by Schur complements, so that memory and time grow with the number of
drives, and not with its square and its cube.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from wmrgen.tools.calibrating.path import Reals


@dataclass(frozen=True, slots=True)
class Sums:
    """Of one drive, by its unknowns, shared ones and then its own: cost, gradient, and second derivatives without those
    of the path."""

    cost: float
    gradient: Reals
    matrix: Reals

    def __add__(self, other: Sums) -> Sums:
        return Sums(self.cost + other.cost, self.gradient + other.gradient, self.matrix + other.matrix)


def robust(z: Reals, by: Reals, weights: Reals) -> Sums:
    """The soft L1 loss sqrt(1 + z^2) - 1 of z, a residual over its scale, with derivatives ``by`` unknowns."""
    root, by = np.sqrt(1 + z * z), by.reshape(-1, by.shape[-1])
    return Sums(float(weights @ (root - 1)), by.T @ (weights * z / root), (by.T * (weights / root**3)) @ by)


@dataclass(frozen=True, slots=True)
class Arrow:
    """Of s shared unknowns and o of each of n drives: ``shared`` (s, s), ``cross`` (n, o, s), ``own`` (n, o, o).
    ``follows`` (n, o, s): how a drive's unknowns follow the shared ones, less; ``reduced`` (s, s): the matrix of the
    shared ones where they do. Vectors are flat, the shared unknowns first."""

    shared: Reals
    cross: Reals
    own: Reals
    follows: Reals
    reduced: Reals

    @staticmethod
    def of(parts: Sequence[Reals], prior: Reals, prior_of_own: Reals) -> Arrow:
        """The sum of what each drive adds, (s + o, s + o), and of the priors: (s, s), and of each drive (o, o)."""
        every, s = np.array(parts), len(prior)
        shared, cross, own = every[:, :s, :s], every[:, s:, :s], every[:, s:, s:] + prior_of_own
        follows = np.linalg.solve(own, cross)
        reduced = (shared - cross.swapaxes(1, 2) @ follows).sum(axis=0)
        return Arrow(shared.sum(axis=0) + prior, cross, own, np.asarray(follows), reduced + prior)

    def __matmul__(self, vector: Reals) -> Reals:
        """The product with a vector."""
        s, own = self._split(vector)
        first = self.shared @ s + np.einsum("nos,no->s", self.cross, own)
        return np.concatenate([first, (self.cross @ s + np.einsum("nop,np->no", self.own, own)).ravel()])

    def solve(self, vector: Reals) -> Reals:
        """The vector whose product is ``vector``."""
        s, own = self._split(vector)
        first = np.linalg.solve(self.reduced, s - np.einsum("nos,no->s", self.follows, own))
        alone = np.linalg.solve(self.own, own[..., None])[..., 0]
        return np.concatenate([first, (alone - self.follows @ first).ravel()])

    def _split(self, vector: Reals) -> tuple[Reals, Reals]:
        """What is shared (s,), and what drives have of their own (n, o)."""
        count = len(self.shared)
        return vector[:count], vector[count:].reshape(self.own.shape[:2])


@dataclass(frozen=True, slots=True)
class Slope:
    """A cost, its gradient, and its second derivatives or what stands for them."""

    cost: float
    gradient: Reals
    matrix: Arrow


def least(slope: Callable[[Reals], Slope], start: Reals, near: float, most_steps: int) -> Reals:
    """The unknowns of least cost from ``start`` on, to where no step gains more than Newton's does that is ``near``
    standard deviations long. Where readings are rough, the cost has edges, at which Newton's step stays long: then what
    the trust region leaves to gain tells the end. A step of the dogleg method lies in the plane of the gradient and of
    Newton's step (Powell, 1970), so scipy takes it among two unknowns, however many drives there are; the trust region
    goes on from step to step as scipy has it."""
    unknowns, here, radius, steps = start, slope(start), 1.0, 0
    enough = 0.5 * near**2
    while steps < most_steps:
        newton, steep = here.matrix.solve(here.gradient), float(np.linalg.norm(here.gradient))
        if steps and min(0.5 * float(here.gradient @ newton), steep * radius) < enough:
            break
        # Each step that does not do makes the region a quarter as wide.
        gained = steep * min(radius, float(np.linalg.norm(newton)))
        tries = min(most_steps - steps, 1 + int(np.log(max(1.0, gained / enough)) / np.log(4)))
        plane = np.linalg.qr(np.array([here.gradient, newton]).T)[0]
        step, there, tried = _step(slope, unknowns, here, plane, radius, tries)
        if there is here:
            break
        bent = 0.5 * step @ (here.matrix @ step)
        gain = (there.cost - here.cost) / (here.gradient @ step + bent)
        radius *= 0.25 ** (tried - 1)
        if gain < 0.25:
            radius *= 0.25
        elif gain > 0.75 and np.linalg.norm(step) > 0.99 * radius:
            radius *= 2
        unknowns, here, steps = unknowns + step, there, steps + tried
    return unknowns


def _step(
    slope: Callable[[Reals], Slope], unknowns: Reals, here: Slope, plane: Reals, radius: float, most: int
) -> tuple[Reals, Slope, int]:
    """The first step in the ``plane`` that does, what is there, and how many were tried; none where ``most`` do not."""
    gradient = plane.T @ here.gradient
    matrix = plane.T @ np.array([here.matrix @ axis for axis in plane.T]).T
    slopes = [here]

    def cost(step: Reals) -> float:
        if step.any():
            slopes.append(slope(unknowns + plane @ step))
        return slopes[-1].cost

    def halt(step: Reals) -> None:
        if step.any():
            raise StopIteration

    solution = minimize(
        cost,
        np.zeros(2),
        jac=lambda _: gradient,  # of the plane's origin: a step that does is the last
        hess=lambda _: matrix,
        method="dogleg",
        callback=halt,
        options={"gtol": 1e-6, "maxiter": most, "initial_trust_radius": radius, "max_trust_radius": np.inf},
    )
    return plane @ solution.x, slopes[-1] if solution.x.any() else here, int(solution.nit)
