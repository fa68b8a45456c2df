"""What a notebook shows of a derivation, and the backends that are called from Python."""

from __future__ import annotations

import inspect
import xml.etree.ElementTree as ET

import pytest

import wmrgen
from tests.conftest import ROOT
from tests.robots import of_gallery
from wmrgen.derivation.facade import Derivation


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


def test_the_formula_has_the_matrices_and_the_degrees(derivation: Derivation) -> None:
    """Siegwart (3.24), (3.26), (3.40) to (3.42)."""
    text = derivation._repr_latex_()
    assert all(f"{name} &= " in text for name in ("J_1", "C_1", "N"))
    assert r"\delta_m &= 2,\quad \delta_s = 0,\quad \delta_M = 2" in text


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("pioneer3dx", "<Derivation pioneer3dx: type (2, 0), 3 wheels>"),
        ("unicycle", "<Derivation unicycle: type (2, 0), 1 wheel>"),
        ("clearpath_a200", "<Derivation clearpath_a200: degenerate, 4 wheels>"),
        ("festo_robotino", "<Derivation festo_robotino: type (3, 0), 3 wheels>"),
    ],
)
def test_a_derivation_says_what_it_is(name: str, said: str) -> None:
    d = of_gallery(name)
    assert repr(d) == said
    assert d._repr_latex_().count("$$") == 2  # also without sliding rows
    assert repr(of_gallery("pioneer3dx").robot) == "<Robot pioneer3dx: 2 fixed, 1 castor>"


def test_no_any_in_what_users_call() -> None:
    """Signatures say what goes in and comes out; ``*args`` says nothing."""
    public = [wmrgen.load, wmrgen.derive]
    public += [
        f for name, f in vars(Derivation).items() if inspect.isfunction(f) and not name.startswith("_")
    ]
    for function in public:
        signature = inspect.signature(function)
        assert "Any" not in str(signature), function
        assert all(p.kind is not p.VAR_POSITIONAL for p in signature.parameters.values()), function
        assert signature.return_annotation is not signature.empty, function


def test_backends_are_called_by_name(derivation: Derivation) -> None:
    inverse = derivation.casadi()["inverse"]
    twist = {"vx": 0.5, "vy": 0.0, "omega": 1.0, "tail.steer": 0.25}
    symbols = inverse(**twist)
    numbers = derivation.numpy().inverse(**{name.replace(".", "_"): value for name, value in twist.items()})
    assert float(numbers["left.spin"]) == pytest.approx(float(symbols["left.spin"]), rel=1e-15)
