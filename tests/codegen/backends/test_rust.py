"""The crate and Rust's tools, and texts that only Rust has. For its bits see `test_rust_bits.py`."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.codegen.backends.modules import MODULES, TWIST, VX, spin, steer
from tests.conftest import ROOT, Outcome, tree
from tests.external_tools import need, tool
from tests.robots import of_gallery
from wmrgen.codegen.registry import BACKENDS, Facts
from wmrgen.codegen.rust import evaluate
from wmrgen.codegen.rust.emit import library
from wmrgen.codegen.rust.functions import unit
from wmrgen.errors import EnvironmentFailure
from wmrgen.ir.build import Builder
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.kernels.trigonometry import SOFT
from wmrgen.ir.nodes import Module, Port, Role
from wmrgen.ir.ops import OPERATIONS, Conditional

FLOAT = Choice()


# ---- the crate as its tools see it


@pytest.fixture
def crate(tmp_path: Path) -> Path:
    """Write the crate of a robot with tunable parameters, kernels, and functions that change their arguments."""
    module = of_gallery("pioneer3dx").c_module
    for name, content in BACKENDS["rust"].load().emit(module, FACTS).items():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content)
    return tmp_path


FACTS = Facts(
    'Drives "there" & [back] <b> \u00e4', ("left: fixed",), "0123456789abcdef", "0.1.0",
    options=FLOAT.words(), constants=(("left.radius", 0.0975, "[m] radius"),),
)  # fmt: skip


def cargo(crate: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run Cargo without a network; warnings of the compiler and of rustdoc are errors."""
    env = {"PATH": str(Path(tool("cargo")).parent) + ":/usr/bin:/bin", "CARGO_HOME": str(crate / "home")}
    env |= {"RUSTFLAGS": "-Dwarnings", "RUSTDOCFLAGS": "-Dwarnings", "CARGO_NET_OFFLINE": "true"}
    return subprocess.run(
        [tool("cargo"), *words], cwd=crate, env=env, capture_output=True, text=True, check=False
    )


@pytest.mark.slow
def test_cargo_runs_the_self_test(crate: Path) -> None:
    need("cargo", "rustc")
    done = cargo(crate, "test")
    assert done.returncode == 0, done.stderr
    for name in (
        "rows_of_odometry",
        "law_of_rows_of_inverse",
        "joints_keep_their_order",
        "src/lib.rs - (line",
    ):
        assert re.search(rf"test {re.escape(name)}.* \.\.\. ok", done.stdout)
    text = (crate / "src/lib.rs").read_text()
    assert "t1 + t0" in text
    (crate / "src/lib.rs").write_text(text.replace("t1 + t0", "t1 - t0"))
    wrong = cargo(crate, "test")
    assert wrong.returncode != 0
    assert "rows_of_inverse" in wrong.stdout


@pytest.mark.slow
@pytest.mark.parametrize("words", [("clippy", "--all-targets", "--", "-Dwarnings"), ("doc",)], ids=" ".join)
def test_clippy_and_rustdoc_find_nothing(crate: Path, words: tuple[str, ...]) -> None:
    need("cargo", "rustc", "cargo-clippy")
    done = cargo(crate, *words)
    assert done.returncode == 0, done.stderr


def test_no_panic_is_compiled_and_nothing_is_unsafe_but_calls_of_the_library(crate: Path) -> None:
    need("rustc")
    command = [
        tool("rustc"),
        "--edition=2021",
        "-Copt-level=3",
        "-Dwarnings",
        "--crate-type=lib",
        "--emit=asm",
        "src/lib.rs",
    ]
    subprocess.run(command, cwd=crate, check=True)
    assert "panic" not in (crate / "lib.s").read_text()
    text = (crate / "src/lib.rs").read_text()
    assert "#![no_std]" in text and "#![deny(unsafe_code)]" in text
    assert text.count("unsafe {") == text.count("unsafe { c::fmaf(a, b, c) }") == 1
    (crate / "src/lib.rs").write_text(text.replace("#[allow(unsafe_code)]", ""))
    assert subprocess.run(command, cwd=crate, check=False, capture_output=True).returncode != 0
    assert "#![forbid(unsafe_code)]" in library(unit(MODULES[0], FLOAT))


def test_its_self_test_checks_every_function_of_a_table(crate: Path) -> None:
    text = (crate / "tests/selftest.rs").read_text()
    tables = [part.partition(". Columns: ") for part in text.split("\n/// ")]
    checks = {called: body.count("check(row, ") for called, columns, body in tables if columns}
    assert checks.pop("forward after inverse") == 1
    assert len(checks) == 10 and checks == {called: called.count(" and ") + 1 for called in checks}


def test_its_self_test_compiles_and_passes(crate: Path) -> None:
    """This test does not use Cargo and takes a quarter of a second; see also `test_cargo_runs_the_self_test`."""
    need("rustc")
    rust = (tool("rustc"), "--edition=2021", "-Dwarnings")
    crate_itself = ("--crate-type=lib", "--crate-name=pioneer3dx_kinematics", "src/lib.rs")
    subprocess.run([*rust, *crate_itself], cwd=crate, check=True)
    tests = ("--test", "tests/selftest.rs", "--extern=pioneer3dx_kinematics", "-L.", "-o", "selftest")
    subprocess.run([*rust, *tests], cwd=crate, check=True)
    done = subprocess.run([crate / "selftest"], capture_output=True, text=True, check=True)
    assert "law_of_rows_of_inverse ... ok" in done.stdout


