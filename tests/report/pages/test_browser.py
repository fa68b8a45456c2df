"""Every robot's page in headless Chromium: nothing on the console, texts in their figures, and a moved slider moves
the picture as the exact kinematics says."""

from __future__ import annotations

import re
from cmath import phase
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from tests.conftest import GALLERY, ROOT
from tests.report.pages.chromium import seen
from wmrgen import derive, load
from wmrgen.codegen import arrays
from wmrgen.derivation.facade import Derivation
from wmrgen.report.pages import live
from wmrgen.report.pages.document import Report, broken, page

pytestmark = pytest.mark.slow
FIXED = {"clearpath_a200", "locked_bicycle", "synchro_drive"}  # these cannot turn, or cannot move
BLIND = {"office_chair", "textbook_omni_steer", "unicycle"}  # their joints do not tell every motion
WIDTH = 1200


@pytest.fixture(scope="module")
def derivations() -> dict[str, Derivation]:
    return {path.stem: derive(load(path), live.FUNCTIONS) for path in GALLERY}


@pytest.fixture(scope="module")
def reports(derivations: dict[str, Derivation]) -> list[Report]:
    """The checked-in reports, with the robots to drive."""
    return [
        Report(name, _files(ROOT / "generated" / name), live.robot(d), live.code(d))
        for name, d in derivations.items()
    ]


def _files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.suffix in (".md", ".svg")}


def test_pages_are_small_enough(reports: list[Report]) -> None:
    sizes = {report.name: len(page([report]).encode()) for report in reports}
    assert max(sizes.values()) < 1_500_000, sizes


def test_reports_are_a_few_screens_long(
    reports: list[Report], derivations: dict[str, Derivation], tmp_path: Path
) -> None:
    """Six of 900 px, eight where several wheels are free to steer; numerics stand folded below."""
    bare = [Report(report.name, report.files) for report in reports]
    script = """
    const tops = [...document.querySelectorAll("h1")].map((e) => [e.textContent, e.getBoundingClientRect().top]);
    const ends = [...tops.slice(1).map(([, top]) => top), document.documentElement.scrollHeight];
    return Object.fromEntries(tops.map(([name, top], i) => [name, (ends[i] - top) / 900]));"""
    screens, console = seen(page(bare), script, tmp_path)
    assert console == [] and screens.keys() >= derivations.keys()
    for name, d in derivations.items():
        assert 3 < screens[name] <= (8 if d.mobility.degree_of_steerability > 1 else 6), (name, screens[name])


def test_texts_formulas_and_figures(reports: list[Report], tmp_path: Path) -> None:
    """On one page of 900 px: no console error, every formula typeset and shown whole, no text outside its figure,
    nothing wider than the page."""
    script = """
    for (const folded of document.querySelectorAll("details")) folded.open = true;
    const figures = [...document.querySelectorAll(".figure > svg")];
    const outside = [];
    for (const figure of figures) {
      const frame = figure.getBoundingClientRect();
      for (const text of figure.querySelectorAll("text")) {
        const box = text.getBoundingClientRect();
        const inside = box.left >= frame.left - 1 && box.right <= frame.right + 1 && box.top >= frame.top - 1
          && box.bottom <= frame.bottom + 1;
        if (!inside) outside.push(`${figure.querySelector("title")?.textContent}: ${text.textContent}`);
      }
    }
    const ids = [...document.querySelectorAll("[id]")].map((e) => e.id);
    return {
      figures: figures.length, outside,
      formulas: document.querySelectorAll(".math").length,
      typeset: document.querySelectorAll(".math > .katex-display").length,
      wrong: [...document.querySelectorAll(".katex-error")].map((e) => e.title),
      cut: [...document.querySelectorAll(".math, .wide")]
        .filter((e) => e.scrollWidth > e.clientWidth).map((e) => e.textContent),
      overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth,
    };"""
    texts = [
        Report("textbook", _files(ROOT / "generated" / "textbook")),
        Report("errata", {"report.md": (ROOT / "generated" / "errata.md").read_bytes()}),
    ]
    result, console = seen(page([*reports, *texts]), script, tmp_path, (900, 900))
    assert console == [] and result["cut"] == []
    assert result["figures"] >= len(GALLERY) and result["outside"] == []
    assert result["formulas"] == result["typeset"] > 600 and result["wrong"] == []
    assert result["overflow"] <= 0


