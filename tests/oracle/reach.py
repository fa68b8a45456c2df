"""Dimension of the poses that a robot reaches: simulated drives, whose end is differentiated by their inputs.

At random inputs the Jacobian of the end by the inputs has the rank of what Lie brackets span (Sussmann, Krener). No
bracket is formed here. Twists come from the contact equations of all wheels, castors turn as the motion turns them, and
steered wheels, whose rates are free, follow whatever twist the other wheels admit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.oracle import oracle

Array = NDArray[np.float64]
Layout = dict[str, Any]
SEGMENTS, STEPS = 4, 12  # of constant input, and steps in each: castors turn by about a radian
DIFFERENCE, SEEN = 1e-4, 1e-5  # of an input; a singular value, relative to the largest


def free_twists(layout: Layout, castors: dict[str, float]) -> Array:
    """Twists that the wheels without steering admit, as columns."""
    return oracle.null(oracle.constraint(oracle.unsteered(layout), castors))


def dof(layout: Layout, castors: dict[str, float], seed: int = 0) -> int:
    """Dimension of the reachable poses (x, y, theta), the castors at these angles in the beginning."""
    start, lead = free_twists(layout, castors), oracle.leaders(layout, "steer")
    turning = [w for w in layout["wheels"] if w["type"] == "castor" and lead[w["name"]] == w["name"]]
    if not start.shape[1]:
        return 0

    def rate(q: Array, wish: Array) -> Array:
        angles = {w["name"]: q[3 + k] for k, w in enumerate(turning)}
        angles |= {n: angles[lead[n]] for n in castors}
        basis = free_twists(layout, angles)
        twist = basis @ (basis.T @ wish)
        c, s = np.cos(q[2]), np.sin(q[2])
        pose = [c * twist[0] - s * twist[1], s * twist[0] + c * twist[1], twist[2]]
        swivels = [
            oracle.joint_rates(w, twist, angles[w["name"]])[f"{w['name']}.steer_rate"] for w in turning
        ]
        return np.array([*pose, *swivels])

    def end(inputs: Array) -> Array:
        q = np.array([0.0, 0.0, 0.0, *(castors[w["name"]] for w in turning)])
        for wish in inputs.reshape(SEGMENTS, 3):
            for _ in range(STEPS):
                k1 = rate(q, wish)
                k2 = rate(q + h / 2 * k1, wish)
                k3 = rate(q + h / 2 * k2, wish)
                q = q + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(q + h * k3, wish))
        return q[:3]

    h = min((abs(w["d"]) for w in turning), default=0.5) / STEPS
    drive = np.random.default_rng(seed).uniform(-1, 1, 3 * SEGMENTS)
    steps = np.eye(len(drive)) * DIFFERENCE
    return oracle.rank(np.array([(end(drive + e) - end(drive - e)) / (2 * DIFFERENCE) for e in steps]), SEEN)
