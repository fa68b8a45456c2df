"""Meshes of wheels: their reach about the axle is the radius where they are round and nothing else says another, else a
hint, in every format alike."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.conftest import Outcome
from tests.tools.importing.urdf import joint, link, robot
from wmrgen.tools.importing.frames import IDENTITY
from wmrgen.tools.importing.meshes import reach

Cli = Callable[..., Outcome]
RADIUS, LOW, HIGH = 0.08, -0.01, 0.03
TURN = 0.4  # [rad] of the mesh in its file, about x


def circle(corners: int) -> Any:
    """Points about y."""
    angles = np.arange(corners) * 2 * math.pi / corners
    return np.column_stack([np.cos(angles), 0 * angles, np.sin(angles)])


def tube(unit: float = 1.0, corners: int = 12) -> Any:
    """Points of a tube of radius 0.08 about y, from -0.01 to 0.03 m, turned about x: as a mesh may lie in its file."""
    rings = [circle(corners) + np.array([0, y / RADIUS, 0]) for y in (LOW, HIGH)]
    c, s = math.cos(TURN), math.sin(TURN)
    return RADIUS / unit * np.concatenate(rings) @ np.array([[1, 0, 0], [0, c, s], [0, -s, c]])


def triangles(points: Any) -> Any:
    return points[np.array([[k, (k + 1) % 24, (k + 2) % 24] for k in range(24)])]


def binary_stl(unit: float) -> bytes:
    faces = triangles(tube(unit))
    body = b"".join(struct.pack("<12f2x", 0, 0, 0, *face.ravel()) for face in faces)
    return b"solid is no sign of text".ljust(80) + struct.pack("<I", len(faces)) + body


def text_stl(unit: float) -> bytes:
    vertices = "\n".join(
        f"  vertex {x:.9e} {y:.9e} {z:.9e}" for x, y, z in triangles(tube(unit)).reshape(-1, 3)
    )
    return f"solid wheel\nfacet normal 0 0 1\n outer loop\n{vertices}\n endloop\nendfacet\n".encode()


def obj(unit: float, corners: int = 12) -> bytes:
    vertices = "\n".join(f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in tube(unit, corners))
    return f"# a wheel\n{vertices}\nvn 9 9 9\nvt 9 9\nf 1 2 3\n".encode()


def dae(unit: float) -> bytes:
    """Its own unit is a centimetre; a node turns, another below it moves the points away and back."""
    degrees = math.degrees(TURN)
    c, s = math.cos(TURN), math.sin(TURN)
    flat = tube(0.01 * unit) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) + [5, 0, 0]
    numbers = " ".join(f"{v:.9g}" for v in flat.ravel())
    return (
        '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit name="cm" '
        'meter="0.01"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="s">'
        f'<float_array id="a" count="{flat.size}">{numbers}</float_array></source><source id="n"><float_array>9 9 9'
        '</float_array></source><vertices id="v"><input semantic="POSITION" source="#s"/><input semantic="NORMAL" '
        'source="#n"/></vertices></mesh></geometry></library_geometries><library_nodes><node id="inner">'
        '<matrix>1 0 0 -5 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#g"/></node></library_nodes>'
        f'<library_visual_scenes><visual_scene id="x"><node><rotate>1 0 0 {degrees:.12f}</rotate><scale>1 1 1</scale>'
        '<instance_node url="#inner"/></node></visual_scene></library_visual_scenes></COLLADA>'
    ).encode()


@pytest.fixture
def hints(wmrgen_cli: Cli, tmp_path: Path) -> Callable[..., dict[str, list[str]]]:
    """Hints by wheel and key of a robot whose wheels are the mesh, turned upright again by its origin."""
    package = tmp_path / "parts"
    package.mkdir()

    def call(
        name: str, data: bytes | None, scale: str = "1 1 1", folder: str = "package://parts"
    ) -> dict[str, list[str]]:
        if data is not None:
            (package / name).write_bytes(data)
        mesh = (
            f'<visual><origin rpy="{-TURN} 0 0"/><geometry><mesh filename="{folder}/{name}" scale="{scale}"/>'
        )
        wheels = "".join(
            f'<link name="{n}">{mesh}</geometry></visual></link>' + joint(n, "base_link", n, f"0 {y} 0.1")
            for n, y in (("left", 0.2), ("right", -0.2))
        )
        (tmp_path / "urdf").mkdir(exist_ok=True)
        (tmp_path / "urdf" / "probe.urdf").write_text(robot(wheels), encoding="utf-8")
        done = wmrgen_cli(
            "import", tmp_path / "urdf" / "probe.urdf", "--package", f"parts={package}", "--json"
        )
        assert done.code == 0, done.err
        said = json.loads(done.out)
        assert {w["r"] for w in said["wheels"]} == {None}
        return {f"{q['wheel']}.{q['key']}": q["hints"] for q in said["questions"]}

    return call


@pytest.mark.parametrize("unit", [1.0, 0.001])
@pytest.mark.parametrize(
    ("name", "write"), [("a.stl", binary_stl), ("b.STL", text_stl), ("c.obj", obj), ("d.dae", dae)]
)
def test_every_format_reaches_as_far(
    hints: Callable[..., dict[str, list[str]]], name: str, write: Callable[[float], bytes], unit: float
) -> None:
    """The middle is 0.01 m along the axle, to the left on both sides."""
    asked = hints(name, write(unit), f"{unit} {unit} {unit}")
    assert asked["left.r"] == asked["right.r"] == [f"0.08 by the visual mesh '{name}'"]
    assert asked["left.y"] == ["0.2 at the joint", f"0.21 at the middle of the visual mesh '{name}'"]
    assert asked["right.y"] == ["-0.2 at the joint", f"-0.19 at the middle of the visual mesh '{name}'"]


@pytest.mark.parametrize("folder", ["file://parts", "model://parts", "../parts", "file://../parts"])
def test_meshes_are_read_by_every_path_that_files_write(
    hints: Callable[..., dict[str, list[str]]], folder: str
) -> None:
    assert hints("a.stl", binary_stl(1.0), folder=folder)["left.r"] == ["0.08 by the visual mesh 'a.stl'"]


def test_a_mesh_in_millimetres_without_a_scale_is_told(hints: Callable[..., dict[str, list[str]]]) -> None:
    said = "80 by the visual mesh 'a.stl', or 0.08 if its unit is the millimetre"
    assert hints("a.stl", binary_stl(0.001))["left.r"] == [said]


def drawn(role: str, scale: str = "1") -> str:
    mesh = f'<mesh filename="a.obj" scale="{scale} {scale} {scale}"/>'
    return f'<{role}><origin rpy="{-TURN} 0 0"/><geometry>{mesh}</geometry></{role}>'


GROUND = link("base_footprint") + joint("foot", "base_link", "base_footprint", "0 0 HEIGHT", "fixed")
DRIVE = (
    '<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so"><left_joint>left</left_joint>'
    "<right_joint>right</right_joint><wheel_diameter>DIAMETER</wheel_diameter></plugin></gazebo>"
)


@pytest.mark.parametrize(
    ("corners", "shapes", "more", "radius"),
    [
        (16, drawn("visual"), "", 0.08),
        (15, drawn("visual"), "", None),  # 2.2 % from round
        (24, drawn("collision") + drawn("visual"), "", 0.08),
        (24, drawn("visual", "0.5") + drawn("collision"), "", None),
        (24, drawn("visual") + drawn("visual", "0.5"), "", None),
        (24, drawn("visual"), GROUND.replace("HEIGHT", "0.02"), 0.08),
        (24, drawn("visual"), GROUND.replace("HEIGHT", "0.03"), None),
        (24, drawn("visual"), DRIVE.replace("DIAMETER", "0.16"), 0.08),
        (24, drawn("visual"), DRIVE.replace("DIAMETER", "1.6"), None),
        (24, drawn("visual", "1000"), "", None),
    ],
)
def test_one_round_mesh_is_the_radius_where_nothing_says_another(
    wmrgen_cli: Cli, tmp_path: Path, corners: int, shapes: str, more: str, radius: float | None
) -> None:
    (tmp_path / "a.obj").write_bytes(obj(1.0, corners))
    wheels = "".join(
        f'<link name="{n}">{shapes}</link>' + joint(n, "base_link", n, f"0 {y} 0.1")
        for n, y in (("left", 0.2), ("right", -0.2))
    )
    (tmp_path / "probe.urdf").write_text(robot(wheels, more), encoding="utf-8")
    out = tmp_path / "probe.yaml"
    said = json.loads(wmrgen_cli("import", tmp_path / "probe.urdf", "-o", out, "--json").out)
    assert [w["r"] for w in said["wheels"]] == [radius] * 2
    assert ("r" in [q["key"] for q in said["questions"]]) is (radius is None)
    role = "collision" if "collision" in shapes else "visual"
    where = f"r: 0.08   # bound of the {role} mesh 'a.obj' about the axle\n"
    assert (where in out.read_text(encoding="utf-8")) is (radius is not None)


BOMB = b'<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;">]><COLLADA>&b;</COLLADA>'
CIRCLE = (
    b'<COLLADA><node id="n"><instance_node url="#n"/></node><visual_scene><node><instance_node url="#n"/></node>'
    b"</visual_scene></COLLADA>"
)


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("none.stl", None),
        ("short.stl", binary_stl(1.0)[:-7]),
        ("empty.obj", b""),
        ("inf.stl", binary_stl(1.0)[:96] + struct.pack("<f", math.inf) + binary_stl(1.0)[100:]),
        ("wide.obj", b"v 1e400 0 0\nv 0 0 0\n"),
        ("what.fbx", b"Kaydara"),
        ("bomb.dae", BOMB),
        ("circle.dae", CIRCLE),
        ("odd.dae", b"<COLLADA><visual_scene><node><matrix>1 2</matrix></node></visual_scene></COLLADA>"),
        ("turn.dae", dae(1.0).replace(b"<rotate>1 0 0", b"<rotate>0 0 0")),
        ("../outside.stl", binary_stl(1.0)),
    ],
)
def test_what_is_no_mesh_gives_no_hint(
    hints: Callable[..., dict[str, list[str]]], name: str, data: bytes | None
) -> None:
    assert hints(name, data)["left.r"] == []


@pytest.mark.parametrize(("scale", "is_gear"), [("0.1", True), ("0.8", False)])
def test_the_mesh_of_a_gear_does_not_reach_the_ground(
    wmrgen_cli: Cli, tmp_path: Path, scale: str, is_gear: bool
) -> None:
    """In the middle of an axle stands a wheel where its mesh reaches about as far as those of the others."""
    (tmp_path / "a.obj").write_bytes(obj(1.0))
    (tmp_path / "probe.urdf").write_text(
        robot(
            *(
                f'<link name="{n}"><visual><origin rpy="{-TURN} 0 0"/><geometry><mesh filename="a.obj" '
                f'scale="{k} {k} {k}"/></geometry></visual></link>' + joint(n, "base_link", n, f"0 {y} 0.1")
                for n, y, k in (("left", 0.2, "1"), ("right", -0.2, "1"), ("middle", 0, scale))
            )
        ),
        encoding="utf-8",
    )
    done = wmrgen_cli("import", tmp_path / "probe.urdf", "--json")
    assert ("middle" in [w["name"] for w in json.loads(done.out)["wheels"]]) is not is_gear
    assert ("it reaches 0.008 m from it, they 0.08 m: the gear of a differential" in done.err) is is_gear


@pytest.mark.parametrize("seed", range(20))
def test_a_mesh_reaches_as_far_turned_about_its_axle_and_in_a_mirror(seed: int) -> None:
    """Few points, of which one side may have none."""
    random = np.random.default_rng(seed)
    cloud = random.normal(size=(random.integers(1, 9), 3))
    zero, z = (Fraction(0),) * 3, (Fraction(0), Fraction(0), Fraction(1))

    def reached(points: Any) -> list[float]:
        told = reach("".join(f"v {x:.12f} {y:.12f} {h:.12f}\n" for x, y, h in points).encode(), "a.obj",
                     (Fraction(1),) * 3, IDENTITY, zero, z)  # fmt: skip
        assert told is not None and told.radius == pytest.approx(np.hypot(points[:, 0], points[:, 1]).max())
        assert (told.low, told.high) == pytest.approx((points[:, 2].min(), points[:, 2].max()))
        return [told.least, told.round]

    c, s = math.cos(seed), math.sin(seed)
    own = reached(cloud)
    assert reached(cloud * [1, -1, 1]) == pytest.approx(own)
    assert reached(cloud @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])) == pytest.approx(own)
