"""Couplings of two files: which joints turn together, in which ratio, and what commands become by them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import Outcome
from tests.tools.comparing.test_motion import said
from tests.tools.importing.urdf import robot, wheel
from wmrgen.derivation.emit import artifacts
from wmrgen.tools.comparing.compare import compare
from wmrgen.tools.comparing.record import Comparison, Layout
from wmrgen.tools.comparing.sources import layouts, of_header

CORNERS = {"fl": (0.3, 0.25), "fr": (0.3, -0.25), "rl": (-0.3, 0.25), "rr": (-0.3, -0.25)}
BELTS = "{equal: [fl.spin, rl.spin]} {equal: [fr.spin, rr.spin]}"


def layout(folder: Path, couplings: str, backward: str = "", type_: str = "fixed") -> Layout:
    lines = [
        f"  - {{name: {n}, type: {type_}, x: {x}, y: {y}, heading: {'pi' if n == backward else 0}, r: 0.1}}\n"
        for n, (x, y) in CORNERS.items()
    ]
    own = "".join(f"  - {{equal:{each}\n" for each in couplings.split("{equal:")[1:])
    path = folder / f"r{len(list(folder.iterdir()))}.yaml"
    path.write_text(
        f"wmrgen: 1\nname: probe\nwheels:\n{''.join(lines)}" + (f"couplings:\n{own}" if own else ""),
        encoding="utf-8",
    )
    (result,) = layouts(path)
    return result


def told(c: Comparison) -> list[tuple[str, object, object]]:
    return [(d.wheel, d.a, d.b) for d in c.differences if d.code == "WMR051"]


@pytest.mark.parametrize(
    ("a", "b", "backward", "expected"),
    [
        (BELTS, BELTS, "", []),
        (BELTS, "{equal: [rr.spin, fr.spin]} {equal: [rl.spin, fl.spin]}", "", []),
        (BELTS, "", "", [("fl", "1 : 1", None), ("fr", "1 : 1", None)]),
        ("", "{equal: [fl.spin, rl.spin], ratios: [1, 2]}", "", [("fl", None, "1 : 2")]),
        (BELTS.replace("rl.spin]", "rl.spin], ratios: [4, 1]"), BELTS, "", [("fl", "1 : 0.25", "1 : 1")]),
        # A wheel whose joint counts the other way turns with the opposite sign.
        ("{equal: [fl.spin, rl.spin]}", "{equal: [fl.spin, rl.spin], ratios: [1, -1]}", "rl", []),
        ("{equal: [fl.spin, rl.spin]}", "{equal: [fl.spin, rl.spin]}", "rl", [("fl", "1 : 1", "1 : -1")]),
        # Through a third wheel: the same shaft, said in other pairs.
        (
            "{equal: [fl.spin, rl.spin, fr.spin], ratios: [1, 2, 6]}",
            "{equal: [fr.spin, rl.spin], ratios: [3, 1]} {equal: [fl.spin, rl.spin], ratios: [1, 2]}", "", [],
        ),
    ],
)  # fmt: skip
def test_couplings_are_compared(
    tmp_path: Path, a: str, b: str, backward: str, expected: list[object]
) -> None:
    assert told(compare(layout(tmp_path, a), layout(tmp_path, b, backward))) == expected


def test_what_turns_together_through_others(tmp_path: Path) -> None:
    own = layout(
        tmp_path,
        "{equal: [fl.spin, fr.spin], ratios: [1, 2]} {equal: [rl.spin, rr.spin]} "
        "{equal: [fr.spin, rl.spin], ratios: [1, 5]}",
    )
    (shaft,) = own.ties or ()
    assert (shaft.joint, len(shaft.marks)) == ("spin", 3)
    assert shaft.turns == {"fl": 1, "fr": 2, "rl": 10, "rr": 10}


def test_what_a_coupling_does_to_the_motion(tmp_path: Path) -> None:
    free, belts = layout(tmp_path, ""), layout(tmp_path, BELTS)
    assert said(compare(belts, free)) == said(compare(free, belts)) == {}  # the belts give what is commanded
    solid = layout(tmp_path, "{equal: [fl.spin, fr.spin]} {equal: [rl.spin, rr.spin]}")
    assert said(compare(free, solid))["turn"].startswith("does not turn, drives ahead or back")
    assert [e.motion for e in compare(solid, free).effects] == ["straight"]  # which it cannot do at all
    geared = layout(tmp_path, BELTS.replace("rl.spin]", "rl.spin], ratios: [1, 2]"))
    assert "wheels work against each other" in said(compare(free, geared))["straight"]


def test_steering_in_common(tmp_path: Path) -> None:
    """Straight on, modules that one motor steers do what is commanded; a curve would need unlike angles."""
    synchro = layout(tmp_path, "{equal: [fl.steer, fr.steer, rl.steer, rr.steer]}", type_="steered")
    free = layout(tmp_path, "", type_="steered")
    assert told(compare(synchro, free)) == [("fl", "1 : 1 : 1 : 1", None)]
    words = said(compare(free, synchro))
    assert words.keys() == {"turn"} and "wheels work against each other" in words["turn"]


def test_mimic_joints_against_a_robot_file(wmrgen_cli: Callable[..., Outcome], tmp_path: Path) -> None:
    text = robot(
        *(
            wheel(n, f"{x} {y} 0.1", more=f'<mimic joint="fl_joint" multiplier="{k}"/>' if n == "rl" else "")
            for n, (x, y) in CORNERS.items()
            for k in ("2.5",)
        )
    )
    (tmp_path / "probe.urdf").write_text(text, encoding="utf-8")
    for ratio, equal in (("2.5", True), ("2", False)):
        own = layout(tmp_path, f"{{equal: [fl.spin, rl.spin], ratios: [1, {ratio}]}}")
        done = wmrgen_cli("compare", tmp_path / "probe.urdf", own.file, "--json")
        (comparison,) = json.loads(done.out)["comparisons"]
        assert comparison["equal"] is equal
        if not equal:
            (difference,) = comparison["differences"]
            assert (difference["code"], difference["a"], difference["b"]) == ("WMR051", "1 : 2.5", "1 : 2")
            assert difference["words"] == "fl.spin, rl.spin turn 1 : 2.5 -> 1 : 2"
            assert difference["marks"][0]["file"] == own.file
            assert (
                "WMR051  fl.spin, rl.spin turn"
                in wmrgen_cli("compare", tmp_path / "probe.urdf", own.file).out
            )


def test_a_header_says_nothing_of_couplings(tmp_path: Path) -> None:
    own = layout(tmp_path, BELTS)
    header = of_header(artifacts(wmrgen.derive(wmrgen.load(Path(own.file))))["probe.h"].decode(), "probe.h")
    assert not compare(own, header).differences and said(compare(own, header)) == {}
