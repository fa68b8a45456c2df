"""Measured lengths: which axles are treated as one, on both sides of the tolerance, what moves, what is reported."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from fractions import Fraction
from math import cos, hypot, pi, remainder, sin
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import wmrgen
from tests.conftest import GALLERY, Outcome
from tests.depth import everyday, examples
from tests.laws.common import NAMES, derived, gallery
from tests.robots import of_text
from tests.tools.lint.test_rules import codes
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import RobotFileError
from wmrgen.geometry.layout.skid import driven

TRACK, RADIUS = 0.4, 0.1
SIZE = TRACK + 2 * RADIUS


def wheel(
    name: str, x: float | str, y: float | str, heading: str = "0", kind: str = "fixed", more: str = ""
) -> str:
    place = f"x: {x}, y: {y}, heading: {heading}, r: {RADIUS}"
    return f"  - {{name: {name}, type: {kind}, {place}{more}}}\n"


def robot(*wheels: str, head: str = "") -> Derivation:
    text = f"wmrgen: 1\nname: r\n{head}wheels:\n{''.join(wheels)}"
    return of_text(text)


def pair(gap: float | str, heading: str = "0", head: str = "") -> Derivation:
    """A differential drive; its right wheel is ``gap`` [m] ahead, and rolls along ``heading``."""
    return robot(wheel("left", 0, TRACK / 2), wheel("right", gap, -TRACK / 2, heading), head=head)


def kind(d: Derivation) -> tuple[int, int]:
    return d.mobility.degree_of_mobility, d.mobility.degree_of_steerability


@pytest.mark.parametrize(
    ("gap", "head", "shared"),
    [
        ("0.0004", "", True),
        ("-0.0004", "", True),
        ("1e-7", "", True),
        (f"{SIZE}e-3", "", True),
        (f"{SIZE * 1.001}e-3", "", False),
        ("0.0004", "tolerance: 0\n", False),
        ("0.0004", "tolerance: 0.4 mm\n", True),
        ("0.0004", "tolerance: 0.399 mm\n", False),
        ("0.004", "tolerance: b\nparameters: {b: 5 mm}\n", True),
    ],
)  # fmt: skip
def test_two_axle_lines(gap: str, head: str, shared: bool) -> None:
    d = pair(gap, head=head)
    assert kind(d) == ((2, 0) if shared else (1, 0))
    assert d.mobility.rank_C1f.exact == d.mobility.rank_C1f.value == (1 if shared else 2)
    (near,) = d.robot.near
    assert bool(near.moves) == shared == bool(d.robot.notes)


@pytest.mark.parametrize(("angle", "shared"), [(0.05, True), (-0.0572, True), (0.0575, False), (2.0, False)])
@pytest.mark.parametrize("ahead", ["20", "109.99"])
def test_two_headings(ahead: str, angle: float, shared: bool) -> None:
    """1 mm per metre is 1/1000 rad, 0.0573 deg. 20 deg is no angle that is snapped."""
    a = np.radians(float(ahead))
    side = TRACK / 2 * np.array([-sin(a), cos(a)])
    d = robot(
        wheel("left", side[0], side[1], f"{ahead} deg"),
        wheel("right", -side[0], -side[1], f"{float(ahead) + angle!r} deg"),
    )
    assert kind(d) == ((2, 0) if shared else (1, 0))
    assert f"{abs(angle):.3g} deg" in d.robot.near[0].text


@pytest.mark.parametrize("off", [(0, 1, 2), (2, 0, 1), (1, 2, 0), (0, 1, 2, 4), (4, 1, 0, 2)])
def test_headings_turn_to_that_of_the_middle_wheel(off: tuple[int, ...]) -> None:
    """Of four to that of the first of both in the middle."""
    wheels = [wheel(f"w{k}", 0, 0.1 * k, f"{20 + 0.01 * o!r} deg") for k, o in enumerate(off)]
    middle = next(o for o in off if o in sorted(off)[(len(off) - 1) // 2 : len(off) // 2 + 1])
    headings = [np.degrees(w.heading) for w in robot(*wheels).robot.wheels]
    assert headings == pytest.approx([20 + 0.01 * middle] * len(off))


def test_opposite_headings_are_one_axle() -> None:
    assert kind(pair(0.0003, "pi")) == (2, 0)
    d = pair(0.0003, "pi - 0.0005", head="snap: false\n")
    assert kind(d) == (2, 0) and d.robot.wheel("right").heading == pytest.approx(pi, abs=1e-12)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
@pytest.mark.parametrize("turn", [0.0, 0.3, 1.7])
@pytest.mark.parametrize(("gap", "shared"), [(0.99, True), (1.01, False)])
def test_alignment_does_not_depend_on_frame_or_unit(
    scale: float, turn: float, gap: float, shared: bool
) -> None:
    """A robot of 1 m from rim to rim; P lies 3 m and more from it."""
    places = (3.0, 1.4), (3.0 + gap * 1e-3, 0.6)
    moved = [complex(*p) * complex(cos(turn), sin(turn)) * scale for p in places]
    wheels = [
        f"  - {{name: w{k}, type: fixed, x: {p.real!r}, y: {p.imag!r}, heading: {turn}, r: {0.1 * scale}}}\n"
        for k, p in enumerate(moved)
    ]
    d = robot(*wheels, head="snap: false\n")
    assert kind(d) == ((2, 0) if shared else (1, 0))
    assert kind(robot(*wheels[::-1], head="snap: false\n")) == kind(d)


def test_kinematics_equal_those_of_the_exact_robot() -> None:
    measured, exact = pair(0.0004, head="snap: false\n"), pair(0)
    twist = {"vx": 0.7, "vy": 0.0, "omega": -1.3}
    for name, outputs in exact.casadi()["inverse"](**twist).items():
        assert float(measured.casadi()["inverse"](**twist)[name]) == pytest.approx(float(outputs), abs=1e-12)


def test_a_car_with_measured_rear_wheels_steers() -> None:
    steered = ", actuated: [steer]"
    front = [wheel(n, 2.5, y, kind="steered", more=steered) for n, y in (("fl", 0.7), ("fr", -0.7))]
    d = robot(wheel("rl", 0.0004, 0.7), wheel("rr", "-0.0", -0.7), *front)
    assert kind(d) == (1, 1) and d.mobility.dof == 3 and not d.mobility.holonomic
    exact = robot(wheel("rl", 0, 0.7), wheel("rr", 0, -0.7), *front)
    assert d.null_space == exact.null_space  # the line through P is in reach of both
    apart = robot(wheel("rl", 0.02, 0.7), wheel("rr", 0, -0.7), *front)
    assert kind(apart) == (1, 0) and apart.mobility.holonomic
    (near,) = apart.robot.near
    assert (near.apart, near.tolerance) == (pytest.approx(0.02), pytest.approx(0.02)) and near.wheel == "rl"
    assert {"rl", "rr"} <= words(apart.mobility.deciding) and "20 mm" in apart.mobility.deciding


def test_wheels_meet_in_the_middle_where_P_is_far() -> None:
    d = robot(wheel("a", 1, 0.2), wheel("b", 1.0001, 0), wheel("c", 1.0005, -0.2))
    assert [w.nominal.x for w in d.robot.wheels] == [Fraction("1.0002")] * 3
    (near,) = d.robot.near
    assert re.findall(r"`(\w)`.*?([\d.]+) mm", near.moves) == [("a", "0.2"), ("b", "0.1"), ("c", "0.3")]
    assert [w.l for w in d.robot.wheels] == pytest.approx([hypot(1.0002, y) for y in (0.2, 0, -0.2)])
    for w in d.robot.wheels:  # heading = alpha + beta - pi/2, as of every wheel
        assert remainder(w.alpha + w.beta - pi / 2 - w.heading, 2 * pi) == pytest.approx(0)


def test_no_wheel_of_a_set_is_farther_from_another_than_the_tolerance() -> None:
    """Each neighbour is within 0.6 mm, the first and the last are not."""
    d = robot(wheel("a", 0, 0.2), wheel("b", 0.0005, 0), wheel("c", 0.001, -0.2))
    assert kind(d) == (1, 0)
    assert [bool(near.moves) for near in d.robot.near] == [True, False]


def test_measured_skid_steering_keeps_its_two_axles() -> None:
    """Four axle lines and four headings, which meet nowhere: nothing could move."""
    offs = (
        ("fl", 0.3001, 0.2, 20.01),
        ("fr", 0.2998, -0.2, 20.0),
        ("bl", -0.3002, 0.2, 19.99),
        ("br", -0.3, -0.2, 20.02),
    )
    turned = [(n, complex(x, y) * np.exp(1j * np.radians(20)), h) for n, x, y, h in offs]
    wheels = [wheel(n, p.real, p.imag, f"{h} deg") for n, p, h in turned]
    assert kind(robot(*wheels, head="tolerance: 0\n")) == (0, 0)
    d = robot(*wheels)
    assert kind(d) == (1, 0) and d.mobility.skids
    assert all(near.moves for near in d.robot.near)


@pytest.mark.parametrize("coupled", [True, False])
def test_twin_wheels_of_one_steering_axis(coupled: bool) -> None:
    """A module of two wheels side by side: measured axes 0.4 mm apart are one, which steers."""
    twins = [
        wheel(n, x, 0, kind="steered", more=f", offset_y: {o}")
        for n, x, o in (("a", 0.0004, 0.05), ("b", 0, -0.05))
    ]
    tail = wheel("tail", -0.4, 0, kind="castor", more=", d: -0.05")
    head = "couplings: [{equal: [a.steer, b.steer]}]\n" if coupled else ""
    d = robot(*twins, tail, head=head)
    assert kind(d) == (2, 1)
    assert {float(w.nominal.x) for w in d.robot.wheels} == {0.0002, -0.4}
    assert kind(robot(*twins, tail, head=f"tolerance: 0\n{head}")) != (2, 1)


def test_tunable_lengths_stay_inputs() -> None:
    """The parameters a and b are the wheels' own; at their nominal values, 0.4 mm apart, the axle lines are one."""
    parameters = "parameters: {a: {value: 0.0003, tunable: true}, b: {value: -0.0001, tunable: true}}\n"
    d = robot(wheel("left", "a", 0.2), wheel("right", "b", -0.2), head=parameters)
    assert kind(d) == (2, 0)
    left, right = (w.working.x for w in d.robot.wheels)
    assert {g.name for g in left.generators} == {"a"} and {g.name for g in right.generators} == {"b"}
    assert [float(w.nominal.x) for w in d.robot.wheels] == [0.0003, 0.0003]
    assert re.findall(r"`(\w+)`.*?([\d.]+) mm", d.robot.near[0].moves) == [("right", "0.4")]


