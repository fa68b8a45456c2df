"""Sentences of the geometry room: they render, name the wheels and the key to write, and have their numbers."""

from __future__ import annotations

import re
from fractions import Fraction

import pytest

from tests.robots import of_text
from wmrgen.errors import RobotFileError
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.expressions import snap
from wmrgen.geometry.layout.records import Near, Tolerance

PAIR = """\
wmrgen: 1
name: r
{head}wheels:
  - {{name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}}
  - {{name: right, type: fixed, x: {x}, y: -0.2, heading: 0, r: {r}}}
"""


def test_a_tolerance_is_given_in_millimetres_with_the_origin_of_the_default() -> None:
    written, default = (str(Tolerance(0.0004, 0.6, is_written)) for is_written in (True, False))
    assert written.endswith("0.4 mm")
    assert default.startswith(written) and "1 mm per metre" in default


@pytest.mark.parametrize("moves", ["", "`right` is moved by 0.4 mm"])
def test_axles_that_nearly_coincide(moves: str) -> None:
    near = Near(
        "the axle lines of `left` and `right` are 0.4 mm apart", "right", 0.0004, 0.0004, "x: 0", moves
    )
    sentence = near.sentence(Tolerance(0.0003, 0.6, True))
    assert sentence.startswith(near.text) and "0.3 mm" in sentence and sentence.endswith(moves)
    assert near.instead in near.remedies and near.remedies.endswith(".")
    assert re.search(r"tolerance: (0|0\.4 mm)\b", near.remedies)


def test_a_note_about_an_angle_differs_between_snapped_and_kept() -> None:
    notes = [snap(Poly.of(Fraction(text)), {}, frozenset(), "a: heading")[1] for text in ("1.57", "1.567")]
    assert all(note and note.startswith("a: heading: ") and "pi/2" in note for note in notes)
    assert "kept" in str(notes[1]) and "kept" not in str(notes[0])


@pytest.mark.parametrize(
    ("head", "x", "r"),
    [
        ("tolerance: -1 mm\n", "0", "0.1"),
        ("deadband: 2\n", "0", "0.1"),
        ("effective_track: 1\n", "0", "-0.1"),
        ("limits: {vx: [1, 0]}\n", "0", "0.1"),
        ("parameters: {a: {value: 1, tunable: true}}\n", "1/(a - 0.95)", "0.1"),
        ("couplings: [{equal: [left.spin, right.spin], ratios: [0, 1]}]\n", "0", "0.1"),
    ],
)
def test_an_error_has_a_place_and_a_remedy(head: str, x: str, r: str) -> None:
    with pytest.raises(RobotFileError) as caught:
        of_text(PAIR.format(head=head, x=x, r=r))
    for error in caught.value.parts:
        assert error.mark and error.instead.endswith(".") and not error.what.endswith(".")
