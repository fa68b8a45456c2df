"""Simulated drives against closed forms, and the figures that the texts print."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.conftest import GALLERY, ROOT, command_line
from tests.depth import everyday
from tests.oracle.harness import robot_text
from tests.seeds import layouts
from wmrgen import derive, load
from wmrgen.functions.motion.segments import Phase, Segment, plan
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.tools.simulating.drive import Drive, Moment, Order, simulate
from wmrgen.tools.simulating.model import Model, Reals
from wmrgen.tools.simulating.sources import GoToPose, Pursue, Recorded, Segments
from wmrgen.tools.simulating.table import read_table

CASES = {c["id"]: c for c in json.loads((ROOT / "textbook" / "cases.json").read_text())["cases"]}
NEEDED = ("inverse", "forward", "odometry", "odometry_increment")
BLIND = {"office_chair", "textbook_omni_steer", "unicycle"}  # their joints do not determine every motion
SEEING = [path for path in GALLERY if path.stem not in BLIND]
PAIR = """\
wmrgen: 1
name: pair
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.05}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.05}
"""
CASTOR = PAIR + "  - {name: tail, type: castor, x: -0.25, y: 0, d: 0.04, r: 0.03}\n"
TRACTOR = PAIR + "trailers:\n  - {name: cart, length: 0.8}\n"
CAR = """\
wmrgen: 1
name: car
wheels:
  - {name: rear,  type: fixed,   x: 0, y: 0, heading: 0, r: 0.1}
  - {name: front, type: steered, x: 1.2, y: 0, heading: 0, r: 0.1, actuated: [steer]}
"""


def model(text: str | Path, folder: Path, *functions: str) -> Model:
    """The model of a robot file, or of its text."""
    path = text if isinstance(text, Path) else folder / "robot.yaml"
    if isinstance(text, str):
        path.write_text(text, encoding="utf-8")
    return Model(derive(load(path), [*NEEDED, *functions]))


def poses(*rows: Sequence[float]) -> Reals:
    return np.array(rows or [(0.0, 0.0, 0.0)], float)


class Twists:
    """Constant twists, each for a time, in steps of at most 10 ms."""

    def __init__(self, *parts: tuple[float, float, float, float]) -> None:
        self.steps = []
        for seconds, *twist in parts:
            count = math.ceil(seconds / 0.01 - 1e-9)
            self.steps += [(seconds / count, twist)] * count

    def order(self, now: Moment) -> Order | None:
        if not self.steps:
            return None
        dt, (vx, vy, omega) = self.steps.pop(0)
        return Order((np.array([vx]), np.array([vy]), np.array([omega])), np.array([dt]))


def driven(robot: Model, *parts: tuple[float, float, float, float], **angles: float) -> Drive:
    given = {name.replace("_", "."): value for name, value in angles.items()}
    return simulate(robot, robot.start(poses(), given), Twists(*parts))


# ---- Pose: exact steps.


@pytest.mark.parametrize(("left", "right"), [(4.0, 6.0), (6.0, -2.0), (-3.0, 3.0), (5.0, 5.0), (-4.0, -1.0)])
def test_arcs_of_the_differential_drive(left: float, right: float, tmp_path: Path) -> None:
    """Constant wheel speeds drive v = r (r + l)/2, omega = r (r - l)/track: a circle, or a line."""
    robot, rows = model(PAIR, tmp_path), "".join(f"{t},{left},{right}\n" for t in (0, 0.7, 2.5))
    table = read_table("t,left.spin,right.spin\n" + rows, "inputs.csv", robot.derivation)
    drive = simulate(robot, robot.start(poses((1.0, 2.0, 0.5)), {}), Recorded(table, 0.03))
    v, omega, time = 0.05 * (left + right) / 2, 0.05 * (right - left) / 0.4, 2.5
    x, y = v * time, 0.0
    if omega:
        x, y = v / omega * math.sin(omega * time), v / omega * (1 - math.cos(omega * time))
    c, s = math.cos(0.5), math.sin(0.5)
    expected = (1 + c * x - s * y, 2 + s * x + c * y, 0.5 + omega * time)
    np.testing.assert_allclose(drive.pose(-1, 0), expected, atol=1e-12)
    np.testing.assert_allclose(drive.length[0], abs(v) * time, atol=1e-12)


def test_the_number_of_steps_has_no_effect_on_a_constant_twist(tmp_path: Path) -> None:
    robot = model(PAIR, tmp_path)
    table = read_table("t,vx,omega\n0,0.4,0.9\n3,0,0\n", "inputs.csv", robot.derivation)
    ends = [simulate(robot, robot.start(poses(), {}), Recorded(table, h)).pose(-1, 0) for h in (0.001, 3.0)]
    np.testing.assert_allclose(*ends, atol=1e-11)


@pytest.mark.parametrize(
    "path", everyday(SEEING, [p for p in SEEING if p.stem in ("pioneer3dx", "nomad_xr4000")])
)
def test_recorded_joints_drive_the_recorded_twist(path: Path, tmp_path: Path) -> None:
    """Forward kinematics of the joints of every row is the twist of that row."""
    robot = model(path, tmp_path)
    drive = driven(robot, (0.3, 0.4, 0.1, 0.5), (0.3, -0.2, 0.0, 0.3))
    rows = {name: column[:-1, 0] for name, column in drive.columns.items()}
    found = robot.call("forward", rows)
    for name in ("vx", "vy", "omega"):
        np.testing.assert_allclose(found[name], rows[name], atol=1e-9)


# ---- Angles that follow: castors and trailers.


def test_a_castor_flips_when_the_robot_reverses(tmp_path: Path) -> None:
    """Straight on: psi' = (v/d) sin psi, so tan(psi/2) = tan(psi0/2) exp(v t/d). It trails at pi, and flips to 0."""
    robot = model(CASTOR, tmp_path)
    drive = driven(robot, (0.5, 0.3, 0.0, 0.0), (1.0, -0.3, 0.0, 0.0), tail_steer=2.0)
    t, psi = drive.t[:, 0], drive.columns["tail.steer"][:, 0]
    travelled = np.where(t <= 0.5, 0.3 * t, 0.3 * (1.0 - t))
    exact = 2 * np.arctan(math.tan(1.0) * np.exp(travelled / 0.04))
    np.testing.assert_allclose(psi, exact, atol=1e-6)
    assert psi.max() > 0.98 * math.pi and psi[-1] < 0.08  # trailing forward, then turned around
    assert drive.reversals(0) == 1