def test_nothing_else_is_moved() -> None:
    """Omni wheels and castors a hair's breadth off their neighbours stay where they are."""
    omni = [wheel(f"w{k}", x, y, h, "swedish") for k, (x, y, h) in enumerate(
        ((0.0004, 0.2, "0"), (0, -0.2, "0.0005"), (-0.2, 0, "pi/2"))
    )]  # fmt: skip
    castors = [wheel(f"k{k}", x, 0, kind="castor", more=", d: -0.05") for k, x in enumerate((0.3, 0.3003))]
    d = robot(*omni, *castors, head="snap: false\n")
    assert d.robot.near == ()
    assert [float(w.nominal.x) for w in d.robot.wheels] == [0.0004, 0.0, -0.2, 0.3, 0.3003]


@pytest.mark.parametrize("path", GALLERY, ids=lambda path: path.stem)
def test_the_gallery_is_exact(path: Path) -> None:
    assert not [near for near in wmrgen.load(path).near if near.moves]


@pytest.mark.parametrize("name", everyday(NAMES, ["ackermann_car"]))
def test_measured_gallery_robots_have_their_degrees(name: str) -> None:
    """Every place and heading is off by a random share of the tolerance, in three files."""
    model, layout = gallery(name)
    degrees, tolerance = model.derivation.mobility, model.derivation.robot.tolerance
    random = np.random.default_rng(len(name))
    for _ in range(3):
        off = random.uniform(-0.3, 0.3, (len(layout["wheels"]), 3)) * (
            tolerance.length,
            tolerance.length,
            tolerance.angle,
        )
        wheels = [
            w | {k: w[k] + float(by) for k, by in zip(("x", "y", "heading"), row, strict=True)} | {"text": {}}
            for w, row in zip(layout["wheels"], off, strict=True)
        ]
        measured = derived(layout | {"wheels": wheels}, extra="snap: false\n").derivation.mobility
        assert (measured.degree_of_mobility, measured.degree_of_steerability, measured.dof) == (
            degrees.degree_of_mobility, degrees.degree_of_steerability, degrees.dof,
        )  # fmt: skip


