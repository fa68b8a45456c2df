"""What a notebook shows of a derivation, and the backends that are called from Python."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import pytest

from tests.conftest import ROOT
from tests.robots import of_gallery
from wmrgen.robot import Derivation


@pytest.fixture(scope="module")
def derivation() -> Derivation:
    return of_gallery("pioneer3dx")


def test_the_picture_is_that_of_the_files(derivation: Derivation) -> None:
    picture = derivation._repr_svg_()
    assert ET.fromstring(picture).tag.endswith("svg")
    assert picture == (ROOT / "generated" / "pioneer3dx" / "layout.svg").read_text(encoding="utf-8")


def test_the_formula_is_the_null_space(derivation: Derivation) -> None:
    rows = " \\\\ ".join(" & ".join(str(entry) for entry in row) for row in derivation.null_space.tolist())
    assert rows in derivation._repr_latex_().replace("\\\\", " \\\\ ")


def test_backends_are_called_by_name(derivation: Derivation) -> None:
    inverse = derivation.casadi()["inverse"]
    twist = {"vx": 0.5, "vy": 0.0, "omega": 1.0, "tail.steer": 0.25}
    symbols = inverse(**twist)
    numbers = derivation.numpy().inverse(**{name.replace(".", "_"): value for name, value in twist.items()})
    assert float(numbers["left.spin"]) == pytest.approx(float(symbols["left.spin"]), rel=1e-15)
