"""Names in mixed case (FL, frontRight, MyBot) are unchanged in all outputs, which compile."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.codegen.backends.test_rust import cargo
from tests.codegen.c.harness import STRICT
from tests.codegen.packages.made import KINDS, files_of, run
from tests.conftest import put
from tests.external_tools import need
from wmrgen import derive, load
from wmrgen.codegen.registry import BACKENDS
from wmrgen.derivation.emit import artifacts
from wmrgen.ir.kernels.choice import choice

TEXT = """\
wmrgen: 1
name: MyBot
parameters:
  halfTrack: {value: 0.2, tunable: true}
  Rad: 50 mm
wheels:
  - {name: FL, type: steered, x: 0.2, y: halfTrack, heading: 0, r: Rad}
  - {name: frontRight, type: steered, x: 0.2, y: -halfTrack, heading: 0, r: Rad}
  - {name: Rear_, type: fixed, x: -0.2, y: halfTrack, heading: 0, r: Rad, encoder: {spin: {counts: 4096}}}
  - {name: rearR, type: fixed, x: -0.2, y: -halfTrack, heading: 0, r: Rad, encoder: {spin: {counts: 4096}}}
virtual:
  - {name: Front, steers: [FL, frontRight]}
limits: {vx: 2, omega: 3, spin: 50, steer: 80 deg, steer_rate: 3 rad/s}
"""
WHEELS = ("FL", "frontRight", "Rear_", "rearR")
CHANGED = re.compile(r"\b(fl|Fl|frontright|FrontRight|front_right|rear_|rearr|halftrack|half_track)\b")
CASE = {"vx": 0.5, "vy": 0.0, "omega": 0.2, "FL.steer": 0.1, "frontRight.steer": 0.1, "halfTrack": 0.21}


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    path = tmp_path / "MyBot.yaml"
    path.write_text(TEXT, encoding="utf-8")
    return path


@pytest.mark.slow
def test_names_are_kept_in_files_and_packages(robot: Path) -> None:
    files = artifacts(derive(load(robot)), choice())
    for kind in (*KINDS, "rust"):
        files |= {f"{kind}/{name}": content for name, content in files_of(robot, kind).items()}
    for name, content in files.items():
        assert "mybot" not in name
        text = content.decode("utf-8", "replace")
        assert not CHANGED.search(text), name
        if name.rsplit("/")[-1] in (
            "MyBot.h",
            "MyBot.py",
            "report.md",
            "model.json",
            "lib.rs",
        ):
            assert all(wheel in text for wheel in WHEELS), name
    hpp, header = files["cmake/src/MyBot.hpp"].decode(), files["MyBot.h"].decode()
    assert "namespace MyBot {" in hpp
    assert "MYBOT_FRONTRIGHT_STEER" in header and "MYBOT_JOINTS" in header


@pytest.mark.slow
def test_c_and_cpp_compile_without_a_warning(robot: Path, tmp_path: Path) -> None:
    need("g++", "gcc")
    put(tmp_path, files_of(robot, "cmake"))
    for source in ("MyBot.c", "MyBot_checked.c"):
        run(tmp_path, "gcc", *STRICT, "-fsyntax-only", f"src/{source}")
    run(tmp_path, "g++", "-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Werror", "-fsyntax-only",
        "-xc++", "src/MyBot.hpp")  # fmt: skip


@pytest.mark.parametrize(
    "backend", [entry.name for entry in BACKENDS.values() if entry.word and not entry.package]
)
def test_backends_agree(backend: str, robot: Path) -> None:
    derivation = derive(load(robot), ("inverse",))
    module = getattr(derivation, BACKENDS[backend].source)
    (exact,) = BACKENDS["numpy"].evaluate(derivation.module, [("inverse", CASE)], {})
    (computed,) = BACKENDS[backend].evaluate(module, [("inverse", CASE)], choice().words())
    assert {"FL.spin", "frontRight.steer", "Rear_.spin"} <= computed.keys()
    assert computed == pytest.approx({name: exact[name] for name in computed}, rel=1e-5, abs=1e-5)


@pytest.mark.slow
def test_the_crate_builds_without_a_warning(robot: Path, tmp_path: Path) -> None:
    put(tmp_path / "crate", files_of(robot, "rust"))
    done = cargo(tmp_path / "crate", "test", "--offline")
    assert done.returncode == 0, done.stderr
