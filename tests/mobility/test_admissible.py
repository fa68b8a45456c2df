"""Twists that a robot admits where wheels agree on a line or at a point alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import wmrgen
from wmrgen.mobility.admissible import components


def test_wheels_that_only_one_motion_suits(tmp_path: Path) -> None:
    """Both wheels at P, of one speed and different radii: the rim speeds agree where P stands still."""
    path = tmp_path / "robot.yaml"
    wheels = [f"{{name: {n}, type: steered, x: 0, y: 0, heading: {h}, r: {r}}}" for n, h, r in
              (("a", 0, 0.17), ("b", 0.7, 0.16))]  # fmt: skip
    listed = "\n  - ".join(wheels)
    path.write_text(
        f"wmrgen: 1\nname: robot\nwheels:\n  - {listed}\ncouplings:\n  - equal: [a.spin, b.spin]\n",
        encoding="utf-8",
    )
    assert wmrgen.derive(wmrgen.load(path)).mobility.degree_of_mobility == 1


def test_semidefinite_forms_vanish_on_a_line() -> None:
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    first, second, other = (
        turn @ np.diag(d) @ turn.T for d in ((2.0, 1.0, 0.0), (1.0, 3.0, 0.0), (1.0, 1.0, 1.0))
    )
    for forms in ([first], [first, second], [-first, first]):
        (line,) = components(np.zeros((0, 3)), forms)
        assert line.dimension == 1 and np.abs(np.cross(line.sample, turn[:, 2])).max() < 1e-9
    assert components(np.zeros((0, 3)), [first, other]) == []
