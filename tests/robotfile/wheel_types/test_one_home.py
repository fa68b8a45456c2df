"""Only `wmrgen.robotfile.wheel_types` uses the name of a wheel type."""

from __future__ import annotations

import ast

import pytest

from tests.conftest import ROOT
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, Glyph, WheelType, Words, register

PACKAGE = ROOT / "wmrgen"
ELSEWHERE = [p for p in sorted(PACKAGE.rglob("*.py")) if "wheel_types" not in p.parts]
NAMES = ("fixed", "steered", "castor", "swedish", "spherical")


def named(source: str) -> list[int]:
    """Lines with a string that is the name of a wheel type."""
    return [
        node.lineno
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Constant) and node.value in NAMES
    ]


def test_the_types_are_these() -> None:
    assert tuple(WHEEL_TYPES) == NAMES
    assert all(name == kind.name for name, kind in WHEEL_TYPES.items())


def test_no_module_elsewhere_names_a_wheel_type() -> None:
    assert named('w.type == "fixed"') == [1] and named('WIDTH = {\n"castor": 3}') == [2]
    places = [
        f"{p.relative_to(ROOT)}:{line}" for p in ELSEWHERE for line in named(p.read_text(encoding="utf-8"))
    ]
    assert places == []


# The five types in Siegwart's table: (rolls about an axle, steers, swivels, has rollers, constrains the twist,
# constrains it by an axle that is fixed in the body).
SIEGWART = {
    "fixed": (True, False, False, False, True, True),
    "steered": (True, True, False, False, True, False),
    "castor": (True, True, True, False, False, False),
    "swedish": (True, False, False, True, False, False),
    "spherical": (False, False, False, False, False, False),
}


@pytest.mark.parametrize("name", NAMES)
def test_properties_of_the_five_types(name: str) -> None:
    kind = WHEEL_TYPES[name]
    facts = (kind.has_spin, kind.turns, kind.swivels, kind.rollers, kind.constrains, kind.fixed_axle)
    assert facts == SIEGWART[name]
    assert kind.steers == (name == "steered")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"name": "fixed"}, "there is a wheel type fixed already"),
        ({"joints": ("spin", "steer"), "sliding_row": False}, "needs a sliding row"),
        ({"joints": ("steer",)}, "joint spin"),
        ({"actuated": ("steer",)}, "joints are"),
        ({"required": ()}, "needs r among its required keys"),
        ({"joints": ("spin", "steer"), "keys": ("d",)}, "d among its required keys"),
        ({"required": ("r", "d")}, "steering axis"),
        ({"keys": ("offset_y",)}, "steering axis"),
        ({"keys": ("gamma",)}, "slides across them"),
        ({"required": ("r", "gamma")}, "slides across them"),
        ({"sliding_row": False}, "words.free must say"),
    ],
)
def test_contradictory_types_are_refused(change: dict[str, object], words: str) -> None:
    before = tuple(WHEEL_TYPES)
    whole = {
        "name": "new", "meaning": "", "noun": "new wheel", "joints": ("spin",), "required": ("r",)
    } | change  # fmt: skip
    with pytest.raises(ValueError, match=words):
        register(WheelType(words=Words(""), glyph=Glyph("#000000"), **whole))  # type: ignore[arg-type]
    assert tuple(WHEEL_TYPES) == before