def test_a_trailer_jack_knifes_in_reverse(tmp_path: Path) -> None:
    """Straight back: the hitch angle g has tan(g/2) = tan(g0/2) exp(v t/L), so it grows until the trailer has turned
    around; forward it decays."""
    robot = model(TRACTOR, tmp_path)
    back = driven(robot, (6.0, -0.5, 0.0, 0.0), cart_theta=-0.1)
    angle = -back.columns["cart.theta"][:, 0]
    np.testing.assert_allclose(
        angle, 2 * np.arctan(math.tan(0.05) * np.exp(0.5 * back.t[:, 0] / 0.8)), atol=1e-6
    )
    assert (np.diff(angle) > 0).all() and angle[-1] > math.pi / 2
    ahead = driven(robot, (6.0, 0.5, 0.0, 0.0), cart_theta=-0.1)
    assert abs(ahead.columns["cart.theta"][-1, 0]) < 0.003


def test_trailers_settle_on_the_steady_circle(tmp_path: Path) -> None:
    """R1^2 = R0^2 - L^2 with the hitch on the axle, so the hitch angle is atan(L/R1)."""
    robot = model(TRACTOR, tmp_path)
    drive = driven(robot, (40.0, 0.5, 0.0, 0.25))
    hitch = drive.columns["theta"][-1, 0] - drive.columns["cart.theta"][-1, 0]
    assert hitch == pytest.approx(math.asin(0.8 / 2.0), abs=1e-6)


def test_trailers_start_in_line_with_a_robot_that_drives_along_y(tmp_path: Path) -> None:
    text = TRACTOR.replace("x: 0, y: 0.2,  heading: 0", "x: 0.2, y: 0, heading: pi/2")
    text = text.replace("x: 0, y: -0.2, heading: 0", "x: -0.2, y: 0, heading: pi/2")
    drive = driven(model(text, tmp_path), (1.0, 0.0, 0.5, 0.0))
    np.testing.assert_allclose(drive.columns["cart.theta"], math.pi / 2, atol=1e-12)


# ---- Segments: Siegwart figures 3.15 and 3.16.


