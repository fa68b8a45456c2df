"""A robot on one axle whose centre of gravity hangs below it, against moments that are summed posture by posture."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import Outcome
from tests.depth import BACKENDS
from tests.functions.common import call, derived, write
from tests.functions.refusals import refused
from wmrgen.functions.registry import Reason

TEXT = """wmrgen: 1
name: two
wheels:
  - {{name: left,  type: fixed, x: {xl}, y: {yl}, heading: {heading}, r: 0.1}}
  - {{name: right, type: fixed, x: {xr}, y: {yr}, heading: {heading}, r: 0.1}}
cg: {{x: {x}, y: {y}, z: {z}}}
"""
R, TRACK = 0.1, 0.45


def two(angle: int = 0, ahead: float = 0.02, side: float = 0.05, z: float = 0.07) -> str:
    """Wheels that roll along ``angle`` [degrees], the centre of gravity ahead of the axle and to the left."""
    c, s = round(math.cos(math.radians(angle)), 15), round(math.sin(math.radians(angle)), 15)

    def at(u: float, v: float) -> tuple[str, str]:
        return repr(0.3 + c * u - s * v), repr(-0.2 + s * u + c * v)

    (xl, yl), (xr, yr), (x, y) = at(0, TRACK / 2), at(0, -TRACK / 2), at(ahead, side)
    return TEXT.format(xl=xl, yl=yl, xr=xr, yr=yr, x=x, y=y, z=z, heading=f"{angle} deg")


def posture(arm: float, f: np.ndarray) -> float | None:
    """The height of the centre of gravity at the stable posture; None without one.

    The body is turned step by step. Its moment is that of the ground's force, which acts at the contact, about the
    centre of gravity: where it changes its sign against the rotation, the body stays.
    """
    turn = np.linspace(-np.pi, np.pi, 200_001)
    x, z = arm * np.sin(turn), R - arm * np.cos(turn)  # a positive turn lifts it forward, from x towards z
    moment = (0 - x) * f[2] - (0 - z) * f[0]  # of the force at (0, 0), in the sense of the turn
    held = np.flatnonzero((moment[:-1] > 0) & (moment[1:] <= 0))
    return float(z[held[0]]) if len(held) else None


@pytest.mark.parametrize("backend", BACKENDS)
def test_forces_that_a_hanging_body_bears(backend: str, tmp_path: Path) -> None:
    path = write(tmp_path, two())
    arm, generator, seen = math.hypot(0.02, 0.03), np.random.default_rng(3), set()
    for _ in range(12):
        f = np.array([*generator.uniform(-1, 1, 2) * (6, 60), 9.81])
        found = call(path, "stability", dict(zip(("fx", "fy", "fz"), map(float, f), strict=True)), backend)
        height = posture(arm, f)
        assert (found["swing.margin"] > 0) == (height is not None)
        seen.add(height is not None)
        if height is not None:
            meets = 0.05 - height * f[1] / f[2]  # the line of the force on the ground, to the left
            assert (found["left.margin"] > 0) == (meets < TRACK / 2)
            assert (found["right.margin"] > 0) == (meets > -TRACK / 2)
            low, high = ((0.05 + k * TRACK / 2) * f[2] / height for k in (-1, 1))
            assert found["fy_min"] == pytest.approx(low, rel=1e-3)
            assert found["fy_max"] == pytest.approx(high, rel=1e-3)
        assert found["margin"] == min(found[f"{n}.margin"] for n in ("left", "right", "swing"))
    assert seen == {True, False}


def test_the_margin_lengthwise_is_the_lean_that_is_left(tmp_path: Path) -> None:
    """asin(d/r) at rest; d/sqrt(r**2 - d**2) of the weight is what the wheels can push."""
    path, d = write(tmp_path, two(ahead=0.0, side=0.0, z=0.06)), 0.04
    rest = call(path, "stability", {"fz": 9.81})
    assert rest["margin"] == pytest.approx(math.asin(d / R), abs=1e-9)
    most = 9.81 * d / math.sqrt(R * R - d * d)
    assert rest["fx_max"] == pytest.approx(most) and rest["fx_min"] == pytest.approx(-most)
    for name in ("right.margin", "left.margin"):
        assert rest[name] == pytest.approx(math.atan2(TRACK / 2, R - d))
    leaning = math.tan(0.1) * 9.81
    assert call(path, "stability", {"fx": -leaning, "fz": 9.81})["margin"] == pytest.approx(
        math.asin(d / R) - 0.1
    )


@pytest.mark.parametrize("angle", [0, 90, 180, 270])
@pytest.mark.parametrize("other", [0.0, 24.0, -24.0, 26.0])
def test_ranges_end_where_the_margin_does(angle: int, other: float, tmp_path: Path) -> None:
    """The rest as given: also where the lean lifts the centre of gravity until the robot tips sideways."""
    path = write(tmp_path, two(angle))
    along, across = ("fx", "fy") if angle % 180 == 0 else ("fy", "fx")
    case = {across: other, "fz": 9.81}
    found = call(path, "stability", case)
    assert found["margin"] > 0
    for end in (found[f"{along}_min"], found[f"{along}_max"]):
        assert call(path, "stability", case | {along: end})["margin"] == pytest.approx(0, abs=1e-6)
        assert call(path, "stability", case | {along: 0.99 * end})["margin"] > 0
    for end in (found[f"{across}_min"], found[f"{across}_max"]):
        assert call(path, "stability", case | {across: end})["margin"] == pytest.approx(0, abs=1e-9)


def test_wheels_that_roll_askew_have_margins_alone(tmp_path: Path) -> None:
    askew, straight = (write(tmp_path, two(angle)) for angle in (30, 0))
    c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
    found = call(askew, "stability", {"fx": c * 2 - s * 9, "fy": s * 2 + c * 9, "fz": 9.81})
    wanted = call(straight, "stability", {"fx": 2.0, "fy": 9.0, "fz": 9.81})
    assert set(found) == {"right.margin", "left.margin", "swing.margin", "margin"}
    assert all(found[n] == pytest.approx(wanted[n], abs=1e-9) for n in found)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (two(z=0.1), Reason.CENTRE_OF_GRAVITY),
        (two(z=0.3), Reason.CENTRE_OF_GRAVITY),
        (two(ahead=0.11), Reason.CENTRE_OF_GRAVITY),
        (two().replace("r: 0.1}", "r: 0.2}", 1), Reason.AXLES),
        (two().replace("heading: 0 deg", "heading: 90 deg"), Reason.NO_POLYGON),
        (two().replace("heading: 0 deg", "heading: 5 deg", 1), Reason.NO_POLYGON),
        (
            two().replace("type: fixed", "type: swedish", 1).replace("r: 0.1}", "r: 0.1, gamma: 0}", 1),
            Reason.NO_POLYGON,
        ),
    ],
    ids=[
        "at the axle",
        "above",
        "as far as the ground",
        "two radii",
        "one behind the other",
        "askew",
        "omni",
    ],
)
def test_what_does_not_hang_is_refused(text: str, reason: Reason, tmp_path: Path) -> None:
    with refused(reason, "stability"):
        derived(write(tmp_path, text), "stability").formula("stability")


def test_the_command_names_what_gives_way(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    path = write(tmp_path, two(ahead=0.0, side=0.0))
    found = json.loads(wmrgen_cli("stability", path, "fx=1", "fz=9.81", "--json").out)
    assert found["about"] == ["right", "left"] and not found["liftoff"] and len(found["edges"]) == 3
    sideways = json.loads(wmrgen_cli("stability", path, "fy=-40", "fz=9.81", "--json").out)
    assert sideways["about"] == ["left", "left"] and sideways["liftoff"]
    assert wmrgen_cli("stability", path, "fx=1", "fz=9.81").code == 0
