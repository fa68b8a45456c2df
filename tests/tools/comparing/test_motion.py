"""What differences do to a motion: formulas of the texts, and the derivation's own inverse and forward kinematics."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

import wmrgen
from tests.tools.comparing.test_corpus import bicycle, mecanum, ring, side
from wmrgen.derivation.emit import artifacts
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.skid import driven
from wmrgen.tools.comparing.compare import compare
from wmrgen.tools.comparing.parameters import standing
from wmrgen.tools.comparing.quantities import as_driven
from wmrgen.tools.comparing.record import Comparison, Layout, Side
from wmrgen.tools.comparing.sources import layouts, of_header, of_robot

S = pytest.mark.parametrize("s", [0.8, 1.07])


def differential(track: float, r: float = 0.1, x: float = 0, left: float = 0, right: float = 0) -> Layout:
    wheels = (
        side("left", "fixed", x, track / 2, left, r=r),
        side("right", "fixed", x, -track / 2, right, r=r),
    )
    return Layout("differential", "description", wheels)


def skid(track: float, wheelbase: float) -> Layout:
    wheels = [
        side(f"{end}_{name}", "fixed", a * wheelbase / 2, b * track / 2)
        for end, a in (("front", 1), ("rear", -1))
        for name, b in (("left", 1), ("right", -1))
    ]
    return Layout("skid", "description", tuple(wheels))


def car(wheelbase: float, track: float, front_track: float, r: float = 0.3, x: float = 0) -> Layout:
    wheels = [
        side(f"rear_{name}", "fixed", x, b * track / 2, r=r) for name, b in (("left", 1), ("right", -1))
    ]
    wheels += [
        Side((w.name,), w.type, w.values, {}, ("steer",))
        for name, b in (("left", 1), ("right", -1))
        for w in [side(f"front_{name}", "steered", x + wheelbase, b * front_track / 2)]
    ]
    return Layout("car", "description", tuple(wheels))


def ratios(c: Comparison) -> dict[str, float]:
    return {e.motion: e.ratio for e in c.effects}


def near(**expected: float) -> object:
    return pytest.approx(expected, abs=1e-9)


@S
def test_differential(s: float) -> None:
    """Siegwart (3.9): the yaw rate is r (right - left)/track."""
    for x in (0.0, -0.17):
        a = differential(0.37, x=x)
        assert ratios(compare(a, differential(0.37 * s, x=x))) == near(straight=1, turn=s)
        assert ratios(compare(a, differential(0.37, r=0.1 * s, x=x))) == near(straight=1 / s, turn=1 / s)


@S
def test_skid(s: float) -> None:
    """Turning is skidding: how much depends on the lengths, but the command's share is that of the track."""
    assert ratios(compare(skid(0.5, 0.7), skid(0.5 * s, 0.7))) == near(straight=1, turn=s)
    assert ratios(compare(skid(0.5, 0.7), skid(0.5, 0.7 * s))) == near(straight=1, turn=1)


@S
def test_mecanum(s: float) -> None:
    """The rim speed for a turn is lx + ly."""
    a, lx, ly = mecanum(0.5, 0.3, 0.1), 0.25, 0.15
    assert ratios(compare(a, mecanum(0.5 * s, 0.3, 0.1))) == near(
        straight=1, strafe=1, turn=(s * lx + ly) / (lx + ly)
    )
    assert ratios(compare(a, mecanum(0.5, 0.3 * s, 0.1))) == near(
        straight=1, strafe=1, turn=(lx + s * ly) / (lx + ly)
    )
    assert ratios(compare(a, mecanum(0.5, 0.3, 0.1 * s))) == near(straight=1 / s, strafe=1 / s, turn=1 / s)


@S
def test_omni(s: float, tmp_path: Path) -> None:
    """A ring scales about its centre, not about the rectangle that three wheels fill: the yaw rate changes alone."""
    path = tmp_path / "p.yaml"
    path.write_text(
        f"a: {{type: omni_wheel_drive_controller/Omni, robot_radius: {0.2 * s}, wheel_radius: 0.1}}\n"
    )
    (parameters,) = layouts(path)
    for other in (ring((0.2 * s,) * 3), parameters):
        result = compare(ring((0.2,) * 3), other)
        assert [d.code for d in result.differences] == ["WMR043"]
        assert ratios(result) == near(straight=1, strafe=1, turn=s)
        assert said(result) == {"turn": f"yaw rate {abs(s - 1) * 100:.1f} % {'high' if s > 1 else 'low'}"}