def _world(robot: Model, rows: Sequence[Sequence[float]], angles: Mapping[str, float]) -> list[Phase]:
    parts = [Segment("world", tuple(map(_exact, row)), Exact(1)) for row in rows]  # type: ignore[arg-type]
    now = {name.removesuffix(".steer"): _exact(angle) for name, angle in angles.items()}
    return plan(robot.robot, parts, robot.derivation.evaluate, (ZERO, ZERO, ZERO), now)


def _exact(value: float) -> Exact:
    from fractions import Fraction

    return Exact(Fraction(value))


def test_siegwart_figure_3_15(tmp_path: Path) -> None:
    """The omnidirectional robot: along x, a quarter turn, along y; poses and wheel speeds of the reference."""
    case = CASES["S-F3.15"]
    robot = model(robot_text(layouts.of(case, "polar")[0], polar=True), tmp_path)
    given, expected = case["given"]["segments"], case["expect"]
    phases = _world(robot, [part["twist_world"] for part in given], {})
    drive = simulate(robot, robot.start(poses(), {}), Segments(phases, 0.01))
    for k, pose in enumerate(expected["poses"]):
        np.testing.assert_allclose(drive.pose(100 * k, 0), pose, atol=1e-9)
    names = [f"w{k}.spin" for k in (1, 2, 3)]
    for k, rates in enumerate(expected["wheel_rates"]):
        row = [drive.columns[name][100 * k + 50, 0] for name in names]
        np.testing.assert_allclose(row, rates, atol=1e-9)


def test_siegwart_figure_3_16(tmp_path: Path) -> None:
    """Two steered wheels: the same course, in five phases: the robot stands while the wheels turn at their limit."""
    case = CASES["S-F3.16"]
    text = robot_text(layouts.of(case, "polar")[0], polar=True) + "limits: {steer_rate: 2}\n"
    robot = model(text, tmp_path)
    # Angle 0 of a wheel is its heading for turning on the spot. The drive starts with both wheels along x.
    headings = case["expect"]["spin_headings_deg"]
    start = {f"w{k}.steer": -math.radians(angle) for k, angle in enumerate(headings, 1)}
    phases = _world(robot, [(1, 0, 0), (0, 0, math.pi / 2), (0, 1, 0)], start)
    assert [p.action for p in phases] == ["drive", "steer", "drive", "steer", "drive"]
    drive = simulate(robot, robot.start(poses(), start), Segments(phases, 0.01))
    np.testing.assert_allclose(drive.pose(-1, 0), (1, 1, math.pi / 2), atol=1e-9)
    steering = np.abs(np.diff(drive.columns["w1.steer"][:, 0])) > 1e-9
    moving = np.abs(np.diff(drive.columns["x"][:, 0])) + np.abs(np.diff(drive.columns["theta"][:, 0])) > 1e-9
    moving |= np.abs(np.diff(drive.columns["y"][:, 0])) > 1e-9
    assert steering.any() and not (steering & moving).any()
    for wheel in ("w1.steer", "w2.steer"):
        rates = np.diff(drive.columns[wheel][:, 0]) / np.diff(drive.t[:, 0])
        assert np.abs(rates).max() <= 2 + 1e-9
    waits = [float(p.dt) for p in phases if p.action == "steer"]
    assert waits == pytest.approx([math.radians(50) / 2] * 2)
    assert drive.t[-1, 0] == pytest.approx(3 + sum(waits))
    # while it turns on the spot, each wheel rolls at l omega
    turning = np.argmax(np.abs(drive.columns["omega"][:, 0]))
    speed = 0.1 * abs(drive.columns["w1.spin"][turning, 0]) / (math.pi / 2)
    assert speed == pytest.approx(case["expect"]["wheel_speed_abs_for_omega1"])


# ---- Goals: Siegwart figure 3.20.