@pytest.mark.parametrize("gap", ["0.00065", "0.0051234567", "0.02"])
def test_above_the_tolerance_the_message_names_what_helps(gap: str) -> None:
    """Both remedies do: the second is taken from the message."""
    d = pair(gap)
    (near,) = d.robot.near
    assert near.apart == pytest.approx(float(gap)) and near.instead and not near.moves
    told = d.mobility.deciding
    assert {"left", "right"} <= words(told) and f"{float(gap) * 1e3:.3g} mm" in told and near.instead in told
    assert f"{1000 * d.robot.tolerance.length:.3g} mm" in told
    (remedy,) = re.findall(r"tolerance: [0-9.]+ mm", told)
    assert kind(pair(gap, head=f"{remedy}\n")) == (2, 0)
    assert kind(pair(gap, head="tolerance: 0.65 mm\n")) == ((2, 0) if gap == "0.00065" else (1, 0))


def test_a_hair_above_the_tolerance_two_equal_numbers_do_not_contradict() -> None:
    """Also where the file asks for exact lengths and names a distance that rounds to none."""
    d = pair("0.0010000001", head="tolerance: 1 mm\n")
    (near,) = d.robot.near
    assert re.findall(r"[\d.]+ mm", near.sentence(d.robot.tolerance)) == ["1 mm", "1 mm"]
    larger = near._replace(tolerance=0.0011)
    assert len(near.sentence(d.robot.tolerance)) > len(larger.sentence(d.robot.tolerance))  # "a little more"
    assert "tolerance: 1.01 mm" in d.mobility.deciding
    (near,) = pair("2e-12", head="tolerance: 0\n").robot.near
    assert "tolerance: 0.01 mm" in near.remedies


