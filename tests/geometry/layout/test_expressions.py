"""Snapping of angles: which angles are snapped, which are kept, and how a note names the multiple of pi/12."""

from __future__ import annotations

import math
import re
from fractions import Fraction

import pytest

from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.expressions import PI, snap

NONE: frozenset[str] = frozenset()
TEXTS = {
    0: "0", 1: "pi/12", 2: "pi/6", 3: "pi/4", 4: "pi/3", 5: "5*pi/12", 6: "pi/2", 8: "2*pi/3", 9: "3*pi/4", 12: "pi",
    18: "3*pi/2", 24: "2*pi", 36: "3*pi", -1: "-pi/12", -6: "-pi/2", -9: "-3*pi/4", -12: "-pi", -24: "-2*pi",
}  # fmt: skip


def near(k: int, error: str) -> Poly:
    """So many twelfths of pi, to eight decimals, and an error [rad]."""
    return Poly.of(Fraction(f"{k * math.pi / 12:.8f}") + Fraction(error))


@pytest.mark.parametrize("k", TEXTS)
@pytest.mark.parametrize("side", ["", "-"])
def test_an_angle_near_a_multiple_is_snapped(k: int, side: str) -> None:
    angle, note = snap(near(k, f"{side}0.0005"), {}, NONE, "left: heading")
    assert angle == PI.scale(Fraction(k, 12))
    assert note is not None and note.startswith("left: heading: ")
    assert re.search(rf"(?<![\w*-]){re.escape(TEXTS[k])}(?![\w/*])", note) and "0.0005 rad" in note


@pytest.mark.parametrize("k", TEXTS)
@pytest.mark.parametrize("side", ["", "-"])
def test_both_sides_of_the_thresholds(k: int, side: str) -> None:
    notes = []
    for error, snapped in (("0.00199", True), ("0.00201", False), ("0.0049", False)):
        angle, note = snap(near(k, side + error), {}, NONE, "x")
        assert note is not None and TEXTS[k] in note
        assert angle == (PI.scale(Fraction(k, 12)) if snapped else near(k, side + error))
        notes.append(re.sub(r"[\d.]+", "", note))
    assert notes[0] != notes[1] == notes[2]  # different words for a snapped angle
    far = near(k, f"{side}0.0051")
    assert snap(far, {}, NONE, "x") == (far, None)


def test_what_is_exact_and_what_is_tunable_stays() -> None:
    for k in TEXTS:
        exact = PI.scale(Fraction(k, 12))
        assert snap(exact, {}, NONE, "x") == (exact, None)
    a = Poly.gen("param", "a")
    values = {"a": Poly.of(Fraction("1.5705"))}
    assert snap(a, values, frozenset("a"), "x") == (a, None)
    assert snap(a, values, NONE, "x")[0] == PI.scale(Fraction(1, 2))
    seventh = PI.scale(Fraction(1, 7))
    assert snap(seventh, {}, NONE, "x") == (seventh, None)
    assert snap(a, {"a": PI.scale(Fraction(1, 4))}, NONE, "x") == (a, None)
    assert snap(PI.scale(Fraction("0.2501")), {}, NONE, "x")[0] == PI.scale(Fraction(1, 4))