def test_siegwart_figure_3_20_sixteen_starts(tmp_path: Path) -> None:
    """k = (3, 8, -1.5), sixteen starts on the unit circle: all reach the goal, none changes its direction of travel."""
    robot = model(PAIR, tmp_path, "goto_pose")
    around = 2 * math.pi * np.arange(16) / 16
    starts = np.stack([np.cos(around), np.sin(around), np.zeros(16)], axis=-1)
    source = GoToPose((0.0, 0.0, 0.0), 0.01, 20.0)
    drive = simulate(robot, robot.start(starts, {}), source)
    assert drive.arrived is not None and (drive.arrived < 6).all()
    assert [drive.reversals(k) for k in range(16)] == [0] * 16
    # those with the goal ahead (|alpha| <= pi/2) drive forward, the others backwards
    forward = np.sign(drive.columns["vx"][0])
    assert forward.tolist() == [1.0 if math.cos(a) < 1e-9 else -1.0 for a in around]
    ends = np.array([drive.pose(-1, k) for k in range(16)])
    assert np.hypot(ends[:, 0], ends[:, 1]).max() < 1e-3 and np.abs(ends[:, 2]).max() < 0.01


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_siegwart_figure_3_20_against_the_continuous_law(number: int, tmp_path: Path) -> None:
    """The held law converges to the reference, of first order in the step."""
    case = CASES[f"S-F3.20-{number}"]
    robot = model(PAIR, tmp_path, "goto_pose")
    errors = []
    for step in (0.004, 0.002):
        source = GoToPose((0.0, 0.0, 0.0), step, case["given"]["t"])
        drive = simulate(robot, robot.start(poses(case["given"]["start_xytheta"]), {}), source)
        assert drive.t[-1, 0] == pytest.approx(case["given"]["t"])
        errors.append(np.array(drive.pose(-1, 0)) - case["expect"]["pose"])
    assert 1e-6 < np.abs(errors[1]).max() < 0.01
    np.testing.assert_allclose(errors[0], 2 * errors[1], atol=2e-4)


def test_the_goal_may_be_anywhere(tmp_path: Path) -> None:
    """Moving start and goal together moves the whole path."""
    robot = model(PAIR, tmp_path, "goto_pose")
    plain = simulate(robot, robot.start(poses((-1, 0.5, 0.3)), {}), GoToPose((0, 0, 0), 0.01, 9))
    c, s = math.cos(1.2), math.sin(1.2)
    start = (3 - c - 0.5 * s, -2 - s + 0.5 * c, 1.5)
    moved = simulate(robot, robot.start(poses(start), {}), GoToPose((3, -2, 1.2), 0.01, 9))
    np.testing.assert_allclose(moved.columns["left.spin"], plain.columns["left.spin"], atol=1e-6)


def test_the_law_is_about_the_axle(tmp_path: Path) -> None:
    """With P before the axle, wheels turn alike if the axle starts at the same place from its place at the goal."""
    plain = model(PAIR, tmp_path, "goto_pose")
    shifted = model(PAIR.replace("x: 0,", "x: -0.3,"), tmp_path, "goto_pose")
    x, y, theta = -1.0, 0.5, 0.7
    p = (x - 0.3 + 0.3 * math.cos(theta), y + 0.3 * math.sin(theta), theta)
    drives = []
    for robot, start in ((plain, (x, y, theta)), (shifted, p)):
        drives.append(simulate(robot, robot.start(poses(start), {}), GoToPose((0, 0, 0), 0.01, 2)))
    for wheel in ("left.spin", "right.spin"):
        np.testing.assert_allclose(drives[0].columns[wheel], drives[1].columns[wheel], rtol=1e-9)
    assert drives[1].columns["slip"].max() < 1e-9


def test_the_direction_of_travel_is_kept(tmp_path: Path) -> None:
    """These gains turn the goal behind the robot on the way (S 3.65 is not enough); the direction stays as it was."""
    text = PAIR + "gains: {k_rho: 0.5, k_alpha: 10.5, k_beta: -6}\n"
    robot = model(text, tmp_path, "goto_pose")
    alpha, beta = 1.55, 3.1
    start = poses((-math.cos(beta), math.sin(beta), -alpha - beta))
    drive = simulate(robot, robot.start(start, {}), GoToPose((0, 0, 0), 0.001, 0.5))
    x, y, theta = (drive.columns[name] for name in ("x", "y", "theta"))
    ahead = -np.cos(theta) * x - np.sin(theta) * y
    assert ahead[0] > 0 and ahead.min() < 0  # the goal gets behind
    assert (drive.columns["vx"] > 0).all()


