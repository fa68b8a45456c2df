"""Both sides of what rules decide by, and robots that are right although a careless rule would speak."""

from __future__ import annotations

import cmath
import re
from math import atan2, degrees, radians
from pathlib import Path

import pytest

from tests.tools.lint.test_rules import HEAD, codes, linted

PAIR = "  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}\n"
PAIR += "  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}\n"


def wheels(*entries: str, after: str = "") -> str:
    return "wheels:\n" + "".join(f"  - {{{entry}}}\n" for entry in entries) + after


def differential(y: str = "0.2", x: str = "0", r: str = "0.1", heading: str = "0", head: str = "") -> str:
    both = (
        f"name: {n}, type: fixed, x: {x}, y: {s}{y}, heading: {heading}, r: {r}"
        for n, s in (("left", ""), ("right", "-"))
    )
    return head + wheels(*both)


def polar(alpha: str, head: str = "") -> str:
    turned = f"name: left, type: fixed, l: 0.2, alpha: {alpha}, heading: 0, r: 0.1"
    return head + wheels(turned, "name: right, type: fixed, l: 0.2, alpha: 3*pi/2, heading: 0, r: 0.1")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (polar("90"), ["WMR001"]),
        (polar("90 deg"), []),
        (polar("90").replace("heading: 0", "heading: 0.3", 1)
         + "  - {name: third, type: fixed, x: 0.3, y: 0, heading: 0, r: 0.1}\n", ["WMR001", "WMR030"]),
        (polar("quarter", "parameters: {quarter: 90}\n"), ["WMR001"]),
        (polar("450", "angles: deg\n").replace("3*pi/2", "270"), ["WMR001"]),
        (polar("90", "angles: deg\n").replace("3*pi/2", "270"), []),
        (polar("5*pi/2"), ["WMR001"]),
        (polar("pi/2 + 2*pi - 2*pi"), []),
        (differential(heading="6.29"), ["WMR001", "WMR001"]),
        (differential(heading="6.2832"), []),  # a turn, rounded
        (differential("10"), ["WMR004"]),
        (differential("4.9"), []),
        (differential("10.1", r="1"), ["WMR003"]),
        (differential("9.9", r="1"), []),
        (differential("21", r="1").replace("-21", "20.5"), ["WMR003", "WMR005", "WMR014"]),
        (differential("b", head="parameters: {b: 0.2}\n"), []),
        *((differential(name, head=f"parameters: {{{name}: 0.2}}\n"), ["WMR005"])
          for name in ("tread", "wheel_distance", "wheel_base", "axle_length")),
        (differential("wheel_base/2", head="parameters: {wheel_base: 0.4}\n"), []),
        (differential("half_track", head="parameters: {half_track: 0.2}\n"), []),
        (differential("track", head="parameters: {track: 0.2}\n"), ["WMR005"]),
        (differential("track_width/2", head="parameters: {track_width: 0.4}\n"), []),
        (differential(r="wheel_diameter", head="parameters: {wheel_diameter: 0.2}\n"), ["WMR005", "WMR005"]),
        (differential(r="wheel_diameter/2", head="parameters: {wheel_diameter: 0.2}\n"), []),
        (differential().replace("r: 0.1}", "r: 0.1}   # wheel diameter 100 mm"), ["WMR005", "WMR005"]),
        (differential().replace("r: 0.1}", "r: 0.1}   # diameter 200 mm, / 2"), []),
        (differential().replace("r: 0.1}", "r: 0.1}   # radius, not diameter"), []),
        (differential(head="description: Track 0.2 m, diameter 20 cm\n"), ["WMR005"]),
        (differential(head="description: Track 200 mm and dia. 0.1\n"), ["WMR005", "WMR005", "WMR005"]),
        (differential(head="description: Track 0.4 m, half track 0.2 m, wheelbase 0\n"), []),
        (differential().replace("y: 0.2,", "y: 0.4,"), ["WMR005"]),
        (differential().replace("y: 0.2,", "y: 0.39,"), ["WMR014"]),
        (differential().replace("r: 0.1}", "r: 0.2}", 1), ["WMR005"]),
        (differential().replace("r: 0.1}", "r: 0.19}", 1), ["WMR015"]),
        (differential().replace("r: 0.1}", "r: 0.112}", 1), ["WMR015"]),
        (differential().replace("r: 0.1}", "r: 0.111}", 1), []),  # as calibration may find them
        (differential(r="0.41"), ["WMR005"]),
        (differential(r="0.39"), []),
        (differential(x="-0.05"), ["WMR014"]),
        (differential(x="0.05").replace("left", "back_left"), ["WMR011", "WMR014"]),
        (differential(x="-0.05").replace("left", "back_left"), ["WMR014"]),
        (differential(x="-0.0"), []),
        (differential(heading="pi"), []),  # both backwards: not against each other
        (differential().replace("heading: 0", "heading: 3.12", 1), ["WMR012", "WMR034"]),
        (differential().replace("y: 0.2,", "y: 0.2003,"), []),
        (differential().replace("y: 0.2,", "y: 0.2005,"), ["WMR014"]),
        (wheels("name: a, type: fixed, x: 0, y: 1.4, heading: 0, r: 0.1",
                "name: b, type: fixed, x: 0, y: 1, heading: 0, r: 0.1"), ["WMR014"]),
        (differential("half_track/2", head="parameters: {half_track: 0.4}\n"), ["WMR005"]),
        (differential("half_width/2", head="parameters: {half_width: 0.4}\n"), []),  # of the body
        *((differential(name, head=f"parameters: {{{name}: 0.2}}\n"), ["WMR005"] if whole else [])
          for name, whole in (("width", True), ("robot_width", True), ("arm_width", False), ("semi_track", False))),
        (differential("wheel_width", head="parameters: {wheel_width: 0.2}\n"), []),  # of a tyre
        (differential(r="radius/2", head="parameters: {radius: 0.2}\n"), ["WMR005", "WMR005"]),
        (differential(r="base_radius/2", head="parameters: {base_radius: 0.2}\n"), []),
        (differential(r="dia", head="parameters: {dia: 0.2}\n"), ["WMR005", "WMR005"]),
        (differential() + "limits: {omega: 62}\n", []),
        (differential() + "limits: {omega: 63}\n", ["WMR002"]),
        (differential() + "limits: {omega: 3600 deg/s}\n", []),
        (differential() + "limits: {vx: 99, spin: 999}\n", []),
        (differential() + "limits: {vx: 101, spin: 1001}\n", ["WMR002", "WMR002"]),
        (differential() + "limits: {spin: 0}\n", ["WMR002"]),
        (differential() + "limits: {vx_rate: [0, 0]}\n", ["WMR002"]),
        (differential() + "limits: {spin: [0, 9], vy: 0}\n", []),
        (differential() + "trailers: [{name: t, length: 19.9}]\n", []),
        (differential() + "trailers: [{name: t, length: 3000}]\n", ["WMR003"]),
        (differential() + "trailers: [{name: t, length: 0.9 mm}]\n", ["WMR004"]),
        (differential() + "cg: {x: 0, y: 0.1 mm, z: 0.3}\n", []),
        (differential() + "cg: {x: 0, y: 0, z: 300}\n", ["WMR003"]),
        (differential(r="10"), ["WMR005"]),  # at one place they are not for that
    ],
)  # fmt: skip
def test_differential_drives(text: str, expected: list[str], tmp_path: Path) -> None:
    assert sorted(codes(tmp_path / "robot.yaml", text)) == expected


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        *((name, 1) for name in ("wheelbase", "base", "length", "base_length", "chassis_length")),
        # Distances from P, which end in a word that is also one for a whole.
        *(
            (name, 0)
            for name in ("base_x", "x_base", "base_offset", "base_to_axle", "arm_length", "half_base")
        ),
    ],
)
def test_a_length_on_both_sides_of_the_middle(name: str, expected: int, tmp_path: Path) -> None:
    steered = "name: {}, type: steered, x: {}, y: 0, heading: 0, r: 0.1"
    text = f"parameters: {{{name}: 0.3}}\n" + wheels(
        steered.format("a", name), steered.format("b", f"-{name}")
    )
    assert codes(tmp_path / "robot.yaml", text) == ["WMR005"] * expected


