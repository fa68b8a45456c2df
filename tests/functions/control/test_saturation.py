"""`turn_first` and `drive_first`: limits kept, the first part as it is wanted, and no more of the second possible."""

from __future__ import annotations

import random

import numpy as np
import pytest

from tests.functions.control.corners import CORNERS, MECANUM, SWERVE, call, derived, robot_text
from tests.functions.refusals import refused
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.registry import Reason

PAIR = """\
  - {name: left, type: fixed, x: 0, y: 0.5, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.5, heading: 0, r: 0.1}"""
LIMITS = "limits: {vx: 1.5, omega: 4, spin: 20}"
FIRST = {"turn_first": ("omega",), "drive_first": ("vx", "vy")}


def fits(d: Derivation, twist: dict[str, float], slack: float) -> bool:
    """Whether limits of twist and spins are kept within a share ``slack``."""
    commands = call(d, "inverse", twist | {f"{n}.steer": 0.0 for n in CORNERS if f"{n}.steer" in present(d)})
    sizes = {"vx": 1.5, "vy": 1.5, "omega": 4.0}
    spins = [abs(commands[f"{w.name}.spin"]) / 20 for w in d.robot.wheels]
    return max([*spins, *(abs(twist[n]) / size for n, size in sizes.items())]) <= 1 + slack


def present(d: Derivation) -> set[str]:
    return {p.name for p in d.formula("inverse").inputs}


@pytest.mark.parametrize("wheels", [SWERVE, MECANUM, PAIR])
@pytest.mark.parametrize("name", FIRST)
def test_the_first_part_is_kept_and_the_rest_is_the_most_that_fits(name: str, wheels: str) -> None:
    d, source, cut = derived(robot_text(wheels, LIMITS), name), random.Random(1), 0
    for _ in range(40):
        wanted = {n: source.uniform(-2, 2) for n in ("vx", "vy", "omega")}
        if wheels == PAIR:
            wanted["vy"] = 0.0
        kept = call(d, name, wanted)
        assert fits(d, kept, 1e-9)
        own = [n for n in wanted if n in FIRST[name]]
        rest = [n for n in wanted if n not in own]
        share = [kept[n] / wanted[n] for n in own if wanted[n]]
        other = [kept[n] / wanted[n] for n in rest if wanted[n]]
        np.testing.assert_allclose(share, share[0])
        np.testing.assert_allclose(other, other[0], atol=1e-12)
        alone = {n: wanted[n] if n in own else 0.0 for n in wanted}
        assert fits(d, alone, 0.0) == (share[0] == pytest.approx(1.0))
        if other[0] < 1 - 1e-9:
            more = {n: kept[n] + (0.01 * wanted[n] if n in rest else 0.0) for n in wanted}
            assert not fits(d, more, 0.0)
            cut += 1
    assert cut > 3


def test_what_has_no_choice_is_named() -> None:
    tricycle = PAIR + "\n  - {name: front, type: steered, x: 0.5, y: 0, heading: 0, r: 0.1}"
    for wheels, reason, names in (
        (tricycle, Reason.CAR, ("limit_twist",)),
        (SWERVE.replace("}", ", offset_y: 0.02}"), Reason.BESIDE_STEERING_AXIS, ("fl", "offset_y")),
    ):
        with refused(reason, *names):
            _ = derived(robot_text(wheels, LIMITS), "turn_first").program