@S
def test_car(s: float) -> None:
    """Tzafestas (2.52): tan of the steering angle is wheelbase times curvature; small, the angles are in proportion."""
    for x in (0.0, -0.9):
        one, other = (bicycle(x + 1.5 * k, x) for k in (1, s))
        assert ratios(compare(one, other)) == pytest.approx({"straight": 1, "turn": s}, abs=1e-6)
        a = car(1.5, 1.1, 1.2, x=x)
        assert ratios(compare(a, car(1.5 * s, 1.1, 1.2, x=x))) == pytest.approx(
            {"straight": 1, "turn": s}, abs=1e-6
        )
        assert ratios(compare(a, car(1.5, 1.1, 1.2, r=0.3 * s, x=x))) == pytest.approx(
            {"straight": 1 / s, "turn": 1 / s}
        )
        narrow = compare(a, car(1.5, 1.1 * s, 1.2, x=x))
        assert ratios(narrow) == pytest.approx({"straight": 1, "turn": 1})
        assert "work against each other" in said(narrow)["turn"]


def said(c: Comparison) -> dict[str, str]:
    return {e.motion: e.words for e in c.effects if e.words}


def test_signs_and_rollers_in_words() -> None:
    pi = math.pi
    a = differential(0.4)
    assert said(compare(a, a)) == {}
    both = said(compare(a, differential(0.4, left=pi, right=pi)))
    assert both == {"straight": "drives backwards", "turn": "turns the wrong way"}
    assert said(compare(a, differential(-0.4))) == {"turn": "turns the wrong way"}
    one = said(compare(a, differential(0.4, left=pi)))
    assert one["straight"].startswith("does not drive straight, turns while driving straight")
    assert one["turn"].startswith("does not turn")
    m = mecanum(0.5, 0.3, 0.1)
    mirrored = [Side(w.names, w.type, dict(w.values) | {"gamma": -w.of("gamma")}) for w in m.wheels]
    words = said(compare(m, Layout("seen from above", "", tuple(mirrored))))
    assert words["strafe"] == "strafes the wrong way"
    assert said(compare(a, differential(0.4 * 0.958))) == {"turn": "yaw rate 4.2 % low"}
    assert said(compare(a, differential(0.4, r=0.1 / 1.013)))["straight"] == "drives 1.3 % too fast"
    assert said(compare(a, differential(0.8))) == {"turn": "yaw rate 100.0 % high"}


def test_what_is_equal() -> None:
    """0.2 % of a length, 2e-3 rad, on both sides of the threshold."""
    a = differential(0.4)
    assert not compare(a, differential(0.4 * 1.0019)).differences
    assert [d.code for d in compare(a, differential(0.4 * 1.0021)).differences] == ["WMR040"]
    assert not compare(a, differential(0.4, r=0.1 * 0.9981)).differences
    assert [d.code for d in compare(a, differential(0.4, r=0.1 * 0.9979)).differences] == ["WMR042"]
    assert not compare(a, differential(0.4, right=1.9e-3)).differences
    assert [d.code for d in compare(a, differential(0.4, right=2.1e-3)).differences] == ["WMR045"]
    assert not compare(a, differential(0.4, left=-0.0, right=2 * math.pi)).differences


