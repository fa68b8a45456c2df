"""The harness that ``derive --fuzz`` writes: it runs, covers every function and finds planted faults."""

from __future__ import annotations

import os
import shutil
import subprocess
from functools import cache
from pathlib import Path

import pytest

from tests.conftest import GALLERY, put
from tests.depth import everyday
from tests.external_tools import missing
from tests.ir.selftest.every import FEW
from tests.mutation.mutants import unfolded
from tests.rules.test_joints import CAR
from wmrgen import derive, load
from wmrgen.codegen.c import emit
from wmrgen.codegen.registry import Facts
from wmrgen.derivation.emit import site

SANITIZERS = "fuzzer,address,undefined,float-divide-by-zero,float-cast-overflow"
WARNINGS = ("-Wall", "-Wextra", "-Werror")
FLAGS = ("-std=c99", *WARNINGS, "-g", "-O1", f"-fsanitize={SANITIZERS}", "-fno-sanitize-recover=all")
ACKERMANN, TUNABLE = "ackermann_car", "pioneer3dx"
RUNS = 100_000  # of seeds 1 to 8 each found every fault of PLANTED within 40,000, every edge and counter within 22,000


def compiled(folder: Path, robot: str, change: tuple[str, str] | None = None, text: str = "") -> Path:
    """Build the fuzzer of a robot of the gallery or of ``text``; ``change`` replaces a piece of its checked
    functions."""
    path = folder / f"{robot}.yaml"
    path.write_text(text or next(path for path in GALLERY if path.stem == robot).read_text())
    derivation = derive(load(path))
    files = emit(derivation.c_module, Facts(site=site(derivation), options={"fuzz": True}))
    put(folder, files)
    if change:
        checked = unfolded(files[f"{robot}_checked.c"].decode())
        assert change[0] in checked
        (folder / f"{robot}_checked.c").write_text(checked.replace(*change, 1))
    sources = [f"test/{robot}_fuzz.c", f"{robot}_checked.c", f"{robot}.c"]
    command = [clang(), *FLAGS, *sources, "-lm", "-o", "fuzzer"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)
    return folder / "fuzzer"


@cache
def clang() -> str:
    """Return a clang with libFuzzer's runtime."""
    found = shutil.which("clang")
    if found is None:
        missing("clang is not installed")
    probe = subprocess.run(
        [str(found), "-fsanitize=fuzzer,address", "-xc", "-", "-o", os.devnull],
        input="int LLVMFuzzerTestOneInput(const unsigned char *d, unsigned long n) { return d && n > 100; }",
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if probe.returncode:
        missing("clang has no libFuzzer (Debian, Ubuntu: apt-get install clang libclang-rt-dev)")
    return str(found)


def run(program: Path) -> subprocess.CompletedProcess[str]:
    arguments = [
        f"-runs={RUNS}",
        "-max_len=600",
        "-seed=1",
        "-artifact_prefix=./",
        "-verbosity=1",
    ]
    env = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0"}
    return subprocess.run(
        [str(program), *arguments],
        cwd=program.parent,
        env=env,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


@pytest.mark.slow
def test_virtual_wheels_do_not_command(tmp_path: Path) -> None:
    """Measured angles may be beyond their limits, and so may those that follow from them."""
    text = CAR.replace("[posture]", "[posture, virtual_angle, virtual_steering]")
    done = run(compiled(tmp_path, "probed", text=text))
    assert done.returncode == 0, done.stderr[-3000:]


@pytest.mark.slow
@pytest.mark.parametrize("robot", FEW)
def test_nothing_is_found(robot: str, tmp_path: Path) -> None:
    done = run(compiled(tmp_path, robot))
    assert done.returncode == 0, done.stderr[-3000:]


HELD = "ackermann_car_held(now->front_left.steer)"
PLANTED = {
    "a range left out": (
        ACKERMANN,
        "ackermann_car_is_within(twist->omega, -2.0f, 2.0f)",
        "(twist->omega >= -2.0f)",
    ),
    "a limit left out": (ACKERMANN, f"ackermann_car_between({HELD}, -0.6981317f, 0.6981317f)", HELD),
    "a parameter left out": (
        TUNABLE,
        "pioneer3dx_is_within(params->radius, 0.08775f, 0.10725f)",
        "(params->radius < 1.0f)",
    ),
    "parameters kept": (TUNABLE, "pioneer3dx_params_default(&nominal)", "nominal = *params"),
}


@pytest.mark.parametrize("fault", everyday(PLANTED, ["a range left out", "a limit left out"]))
@pytest.mark.slow
def test_planted_faults_are_found_by_fuzzing(fault: str, tmp_path: Path) -> None:
    robot, *change = PLANTED[fault]
    done = run(compiled(tmp_path, robot, (change[0], change[1])))
    assert done.returncode != 0 and "deadly signal" in done.stderr, done.stderr[-3000:]
