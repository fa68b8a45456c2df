"""What the templates of the Arduino library print of a robot: its keywords and the loop of its sketch."""

from __future__ import annotations

from collections.abc import Mapping

from wmrgen.backends.packages.loop import loop
from wmrgen.interface import members
from wmrgen.ir.nodes import Module


def context(module: Module, scalar: str) -> Mapping[str, object]:
    """``types`` and ``functions`` for the editor; ``variables`` and statements of the loop, without covariances, which
    nobody reads there."""
    steps = loop(module, scalar, covariances=False)
    return {
        "types": [f"{module.name}_{kind}" for kind in members(module)],
        "functions": [f"{module.name}_{f.name}" for f in module.functions if f.outputs],
        "variables": list(steps.variables.items()),
        "prepare": [f"{call.text()};" for call in steps.prepare],
        "step": [f"{call.text()};" for call in (*steps.sense, *steps.act)],
    }