def line(places: Sequence[float], head: str, headings: Sequence[float] = ()) -> Derivation:
    """Fixed wheels so many mm ahead [deg to the left], one beside the other."""
    turned = headings or [0.0] * len(places)
    return robot(*(
        wheel(f"w{k}", f"{x} mm", TRACK / 2 - 0.1 * k, f"{turned[k]} deg") for k, x in enumerate(places)
    ), head=f"snap: false\n{head}")  # fmt: skip


@pytest.mark.parametrize("places", [(0, 0.6, 1.2), (1.2, 0, 0.6), (0, 0.6, 1.2, 1.8, 2.4), (0, 1, 1.1, 2.05)])
def test_the_span_of_a_chain_of_axles_is_reported(places: tuple[float, ...]) -> None:
    """The message has the tolerance for one axle, although each axle is nearer to its neighbour."""
    (first, *_) = [near for near in line(places, "tolerance: 1 mm\n").robot.near if not near.moves]
    (told,) = re.findall(r"([0-9.]+) mm", first.text)
    assert float(told) > 1 and f"tolerance: {told} mm" in first.remedies
    assert len(set(re.findall(r"`(w\d)`", first.text))) >= 3


@settings(max_examples=examples(60))
@given(
    st.lists(st.integers(0, 60), min_size=2, max_size=6),
    st.booleans(),
    st.sampled_from(["0", "0.3 mm", "1 mm"]),
)
def test_the_remedy_removes_the_finding(tenths: list[int], turned: bool, tolerance: str) -> None:
    """Where the tolerance of a message is written, its wheels are one set; in the end no message is left."""
    places = [k / 10 for k in tenths]
    head, seen = f"tolerance: {tolerance}\n", set[str]()
    for _ in range(20):
        layout = line([0.0] * len(places), head, [x / 20 for x in places]) if turned else line(places, head)
        open_ = [near for near in layout.robot.near if not near.moves]
        assert seen.isdisjoint(near.text for near in open_)
        if not open_:
            return
        seen.add(open_[0].text)
        (remedy,) = re.findall(r"tolerance: [0-9.]+ mm", open_[0].remedies)
        head = f"{remedy}\n"
    raise AssertionError(f"{places} still has {open_[0]}")


