"""Admissible twists of robots whose couplings leave a line or a cone of twists."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import wmrgen
from wmrgen.analysis.mobility.admissible import components


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


@pytest.mark.parametrize("signs", [(1, 1, -1), (-1, -1, 1), (1, -1, -1), (-1, 1, 1)])
def test_a_cone_is_a_twist_of_the_form_and_its_tangent_plane(signs: tuple[int, int, int]) -> None:
    """In turned axes, with unequal curvatures: the point solves the equation, the tangent is across its gradient."""
    random = np.random.default_rng(7)
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    form = turn @ np.diag(np.array(signs) * (0.3, 1.1, 2.7)) @ turn.T
    (cone,) = components(np.zeros((0, 3)), [form])
    assert not cone.linear and cone.dimension == 2 and len(cone.tangent) == 2
    assert abs(cone.sample @ form @ cone.sample) < 1e-12 < np.linalg.norm(cone.sample)
    assert np.abs(cone.tangent @ form @ cone.sample).max() < 1e-12


@pytest.mark.parametrize("sign", [1, -1])
def test_a_definite_form_has_no_twist_but_rest(sign: int) -> None:
    assert components(np.zeros((0, 3)), [sign * np.diag((0.3, 1.1, 2.7))]) == []