@pytest.mark.parametrize(
    ("comment", "expected"),
    [
        ("diameter", 2),
        ("wheel diameter", 2),
        ("Ø", 2),
        ("half the diameter", 0),
        ("radius", 0),
        ("Ø 200 mm", 0),
    ],
)
def test_a_comment_beside_a_radius_alone(comment: str, expected: int, tmp_path: Path) -> None:
    one = "  - name: {}\n    type: fixed\n    x: 0\n    y: {}\n    heading: 0\n    r: 0.1   # {}\n"
    text = "wheels:\n" + one.format("left", "0.2", comment) + one.format("right", "-0.2", comment)
    assert codes(tmp_path / "robot.yaml", text) == ["WMR005"] * expected


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (("fl", "fr", "bl", "br"), 0),
        (("lf", "rf", "lb", "rb"), 0),
        (("front_left", "front_right", "rear_left", "rear_right"), 0),
        (("front_left_wheel", "right_front", "left_hind", "back_right"), 0),
        (("a", "b", "c", "d"), 0),
        (("fr", "fl", "bl", "br"), 2),
        (("rf", "lf", "lr", "rr"), 2),
        (("bl", "fr", "fl", "br"), 2),
        # Simulation of the Neobotix MPO-700: back_left at the front right, back_right at the back left.
        (("front_left", "back_left", "back_right", "front_right"), 3),
        (("bright", "leftover", "rearm", "fright"), 0),
        (("frontleft", "FRONTRIGHT", "lrear", "rr_wheel"), 0),
        (("frontright", "FRONTLEFT", "lrear", "rr_wheel"), 2),
        (("wheel_l", "wheel_r", "back_l", "back_r"), 0),
        (("f_l", "F_R", "r_l", "wheel_r_r"), 0),
        (("r_l", "wheel_r_r", "f_l", "F_R"), 4),
        (("wheel_r", "wheel_l", "back_l", "back_r"), 1),  # r may be rear
    ],
)  # fmt: skip
def test_names_and_places(names: tuple[str, ...], expected: int, tmp_path: Path) -> None:
    """Wheels at the front left, front right, back left and back right."""
    places = ((0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2))
    entries = (
        f"name: {n}, type: steered, x: {x}, y: {y}, heading: 0, r: 0.1"
        for n, (x, y) in zip(names, places, strict=True)
    )
    assert codes(tmp_path / "robot.yaml", wheels(*entries)) == ["WMR011"] * expected