def test_it_is_a_package(wmrgen_cli: Callable[..., Outcome], robot_file: Path) -> None:
    out = robot_file.parent / "out"
    assert wmrgen_cli("derive", robot_file, "-o", out, "--package", "rust", "--target", "m0").code == 0
    package = out / "package-rust" / "pair"
    assert set(tree(package)) == {"Cargo.toml", "src/lib.rs", "tests/selftest.rs", "manifest.json"}
    manifest, text = ((package / name).read_text() for name in ("Cargo.toml", "src/lib.rs"))
    assert 'name = "pair-kinematics"' in manifest
    assert "--target m0" in text and "Proved" not in text and "left: fixed, x 0 m, y 0.1655 m" in text
    model_hash = re.search(r'MODEL_HASH: &str = "(\w+)"', text)
    assert model_hash and f'PAIR_MODEL_HASH "{model_hash[1]}"' in (out / "pair" / "pair.h").read_text()
    assert wmrgen_cli("check", robot_file, "-o", out).code == 0
    (package / "src/lib.rs").write_text("mine")
    assert "package-rust/pair/src/lib.rs" in wmrgen_cli("check", robot_file, "-o", out).out


@pytest.mark.slow
def test_bounds_are_those_of_the_c(wmrgen_cli: Callable[..., Outcome], tmp_path: Path) -> None:
    robot = ROOT / "robots" / "pioneer3dx.yaml"
    assert wmrgen_cli("derive", robot, "-o", tmp_path, "--package", "rust").code == 0
    text = (tmp_path / "package-rust/pioneer3dx/src/lib.rs").read_text()
    line = "odometry: theta in [-3.1416, 3.1416] rad, off by 9.8e-07"
    assert f"//!   {line}" in text and line in (tmp_path / "pioneer3dx/pioneer3dx.h").read_text()


# ---- texts that only Rust has


def test_every_operation_has_a_form() -> None:
    """Calls are written as in C, choices are not. The crate has its own functions for those that C calls `wmrgen_…`."""
    bits_text = (ROOT / "templates/rust/bits.rs.j2").read_text()
    choices = [op for op in OPERATIONS.values() if isinstance(op.c, Conditional)]
    assert choices
    assert all(isinstance(op.rust, Conditional) for op in choices)
    names = {(op.rust or op.c).partition("(")[0] for op in OPERATIONS.values() if op not in SOFT.values()}
    own = {name for name in names if name.startswith("wmrgen_")}
    assert own
    assert all(f"fn {name}(" in bits_text for name in own)


def swapping() -> Module:
    """Return functions that swap members of a twist, change a pose, write one joint of the wheels, and return a
    scalar."""
    b = Builder()
    vx, vy, x, step = (b.input(name) for name in ("vx", "vy", "x", "type"))
    x_port, type_port = Port("x", Role.STATE, "m"), Port("type", Role.COMMAND, "")
    both = b.function("both", (VX, TWIST[1], x_port, type_port), (), ())
    ports = (VX, TWIST[1], x_port, Port("sum", Role.COMMAND, ""))
    results = (vy, vx, b.add(vx, x), b.add(x, step))
    both = replace(both, nodes=tuple(b.nodes), outputs=ports, results=results, in_place=True)
    a = Builder()
    turned = a.function("turn", (spin("box"),), (steer("box"),), (a.neg(a.input("box.spin")),))
    return Module("swaps", (both, turned), joints=("box.spin", "box.steer"))


def test_what_changes_in_place_changes_at_once_and_other_members_stay() -> None:
    need("rustc")
    text = library(unit(swapping(), FLOAT))
    assert "pub fn both(pose: &mut Pose, twist: &mut Twist, r#type: f32) -> f32 {" in text
    assert "pub fn turn(now: &Wheels, out: &mut Wheels) {" in text
    assert "r#box: SpinSteer { steer: -now.r#box.spin, ..out.r#box }" in " ".join(text.split())
    case = {"vx": 1.0, "vy": 2.0, "x": 4.0, "type": 8.0}
    both, turned = evaluate(swapping(), [("both", case), ("turn", {"box.spin": 3.0})])
    assert both == {"vx": 2.0, "vy": 1.0, "x": 5.0, "sum": 12.0}
    assert turned == {"box.steer": -3.0}


@pytest.mark.slow
def test_wheels_and_parameters_may_have_names_of_rust_keywords(
    wmrgen_cli: Callable[..., Outcome], robot_file: Path
) -> None:
    need("rustc")
    text = robot_file.read_text().replace("half_track: 0.1655", "let: {value: 0.1655, tunable: true}")
    robot_file.write_text(text.replace("half_track", "let").replace("name: left", "name: loop"))
    words = ("eval", robot_file, "inverse", "vx=0.0975", "omega=0", "--backend", "rust", "--json")
    done = wmrgen_cli(*words)
    assert done.code == 0, done.err
    assert '"loop.spin": 1.0' in done.out
    robot_file.write_text(robot_file.read_text().replace("name: loop", "name: self"))
    done = wmrgen_cli(*words)
    assert done.code == 2 and "'self'" in done.err and "Rust" in done.err


def test_without_a_compiler_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(EnvironmentFailure, match="rustc"):
        evaluate(MODULES[0], [("inverse", {"vx": 1.0, "vy": 0.0, "omega": 0.0})])