def test_on_a_narrow_screen_all_can_be_read(reports: list[Report], tmp_path: Path) -> None:
    """Names of sliders are whole, figures stand one below the other, as wide as the page, and nothing sticks out."""
    (tidybot,) = (report for report in reports if report.name == "tidybot2")
    script = """
    const wide = [...document.querySelectorAll("#live, #live *, main > section")];
    return {
      cut: [...document.querySelectorAll(".name")].filter((e) => e.scrollWidth > e.clientWidth).map((e) => e.title),
      out: wide.filter((e) => e.clientWidth && e.scrollWidth > e.clientWidth).map((e) => e.className || e.tagName),
      figures: [...document.querySelectorAll(".figure")].map((e) => e.clientWidth),
      page: document.querySelector("main section").clientWidth,
    };"""
    result, console = seen(page([tidybot]), script, tmp_path, (500, 900))
    assert console == [] and result["cut"] == result["out"] == []
    assert result["figures"] and min(result["figures"]) > 0.8 * result["page"]


def test_on_paper_nothing_is_folded_or_cut(reports: list[Report], tmp_path: Path) -> None:
    """As wide as between the margins of A4, the letters as much smaller as the page says that they become in print."""
    (swerve,) = (report for report in reports if report.name == "wpilib_swervebot")
    script = """
    dispatchEvent(new Event("beforeprint"));
    for (const e of document.querySelectorAll("main, details")) Object.assign(e.style, { padding: 0, border: 0 });
    document.body.style.width = "680px";
    for (const e of document.querySelectorAll(".katex-display")) {
      e.querySelector(".katex").style.fontSize = `${getComputedStyle(e).getPropertyValue("--fit")}em`;
    }
    const formulas = [...document.querySelectorAll(".math")];
    return {
      folded: document.querySelectorAll("details:not([open])").length,
      cut: formulas.filter((e) => e.scrollWidth > e.clientWidth).map((e) => e.textContent.slice(0, 80)),
      small: formulas.filter((e) => getComputedStyle(e.firstChild).getPropertyValue("--fit") < 0.5).length,
      formulas: formulas.length,
    };"""
    result, console = seen(page([Report(swerve.name, swerve.files)]), script, tmp_path)
    assert console == [] and result.pop("formulas") > 20 and result == {"folded": 0, "cut": [], "small": 0}


def test_a_console_error_is_seen(tmp_path: Path) -> None:
    """The net catches something: an error, a script that the policy does not let in, a text beside its figure."""
    result, console = seen(broken("a <b>&amp; mistake"), "console.error('oh'); return 1", tmp_path)
    assert result == 1 and len(console) == 1 and "oh" in console[0]
    injected = broken("x").replace("</main>", "<script>pwned()</script></main>")
    result, console = seen(injected, "return document.querySelector('.error').textContent", tmp_path)
    assert result == "x" and len(console) == 1 and "Content Security Policy" in console[0]


def test_the_gallery(tmp_path: Path) -> None:
    generated = ROOT / "generated"
    for path in generated.glob("*/layout.svg"):
        (tmp_path / path.parent.name).mkdir()
        (tmp_path / path.parent.name / path.name).write_bytes(path.read_bytes())
    script = """
    const images = [...document.images];
    images.forEach((image) => image.loading = "eager");
    window.onload = () => document.title = JSON.stringify(images.filter((image) => image.naturalWidth > 0).length);"""
    result, console = seen((generated / "index.html").read_text(encoding="utf-8"), script, tmp_path)
    assert (result, console) == (len(GALLERY), [])


def test_a_moved_slider_moves_the_picture(
    reports: list[Report], derivations: dict[str, Derivation], tmp_path: Path
) -> None:
    bare = [Report(report.name, {}, report.robot, report.code) for report in reports]
    script = (Path(__file__).parent / "drive.js").read_text(encoding="utf-8")
    results, console = seen(page(bare), script, tmp_path)
    assert console == [] and results.keys() == derivations.keys()
    for name, d in derivations.items():
        for what in ("ahead", "turning", "all", "joints"):
            _as_numpy_says(d, what, *results[name][what])
        assert not re.search(r"-0\.0+\b", " ".join(results[name]["small"])), name
        path = results[name]["path"]
        assert (path["arrives"] and path["off"] < 0.3) or name in FIXED, (name, path)


