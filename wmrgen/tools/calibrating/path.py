"""The path that a robot's joint readings tell, and how it changes with the robot's parameters.

A position is one complex number, x + iy, and so is a displacement: a step that turns by omega while the robot's point
moves by u in its own frame takes it, turned with the robot, by u (exp(i omega) - 1) / (i omega), which is
u exp(i omega / 2) sinc(omega / 2): the exponential map of SE(2), which `wmrgen.analysis.kinematics.odometry` has as
a formula.
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
_BLOCK = 4096  # steps that are reckoned at a time


@dataclass(frozen=True, slots=True)
class Reckoning:
    """Dead reckoning from a pose of zeros: ``position`` [m] and ``heading`` [rad] at N times, and their derivatives by
    P parameters, (P, N)."""

    position: Complexes
    heading: Reals
    position_by: Complexes
    heading_by: Reals

    def at(self, which: Any) -> Reckoning:
        """Some of the poses, by their indices."""
        return Reckoning(
            self.position[..., which], self.heading[..., which],
            self.position_by[..., which], self.heading_by[..., which],
        )  # fmt: skip

    def within(self, share: Reals) -> Reckoning:
        """Of samples (..., 2, n) of where steps begin and end the poses (..., n) a ``share`` of a step behind its
        start, along an arc: beside the chord by its length, i omega / 2 and the shares that are over and left, right to
        the square of omega. Outside the step it goes on as the chord."""
        every: tuple[Any, ...] = self.position, self.heading, self.position_by, self.heading_by
        start = Reckoning(*(samples[..., 0, :] for samples in every))
        step = Reckoning(*(samples[..., 1, :] - samples[..., 0, :] for samples in every))
        bulge = share - 0.5j * np.maximum(share * (1 - share), 0.0) * step.heading
        bent = -0.5j * np.maximum(share * (1 - share), 0.0) * step.position
        return Reckoning(
            start.position + bulge * step.position,
            start.heading + share * step.heading,
            start.position_by + bulge * step.position_by + bent * step.heading_by,
            start.heading_by + share * step.heading_by,
        )

    def pace(self, share: Reals) -> tuple[Complexes, Reals]:
        """How fast place and heading go there, by steps."""
        poses: tuple[Any, Any] = self.position, self.heading
        length, turn = (samples[..., 1, :] - samples[..., 0, :] for samples in poses)
        inside = (share > 0) & (share < 1)
        return length * (1 - 0.5j * turn * np.where(inside, 1 - 2 * share, 0.0)), turn


_ORIGIN = Reckoning(np.zeros((), complex), np.zeros(()), np.zeros((), complex), np.zeros(()))


@dataclass(frozen=True, slots=True)
class Increments:
    """What a robot's `forward` makes of joint increments: linear in them, so increments of angle give increments of
    the twist, whatever a step's duration is. ``joints``: its inputs by contract name; ``parameters``: the others."""

    joints: tuple[str, ...]
    parameters: tuple[str, ...]
    sensitivity: OfColumns  # of columns of all inputs: vx, vy, omega, and these by each parameter
    disagreement: OfColumns  # of the same columns: `slip` of forward, and nothing else
    rows: OfColumns | None  # of the same columns: what each measured row is off by, and by each parameter

    @staticmethod
    def of(forward: Function, rows: Function | None) -> Increments:
        """``forward`` and what it leaves of measured ``rows``: a robot's functions, with its parameters as inputs."""
        names = [port.name for port in forward.inputs]
        joints = tuple(name for name in names if "." in name)
        parameters = tuple(name for name in names if "." not in name)
        twist = sensitivity(forward, ("vx", "vy", "omega"), joints, parameters)
        slip = sensitivity(forward, ("slip",), (*joints, *parameters), ())
        if rows is None:
            return Increments(joints, parameters, twist, slip, None)
        off = sensitivity(rows, [port.name for port in rows.outputs], joints, parameters)
        return Increments(joints, parameters, twist, slip, off)

    @property
    def alone(self) -> Increments:
        """The same without derivatives, for paths that need none."""
        return replace(self, parameters=())

    def slip(self, columns: Mapping[str, Reals], values: Reals | Sequence[float]) -> Reals:
        """What the joints disagree by in each step [m]; 0 where they tell no more than a twist."""
        inputs = np.array([columns[name] for name in self.joints])
        constant = np.repeat(np.asarray(values, dtype=float)[:, None], inputs.shape[1], axis=1)
        return np.asarray(self.disagreement(np.vstack([inputs, constant]))[0])

    def __call__(self, columns: Mapping[str, Reals], values: Reals | Sequence[float]) -> Reckoning:
        """Displacement (vx + i vy) and turn of each step, as a path of single steps."""
        rows = self._of(self.sensitivity, np.array([columns[name] for name in self.joints]), values)
        by = rows[3 : 3 + 3 * len(self.parameters)].reshape(-1, 3, rows.shape[1])
        return Reckoning(rows[0] + 1j * rows[1], rows[2], by[:, 0] + 1j * by[:, 1], by[:, 2])

    def joint_residuals(
        self, columns: Mapping[str, Reals], values: Reals | Sequence[float], firsts: NDArray[np.intp]
    ) -> Reals:
        """What each of R measured rows is off by [m] in n spans of steps, which begin with ``firsts``, and this by P
        parameters, (1 + P, R, n), block by block; no rows where joints tell no more than a twist."""
        if self.rows is None:
            return np.zeros((1 + len(self.parameters), 0, len(firsts)))
        inputs, parts = np.array([columns[name] for name in self.joints]), []
        edges = np.union1d(firsts, np.arange(0, inputs.shape[1], _BLOCK))
        for first in range(0, inputs.shape[1], _BLOCK):
            rows = self._of(self.rows, inputs[:, first : first + _BLOCK], values)
            inside = slice(*np.searchsorted(edges, [first, first + _BLOCK]))
            parts.append(np.add.reduceat(rows, edges[inside] - first, axis=1))
        spans = np.add.reduceat(np.concatenate(parts, axis=1), np.searchsorted(edges, firsts), axis=1)
        return np.asarray(spans.reshape(1 + len(self.parameters), -1, len(firsts)))

    def _of(self, function: OfColumns, inputs: Reals, values: Reals | Sequence[float]) -> Reals:
        """A function, linear in joints that are no angles, of columns of all joints (joints, N)."""
        if not any(name.endswith(".steer") for name in self.joints):
            return _linear(function, len(inputs), tuple(map(float, values))) @ inputs
        constant = np.repeat(np.asarray(values, dtype=float)[:, None], inputs.shape[1], axis=1)
        return function(np.vstack([inputs, constant]))