def test_a_name_that_is_wrong_in_both_ways_is_told_of_both(tmp_path: Path) -> None:
    places = {
        "front_left": (0.3, 0.2),
        "front_right": (0.3, -0.2),
        "back_right": (-0.3, -0.2),
        "back_left": (0.3, -0.4),
    }
    entries = (f"name: {n}, type: fixed, x: {x}, y: {y}, heading: 0, r: 0.1" for n, (x, y) in places.items())
    path = tmp_path / "robot.yaml"
    path.write_text(HEAD + wheels(*entries), encoding="utf-8")
    (finding,) = (f for f in linted(path) if f.code == "WMR011")
    assert finding.mark.line == 7
    assert "(0.3, -0.4)" in finding.what
    assert {"back_left", "front", "right", "rear", "left"} <= set(re.findall(r"\w+", finding.what))


@pytest.mark.parametrize(
    ("left", "couplings", "expected"), [(0.05, True, 0), (-0.05, True, 1), (0.05, False, 1)]
)
def test_sides_of_wheels_that_one_joint_steers(
    left: float, couplings: bool, expected: int, tmp_path: Path
) -> None:
    """Both stand left of the robot's middle: the right one is that of their pivot."""
    hub = "type: castor, x: -0.3, y: 0.3, heading: 0, d: -0.05, r: 0.05, actuated: [spin, steer]"
    twins = wheels(f"name: left_hub, {hub}, offset_y: {left}", f"name: right_hub, {hub}, offset_y: {-left}")
    rest = "  - {name: tail, type: castor, x: 0.3, y: -0.3, heading: 0, d: -0.05, r: 0.05}\n"
    coupled = "couplings:\n  - {equal: [left_hub.steer, right_hub.steer]}\n" * couplings
    found = codes(tmp_path / "robot.yaml", twins + rest + coupled)
    assert found.count("WMR011") == expected, found


@pytest.mark.parametrize("ratio", [1, 0.5, 2])
def test_omni_wheels_that_run_around_the_middle_do_not_roll_against_each_other(
    ratio: float, tmp_path: Path
) -> None:
    """At the corners of oblong bases too."""
    around = [
        f"name: w{k}, type: swedish, x: {x}, y: {y * ratio}, heading: {135 + 90 * k} deg, gamma: 0, r: 0.05"
        for k, (x, y) in enumerate(((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)))
    ]
    assert codes(tmp_path / "robot.yaml", wheels(*around)) == []