def test_headings_above_the_tolerance_name_what_helps() -> None:
    d = pair("0", "0.5 deg")
    (near,) = d.robot.near
    assert {"left", "right"} <= words(near.text) and "0.5 deg" in near.text and "heading" in near.instead
    assert near.instead in d.mobility.deciding
    (remedy,) = re.findall(r"tolerance: [0-9.]+ mm", d.mobility.deciding)
    assert kind(pair("0", "0.5 deg", head=f"{remedy}\n")) == (2, 0)


def test_two_distinct_axles_are_not_reported() -> None:
    husky = [
        wheel(n, x, y)
        for n, x, y in (("fl", 0.25, 0.3), ("fr", 0.25, -0.3), ("bl", -0.25, 0.3), ("br", -0.25, -0.3))
    ]
    assert robot(*husky).robot.near == ()
    assert robot(wheel("front", 0.5, 0), wheel("rear", -0.5, 0)).robot.near == ()


def test_lint_reports_aligned_axles_unless_the_file_has_a_tolerance(tmp_path: Path) -> None:
    text = "wheels:\n" + wheel("left", 0, 0.2) + wheel("right", "0.0004", -0.2)
    assert codes(tmp_path / "robot.yaml", text) == ["WMR034"]
    assert codes(tmp_path / "robot.yaml", f"tolerance: 1 mm\n{text}") == []
    assert codes(tmp_path / "robot.yaml", f"tolerance: 0.1 mm\n{text}") == ["WMR034"]


def test_the_report_and_the_command_line_say_it(wmrgen_cli: Callable[..., Outcome], tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    text = "wmrgen: 1\nname: r\nwheels:\n" + wheel("left", 0, 0.2) + wheel("right", "0.0004", -0.2)
    path.write_text(text, encoding="utf-8")
    done = wmrgen_cli("derive", path, "-o", tmp_path / "out")
    assert done.code == 0
    report = (tmp_path / "out" / "r" / "report.md").read_text(encoding="utf-8")
    for name, text in (("right", done.err), ("`right`", report)):
        assert re.search(rf"{name} is \w+ by 0\.4 mm", text)


def words(text: str) -> set[str]:
    return {*re.findall(r"\w+", text)}


@pytest.mark.parametrize(("value", "code"), [("-1 mm", "WMR109"), ("3 deg", "WMR104"), ("t", "WMR109")])
def test_bad_tolerances(value: str, code: str) -> None:
    with pytest.raises(RobotFileError) as caught:
        pair(0, head=f"tolerance: {value}\nparameters: {{t: {{value: 0.001, tunable: true}}}}\n")
    assert caught.value.code == code and value in caught.value.what
    assert caught.value.mark and (caught.value.mark.line, caught.value.mark.column) == (3, 12)


@pytest.mark.parametrize("given", ["0.5", "2.5*half", "track", "2*track - half"])
def test_the_drive_in_the_place_of_a_skidding_robot_keeps_the_names_of_lengths(given: str) -> None:
    """Its wheels stand an effective track apart in every view: by its names, by what is tunable, and in numbers."""
    head = f"parameters:\n  half: 0.2\n  track: {{value: 0.5, tunable: true}}\neffective_track: {given}\n"
    wheels = (wheel(f"w{x}{side}", x, y) for x in (1, 0) for side, y in (("l", "half"), ("r", "-half")))
    skid = robot(*wheels, head=head).robot
    drive, track = driven(skid), skid.effective_track
    assert track is not None and drive.effective_track is None
    for left, right in zip(drive.wheels[::2], drive.wheels[1::2], strict=True):
        assert left.symbolic.y - right.symbolic.y == track.symbolic
        assert left.working.y - right.working.y == track.working
        assert left.nominal.y - right.nominal.y == track.nominal
