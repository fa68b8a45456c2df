"""Import after export is the same robot: wheels, places, headings, rollers, motors, couplings, degrees.

Import knows wheels by their axles, so balls are not among what comes back. One wheel alone it takes for one where the
file drives it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

import wmrgen
from tests.conftest import GALLERY, Outcome
from tests.depth import DEEP
from tests.tools.exporting.common import drives, load, same_angle
from wmrgen.errors import NotDerivableError
from wmrgen.geometry.layout.records import Robot
from wmrgen.robotfile.wheel_types import CASTOR, FIXED
from wmrgen.tools.comparing.compare import compare
from wmrgen.tools.comparing.sources import layouts
from wmrgen.tools.exporting.ros2_control import ros2_control
from wmrgen.tools.exporting.sdf import sdf
from wmrgen.tools.exporting.urdf import urdf
from wmrgen.tools.importing.records import SUPPORT, Imported, Question
from wmrgen.tools.importing.robot_file import text
from wmrgen.tools.importing.source import description_of
from wmrgen.tools.importing.wheels import import_wheels

WRITERS = {"urdf": urdf, "sdf": sdf}


def back(robot: Robot, folder: Path, kind: str, written: str = "") -> Imported:
    path = folder / f"{robot.name}.{kind}"
    path.write_text(written or WRITERS[kind](robot), encoding="utf-8")
    return import_wheels(description_of(path, (), ()), None)


def asked(robot: Robot, imported: Imported) -> list[Question]:
    """What is asked, but whether two wheels stand, of castors alone without motors which have one, whether a wheel
    stands so that differs in one length from three others or more, and whether four driven wheels of a robot that skids
    have rollers: a URDF does not say."""
    skids = len(robot.wheels) == 4 and all("spin" in w.actuated and w.kind == FIXED for w in robot.wheels)
    motors = any(w.actuated or (w.has_spin and w.kind != CASTOR) for w in robot.wheels)
    questions = [q for q in imported.questions if q.wheel != SUPPORT and "others" not in q.text]
    questions = [q for q in questions if not (skids and q.key == "type" and len(q.also) == 3)]
    return [q for q in questions if motors or (q.key, q.hints) != ("actuated", ("[spin, steer]", "[]"))]


def same(robot: Robot, imported: Imported) -> None:
    assert imported.base in ("base_link", "__model__")  # of SDFormat the model, where base_link lies
    assert [q for q in asked(robot, imported) if "which way is forward" not in q.text] == []
    by_joint = {w.joint: w for w in imported.wheels}
    rolling = [w for w in robot.wheels if w.has_spin]
    assert list(by_joint) == [f"{w.name}_spin" for w in rolling]
    for w in rolling:
        got = by_joint[f"{w.name}_spin"]
        assert got.steer_joint == (f"{w.name}_steer" if w.turns else None)
        assert got.type == w.type
        g = w.nominal
        for value, wanted in ((got.x, g.x), (got.y, g.y), (got.r, g.r), (got.d, g.d), (got.offset_y, g.o)):
            assert float(value or 0) == pytest.approx(float(wanted), abs=1e-9)
        assert got.heading is not None and same_angle(got.heading, w.heading)
        if w.kind.rollers:
            assert got.gamma is not None and abs(math.remainder(got.gamma - w.gamma, math.pi)) < 1e-9
        assert got.actuated == (w.actuated if any(v.actuated for v in robot.wheels) else None)
    names = {w.name: w.joint.removesuffix("_spin") for w in imported.wheels if w.joint}
    pairs = {
        (c.first.rpartition(".")[2], *(names[s.rpartition(".")[0]] for s in (c.first, c.second))): float(
            c.ratio
        )
        for c in imported.couplings
    }
    wanted = {
        (j, a.name, b.name): float(robot.turn_ratio(j, b))
        for j in ("spin", "steer")
        for a, *others in robot.together(j, [w for w in robot.wheels if j in w.kind.joints])
        for b in others
    }
    assert pairs == pytest.approx(wanted)


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("path", GALLERY, ids=lambda p: p.stem)
def test_the_gallery_comes_back(path: Path, kind: str, tmp_path: Path) -> None:
    robot = wmrgen.load(path)
    if any(w.ball for w in robot.wheels):  # no joint of URDF or SDF is one of a driven ball
        with pytest.raises(NotDerivableError):
            back(robot, tmp_path, kind)
        return
    robot = replace(
        robot, name=robot.name.replace("omni_", "")
    )  # of which import would ask where its rollers are
    imported = back(robot, tmp_path, kind)
    same(robot, imported)
    assert asked(robot, imported) == []
    file = text(imported, "again.urdf").replace("actuated: TODO", "actuated: []")
    file = file.replace("type: TODO", "type: fixed")  # the answer for a robot that skids
    (tmp_path / "again.yaml").write_text(file, encoding="utf-8")
    once, again = wmrgen.derive(robot).mobility, wmrgen.derive(wmrgen.load(tmp_path / "again.yaml")).mobility
    assert (again.robot_type, again.degenerate) == (once.robot_type, once.degenerate)


def drawn(draw: Random) -> tuple[list[str], str]:
    """Any mix of wheels that import can tell: wheels with rollers, or wheels that steer beside plain ones. No angle is
    so near a multiple of pi/12 that import takes it for one."""

    def angle(low: int, high: int) -> str:
        return f"{math.pi / 12 * (draw.randint(low, high) + draw.uniform(0.02, 0.98)):.5f}"

    def near(low: float, high: float) -> str:
        return f"{draw.choice((-1, 1)) * draw.uniform(low, high):.5f}"

    def wheel(k: int, kind: str) -> str:
        r = f"{draw.uniform(0.02, 0.3):.4f}"
        base = f"name: w{k}, type: {kind}, x: {near(0, 2)}, y: {near(0, 2)}"
        if kind == "spherical":
            return base + draw.choice(("", f", r: {r}"))
        heading = parallel if kind == "fixed" else draw.choice((angle(-12, 11), "pi", "0", "-pi/2"))
        base += f", heading: {heading}, r: {r}"
        if kind == "castor":
            base += f", d: {near(0.035, 0.2)}, offset_y: {near(0, 0.1)}"
        if kind == "swedish":
            base += f", gamma: {angle(-5, 4)}"
        if kind == "steered":
            base += f", offset_y: {near(0, 0.1)}"
        joints = {"fixed": ["spin"], "swedish": ["spin"], "steered": ["steer"], "castor": []}[kind]
        more = {"steered": ["spin"], "castor": ["spin", "steer"]}.get(kind, [])
        return base + f", actuated: [{', '.join(joints + more * draw.randint(0, 1))}]"

    parallel = angle(-12, 11)
    some = draw.choice((["swedish"], ["fixed", "steered", "castor"], ["castor", "fixed"], ["steered"]))
    count = draw.randint(2, 6)
    wheels = [wheel(k, draw.choice(some)) for k in range(count)]
    wheels += [wheel(k, "spherical") for k in range(count, count + draw.randint(0, 2))]
    steered = [k for k, w in enumerate(wheels) if "steered" in w]
    more = (
        f"couplings:\n  - equal: [{', '.join(f'w{k}.steer' for k in steered)}]\n" if len(steered) > 1 else ""
    )
    return wheels, more * draw.randint(0, 1)


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("seed", range(100 if DEEP else 12))
def test_drawn_robots_come_back(seed: int, kind: str, tmp_path: Path) -> None:
    wheels, more = drawn(Random(seed))
    robot = load(tmp_path, *wheels, more=more)
    same(robot, back(robot, tmp_path, kind))


@pytest.mark.parametrize("kind", WRITERS)
def test_spins_in_a_ratio_come_back(kind: str, tmp_path: Path) -> None:
    """The first of a set leads, whatever the shaft is that the file names."""
    wheels = [
        f"name: w{k}, type: swedish, x: {x}, y: {y}, heading: 0, gamma: {g} deg, r: 0.1"
        for k, (x, y, g) in enumerate([(0.3, 0.2, 45), (0.3, -0.2, -45), (-0.3, 0.2, -45), (-0.3, -0.2, 45)])
    ]
    more = "couplings:\n  - {equal: [w0.spin, w3.spin, w1.spin], ratios: [2, -17/42, 1]}\n"
    robot = load(tmp_path, *wheels, more=more)
    assert [float(k) for k in robot.spin_ratios] == pytest.approx([1, 0.5, 1, -17 / 84])
    same(robot, back(robot, tmp_path, kind))


@pytest.mark.parametrize("kind", list(drives(Random(0))))
def test_what_ros2_control_gets_comes_back(kind: str, tmp_path: Path) -> None:
    """Its <ros2_control> says what drives, in the place of <transmission>."""
    wheels, more = drives(Random(kind))[kind]
    robot = load(tmp_path, *wheels, more=more)
    same(robot, back(robot, tmp_path, "urdf", ros2_control(robot)["drawn.urdf"]))


@pytest.mark.parametrize("kind", list(drives(Random(0))))
def test_compare_finds_no_difference(kind: str, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    """`wmrgen compare` of the robot file, without its ball, with each file that was made of it."""
    wheels, more = drives(Random(kind))[kind]
    forward = [w for w in wheels if "spherical" not in w]
    robot = load(tmp_path, *forward, more=more)
    files = {**ros2_control(robot), "drawn.sdf": sdf(robot)}
    for name, written in files.items():
        (tmp_path / name).write_text(written, encoding="utf-8")
        done = wmrgen_cli("compare", tmp_path / "drawn.yaml", tmp_path / name)
        assert (done.code, done.out.strip().endswith("equal")) == (0, True), (name, done.out)


def changes(line: str) -> str:
    """A line of a controller's parameters, its number increased or its list reversed; "" if it has neither."""
    start, _, value = line.partition(": ")
    if value.startswith("[") and start.strip() not in ("left_wheel_names", "right_wheel_names"):
        return f"{start}: [{', '.join(reversed(value.strip('[]').split(', ')))}]"
    try:
        number = float(value)
    except ValueError:
        return ""
    return "" if start.strip() == "update_rate" else f"{start}: {number * 1.01 if number else 0.2}"