TEXTS = {
    "differential": (
        "  - {{name: left, type: fixed, x: {x}, y: 0.2, heading: 0, r: {r}}}\n"
        "  - {{name: right, type: fixed, x: {x}, y: -{y}, heading: 0, r: 0.1}}\n"
    ),
    "skid": (
        "  - {{name: fl, type: fixed, x: 0.31, y: 0.2, heading: 0, r: {r}}}\n"
        "  - {{name: fr, type: fixed, x: 0.3, y: -{y}, heading: 0, r: 0.1}}\n"
        "  - {{name: rl, type: fixed, x: -0.2, y: 0.25, heading: 0, r: 0.1}}\n"
        "  - {{name: rr, type: fixed, x: {x}, y: -0.25, heading: 0, r: 0.1}}\n"
    ),
    "mecanum": (
        "  - {{name: fl, type: swedish, x: 0.3, y: 0.2, heading: 0, r: {r}, gamma: -45 deg}}\n"
        "  - {{name: fr, type: swedish, x: 0.3, y: -{y}, heading: 0, r: 0.1, gamma: 45 deg}}\n"
        "  - {{name: rl, type: swedish, x: -0.2, y: 0.25, heading: pi, r: 0.1, gamma: 40 deg}}\n"
        "  - {{name: rr, type: swedish, x: {x}, y: -0.25, heading: 0, r: 0.1, gamma: -45 deg}}\n"
    ),
    "modules": (
        "  - {{name: fl, type: steered, x: 0.3, y: 0.2, heading: 0, r: {r}, offset_y: 0.03}}\n"
        "  - {{name: fr, type: steered, x: 0.3, y: -{y}, heading: 0.3, r: 0.1}}\n"
        "  - {{name: rear, type: steered, x: {x}, y: 0.05, heading: pi, r: 0.1, offset_y: -0.02}}\n"
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", TEXTS)
def test_the_derivation_says_the_same(kind: str, tmp_path: Path) -> None:
    """Forward kinematics of the first robot, of inverse kinematics of the second, exactly evaluated."""
    robots = []
    for name, values in (
        ("one", {"x": "-0.15", "y": "0.2", "r": "0.1"}),
        ("two", {"x": "-0.16", "y": "0.23", "r": "0.12"}),
    ):
        path = tmp_path / f"{name}.yaml"
        path.write_text(f"wmrgen: 1\nname: {name}\nwheels:\n{TEXTS[kind].format(**values)}", encoding="utf-8")
        robots.append(wmrgen.load(path))
    first, second = (wmrgen.derive(robot, ["inverse", "forward"]) for robot in robots)
    result = compare(*(layouts(tmp_path / f"{name}.yaml")[0] for name in ("one", "two")))
    assert ratios(result)
    for effect in result.effects:
        twist = {"straight": "vx", "strafe": "vy", "turn": "omega"}[effect.motion]
        moved = []
        for driver in (first, second):
            told = (
                driver.evaluate("inverse", {twist: Exact.of(1)})
                if kind != "differential" or twist != "turn"
                else None
            )
            if told is None:  # P is beside the axle: the twist that it allows
                x = Fraction(str({"one": -0.15, "two": -0.16}[driver.robot.name]))
                told = driver.evaluate("inverse", {"omega": Exact.of(1), "vy": Exact.of(-x)})
            rates = {name: value for name, value in told.items() if name != "slip"}
            moved.append(float(first.evaluate("forward", rates)[twist]))
        assert effect.ratio == pytest.approx(moved[1] / moved[0], rel=1e-9), effect


def test_nothing_in_the_gallery_differs_from_itself_or_its_header() -> None:
    from tests.conftest import GALLERY, ROOT

    for path in GALLERY:
        robot = wmrgen.read(path)
        (header,) = layouts(ROOT / "generated" / path.stem / f"{path.stem}.h")
        for other in (of_robot(*robot, "itself"), header):
            result = compare(of_robot(*robot, "robot"), other)
            assert not result.differences, path
            assert not said(result), path


KINDS = {
    "diff_drive_controller/DiffDriveController": ("wheel_separation", "wheel_radius"),
    "mecanum_drive_controller/MecanumDriveController": ("wheel_separation_x", "wheel_radius"),
    "tricycle_controller/TricycleController": ("wheelbase", "wheel_radius"),
    "bicycle_steering_controller/BicycleSteeringController": ("wheelbase", "rear_wheel_radius"),
    "ackermann_steering_controller/AckermannSteeringController": ("wheelbase", "rear_wheels_radius"),
    "omnidirectional_controllers/OmnidirectionalController": ("robot_radius", "wheel_radius"),
    "swerve_drive_controller/SwerveController": ("chassis_length", "wheel_radius"),
}


@pytest.mark.parametrize("kind", KINDS)
@S
def test_two_controllers_without_a_robot(kind: str, s: float, tmp_path: Path) -> None:
    """The first is a robot of its kind; only what both say is compared."""
    key, radius = KINDS[kind]
    texts = (
        f"{key}: 0.6, {radius}: 0.1",
        f"{key}: {0.6 * s}, {radius}: 0.1, wheel_steering_y_offset: 0.1",
        f"{radius}: 0.1",
    )
    given = []
    for text in texts:
        path = tmp_path / "p.yaml"
        path.write_text(f"drive: {{type: {kind}, {text}}}\n", encoding="utf-8")
        given += layouts(path)
    first, second, silent = given
    assert not compare(first, first).differences
    assert not compare(first, silent).differences and not compare(silent, first).differences
    result = compare(first, second)
    assert len(result.differences) == 1
    turn = ratios(result)["turn"]
    if kind.startswith(("swerve", "mecanum")):
        assert (turn > 1) == (s > 1)
        assert [abs(w.values["x"]) for w in standing(first).wheels] == pytest.approx([0.3] * 4)
    else:
        assert turn == pytest.approx(s, abs=1e-6)


CAR = (
    "drive: {type: ackermann_steering_controller/AckermannSteeringController, wheelbase: 1,"
    " traction_joints_names: [rear_right, rear_left], steering_joints_names: [front_right, front_left]}"
)
RING = (
    "drive: {type: omni_wheel_drive_controller/OmniWheelDriveController, robot_radius: 0.2, wheel_radius: 0.1,"
    f" wheel_offset: {math.pi / 3}, wheel_names: [w0, w1, w2]}}"
)


@pytest.mark.parametrize(
    ("text", "robot", "backward"),
    [(CAR, car(1, 0.5, 0.5), ["rear_right"]), (RING, ring((0.2, 0.2, 0.2)), ["w2"])],
)
def test_a_joint_that_counts_backward_for_cars_and_rings(
    tmp_path: Path, text: str, robot: Layout, backward: list[str]
) -> None:
    """The last wheel but those that steer is turned round."""
    *_, last = (w for w in robot.wheels if w.type != "steered")
    turned = replace(last, values={**last.values, "heading": last.of("heading") + math.pi})
    wheels = tuple(turned if w is last else w for w in robot.wheels)
    (tmp_path / "p.yaml").write_text(text, encoding="utf-8")
    (controller,) = layouts(tmp_path / "p.yaml")
    results = [compare(replace(robot, wheels=own), controller) for own in (robot.wheels, wheels)]
    wrong = [[(d.code, d.wheel) for d in c.differences] for c in results]
    assert wrong == [[], [("WMR052", name) for name in backward]]


def test_a_joint_that_counts_backward_for_a_controller_that_cannot_know(tmp_path: Path) -> None:
    path = tmp_path / "p.yaml"
    path.write_text(
        "drive: {type: diff_drive_controller/DiffDriveController, wheel_separation: 0.4}\n", encoding="utf-8"
    )
    (controller,) = layouts(path)
    result = compare(differential(0.4, left=math.pi), controller)
    assert [(d.code, d.wheel) for d in result.differences] == [("WMR045", "left")]
    assert said(result)["straight"].startswith("does not drive straight, turns")
    path.write_text(
        "driver: {wheel_separation: 0.4}\n", encoding="utf-8"
    )  # may know how its motors are mounted
    assert not compare(differential(0.4, left=math.pi), *layouts(path)).differences


SKID = """wmrgen: 1
name: skid
effective_track: {track}
wheels:
  - {{name: front_left, type: fixed, x: 0.2, y: 0.3, heading: 0, r: 0.1}}
  - {{name: front_right, type: fixed, x: 0.2, y: -0.3, heading: 0, r: 0.1}}
  - {{name: rear_left, type: fixed, x: -0.3, y: 0.3, heading: 0, r: 0.1}}
  - {{name: rear_right, type: fixed, x: -0.3, y: -0.3, heading: 0, r: 0.1}}
"""


def skidding(folder: Path, track: str) -> Layout:
    """A robot file with an effective track, or, where it is empty, without."""
    text = SKID.format(track=track)
    path = folder / f"skid{track}.yaml"
    path.write_text(text if track else text.replace("effective_track: \n", ""), encoding="utf-8")
    (layout,) = layouts(path)
    return layout


@pytest.mark.parametrize(
    ("separation", "multiplier", "product"),
    [(0.6, 1.5, 0.9), (0.6, 1.2, 0.72), (0.9, 1.0, 0.9), (0.6, 1.0, 0.6)],
)
def test_the_effective_track_is_that_times_the_multiplier(
    tmp_path: Path, separation: float, multiplier: float, product: float
) -> None:
    path = tmp_path / "p.yaml"
    lengths = f"wheel_separation: {separation}, wheel_separation_multiplier: {multiplier}, wheel_radius: 0.1"
    path.write_text(
        f"drive: {{type: diff_drive_controller/DiffDriveController, {lengths}}}\n", encoding="utf-8"
    )
    result = compare(skidding(tmp_path, "0.9"), *layouts(path))
    assert ratios(result) == near(straight=1, turn=product / 0.9)
    told = [(d.code, d.quantity, d.a, d.b) for d in result.differences]
    assert told == ([] if product == 0.9 else [("WMR040", "effective track", 0.9, pytest.approx(product))])
    assert not result.notes


def test_effective_tracks_of_two_files(tmp_path: Path) -> None:
    """What a file does not say, and the header says it, is taken from the other."""
    wide, narrow, silent = (skidding(tmp_path, track) for track in ("0.9", "0.72", ""))
    result = compare(wide, narrow)
    assert ratios(result) == near(straight=1, turn=0.8)
    assert [(d.code, d.quantity) for d in result.differences] == [("WMR040", "effective track")]
    assert [(m.file, m.line) for m in result.differences[0].marks] == [(narrow.file, 3), (wide.file, 3)]
    for a, b in ((wide, silent), (silent, narrow)):
        assert not compare(a, b).differences and ratios(compare(a, b)) == near(straight=1, turn=1)
    derivation = wmrgen.derive(wmrgen.load(tmp_path / "skid0.72.yaml"))
    header = of_header(artifacts(derivation)["skid.h"].decode(), "skid.h")
    assert not compare(narrow, header).differences
    assert ratios(compare(wide, header)) == near(straight=1, turn=0.8)


def test_a_radius_of_one_side(tmp_path: Path) -> None:
    path = tmp_path / "p.yaml"
    path.write_text(
        "drive: {wheel_separation: 0.4, wheel_radius: 0.1, left_wheel_radius_multiplier: 0.98}\n",
        encoding="utf-8",
    )
    result = compare(differential(0.4), *layouts(path))
    assert [(d.code, d.quantity) for d in result.differences] == [("WMR042", "left radius")]
    assert said(result)["straight"] == "drives 1.0 % too fast, turns while driving straight"


def test_a_controller_that_swaps_the_sides(tmp_path: Path) -> None:
    path = tmp_path / "p.yaml"
    path.write_text("drive: {wheel_separation: 0.4, left_wheel: right, right_wheel: left}\n")
    result = compare(differential(0.4), *layouts(path))
    assert [(d.code, d.wheel, d.b) for d in result.differences] == [
        ("WMR044", "left", "right"), ("WMR044", "right", "left"),
    ]  # fmt: skip
    assert said(result) == {"turn": "turns the wrong way"}
    path.write_text("drive: {wheel_separation: 0.5, left_wheel: left, right_wheel: right}\n")
    assert said(compare(differential(0.4), *layouts(path))) == {"turn": "yaw rate 25.0 % high"}
    front = "front_left_wheel: rear_left, rear_left_wheel: front_left"
    path.write_text(f"drive: {{type: mecanum_drive_controller/MecanumDriveController, {front}}}\n")
    result = compare(mecanum(0.5, 0.3, 0.1), *layouts(path))
    assert [d.wheel for d in result.differences] == ["front_left", "rear_left"]
    assert said(result)["strafe"].startswith("does not strafe, wheels work against each other")


@pytest.mark.parametrize(("heading", "at"), [(0, 0), (90, 1 + 2j), (-150, -3j)])
def test_a_robot_that_skids_stands_as_in_its_derivation(tmp_path: Path, heading: int, at: complex) -> None:
    turn = cmath.rect(1, math.radians(heading))
    places = [at + turn * p for p in (0.2 + 0.3j, 0.25 - 0.3j, -0.3 + 0.35j, -0.3 - 0.3j)]
    lines = [
        f"  - {{name: w{k}, type: fixed, x: {p.real!r}, y: {p.imag!r}, heading: {heading} deg, r: 0.1}}\n"
        for k, p in enumerate(places)
    ]
    path = tmp_path / "skid.yaml"
    path.write_text(
        f"wmrgen: 1\nname: skid\neffective_track: 0.9\nwheels:\n{''.join(lines)}", encoding="utf-8"
    )
    (layout,) = layouts(path)
    expected = [
        at + turn * (-0.0375 + (0.0125 + way * 0.45) * 1j) for way in (1, -1, 1, -1)
    ]  # means, by hand
    assert [w.pivot for w in driven(wmrgen.load(path)).wheels] == pytest.approx(expected)
    assert [w.pivot for w in as_driven(layout.wheels, 0.9)] == pytest.approx(expected)
    rolling = mecanum(0.5, 0.6, 0.1)
    assert as_driven(rolling.wheels, 0.9) == rolling.wheels  # nothing of it skids