@pytest.mark.parametrize("speed", [0.5, -0.5])
@pytest.mark.parametrize("text", [PAIR, CAR])
def test_pursuit_drives_one_circle_to_the_point(text: str, speed: float, tmp_path: Path) -> None:
    """A circle tangent to x through (a, b) has the radius (a^2 + b^2)/(2 b)."""
    robot = model(text, tmp_path, "pursuit")
    a, b = math.copysign(2.0, speed), 1.0
    drive = simulate(robot, robot.start(poses(), {}), Pursue((a, b), speed, 0.01, 30.0))
    np.testing.assert_allclose(drive.pose(-1, 0)[:2], (a, b), atol=2e-3)
    x, y, radius = drive.columns["x"], drive.columns["y"], (a * a + b * b) / (2 * b)
    np.testing.assert_allclose(np.hypot(x, y - radius), radius, atol=1e-4)
    assert drive.arrived is not None
    assert drive.length[0] == pytest.approx(radius * 2 * math.atan2(b, abs(a)), abs=2e-3)


# ---- Commands in the inputs of the model.


def test_a_car_with_a_steering_rate_against_a_finer_integration(tmp_path: Path) -> None:
    """Constant speed and steering rate, against the midpoint rule with a thousand times the steps."""
    robot = model(CAR, tmp_path)
    names = [port.name for port in robot.derivation.default_state_space.inputs]  # type: ignore[union-attr]
    values = {"front.steer_rate": 0.3}
    speed = next(name for name in names if name != "front.steer_rate")
    values[speed] = 5.0
    header = ",".join(["t", *names])
    rows = "".join(f"{t}," + ",".join(str(values[n]) for n in names) + "\n" for t in (0, 2))
    table = read_table(f"{header}\n{rows}", "inputs.csv", robot.derivation)
    drive = simulate(robot, robot.start(poses(), {}), Recorded(table, 0.01))
    v = 5.0 * (0.1 if speed.endswith(".spin") else 1.0)  # r spin, or a speed in m/s
    count = 200_000
    h = 2 / count
    theta = np.cumsum(v * np.tan(0.3 * h * (np.arange(count) + 0.5)) / 1.2 * h)
    middle = theta - np.diff(theta, prepend=0.0) / 2
    expected = (
        float((v * h * np.cos(middle)).sum()),
        float((v * h * np.sin(middle)).sum()),
        float(theta[-1]),
    )
    np.testing.assert_allclose(drive.pose(-1, 0), expected, atol=1e-8)
    assert drive.columns["front.steer"][-1, 0] == pytest.approx(0.6)
    assert drive.columns["slip"].max() < 1e-6
    rows = {name: column[:-1, 0] for name, column in drive.columns.items()}
    step = robot.call("odometry_increment", {**rows, "dt": np.diff(drive.t[:, 0])})
    for name in ("x", "y", "theta"):  # the recorded twists lead from row to row
        np.testing.assert_allclose(step[f"{name}_step"], np.diff(drive.columns[name][:, 0]), atol=1e-12)


# ---- The command line.


def run(*words: object, code: int = 0) -> dict[str, Any]:
    done = command_line("simulate", *words, "--json")
    assert done.code == code, done.err
    found: dict[str, Any] = json.loads(done.out)
    return found


def test_two_robots_on_one_course(tmp_path: Path) -> None:
    first, second = tmp_path / "pair.yaml", tmp_path / "castor.yaml"
    first.write_text(PAIR)
    second.write_text(CASTOR.replace("name: pair", "name: other"))
    table = tmp_path / "drive.csv"
    done = run(first, "--compare", second, "--twist", "0.5,0,0.5", "--time", "pi", "tail=pi", "--csv", table)
    assert [d["robot"] for d in done["drives"]] == ["pair", "other"]
    for drive in done["drives"]:
        np.testing.assert_allclose(drive["end"], (1, 1, math.pi / 2), atol=1e-9)
    assert list(done["drives"][1]["angles"]) == ["tail.steer"]
    lines = table.read_text().splitlines()
    assert lines[0].split(",")[:3] == ["robot", "t", "x"] or "robot" in lines[0].split(",")
    assert {line.split(",")[0] for line in lines[1:]} == {"pair", "other"}
    assert all(line.count(",") == lines[0].count(",") for line in lines)


def test_a_forbidden_twist_is_projected_and_reported(robot_file: Path) -> None:
    done = command_line("simulate", robot_file, "--twist", "0.5,0.2,0", "--time", "2", "--json")
    drive = json.loads(done.out)["drives"][0]
    np.testing.assert_allclose(drive["end"], (1, 0, 0), atol=1e-12)
    assert drive["slip"] > 0.1 and done.err