def test_omni_wheels_along_x_that_turn_oppositely_do(tmp_path: Path) -> None:
    corners = ((0.3, 0.2, 0), (-0.3, 0.2, 0), (-0.3, -0.2, 180), (0.3, -0.2, 180))
    entries = [
        f"name: w{k}, type: swedish, x: {x}, y: {y}, heading: {h} deg, gamma: 0, r: 0.05"
        for k, (x, y, h) in enumerate(corners)
    ]
    side = ["name: aside, type: swedish, x: 0.4, y: 0, heading: pi/2, gamma: 0, r: 0.05"]
    assert codes(tmp_path / "robot.yaml", wheels(*entries, *side)) == ["WMR012"] * 2


@pytest.mark.parametrize("turn", [0, 90, 180, -90])
@pytest.mark.parametrize("half", [0.1, 0.2, 0.5])
def test_wheels_against_each_other_do_not_depend_on_the_frame(half: float, turn: int, tmp_path: Path) -> None:
    """Of a row of omni wheels on each side, the one or the other rolls backward."""
    rows = ((0.3, half, 0), (-0.3, half, 0), (-0.3, -half, 180), (0.3, -half, 180))
    places = [(complex(x, y) * cmath.rect(1, radians(turn)), h + turn) for x, y, h in rows]
    entries = [
        f"name: w{k}, type: swedish, x: {p.real:.9f}, y: {p.imag:.9f}, heading: {h} deg, gamma: 0, r: 0.05"
        for k, (p, h) in enumerate(places)
    ]
    assert codes(tmp_path / "robot.yaml", wheels(*entries)).count("WMR012") == 2


@pytest.mark.parametrize(
    ("headings", "expected"),
    [
        ((0, 0, 0, 0), []),
        ((0, 180, 0, 180), ["2", "4"]),
        ((180, 0, 0, 180), ["1", "4"]),  # those that roll backwards, wherever they stand
        ((180, 178, 180, 180), []),
        ((45, -45, 135, -135), []),  # which angle 0 leaves open
    ],
)
def test_steered_wheels_against_each_other(
    headings: tuple[int, ...], expected: list[str], tmp_path: Path
) -> None:
    places = ((0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2))
    entries = (
        f"name: w{k}, type: steered, x: {x}, y: {y}, heading: {h} deg, r: 0.1"
        for k, ((x, y), h) in enumerate(zip(places, headings, strict=True), 1)
    )
    path = tmp_path / "robot.yaml"
    path.write_text(HEAD + wheels(*entries))
    assert [f.what[8] for f in linted(path) if f.code == "WMR012"] == expected


@pytest.mark.parametrize(
    ("second", "expected"),
    [
        ("d: -0.03", ["WMR010"]),
        ("d: 0.03, heading: pi", ["WMR010"]),
        ("d: -0.03, heading: pi/2", ["WMR010"]),  # they turn about one axis
        ("d: -0.03, offset_y: 0.04", []),
    ],
)
def test_two_castors_on_one_pivot(second: str, expected: list[str], tmp_path: Path) -> None:
    tail = "".join(
        f"  - {{name: {n}, type: castor, x: -0.3, y: 0, {arm}, r: 0.05}}\n"
        for n, arm in (("a", "d: -0.03"), ("b", second))
    )
    assert codes(tmp_path / "robot.yaml", f"wheels:\n{PAIR}{tail}") == expected


