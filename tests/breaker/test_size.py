"""`--size` on layouts whose repeated parts overlap: two places of one part shared a call of another."""

from __future__ import annotations

from pathlib import Path

import pytest

import wmrgen
from tests.depth import everyday
from wmrgen.ir.inline import hand_through
from wmrgen.ir.kernels import expand
from wmrgen.ir.nodes import Op
from wmrgen.ir.outline import outline, sizes
from wmrgen.ir.outline.undo import calls

ROBOT = """
wmrgen: 1
name: overlapping
parameters: {len10: 14.2 mm, a1: 0.0120, wb2: 0.0109}
wheels:
  - {name: w0, type: spherical, x: len10/2, y: 0.024, r: 0.0027}
  - {name: w1, type: swedish, l: a1*sqrt(2)/2, alpha: -31.2 deg, beta: 0.785, r: a1, gamma: 0.01}
  - {name: w2, type: steered, l: -len10, alpha: 1.36, beta: 0, r: 4.6 mm, actuated: [spin, steer]}
  - {name: w3, type: steered, x: wb2, y: -len10, heading: pi/11, r: sqrt(2)*0.006, actuated: [steer]}
"""


@pytest.mark.parametrize("target", everyday(["m4f", "host", "m0", "avr"], ["m4f"]))
def test_every_call_has_its_part(target: str, tmp_path: Path) -> None:
    path = tmp_path / "overlapping.yaml"
    path.write_text(ROBOT)
    module = hand_through(wmrgen.derive(wmrgen.load(path)).c_module)
    made = outline(expand(module, "float", "inline", target, small=True).functions, "part", sizes(target))
    used = calls([node for f in (*made.functions, *made.parts) for node in f.nodes])
    assert used.keys() == {part.name for part in made.parts}
    assert not any(node.op is Op.CALL for part in made.parts for node in part.nodes)