BAD: Mapping[str, Sequence[str]] = {
    "no course": [],
    "two courses": ["--twist", "1,0,0", "--time", "1", "--goal", "0,0,0"],
    "no duration": ["--twist", "1,0,0"],
    "two values": ["--twist", "1,0", "--time", "1"],
    "wrong unit": ["--twist", "1 rad,0,0", "--time", "1"],
    "no number": ["--twist", "fast,0,0", "--time", "1"],
    "no time": ["--twist", "1,0,0", "--time", "0"],
    "negative step": ["--twist", "1,0,0", "--time", "1", "--step", "-1"],
    "too many steps": ["--twist", "1,0,0", "--time", "1e5"],
    "too many steps of a segment": ["--twist", "1,0,0", "--time", "1", "--step", "1e-12"],
    "too many steps to a goal": ["--goal", "1,0,0", "--step", "1e-12"],
    "no finite number": ["--twist", "1e400,0,0", "--time", "1"],
    "beyond doubles": ["--twist", "1e300,0,1e300", "--time", "1e300", "--step", "1e300"],
    "circle without a goal": ["--twist", "1,0,0", "--time", "1", "--from", "circle:8"],
    "circle of no robots": ["--goal", "0,0,0", "--from", "circle:0"],
    "circle of a word": ["--goal", "0,0,0", "--from", "circle:many"],
    "law without a goal": ["--twist", "1,0,0", "--time", "1", "--law", "pursuit"],
    "unknown angle": ["--twist", "1,0,0", "--time", "1", "nose=1"],
    "missing file": ["none.csv"],
    "missing segments": ["--segments", "none.json"],
    "missing robot": ["--twist", "1,0,0", "--time", "1", "--compare", "none.yaml"],
    "speed of nothing": ["--goal", "1,0,0", "--law", "pursuit", "--speed", "0"],
    "time of a table": ["inputs.csv", "--time", "2"],
    "speed without pursuit": ["--goal", "1,0,0", "--speed", "0.5"],
    "speed of a twist": ["--twist", "1,0,0", "--time", "1", "--speed", "0.5"],
    "circle of no radius": ["--goal", "0,0,0", "--from", "circle:8:"],
    "circle of a wrong radius": ["--goal", "0,0,0", "--from", "circle:8:2 deg"],
    "time in metres": ["--twist", "1,0,0", "--time", "1 m"],
    "circle of radius 0": ["--goal", "0,0,0", "--from", "circle:8:0"],
}


@pytest.mark.parametrize("name", BAD)
def test_wrong_usage_is_refused(name: str, robot_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(robot_file.parent)
    found = run(robot_file, *BAD[name], code=2)
    assert found["exit_code"] == 2 and found["errors"]


@pytest.mark.parametrize(
    "text",
    [
        "t;vx\n0;1\n1;1\n",
        "", "t,vx\n", "t,vx\n0,1\n", "vx,omega\n0,1\n1,1\n", "t,vx\n0,1\n0,1\n", "t,vx\n0,one\n1,1\n",
        "t,vx\n0,1,2\n1,1\n", "t,vx\n0,nan\n1,1\n", "t,vx,vx\n0,1,1\n1,1,1\n", "t,speed\n0,1\n1,1\n",
        "t,left.spin\n0,1\n1,1\n", "t\n0\n1\n", "t,vx\n0,\0\n1,1\n", "t,vx\n0," + 200_000 * "1" + "\n1,1\n",
    ],
)  # fmt: skip
def test_wrong_tables_are_refused(text: str, robot_file: Path) -> None:
    path = robot_file.parent / "inputs.csv"
    path.write_text(text)
    assert run(robot_file, path, code=2)["errors"]


def test_huge_numbers_do_not_widen_the_table(robot_file: Path) -> None:
    done = command_line("simulate", robot_file, "--twist", "1e300,0,0", "--time", "1")
    assert done.code == 0 and all(len(line) < 200 for line in done.out.splitlines())


def test_a_robot_without_drives_is_remarked(robot_file: Path) -> None:
    words = ["--twist", "1,0,0", "--time", "1"]
    assert not command_line("simulate", robot_file, *words).err
    robot_file.write_text(PAIR.replace("r: 0.05}", "r: 0.05, actuated: []}"))
    done = command_line("simulate", robot_file, *words)
    assert done.code == 0 and done.err