def test_what_to_write_for_an_angle_without_unit(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    for text, value in (
        (polar("90"), "90 deg"),
        (polar("45*2"), " deg "),  # the unit alone: the numbers are in an expression
        (polar("450", "angles: deg\n").replace("3*pi/2", "270"), " 90,"),
    ):
        path.write_text(HEAD + text)
        (finding,) = (f for f in linted(path) if f.code == "WMR001")
        assert value in finding.instead


def test_a_skid_steer_robot(tmp_path: Path) -> None:
    four = [
        f"name: w{k}, type: fixed, x: {x}, y: {y}, heading: 0, r: 0.1, sensed: [spin]"
        for k, (x, y) in enumerate(((0.3, 0.2), (-0.3, 0.2), (0.3, -0.2), (-0.3, -0.2)))
    ]
    track = "effective_track: 0.6\n"
    for size, expected in (("0.6", []), ("0.39", []), ("0.3", ["WMR005"]), ("600", ["WMR003"])):
        assert codes(tmp_path / "robot.yaml", track.replace("0.6", size) + wheels(*four)) == expected
    left = [*four[:2], *(wheel.replace("[spin]", "[]") for wheel in four[2:])]
    assert codes(tmp_path / "robot.yaml", track + wheels(*left)) == ["WMR022"]


@pytest.mark.parametrize(
    ("castor", "expected"),
    [
        ("d: 0.04", ["WMR013"]),
        ("heading: 0, d: 0.04", ["WMR013"]),
        ("heading: pi, d: 0.04", []),
        ("heading: pi/2, d: 0.04", []),
        ("heading: 0, d: -0.04", []),
        ("heading: pi, d: -0.04", ["WMR013"]),
        ("heading: 25 deg, d: 0.04", ["WMR013"]),
        ("heading: 27 deg, d: 0.04", []),  # placed on a star, as of a chair
        ("d: -0.39", []),
        ("d: -0.41", ["WMR004"]),
        ("d: -0.0011", []),
        ("d: -0.0009", ["WMR004"]),
        ("d: -0.04, y: 0.2, x: 0", ["WMR010"]),
        ("d: -0.04, actuated: [spin]", ["WMR021"]),
        ("d: -0.04, actuated: [spin, steer]", ["WMR021"]),
    ],
)
def test_castors(castor: str, expected: list[str], tmp_path: Path) -> None:
    place = "" if "x:" in castor else "x: -0.3, y: 0, "
    tail = f"  - {{name: tail, type: castor, {place}{castor}, r: 0.1}}\n"
    assert codes(tmp_path / "robot.yaml", f"wheels:\n{PAIR}{tail}") == expected


def car(limit: str, omega: float) -> str:
    """Wheelbase 1.2 m, at most 1.5 m/s."""
    rear = "name: rear, type: fixed, x: 0, y: 0, heading: 0, r: 0.3"
    front = "name: front, type: steered, x: 1.2, y: 0, heading: 0, r: 0.3, actuated: [steer], limits: {steer: LIMIT}"
    return wheels(rear, front.replace("LIMIT", limit), after=f"limits: {{vx: 1.5, omega: {omega}}}\n")


NEEDED = degrees(atan2(1.2 * 0.8, 1.5))  # steering of that car at 0.8 rad/s


@pytest.mark.parametrize(
    ("limit", "expected"),
    [
        (f"{NEEDED + 0.01} deg", []),
        (f"{NEEDED - 0.2} deg", ["WMR023"]),
        (f"[-{NEEDED + 0.01} deg, {NEEDED - 0.2} deg]", ["WMR023"]),
        (f"[-{NEEDED - 0.2} deg, {NEEDED + 0.01} deg]", ["WMR023"]),
        ("[-35, 35]", ["WMR002"]),
        ("[-35 deg, 35]", ["WMR002"]),
        ("[-35 rad, 35 rad]", ["WMR002"]),
        ("[-12*pi, 1]", ["WMR002"]),
        ("[-6.2, 6.2]", []),
    ],
)
def test_steering_limits_of_a_car(limit: str, expected: list[str], tmp_path: Path) -> None:
    assert codes(tmp_path / "robot.yaml", car(limit, 0.8)) == expected


@pytest.mark.parametrize(
    ("zero", "limit", "expected"),
    [
        ("0", "[0, 35 deg]", []),
        ("0", "[1 deg, 35 deg]", ["WMR023"]),
        ("90 deg", "35 deg", ["WMR023"]),
        ("90 deg", "90 deg", []),
        ("180 deg", "35 deg", []),
        ("30 deg", "[-31 deg, 5 deg]", []),
        ("30 deg", "[-29 deg, 5 deg]", ["WMR023"]),
    ],
)
def test_steering_limits_that_do_not_let_a_car_drive_straight_on(
    zero: str, limit: str, expected: list[str], tmp_path: Path
) -> None:
    """Whatever the limits of its motion."""
    front = "name: front, type: steered, x: 1, y: 0, r: 0.3, actuated: [steer]"
    rear = "name: rear, type: fixed, x: 0, y: 0, heading: 0, r: 0.3"
    text = wheels(rear, f"{front}, heading: {zero}, limits: {{steer: {limit}}}")
    assert codes(tmp_path / "robot.yaml", text) == expected


@pytest.mark.parametrize(("lag", "expected"), [("10", []), ("150", ["WMR002"] * 2), ("150 ms", [])])
def test_lags_of_a_robot_and_of_a_wheel(lag: str, expected: list[str], tmp_path: Path) -> None:
    text = car("1", 0.8).replace("r: 0.3, act", f"r: 0.3, lag: {{steer: {lag}}}, act")
    assert codes(tmp_path / "robot.yaml", f"{text}lag: {{steer: {lag}}}\n") == expected


@pytest.mark.parametrize(("limit", "expected"), [("1.57", []), ("1.56", ["WMR023"]), ("[0, pi]", [])])
def test_sideways_with_four_steered_wheels(limit: str, expected: list[str], tmp_path: Path) -> None:
    places = ((1, 1), (1, -1), (-1, 1), (-1, -1))
    entries = (
        f"name: w{k}, type: steered, x: {x}, y: {y}, heading: 0, r: 0.1" for k, (x, y) in enumerate(places)
    )
    text = wheels(*entries, after=f"limits: {{vx: 1, vy: 1, omega: 1, steer: {limit}}}\n")
    assert codes(tmp_path / "robot.yaml", text) == expected


@pytest.mark.parametrize(("off", "expected"), [("0", []), ("0.004", ["WMR034"]), ("0.1", ["WMR031"])])
def test_two_axles_that_nearly_are_one(off: str, expected: list[str], tmp_path: Path) -> None:
    """What is a skid-steer robot by an axle of its own is a slip of the pen by 4 mm."""
    text = differential().replace("x: 0, y: -0.2", f"x: {off}, y: -0.2")
    assert codes(tmp_path / "robot.yaml", text) == expected


@pytest.mark.parametrize(("share", "expected"), [("7e-10", []), ("1e-8", ["WMR034"])])
@pytest.mark.parametrize(("half", "r"), [("0.02", "0.01"), ("4", "1")])
def test_what_the_noise_of_floats_is_goes_by_the_size_of_the_robot(
    half: str, r: str, share: str, expected: list[str], tmp_path: Path
) -> None:
    text = differential(y=half, r=r).replace(f"x: 0, y: -{half}", f"x: {half}*{share}, y: -{half}")
    assert codes(tmp_path / "robot.yaml", text) == expected


@pytest.mark.parametrize(("apart", "expected"), [("0.01", ["WMR034", "WMR010"]), ("0.02", [])])
def test_steered_wheels_that_nearly_stand_on_one_point(
    apart: str, expected: list[str], tmp_path: Path
) -> None:
    """No wheel is fixed: it is C1 whose rank is 2 by so little."""
    two = (
        f"name: {n}, type: steered, x: {x}, y: 0, heading: pi/2, r: 0.1"
        for n, x in (("a", "0"), ("b", apart))
    )
    text = wheels(*two, "name: c, type: castor, x: -1, y: 0, d: -0.05, heading: 0, r: 0.1")
    assert codes(tmp_path / "robot.yaml", text) == expected


@pytest.mark.parametrize(
    ("off", "expected"),
    [("0.3", []), ("0.300000000005", []), ("0.300001", ["WMR034"]), ("0.304", ["WMR034"])],
)
def test_a_robot_that_skids_on_two_axles_skids_beside_an_axle_that_is_taken_for_one(
    off: str, expected: list[str], tmp_path: Path
) -> None:
    """Beside a third axle that is a slip of the pen, what the robot is remains to be seen."""
    places = (("fl", "0.3", 0.2), ("fr", off, -0.2), ("bl", "-0.3", 0.2), ("br", "-0.3", -0.2))
    text = wheels(*(f"name: {n}, type: fixed, x: {x}, y: {y}, heading: 0, r: 0.1" for n, x, y in places))
    skids = ["WMR031"] * (off != "0.304")
    assert codes(tmp_path / "robot.yaml", text) == skids + expected


@pytest.mark.parametrize(
    ("half_track", "gamma", "expected"),
    [
        ("0.25", "45", ["WMR032"]),  # on oblong bases too
        ("0.201", "45", ["WMR032", "WMR033"]),
        ("0.2", "45", ["WMR033"]),  # rank 2: said once
        ("0.25", "-45", []),
        ("0.2", "-45", []),
    ],
)
def test_mecanum_rollers(half_track: str, gamma: str, expected: list[str], tmp_path: Path) -> None:
    text = f"angles: deg\nparameters: {{b: {half_track}, g: {gamma}}}\nwheels:\n"
    for name, x, y, g in (
        ("fl", "", "", ""),
        ("fr", "", "-", "-"),
        ("bl", "-", "", "-"),
        ("br", "-", "-", ""),
    ):
        text += f"  - {{name: {name}, type: swedish, x: {x}0.2, y: {y}b, heading: 0, gamma: {g}g, r: 0.05}}\n"
    assert codes(tmp_path / "robot.yaml", text) == expected


@pytest.mark.parametrize(
    "fourth",
    [
        "",
        "type: castor, x: -0.4, y: 0, heading: 0, d: -0.05, r: 0.05",
        "type: spherical, x: -0.4, y: 0, r: 0.05",
    ],
)
def test_three_wheels_of_aslant_rollers_are_no_four_mecanum_wheels(fourth: str, tmp_path: Path) -> None:
    three = (
        f"name: w{k}, type: swedish, l: 0.3, alpha: {k}*2*pi/3, beta: 0, gamma: 30 deg, r: 0.05"
        for k in range(3)
    )
    assert codes(tmp_path / "robot.yaml", wheels(*three, *([f"name: w3, {fourth}"] * bool(fourth)))) == []


@pytest.mark.parametrize("size", ["1e30", "1e30*1e5", "1e-30**4", "1e-30**4*1e-30**4*1e-30**2"])
def test_sizes_at_the_ends_of_what_is_read_stop_no_rule_but_their_own(size: str, tmp_path: Path) -> None:
    text = differential("c", head=f"parameters: {{c: {size}}}\n")
    assert {"WMR003", "WMR004"} & set(codes(tmp_path / "robot.yaml", text))


@pytest.mark.parametrize(
    ("gammas", "expected"),
    [
        ((-45, 45, 45, -45), []),
        ((45, -45, -45, 45), ["WMR032"]),
        ((-45, 45, 45, 45), ["WMR032"]),  # one wheel in the place of its mirror image
        ((-45, -45, 45, 45), ["WMR032"]),  # two of them
        ((45, -45, 45, -45), ["WMR032"]),
    ],
)
def test_mecanum_wheels_in_each_others_places(
    gammas: tuple[int, ...], expected: list[str], tmp_path: Path
) -> None:
    """On an oblong base whose origin is shifted."""
    places = ((0.5, 0.35), (0.5, -0.25), (0.1, 0.35), (0.1, -0.25))
    entries = (
        f"name: w{k}, type: swedish, x: {x}, y: {y}, heading: 0, gamma: {g} deg, r: 0.05"
        for k, ((x, y), g) in enumerate(zip(places, gammas, strict=True))
    )
    assert codes(tmp_path / "robot.yaml", wheels(*entries)) == expected


CAR = (
    "name: rear_left, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.1",
    "name: rear_right, type: fixed, x: 0, y: -0.3, heading: 0, r: 0.1",
    "name: front_left, type: steered, x: 1, y: 0.3, heading: 0, r: 0.1, actuated: [steer], "
    "limits: {steer: [-30 deg, 35 deg]}",
    "name: front_right, type: steered, x: 1, y: -0.3, heading: 0, r: 0.1, actuated: [steer], "
    "limits: {steer: [-35 deg, 30 deg]}",
)


@pytest.mark.parametrize(
    ("old", "new", "count"),
    [
        ("", "", 0),
        ("[-35 deg, 30 deg]", "[-30 deg, 35 deg]", 0),  # the same limits, not mirrored
        ("[-35 deg, 30 deg]", "[-25 deg, 35 deg]", 1),
        ("x: 1, y: -0.3", "x: 1.1, y: -0.3", 0),  # less than 10 % of the distance of the wheels
        ("x: 1, y: -0.3", "x: 1.2, y: -0.3", 1),
        ("x: 1, y: -0.3", "x: 1, y: -0.03", 1),
        ("front_right, type: steered, x: 1, y: -0.3, heading: 0, r: 0.1", "front_right, type: steered, x: 1, "
         "y: -0.3, heading: 0, r: 1", 1),
        ("r: 0.1", "r: 0.11", 0),  # of all wheels alike
    ],
)  # fmt: skip
def test_left_and_right_partners(old: str, new: str, count: int, tmp_path: Path) -> None:
    entries = [entry.replace(old, new) if old else entry for entry in CAR]
    assert codes(tmp_path / "robot.yaml", wheels(*entries)).count("WMR015") == count
