"""Advice is a law: a file changed as a finding says no longer has that finding, and gets no worse one.

The tests take the piece of YAML out of the advice (`tolerance: 1.2 mm`, `r: diameter/2`, `sensed: [spin]`), write it
where the advice says, and run `lint` again.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from tests.tools.lint.test_rules import HEAD, linted
from tests.tools.lint.test_thresholds import wheels
from wmrgen.tools.lint import RULES, Finding

YAML = r"(\[[^\]]*\]|\{[^}]*\}|[^,.;\s}\]]+(?:\.\d+)?(?: (?:mm|deg)\b)?)"
OF_ROBOT = ("tolerance", "gyro", "effective_track")
SEEDS = range(30)


def enough(finding: Finding) -> float:
    """The tolerance that the advice of WMR034 gives [mm]; 0 where it gives none, or says how to switch it off."""
    match = re.search(r"tolerance: ([\d.]+) mm", finding.instead)
    return float(match[1]) if match and finding.code == "WMR034" else 0.0


def changed(text: str, finding: Finding, key: str) -> str:
    """The file with the value of ``key`` that the advice gives: for the robot, or in the line of the finding."""
    value = re.search(rf"\b{key}: {YAML}", finding.instead)
    assert value, finding.instead
    lines = text.split("\n")
    if key in OF_ROBOT:
        kept = [line for line in lines if not line.startswith(f"{key}:")]
        return "\n".join([*kept[:2], f"{key}: {value[1]}", *kept[2:]])
    at = finding.mark.line - 1
    there = re.compile(rf"\b{key}: ?{YAML}")
    if there.search(lines[at]):
        lines[at] = there.sub(f"{key}: {value[1]}", lines[at])
    else:
        lines[at] = lines[at].replace("}", f", {key}: {value[1]}}}")
    return "\n".join(lines)


def found(path: Path, text: str) -> list[Finding]:
    path.write_text(text, encoding="utf-8")
    return linted(path)


def nearly_one_axle(rng: np.random.Generator) -> str:
    """Two to five fixed wheels that a person meant to put on one axle, each a little off in place or heading."""
    count = int(rng.integers(2, 6))
    spread = 10.0 ** rng.uniform(-4, -2.2)
    turned = rng.random() < 0.5
    lines = []
    for k in range(count):
        x = 0.0 if turned else round(float(rng.uniform(-spread, spread)), 5)
        heading = round(float(rng.uniform(-spread, spread)), 5) if turned else 0.0
        y = round(0.6 * k / (count - 1) - 0.3, 4)
        lines.append(f"  - {{name: w{k}, type: fixed, x: {x}, y: {y}, heading: {heading}, r: 0.1}}\n")
    tolerance = f"tolerance: {rng.choice(['1 mm', '0.3 mm', '0'])}\n" if rng.random() < 0.6 else ""
    return f"{HEAD}{tolerance}wheels:\n{''.join(lines)}"


@pytest.mark.parametrize("seed", SEEDS)
def test_the_tolerance_of_the_advice_is_enough(seed: int, tmp_path: Path) -> None:
    """WMR034: at most one more round, for headings first and then for lines, and no finding comes back."""
    text = nearly_one_axle(np.random.default_rng(seed))
    reported = set[tuple[int, str]]()
    for _ in range(3):
        advised = [f for f in found(tmp_path / "a.yaml", text) if enough(f)]
        if not advised:
            return
        largest = max(advised, key=enough)
        assert (largest.mark.line, largest.what) not in reported
        reported.add((largest.mark.line, largest.what))
        text = changed(text, largest, "tolerance")
    raise AssertionError(text)


@pytest.mark.parametrize("seed", SEEDS)
def test_axles_that_miss_are_reported_with_the_distance_that_is_too_much(seed: int, tmp_path: Path) -> None:
    """WMR034 never says that a distance within the tolerance is more than the tolerance."""
    text = nearly_one_axle(np.random.default_rng(seed))
    named = re.search(r"tolerance: ([\d.]+)", text)
    for finding in found(tmp_path / "a.yaml", text):
        if named and enough(finding):
            assert enough(finding) > float(named[1])


@pytest.mark.parametrize(
    ("code", "key"),
    [("WMR005", "r"), ("WMR013", "heading"), ("WMR022", "sensed"), ("WMR031", "effective_track")],
)
def test_yaml_in_the_advice_removes_the_finding(code: str, key: str, tmp_path: Path) -> None:
    text = HEAD + RULES[code].wrong.replace("y: track", "y: track/2").replace("y: -track", "y: -track/2")
    if code == "WMR031":  # a length that has to be measured: the advice names the key alone
        text_then = text.replace("wheels:", "effective_track: 0.7\nwheels:")
        assert code not in [f.code for f in found(tmp_path / "a.yaml", text_then)]
        return
    rounds = len(text.split("\n"))
    for _ in range(rounds):
        advised = [f for f in found(tmp_path / "a.yaml", text) if f.code == code and f"{key}: " in f.instead]
        if not advised:
            break
        text = changed(text, advised[0], key)
    assert code not in [f.code for f in found(tmp_path / "a.yaml", text)], text


def test_a_gyro_as_advised_removes_the_finding(tmp_path: Path) -> None:
    pods = (
        "  - {name: along,  type: swedish, x: 0, y: 0.2, heading: 0, gamma: 0, r: 0.02, actuated: []}\n"
        "  - {name: across, type: swedish, x: 0.1, y: 0, heading: pi/2, gamma: 0, r: 0.02, actuated: []}\n"
        "  - {name: drive,  type: castor, x: 0, y: 0, d: -0.02, r: 0.05, actuated: [spin, steer], sensed: []}\n"
    )
    text = f"{HEAD}wheels:\n{pods}".replace("actuated: []", "actuated: [], sensed: [spin]")
    (advised,) = (f for f in found(tmp_path / "a.yaml", text) if f.code == "WMR022" and "gyro: " in f.instead)
    then = changed(text, advised, "gyro")
    assert "WMR022" not in [f.code for f in found(tmp_path / "a.yaml", then)]


@pytest.mark.parametrize("value", ["90", "-270", "450", "400.5", "180"])
def test_degrees_as_advised_are_degrees(value: str, tmp_path: Path) -> None:
    """WMR001: the number with its unit."""
    tail = f"  - {{name: tail, type: castor, x: -0.3, y: 0, heading: {value}, d: 0.04, r: 0.05}}\n"
    text = HEAD + RULES["WMR005"].right.replace("track/2", "0.2").replace("diameter/2", "0.1") + tail
    text = text.replace("parameters: {track: 0.331, diameter: 0.195}\n", "")
    (advised,) = (f for f in found(tmp_path / "a.yaml", text) if f.code == "WMR001")
    assert f"{value} deg" in advised.instead
    then = text.replace(f"heading: {value},", f"heading: {value} deg,")
    assert "WMR001" not in [f.code for f in found(tmp_path / "a.yaml", then)]


@pytest.mark.parametrize(
    ("sizes", "units"),
    [
        (("0.2", "50"), {"50 mm"}),
        (("0.2", "50 m"), {"50 mm"}),
        (("200", "50 mm"), {"50 m"}),  # or a distance of 200 mm, on which WMR003 remarks
        (("0.2", "1e6"), set()),
        (("0.2", "50 + 1"), set()),  # no number that could have a unit
        (("0.2", "size"), set()),
    ],
)
def test_a_proposed_size_is_the_number_of_the_file_in_a_unit_that_fits(
    sizes: tuple[str, str], units: set[str], tmp_path: Path
) -> None:
    y, r = sizes
    both = [
        f"name: {n}, type: fixed, x: 0, y: {s}{y}, heading: 0, r: {r}" for n, s in (("a", ""), ("b", "-"))
    ]
    text = f"{HEAD}parameters: {{size: 50}}\n{wheels(*both)}"
    (finding,) = (f for f in found(tmp_path / "a.yaml", text) if f.code == "WMR004")
    assert set(re.findall(r"[\d.e]+ (?:mm|cm|in|m)\b", finding.instead)) == units


@pytest.mark.parametrize(
    ("rest", "units"),
    [
        ("  - {name: c, type: fixed, x: 1, y: 0, heading: 0, r: 0.1 mm}\n", {"0.1 m"}),
        ("  - {name: c, type: castor, x: -0.3, y: 0, d: -40, r: 0.1}\n", {"-40 mm"}),
        ("trailers: [{name: t, length: 0.9 mm, hitch: 0.1}]\n", {"0.9 m"}),
    ],
)
def test_a_proposed_size_of_other_parts(rest: str, units: set[str], tmp_path: Path) -> None:
    both = [f"name: {n}, type: fixed, x: 0, y: {y}, heading: 0, r: 0.1" for n, y in (("a", 0.2), ("b", -0.2))]
    (finding,) = (f for f in found(tmp_path / "a.yaml", HEAD + wheels(*both) + rest) if f.code == "WMR004")
    proposed = set(re.findall(r"-?[\d.e]+ (?:mm|cm|in|m)\b", finding.instead))
    assert proposed and proposed <= units
