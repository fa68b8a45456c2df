"""The picture of a calibration: curves fill their frames, and dots are in the middle of their intervals."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from wmrgen.tools.calibration.observability import Estimate
from wmrgen.tools.calibration.picture import _ERRORS, _PATHS, _errors, _key, _paths, _values, picture


def svg(elements: Any) -> ElementTree.Element:
    return ElementTree.fromstring(f"<svg>{''.join(elements)}</svg>")


def line_of(count: int) -> Any:
    """Return odometry that goes off a reference, both along one line, its error growing with time."""
    share = np.linspace(0, 1, count)
    return SimpleNamespace(
        t=5 + 2 * share, distance=0.3 * share, seen=(4 + 3j) * share, place=(4 + 3j) * share
    )


@pytest.mark.parametrize("count", [2, 299, 300, 1000])
def test_curves_fill_their_frames(count: int) -> None:
    """From the lower left to the upper right corner, paths with one scale for both axes, of at most 600 points."""
    d = line_of(count)
    left, _, _, bottom = _PATHS
    scale = min(_PATHS[2] - left, bottom - _PATHS[1]) / 4
    for drawn, (x0, y1, x1, y0) in (
        (_errors([d], [d]), _ERRORS),
        (_paths([d], [d]), (left, bottom - 3 * scale, left + 4 * scale, bottom)),
    ):
        for curve in svg(drawn).iter("polyline"):
            x, y = np.array([[*map(float, p.split(","))] for p in curve.attrib["points"].split()]).T
            assert len(x) <= 600 and (x[0], y[0]) == (x0, y0)
            assert x[-1] == pytest.approx(x1, abs=2) and y[-1] == pytest.approx(y1, abs=2)
            assert (x - x0) / (x1 - x0) == pytest.approx((y0 - y) / (y0 - y1), abs=0.01)


def test_each_estimate_is_in_the_middle_of_its_interval() -> None:
    """The change from nominal to scale: 5 % is half of 10 %, to the other side for a parameter that got smaller."""
    estimates = {"a": Estimate(1.1, 0.001, 1.0, True), "b": Estimate(1.9, 0.001, 2.0, True)}
    drawn = svg(_values(estimates))
    dots = [float(e.attrib["cx"]) for e in drawn.iter("circle")]
    (axis, *intervals) = [(float(e.attrib["x1"]), float(e.attrib["x2"])) for e in drawn.iter("line")]
    assert dots == pytest.approx([sum(ends) / 2 for ends in intervals], abs=0.1)
    assert dots[0] - axis[0] == pytest.approx(-2 * (dots[1] - axis[0]), abs=0.1)


def test_the_key_has_a_dash_before_each_word() -> None:
    drawn = svg(_key())
    dashes = [[float(p.split(",")[0]) for p in e.attrib["points"].split()] for e in drawn.iter("polyline")]
    words = [float(e.attrib["x"]) for e in drawn.iter("text")]
    assert [b - a for a, b in dashes] == [30] * 3
    assert [w - b for (_, b), w in zip(dashes, words, strict=True)] == [6] * 3


def test_a_whole_picture() -> None:
    """Two logs: a reference, and paths and errors before and after of each; words of 12 px are 10 px high at 400."""
    d = line_of(50)
    estimates = {"a": Estimate(1.1, None, 1.0, False), "zero": Estimate(0.02, 0.001, 0.0, True)}
    whole = ElementTree.fromstring(picture([d, d], [d, d], estimates))
    curves = [e.get("class") for e in whole.iter("{http://www.w3.org/2000/svg}polyline")]
    assert [curves.count(name) for name in ("reference", "before", "after")] == [1 + 2, 1 + 4, 1 + 4]
    assert {"a", "zero"} <= {e.text for e in whole.iter("{http://www.w3.org/2000/svg}text")}
    assert float((whole.get("viewBox") or "").split()[2]) <= 480


def test_a_picture_without_whole_poses() -> None:
    nothing = SimpleNamespace(
        t=np.zeros(0), distance=np.zeros(0), seen=np.zeros(0, complex), place=np.zeros(0, complex)
    )
    whole = ElementTree.fromstring(picture([nothing], [nothing], {"a": Estimate(1.1, 0.01, 1.0, True)}))
    assert len(list(whole.iter("{http://www.w3.org/2000/svg}polyline"))) == 3  # the key's
