"""Every choice, root and size of `inverse_together` matters: without it some input gives other results."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from tests.functions.control.corners import CORNERS, SWERVE, derived, robot_text
from wmrgen.ir.calls import inlined_calls
from wmrgen.ir.interpret import values_of
from wmrgen.ir.nodes import Function, Op, pruned

POINTS = 4_000
_TAKEN = {
    Op.SELECT: (2, 3),
    Op.MIN: (0, 1),
    Op.MAX: (0, 1),
    Op.SQRT: (0,),
    Op.ABS: (0,),
}  # what may stand for it


def inputs() -> dict[str, np.ndarray]:
    """Twists of every kind: also none, and such as leave a wheel where it stands."""
    source = np.random.default_rng(14)
    vx, vy, omega = (source.uniform(-2, 2, POINTS) for _ in range(3))
    still = source.integers(0, 4 * len(CORNERS), POINTS)
    for k, (a, b) in enumerate(CORNERS.values()):
        vx[still == k], vy[still == k] = (0.25 * b * omega)[still == k], (-0.3 * a * omega)[still == k]
    for v in (vx, vy, omega):
        v[still == len(CORNERS)] = 0.0
    values = {"vx": vx, "vy": vy, "omega": omega}
    return values | {f"{n}.steer": source.uniform(-12, 12, POINTS) for n in CORNERS}


def idle(function: Function) -> Iterator[str]:
    """Operations in whose place one of their arguments does."""
    at = inputs()
    whole = [values_of(function, at, np.float64)[r] for r in function.results]
    for i, node in enumerate(function.nodes):
        for k in _TAKEN.get(node.op, ()):
            instead = [node.args[k] if j == i else j for j in range(len(function.nodes))]
            nodes = tuple(n._replace(args=tuple(instead[a] for a in n.args)) for n in function.nodes)
            without = replace(function, nodes=nodes, results=tuple(instead[r] for r in function.results))
            values = values_of(without, at, np.float64)
            if all(
                np.allclose(values[r], w, 1e-9, 1e-9) for r, w in zip(without.results, whole, strict=True)
            ):
                yield f"{i} {node.op.name}: argument {k} of {node.args} does"


@pytest.mark.parametrize("limits", ["", "limits: {steer: [-1.6, 1.9]}", "limits: {steer: 200 deg}"])
def test_of_a_swerve_drive(limits: str) -> None:
    d = derived(robot_text(SWERVE, limits), "inverse_together")
    function = pruned(inlined_calls(d.c_module).function("inverse_together"))
    assert sum(node.op in _TAKEN for node in function.nodes) > 12
    assert list(idle(function)) == []
