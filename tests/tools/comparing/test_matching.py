"""Which wheel is which: by name, by what names say, by place; what is only noted, and what is not known."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from tests.tools.comparing.test_corpus import mecanum, ring, side
from tests.tools.comparing.test_motion import differential, said
from wmrgen.errors import RobotFileError
from wmrgen.tools.comparing.compare import compare, findings, labelled
from wmrgen.tools.comparing.differences import length
from wmrgen.tools.comparing.matching import matched
from wmrgen.tools.comparing.record import Layout, Side
from wmrgen.tools.comparing.sources import layouts, of_header

PLACES = {
    "front left": (0.2, 0.1),
    "front right": (0.2, -0.1),
    "rear left": (-0.2, 0.1),
    "rear right": (-0.2, -0.1),
}


def four(*names: str) -> list[Side]:
    return [side(name, "fixed", *at) for name, at in zip(names, PLACES.values(), strict=True)]


def partners(a: list[Side], b: list[Side]) -> dict[str, str]:
    pairs, left, over = matched(a, b)
    assert not left and not over
    return {v.name: w.name for v, w in pairs}


def test_names_come_first_then_what_they_say_then_places() -> None:
    a = four("fl", "fr", "rl", "rr")
    for names in (
        ("FL", "FR", "RL", "RR"),
        ("front_left_wheel_joint", "rightFront", "back_left", "wheel_rear_right"),
    ):
        assert partners(a, four(*names)[::-1]) == dict(zip(("fl", "fr", "rl", "rr"), names, strict=True))
    numbered = four("w1", "w2", "w3", "w4")
    assert partners(a, numbered[::-1]) == {"fl": "w1", "fr": "w2", "rl": "w3", "rr": "w4"}
    swapped = four("fr", "fl", "rl", "rr")  # a name counts more than the place
    assert partners(a, swapped) == {"fl": "fl", "fr": "fr", "rl": "rl", "rr": "rr"}
    joints = [
        replace(w, names=(f"w{k}", joint))
        for k, (w, joint) in enumerate(zip(numbered, ("a", "b", "c", "d"), strict=True))
    ]
    others = [
        replace(w, names=(f"v{k}", joint))
        for k, (w, joint) in enumerate(zip(numbered, ("d", "c", "b", "a"), strict=True))
    ]
    assert partners(joints, others) == {"w0": "v3", "w1": "v2", "w2": "v1", "w3": "v0"}


def test_two_of_one_side_are_told_apart_by_place() -> None:
    a = [*four("l1", "r1", "l2", "r2"), side("left_ball", "spherical", 0.3, 0)]
    pairs, left, over = matched(a, four("left_a", "right_a", "left_b", "right_b"))
    assert {v.name: w.name for v, w in pairs} == {
        "l1": "left_a",
        "r1": "right_a",
        "l2": "left_b",
        "r2": "right_b",
    }
    assert [w.name for w in left] == ["left_ball"] and not over


def test_wheels_that_leave_the_motion_free_are_noted() -> None:
    a = differential(0.4)
    ball = replace(a, wheels=(*a.wheels, side("tail", "castor", -0.3, 0, d=-0.04)))
    for first, second in ((a, ball), (ball, a)):
        result = compare(first, second)
        assert not result.differences and "tail" in result.notes[0]
    driven = replace(a, wheels=(*a.wheels, replace(ball.wheels[-1], actuated=("spin",))))
    assert [d.code for d in compare(a, driven).differences] == ["WMR048"]


def test_order_counts_where_both_files_have_one() -> None:
    a = replace(differential(0.4), ordered=True)
    b = replace(a, wheels=a.wheels[::-1])
    result = compare(a, b)
    assert [(d.code, d.a, d.b) for d in result.differences] == [("WMR047", "left right", "right left")]
    assert said(result) == {}
    assert result.notes == ("wheels taken by number, not by name: turns the wrong way",)
    assert not compare(a, replace(b, ordered=False)).differences


def test_order_of_an_array_of_joints(tmp_path: Path) -> None:
    path = tmp_path / "p.yaml"
    path.write_text("omni: {wheel_names: [w0, w2, w1], robot_radius: 0.2, wheel_radius: 0.1}\n")
    robot = replace(ring((0.2,) * 3), ordered=True)
    assert [d.code for d in compare(robot, *layouts(path)).differences] == ["WMR047"]
    assert not compare(replace(robot, ordered=False), *layouts(path)).differences
    path.write_text("omni: {wheel_names: [w0, w1, w2], robot_radius: 0.2, wheel_radius: 0.1}\n")
    assert not compare(robot, *layouts(path)).differences
    path.write_text(
        "diff_drive: {left_wheel_names: [left], right_wheel_names: [right], wheel_separation: 0.4}\n"
    )
    pair = differential(0.4)  # whose joints have their sides: their order tells nothing
    for wheels in (pair.wheels, pair.wheels[::-1]):
        assert not compare(replace(pair, wheels=wheels, ordered=True), *layouts(path)).differences


def test_motion_is_not_guessed() -> None:
    m = mecanum(0.5, 0.3, 0.1)
    silent = [replace(w, values={k: v for k, v in w.values.items() if k != "gamma"}) for w in m.wheels]
    unknown = Layout("seen", "description", tuple(silent))
    wider = mecanum(0.5, 0.4, 0.1)
    result = compare(unknown, Layout("other", "description", tuple(replace(w) for w in silent)))
    assert not result.effects and "rollers" in result.notes[0]
    assert compare(unknown, wider).effects == compare(m, wider).effects  # the other file says it
    bare = [
        replace(w, values={k: v for k, v in w.values.items() if k != "r"}) for w in differential(0.4).wheels
    ]
    small = differential(0.4, r=0.05)
    assert not compare(Layout("bare", "description", tuple(bare)), small).differences


def test_names_that_contradict_places() -> None:
    assert [f.code for f in labelled(Layout("f", "description", tuple(four("fr", "fl", "rl", "rr"))))] == [
        "WMR011"
    ] * 2
    assert not list(labelled(Layout("f", "description", tuple(four("fl", "fr", "rl", "rr")))))
    twins = [
        side(f"module_{s}", "steered", 0.2, 0.1, offset_y=o) for s, o in (("left", 0.05), ("right", -0.05))
    ]
    assert not list(labelled(Layout("f", "description", (*twins, side("rear", "fixed", -0.2, -0.1)))))


def test_what_has_no_place_is_told_at_the_beginning_of_its_file() -> None:
    """As of a description that xacro has written anew."""
    a, b = (
        Layout("a", "description", tuple(four("fl", "fr", "rl", "rr"))),
        tuple(four("fr", "fl", "rr", "rl")),
    )
    other = Layout("b", "description", (*b, side("more", "fixed", 0.0, 0.3)))
    told = [*labelled(other), *findings(compare(a, other))]
    assert {f.code for f in told} == {"WMR011", "WMR044", "WMR048"}
    assert {(f.mark.file, f.mark.line, f.mark.column) for f in told if f.mark} == {("b", 1, 1)}


def test_a_name_that_fits_two_wheels_leaves_it_to_the_place_and_the_type() -> None:
    (pair,), left, _ = matched(four("left_1", "r1", "left_2", "r2"), [side("left", "fixed", -0.2, 0.1)])
    assert pair[0].name == "left_2" and len(left) == 3
    ((_, other),), _, _ = matched(
        [side("x1", "fixed", 0, 0)], [side("y1", "castor", 0, 0), side("y2", "fixed", 0.3, 0)]
    )
    assert other.name == "y2"


def test_contact_of_a_castor_that_follows_and_of_one_that_drives() -> None:
    base = differential(0.4).wheels

    def with_tail(d: float, actuated: tuple[str, ...] | None, offset: float = 0) -> Layout:
        tail = replace(side("tail", "castor", -0.3, 0, d=d, offset_y=offset), actuated=actuated)
        return Layout("", "description", (*base, tail))

    assert not compare(with_tail(-0.04, None), with_tail(0.04, None)).differences  # it swings round
    assert [d.code for d in compare(with_tail(-0.04, None), with_tail(-0.05, None)).differences] == ["WMR050"]
    driven = ("spin", "steer")
    assert [d.code for d in compare(with_tail(-0.04, driven), with_tail(0.04, driven)).differences] == [
        "WMR050"
    ]
    steered = [
        Layout("", "d", (*base, side("front", "steered", 0.5, 0, offset_y=o))) for o in (0, 5e-7, 5e-6)
    ]
    assert not compare(*steered[:2]).differences
    assert [d.code for d in compare(steered[0], steered[2]).differences] == ["WMR050"]


def test_a_sign_is_told_from_a_heading() -> None:
    a = differential(0.4)
    (d,) = compare(a, differential(0.4, right=math.pi - 1e-3)).differences
    assert (d.quantity, d.wheel) == ("sign", "right")
    (d,) = compare(a, differential(0.4, right=0.1)).differences
    assert (d.quantity, d.wheel) == ("heading", "right")


def test_the_radius_of_a_side_counts_before_that_of_all(tmp_path: Path) -> None:
    path = tmp_path / "p.yaml"
    path.write_text("drive: {left_wheel_radius: 0.05, wheel_radius: 0.2, wheel_separation: 0.4}\n")
    result = compare(differential(0.4), *layouts(path))
    assert [d.quantity for d in result.differences] == ["left radius", "radius"]
    straight = next(e for e in result.effects if e.motion == "straight")
    assert straight.ratio == pytest.approx((0.1 / 0.05 + 0.1 / 0.2) / 2)


@pytest.mark.parametrize(("driven", "radius"), [("rear", 0.45), ("front", 0.5), ("", 0.475)])
def test_the_radius_of_a_controller_is_that_of_the_wheels_that_are_driven(
    tmp_path: Path, driven: str, radius: float
) -> None:
    """Of a lorry whose front wheels are larger; of one that does not say which are, all."""
    motors: dict[str, dict[str, tuple[str, ...]]] = {
        "rear": {"rear": ("spin",), "front": ("steer",)}, "front": {"rear": (), "front": ("spin", "steer")}, "": {}
    }  # fmt: skip
    sides = [
        Side(
            (f"{end}_{k}",), kind, {"x": x, "y": y, "r": r, "heading": 0.0}, actuated=motors[driven].get(end)
        )
        for x, end, kind, r in ((0.0, "rear", "fixed", 0.45), (3.6, "front", "steered", 0.5))
        for k, y in (("left", 1.0), ("right", -1.0))
    ]
    path = tmp_path / "p.yaml"
    text = "car: {type: AckermannSteeringController, wheelbase: 3.6, wheel_radius: %s}"
    for told, differs in ((radius, False), (radius * 1.02, True)):
        path.write_text(text % told, encoding="utf-8")
        result = compare(Layout("", "d", tuple(sides)), *layouts(path))
        assert ["radius" in d.quantity for d in result.differences] == [True] * differs


@pytest.mark.parametrize("names", [("left", "right"), ("wheel_left", "wheel_right")])
def test_sides_that_a_controller_has_the_other_way_round(names: tuple[str, str], tmp_path: Path) -> None:
    """The wheels of a robot file bear no names of joints: `left` is that of `wheel_left_joint`."""
    a = Layout("", "d", tuple(side(n, "fixed", 0, y) for n, y in zip(names, (0.2, -0.2), strict=True)))
    for left, right, swapped in (("left", "right", []), ("right", "left", ["side", "side"])):
        path = tmp_path / "p.yaml"
        path.write_text(
            f"drive: {{left_wheel_names: [wheel_{left}_joint], right_wheel_names: [wheel_{right}_joint],\n"
            "  wheel_separation: 0.4, wheel_radius: 0.1}\n"
        )
        result = compare(a, *layouts(path))
        assert [d.quantity for d in result.differences] == swapped
        (turn,) = [e.ratio for e in result.effects if e.motion == "turn"]
        assert turn == pytest.approx(-1 if swapped else 1)


@pytest.mark.parametrize("wrong", ["0", "-0.1", "1e308", "1e-320"])
def test_a_header_with_a_radius_that_no_wheel_has(wrong: str) -> None:
    text = " *   left: fixed, x 0 m, y 0.2 m, heading 0 deg, r 0.1 m\n#define A_WHEELS 1\n#define A_LEFT_RADIUS {}f\n"
    assert of_header(text.format("0.1"), "a.h").wheels[0].values["r"] == 0.1
    with pytest.raises(RobotFileError, match="which no wheel has"):
        of_header(text.format(wrong), "a.h")


def test_a_length_that_is_nothing_but_rounding_has_no_share() -> None:
    """Wheels that roll across have a track of 1e-17."""
    assert length("track", 2.4e-17, 0.4, ()).words == "track 2.4e-17 m -> 0.4 m"
    assert length("track", 0.2, 0.4, ()).words.endswith("(+100.0 %, twice that)")


def test_a_wheelbase_of_plain_wheels_is_one_where_the_robot_has_it(tmp_path: Path) -> None:
    """Some drivers call the track of four plain wheels so, and some mean it."""
    robot = Layout("robot", "description", tuple(four("fl", "fr", "rl", "rr")))
    path = tmp_path / "driver.yaml"
    for value, expected in ((0.4, []), (0.3, ["track (wheel_base) 0.2 m -> 0.3 m (+50.0 %)"])):
        path.write_text(f"driver: {{wheel_base: {value}}}\n", encoding="utf-8")
        assert [d.words for d in compare(robot, layouts(path)[0]).differences] == expected


def test_parameters_that_a_launch_file_gives_are_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "driver.yaml"
    path.write_text("driver: {track_width: $(arg track), wheel_diameter: $(arg size)}\n", encoding="utf-8")
    with pytest.raises(RobotFileError, match="track:=VALUE size:=VALUE"):
        layouts(path)
    (layout,) = layouts(path, ["track:=0.4"])
    assert layout.controller and float(layout.controller.lengths["track"].value) == 0.4