@pytest.mark.parametrize("path", GALLERY, ids=lambda p: p.stem)
def test_every_change_of_a_parameter_is_found(path: Path, tmp_path: Path) -> None:
    """Numbers changed by 1 %; lists of joints reversed, but those of one side, whose order has no effect."""
    robot = wmrgen.load(path)
    (own,) = layouts(path)
    try:
        lines = ros2_control(robot)[f"{robot.name}_controllers.yaml"].split("\n")
    except NotDerivableError:
        return
    missed = []
    for i, line in enumerate(lines):
        changed = changes(line)
        if changed and changed != line:
            (tmp_path / "p.yaml").write_text(
                "\n".join([*lines[:i], changed, *lines[i + 1 :]]), encoding="utf-8"
            )
            (controller,) = layouts(tmp_path / "p.yaml")
            missed += [changed] if not compare(own, controller).differences else []
    assert missed == []


def exported(robot: Robot) -> dict[str, str]:
    """Every file that `export` writes of a robot, of which `compare` reads joints or wheels; none of a driven ball."""
    files = {}
    for kind, write in (
        ("urdf", lambda: {f"{robot.name}.urdf": urdf(robot)}),
        ("sdf", lambda: {f"{robot.name}.sdf": sdf(robot)}),
        ("ros2_control", lambda: ros2_control(robot)),
    ):
        try:
            files |= {f"{kind}_{name}": file for name, file in write().items()}
        except NotDerivableError:
            assert kind == "ros2_control" or any(w.ball for w in robot.wheels)
    return files


@pytest.mark.parametrize("path", GALLERY, ids=lambda p: p.stem)
def test_every_export_of_the_gallery_is_equal_under_compare(path: Path, tmp_path: Path) -> None:
    robot, found = wmrgen.load(path), {}
    (own,) = layouts(path)
    for name, file in exported(robot).items():
        (tmp_path / name).write_text(file, encoding="utf-8")
        for layout in layouts(tmp_path / name):
            result = compare(own, layout)
            found |= {(name, d.code, d.wheel): d.words for d in result.differences}
            assert result.compared or not any(w.actuated for w in robot.wheels)
    assert found == {}