def _as_numpy_says(d: Derivation, what: str, before: dict[str, Any], after: dict[str, Any]) -> None:
    steers = {f"{w.name}.steer": 0.0 for w in d.robot.wheels if w.turns}
    shown = before["asked"] | before["joints"]
    for name, (value, step, least, most) in before[
        "values"
    ].items():  # a slider shows the nearest that it can
        assert abs(value - np.clip(shown[name], least, most)) <= step, name
    if what == "joints":
        joints = before["joints"]
        assert any(joints[name] for name in live.robot(d)["joints"]) or not live.robot(d)["joints"]
    else:
        assert any(before["asked"].values())
        joints = _called(d, "inverse", {**steers, **before["asked"]})
        assert before["slip"] == pytest.approx(joints.pop("slip"), abs=1e-12)
        joints = dict.fromkeys(live.robot(d)["joints"], 0.0) | steers | joints
        assert before["joints"] == pytest.approx(joints, abs=1e-12)
    driven = _called(d, "forward", joints)
    slip = driven.pop("slip")
    if what == "joints":
        assert before["slip"] == pytest.approx(slip, abs=1e-9)
    elif before["slip"] < 1e-6:  # what is asked; `forward` tells the same where the joints tell all
        assert driven == pytest.approx(before["asked"], abs=1e-9) or d.robot.name in BLIND
        driven = before["asked"]
    assert before["driven"] == pytest.approx(driven, abs=1e-12)
    for wheel in d.robot.wheels:
        angle = wheel.heading + joints.get(f"{wheel.name}.steer", 0.0)
        g = wheel.nominal
        x, y, turned = _transform(before["wheels"][wheel.name])
        assert (x, y) == (float(g.x), float(g.y))
        assert np.exp(1j * turned) == pytest.approx(np.exp(1j * angle), abs=1e-9)
    vx, vy, omega = driven["vx"], driven["vy"], driven["omega"]
    if abs(omega) > 1e-3:
        assert before["icr"][2] == "visible"
        assert [float(v) for v in before["icr"][:2]] == pytest.approx(
            [-vy / omega, vx / omega], rel=1e-6, abs=1e-9
        )
        if before["slip"] < 1e-9:  # the picture alone: every zero-motion line goes through the ICR
            icr = complex(-vy / omega, vx / omega)
            for wheel in (w for w in d.robot.wheels if w.kind.sliding_row and not w.kind.swivels):
                x, y, turned = _transform(before["wheels"][wheel.name])
                ahead = np.exp(1j * turned)
                contact = complex(x, y) + ahead * complex(float(wheel.nominal.d), float(wheel.nominal.o))
                assert ((icr - contact) * ahead.conjugate()).real == pytest.approx(
                    0, abs=1e-7 * (1 + abs(icr))
                )
    # The pose by the exponential of the twist, which no odometry is asked for. Castors turn during the step, a robot
    # that goes by their angles then drives another twist.
    still = expm(0.5 * np.array([[0, -omega, vx], [omega, 0, vy], [0, 0, 0]]))
    assert _transform(before["body"]) == (0, 0, 0)
    assert after["trailers"].keys() == {t.name for t in d.robot.trailers}
    for name, place in _towed(d, driven, 0.5).items():
        assert _transform(after["trailers"][name]) == pytest.approx(place, abs=0.01), name
    x, y, theta = _transform(after["body"])
    assert (x, y) == pytest.approx((still[0, 2], still[1, 2]), abs=1e-6)
    assert np.exp(1j * theta) == pytest.approx(np.exp(1j * 0.5 * omega), abs=1e-6)


def _towed(d: Derivation, driven: dict[str, float], time: float) -> dict[str, tuple[float, float, float]]:
    """Axle and heading of each trailer, in line behind P at first: each is drawn along the bar that its coupling has
    left behind, step by step (a tractrix). The axle that pulls the first passes through P."""
    speed, omega = complex(driven["vx"], driven["vy"]), driven["omega"]
    axles: dict[str, complex] = {}
    places = {}
    at = np.linspace(0.0, time, 4001 if d.robot.trailers else 0)
    fronts = speed * at * np.exp(0.5j * omega * at) * np.sinc(omega * at / (2 * np.pi))
    for front, ahead in zip(fronts.tolist(), np.exp(1j * omega * at).tolist(), strict=True):
        for t in d.robot.trailers:
            coupling, length = front - ahead * float(t.hitch.nominal), float(t.length.nominal)
            bar = coupling - axles.get(t.name, coupling - length)
            ahead = bar / abs(bar)
            axles[t.name] = front = coupling - length * ahead
            places[t.name] = front.real, front.imag, phase(ahead)
    return places


def _called(d: Derivation, function: str, values: dict[str, float]) -> dict[str, float]:
    return arrays.evaluate(d.module, [(function, values)])[0]


def _transform(text: str) -> tuple[float, float, float]:
    match = re.fullmatch(r"translate\((\S+) (\S+)\) rotate\((\S+)\)", text)
    assert match
    x, y, angle = map(float, match.groups())
    return x, y, float(np.radians(angle))