@lru_cache(maxsize=16)  # blocks and drives of one evaluation have the same values
def _linear(function: OfColumns, joints: int, values: tuple[float, ...]) -> Reals:
    """The matrix of a function that is linear in joints."""
    constant = np.repeat(np.array(values)[:, None], joints, axis=1)
    return function(np.vstack([np.eye(joints), constant]))


def reckoned(step: Reckoning, start: Reckoning = _ORIGIN) -> Reckoning:
    """Steps, one after the other: N + 1 poses, of which the first is ``start``. A step goes by the chord
    u sinc(omega / 2) along the heading at the middle of its arc; where omega is small, sinc is its series, right to
    1e-16."""
    heading, heading_by = _sums(start.heading, step.heading), _sums(start.heading_by, step.heading_by)
    half = 0.5 * step.heading
    small = np.abs(half) < 1e-4
    divisor = np.where(small, 1.0, half)
    sinc = np.where(small, 1 - half**2 / 6, np.sin(half) / divisor)
    slope = np.where(small, -half / 6, (np.cos(half) - sinc) / (2 * divisor))  # of sinc, by omega
    along = np.exp(1j * (heading[:-1] + half))
    ahead = along * step.position
    chord = ahead * sinc
    turn = ahead * slope + 0.5j * chord
    chord_by = along * sinc * step.position_by + turn * step.heading_by + 1j * chord * heading_by[:, :-1]
    position, position_by = _sums(start.position, chord), _sums(start.position_by, chord_by)
    return Reckoning(position, heading, position_by, heading_by)


def passed(
    increments: Increments,
    columns: Mapping[str, Reals],
    values: Reals | Sequence[float],
    step: NDArray[np.intp],
) -> Reckoning:
    """The poses in which n steps of the path, of numbers that do not fall, begin and end (..., 2, n). The path is
    reckoned to the last of them, block by block: fresh memory for the whole takes the system as long as all that is
    computed in it."""
    here, parts = _ORIGIN, []
    for first in range(0, int(step.max(initial=0)) + 1, _BLOCK):
        block = {joint: column[first : first + _BLOCK] for joint, column in columns.items()}
        path = reckoned(increments(block, values), here)
        here = path.at(-1)
        inside = slice(*np.searchsorted(step, [first, first + _BLOCK]))
        parts.append(path.at(step[inside] - first + [[0], [1]]))
    every = ((p.position, p.heading, p.position_by, p.heading_by) for p in parts)
    return Reckoning(*(np.concatenate(of_all, axis=-1) for of_all in zip(*every, strict=True)))


def _sums(start: Any, steps: Any) -> Any:
    """The start and the running sums from it along the last axis."""
    result = np.empty((*steps.shape[:-1], steps.shape[-1] + 1), dtype=steps.dtype)
    result[..., 0], result[..., 1:] = start, steps
    return np.cumsum(result, axis=-1, out=result)
