"""The picture of a drive: what it draws, and what moves; and the page that plays the drive."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from tests.conftest import ROOT, command_line
from tests.report.figures.words import mistakes
from tests.report.pages.chromium import seen

pytestmark = pytest.mark.slow

SVG = "{http://www.w3.org/2000/svg}"
PIONEER = ROOT / "robots" / "pioneer3dx.yaml"


def drawn(folder: Path, *words: object) -> ElementTree.Element:
    path = folder / "drive.svg"
    done = command_line("simulate", *words, "--svg", path)
    assert done.code == 0, done.err
    text = path.read_text(encoding="utf-8")
    assert "<script" not in text and not re.search(r"\son\w+=", text)
    return ElementTree.fromstring(text)


def animations(root: ElementTree.Element) -> list[tuple[str, list[str], str]]:
    """Each animated group: the kind of its transform, its keyframes, and its transform without animation."""
    found = []
    for group in root.iter(f"{SVG}g"):
        own = group.find(f"{SVG}animateTransform")
        if own is not None:
            found.append((own.attrib["type"], own.attrib["values"].split(";"), group.get("transform", "")))
    return found


def test_the_robot_moves_along_its_path(tmp_path: Path) -> None:
    """Half a circle of radius 1 m to the left: on paper P rises by 2 m, and the robot turns by -180 deg (y is down)."""
    root = drawn(tmp_path, PIONEER, "tail=pi", "--twist", "0.5,0,0.5", "--time", "2*pi")
    moving = animations(root)
    kinds = [kind for kind, *_ in moving]
    assert kinds.count("translate") == 2  # the robot and the line at the present time
    _, frames, rest = next(entry for entry in moving if entry[0] == "translate")
    assert rest == f"translate({frames[-1]})"
    places = np.array([frame.split() for frame in frames], float)
    scale = float(next(g.attrib["data-scale"] for g in root.iter(f"{SVG}g") if "data-scale" in g.attrib))
    np.testing.assert_allclose((places[-1] - places[0]) / scale, (0, -2), atol=0.01)
    np.testing.assert_allclose((places[60] - places[0]) / scale, (1, -1), atol=0.01)
    _, turns, _ = next(entry for entry in moving if entry[0] == "rotate")
    assert (turns[0], turns[-1]) == ("0", "-180")


def test_steered_wheels_and_trailers_move(tmp_path: Path) -> None:
    root = drawn(tmp_path, ROOT / "robots" / "car_with_trailers.yaml", "--goal", "6,3,0", "--law", "pursuit")
    kinds = [kind for kind, *_ in animations(root)]
    assert kinds.count("translate") == 1 + 2 + 1  # body, trailers, present time
    words = [text.text for text in root.iter(f"{SVG}text")]
    assert words.count("trailer1") == words.count("trailer2") == 1  # in the legend of hitch angles


def test_several_starts_are_several_robots(tmp_path: Path) -> None:
    root = drawn(tmp_path, PIONEER, "--goal", "0,0,0", "--from", "circle:4")
    assert [kind for kind, *_ in animations(root)].count("translate") == 4 + 1
    ends = [frames[-1] for kind, frames, _ in animations(root) if kind == "translate"][:4]
    places = np.array([end.split() for end in ends], float)
    assert np.ptp(places, axis=0).max() < 1.0  # px: all at the goal


def test_a_standing_robot_is_drawn(tmp_path: Path) -> None:
    root = drawn(tmp_path, PIONEER, "--goal", "0,0,0")
    assert animations(root) == []
    assert len(list(root.iter(f"{SVG}rect"))) > 1


def test_words_are_inside_the_picture(tmp_path: Path) -> None:
    root = drawn(
        tmp_path,
        PIONEER,
        "--compare",
        ROOT / "robots" / "nomad_xr4000.yaml",
        "--twist",
        "0.4,0,1",
        "--time",
        "9",
    )
    wide, high = map(float, root.attrib["viewBox"].split()[2:])
    for text in root.iter(f"{SVG}text"):
        assert 0 <= float(text.attrib["x"]) <= wide and 0 <= float(text.attrib["y"]) <= high


@pytest.mark.slow
def test_the_page_plays_the_drive(tmp_path: Path) -> None:
    """Played in frames of 17 ms, the robots end where the simulation ends; the castor and the trailer as well."""
    path, tractor = tmp_path / "drive.html", ROOT / "robots" / "tractor_off_axle.yaml"
    words = ["--goal", "2,1,0.5", "--from=-1,0.5,0.2", "tail=pi", "--html", path, "--json"]
    done = command_line("simulate", tractor, *words)
    assert done.code == 0, done.err
    import json

    (expected,) = json.loads(done.out)["drives"]
    script = """
    const [live] = document.getElementById("live").lives;
    live.play();
    for (let k = 0; k < 5000 && live.played.length; k++) live.step(0.017);
    return [[live.pose.x, live.pose.y, live.pose.theta], live.joints["tail.steer"], live.headings["cart.theta"]];"""
    (pose, tail, cart), console = seen(path.read_text(encoding="utf-8"), script, tmp_path)
    assert console == []
    np.testing.assert_allclose(pose, expected["end"], atol=1e-9)
    assert cart == pytest.approx(expected["angles"]["cart.theta"], abs=5e-3)  # Euler's rule, in steps of 5 ms
    assert tail == pytest.approx(expected["angles"]["tail.steer"], abs=0.05)


def test_every_wheel_is_in_the_legend(tmp_path: Path) -> None:
    """In as many rows as they need, inside the picture."""
    nexus = ROOT / "robots" / "nexus_4wd.yaml"
    root = drawn(tmp_path, nexus, "--twist", "0.3,0.2,0.5", "--time", "1", "--compare", PIONEER)
    keys = [text for text in root.iter(f"{SVG}text") if text.get("class") == "key"]
    wheels = [
        *(f"{end}_{side}" for end in ("upper", "lower") for side in ("left", "right")),
        "left",
        "right",
        "tail",
    ]
    assert set(wheels) <= {key.text for key in keys}
    width = float(root.attrib["viewBox"].split()[2])
    assert all(0 < float(key.attrib["x"]) < width - 30 for key in keys)


@pytest.mark.parametrize(
    "words",
    [
        ["--twist", "1234567,0,5e-4", "--time", "5"],
        ["--twist", "1e-6,0,-1e-7", "--time", "1 ms", "--step", "1 ms"],
        ["--goal", "0,0,0", "--from", "circle:3", "--compare", ROOT / "robots" / "car_with_trailers.yaml"],
    ],
)
def test_no_word_is_cut_or_covered(words: list[object], tmp_path: Path) -> None:
    path = tmp_path / "drive.svg"
    command_line("simulate", PIONEER, *words, "--svg", path)
    assert mistakes(path.read_text(encoding="utf-8"), tmp_path) == []


def test_long_names_of_two_robots_are_in_two_rows(tmp_path: Path) -> None:
    text = PIONEER.read_text(encoding="utf-8")
    paths = [tmp_path / f"{k}.yaml" for k in (1, 2)]
    for k, path in enumerate(paths):
        path.write_text(text.replace("name: pioneer3dx", f"name: a_very_long_name_of_a_robot_nr{k}"))
    path = tmp_path / "drive.svg"
    done = command_line(
        "simulate", paths[0], "--compare", paths[1], "--twist", "1,0,0", "--time", "1", "--svg", path
    )
    assert done.code == 0 and mistakes(path.read_text(encoding="utf-8"), tmp_path) == []


def test_joints_of_several_starts_are_those_of_the_first(tmp_path: Path) -> None:
    titles = []
    for start in ("1,0,0", "circle:3"):
        root = drawn(tmp_path, PIONEER, "--goal", "0,0,0", "--from", start)
        titles.append({text.text for text in root.iter(f"{SVG}text") if "title" in text.get("class", "")})
    one, several = titles
    assert len(one - several) == len(several - one) == 2 and len(one & several) == 4
