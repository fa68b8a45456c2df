"""Robots of which every length and angle is tunable: least squares step by step instead of written out."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import Outcome

SECONDS = 10
MECANUM = [
    f"{{{{name: w{i}, type: swedish, x: {x}, y: {y}, heading: {{h{i}}}, gamma: {{g{i}}}, r: 0.1}}}}"
    for i, (x, y) in enumerate(((0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2)))
]
OMNI = [
    f"{{{{name: w{i}, type: swedish, x: {{x{i}}}, y: {{p{i}}}, heading: {{h{i}}}, gamma: 0, r: 0.1}}}}"
    for i in range(3)
]
FIXED = [
    f"{{{{name: w{i}, type: fixed, x: {{x{i}}}, y: {{p{i}}}, heading: {{h{i}}}, r: 0.1}}}}" for i in range(4)
]
SMALL = {"h0": 0.1, "h1": -0.2, "h2": 0.05, "h3": 0.15, "g0": 0.7, "g1": -0.8, "g2": -0.75, "g3": 0.85}
WIDE = {
    "x0": 0.2, "x1": -0.1, "x2": -0.12, "x3": 0.3, "p0": 0.01, "p1": 0.2, "p2": -0.21, "p3": 0.4,
    "h0": 1.6, "h1": 3.7, "h2": -0.5, "h3": 0.6,
}  # fmt: skip
ROBOTS = {"mecanum": (MECANUM, SMALL), "omni": (OMNI, WIDE), "fixed": (FIXED, WIDE)}


def written(folder: Path, wheels: list[str], values: dict[str, float], tunable: bool) -> Path:
    used = {n: v for n, v in values.items() if any(f"{{{n}}}" in w for w in wheels)}
    parameters = "".join(f"  {n}: {{value: {v}, tunable: true}}\n" for n, v in used.items())
    lines = [w.format(**({n: n for n in used} if tunable else used)) for w in wheels]
    path = folder / "robot.yaml"
    top = (
        f"wmrgen: 1\nname: robot\nsnap: false\nparameters:\n{parameters}"
        if tunable
        else "wmrgen: 1\nname: robot\nsnap: false\n"
    )
    path.write_text(top + "wheels:\n" + "".join(f"  - {line}\n" for line in lines), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", ROBOTS)
def test_every_angle_and_length_tunable(
    name: str, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    """Derived within ten seconds; in all backends, at other values, what the file with those values gives."""
    wheels, nominal = ROBOTS[name]
    file = written(tmp_path, wheels, nominal, tunable=True)
    begin = time.process_time()
    assert wmrgen_cli("derive", file, "-o", tmp_path / "out").code == 0
    assert time.process_time() - begin < SECONDS
    parameters = [p.name for p in wmrgen.load(file).parameters]
    other = {n: round(nominal[n] + 0.01 * (k % 3 + 1), 3) for k, n in enumerate(parameters)}
    spins = {f"w{i}.spin": 0.5 * i - 0.75 for i in range(len(wheels))}
    words = [f"{n}={v}" for n, v in {**spins, **other}.items()]
    found = {
        backend: json.loads(wmrgen_cli("eval", file, "forward", *words, "--backend", backend, "--json").out)
        for backend in ("exact", "casadi", "numpy", "c")
    }
    plain = written(tmp_path, wheels, other, tunable=False)
    wanted = json.loads(wmrgen_cli("eval", plain, "forward", *words[: len(spins)], "--json").out)
    for backend, values in found.items():
        near = 2e-5 if backend == "c" else 1e-9
        assert values == pytest.approx(wanted, rel=near, abs=near), backend


def test_a_model_of_motion_that_is_too_long_is_refused(
    tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    """A following wheel whose velocity has hundreds of terms; what needs no model of motion is there."""
    path = tmp_path / "robot.yaml"
    path.write_text(
        "wmrgen: 1\nname: robot\nsnap: false\nparameters:\n"
        + "".join(f"  {n}: {{value: {v}, tunable: true}}\n" for n, v in (("a", 0.5), ("b", 0.55), ("c", 0.7)))
        + "wheels:\n"
        "  - {name: w0, type: steered, x: -0.18+sqrt(a**2+b**2), y: 0.17+sqrt(a**2+a**2), "
        "heading: a/2, r: 0.1, offset_y: a/4}\n"
        "  - {name: w1, type: steered, x: c/2, y: 0.1+sqrt(b**2+b**2), heading: 0-2*c, r: 0.1}\n"
        "  - {name: w2, type: steered, x: 0.41, y: b+b/4, heading: pi/3-2*b, r: 0.1}\n",
        encoding="utf-8",
    )
    begin = time.process_time()
    assert wmrgen_cli("derive", path, "-o", tmp_path / "out").code == 0
    done = wmrgen_cli("eval", path, "posture")
    assert time.process_time() - begin < SECONDS
    assert done.code == 3 and "the velocity of w" in done.err and "terms in the parameters" in done.err
