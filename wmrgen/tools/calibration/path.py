"""Dead reckoning: the path that joint readings give, and its derivatives by the robot's parameters.

A position is one complex number, x + iy, and so is a displacement. A step that turns by omega while the robot's point
moves by u in its own frame moves it by u exp(i omega / 2) sinc(omega / 2), turned with the robot. This is the
exponential map of SE(2), which `wmrgen.analysis.kinematics.odometry` has as a formula.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wmrgen.codegen.casadi import OfColumns, sensitivity
from wmrgen.ir.nodes import Function

Reals = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Indices = NDArray[np.intp]

_SMALL = 1e-4  # [rad] of half a turn: below it the series of sinc is right to 1e-16


@dataclass(frozen=True, slots=True)
class Path:
    """Poses along a path, or single steps, with their derivatives by P parameters."""

    position: Complexes  # (N,) [m]
    heading: Reals  # (N,) [rad]
    position_by: Complexes  # (P, N)
    heading_by: Reals  # (P, N)

    def at(self, which: Any) -> Path:
        """Return some of the poses, by their indices."""
        return Path(
            self.position[..., which],
            self.heading[..., which],
            self.position_by[..., which],
            self.heading_by[..., which],
        )

    def between(self, step: Indices, share: Reals) -> Path:
        """Return poses inside steps.

        Inside a step the robot moves along an arc. Its distance from the chord is the length of the chord times half of
        omega, times the share that is over, times the share that is left. This is right to the square of omega. Outside
        the step the robot goes on along the chord.

        Args:
            step: (n,) numbers of the steps.
            share: (n,) how much of each step is over; below 0 or above 1 outside of it.

        Returns:
            The n poses.
        """
        start, end = self.at(step), self.at(step + 1)
        chord, turn = end.position - start.position, end.heading - start.heading
        inside = np.maximum(share * (1 - share), 0.0)
        bulge, bent = share - 0.5j * inside * turn, -0.5j * inside * chord
        turn_by = end.heading_by - start.heading_by
        return Path(
            start.position + bulge * chord,
            start.heading + share * turn,
            start.position_by + bulge * (end.position_by - start.position_by) + bent * turn_by,
            start.heading_by + share * turn_by,
        )


@dataclass(frozen=True, slots=True)
class Increments:
    """The twist that `forward` makes of joint increments.

    It is linear in them, so increments of angle give increments of the pose, whatever the duration of a step is.
    """

    joints: tuple[str, ...]  # inputs of `forward` by contract name
    parameters: tuple[str, ...]  # its other inputs, and the gains of joints
    twist: OfColumns  # vx, vy, omega and their derivatives by each parameter, of columns of all inputs
    # The residual of each measured row, and its derivatives; None without redundant joints.
    rows: OfColumns | None

    @staticmethod
    def of(forward: Function, rows: Function | None, scaled: Sequence[str] = ()) -> Increments:
        """Build the increments of a robot.

        Args:
            forward: The robot's `forward`, with its parameters as inputs.
            rows: What redundant joints disagree by.
            scaled: Joints whose readings get an unknown factor, ``<joint>.gain``.
        """
        names = [port.name for port in forward.inputs]
        joints = tuple(name for name in names if "." in name)
        parameters = tuple(name for name in names if "." not in name)
        unknown = (*parameters, *(f"{joint}.gain" for joint in scaled))
        twist = sensitivity(forward, ("vx", "vy", "omega"), joints, parameters, scaled)
        if rows is None:
            return Increments(joints, unknown, twist, None)
        outputs = [port.name for port in rows.outputs]
        return Increments(joints, unknown, twist, sensitivity(rows, outputs, joints, parameters, scaled))

    @property
    def alone(self) -> Increments:
        """The same without derivatives."""
        return replace(self, parameters=())

    def steps(self, columns: Mapping[str, Reals], values: Reals) -> Path:
        """Return displacement and rotation of each step, in the frame of its own start.

        Args:
            columns: Increments of each joint [rad]; of steering angles the angle itself [rad].
            values: (P,) parameters.
        """
        rows = self._evaluated(self.twist, columns, values)
        by = rows[3 : 3 + 3 * len(self.parameters)].reshape(-1, 3, rows.shape[1])
        return Path(rows[0] + 1j * rows[1], rows[2], by[:, 0] + 1j * by[:, 1], by[:, 2])

    def path(self, columns: Mapping[str, Reals], values: Reals) -> Path:
        """Return N + 1 poses from a pose of zeros on; arguments as of `steps`."""
        return chained(self.steps(columns, values))

    def disagreement(self, columns: Mapping[str, Reals], values: Reals) -> Reals:
        """Return what R redundant rows are off by [m] in N steps, and their derivatives, (1 + P, R, N)."""
        count = len(next(iter(columns.values())))
        if self.rows is None:
            return np.zeros((1 + len(self.parameters), 0, count))
        rows = self._evaluated(self.rows, columns, values)
        return np.asarray(rows.reshape(-1, rows.shape[0] // (1 + len(values)), count))

    def _evaluated(self, function: OfColumns, columns: Mapping[str, Reals], values: Reals) -> Reals:
        inputs = np.array([columns[name] for name in self.joints])
        if not any(name.endswith(".steer") for name in self.joints):
            return np.asarray(_matrix(function, len(inputs), tuple(map(float, values))) @ inputs)
        constant = np.repeat(np.asarray(values, dtype=float)[:, None], inputs.shape[1], axis=1)
        return np.asarray(function(np.vstack([inputs, constant])))


@lru_cache(maxsize=16)  # all logs of one evaluation have the same parameters
def _matrix(function: OfColumns, joints: int, values: tuple[float, ...]) -> Reals:
    """Return the matrix of a function that is linear in the joints."""
    constant = np.repeat(np.array(values)[:, None], joints, axis=1)
    return np.asarray(function(np.vstack([np.eye(joints), constant])))


def chained(step: Path) -> Path:
    """Return the poses of steps that follow one another, from a pose of zeros on.

    Each step goes by the chord u sinc(omega / 2) along the heading in the middle of its arc.
    """
    heading, heading_by = _sums(step.heading), _sums(step.heading_by)
    half = 0.5 * step.heading
    small = np.abs(half) < _SMALL
    divisor = np.where(small, 1.0, half)
    sinc = np.where(small, 1 - half**2 / 6, np.sin(half) / divisor)
    slope = np.where(small, -half / 6, (np.cos(half) - sinc) / (2 * divisor))  # of sinc, by omega
    along = np.exp(1j * (heading[:-1] + half))
    ahead = along * step.position
    chord = ahead * sinc
    turn = ahead * slope + 0.5j * chord
    chord_by = along * sinc * step.position_by + turn * step.heading_by + 1j * chord * heading_by[:, :-1]
    return Path(_sums(chord), heading, _sums(chord_by), heading_by)


def _sums(steps: Any) -> Any:
    """Return the running sums along the last axis, from 0 on."""
    result = np.zeros((*steps.shape[:-1], steps.shape[-1] + 1), dtype=steps.dtype)
    np.cumsum(steps, axis=-1, out=result[..., 1:])
    return result
