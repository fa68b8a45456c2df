"""Compiler options that change results: the C does not compile with them, or the self-test passes."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.emulator.zig import FLAGS as ZIG
from benchmarks.emulator.zig import M4F
from tests.codegen.c.harness import COMPILERS
from tests.ir.selftest.every import EVERY, FEW, FUNCTIONS, TESTS, failures, write
from tests.ir.selftest.target import on_target
from wmrgen.codegen.compiler import compile_program, run_program
from wmrgen.errors import EnvironmentFailure

ASSOCIATIVE = "-fassociative-math -fno-signed-zeros -fno-trapping-math"  # the first does nothing by itself
OPTIONS = (
    "-ffast-math", "-Ofast", "-Ofast -fno-finite-math-only", "-funsafe-math-optimizations", ASSOCIATIVE,
    "-ffast-math -fno-associative-math", "-freciprocal-math", "-ffinite-math-only", "-fno-signed-zeros",
    "-fno-trapping-math", "-fno-math-errno", "-frounding-math", "-ffp-contract=fast",
)  # fmt: skip
OF_CLANG = (
    "-fapprox-func",
    "-ffp-model=fast",
    "-fno-honor-nans",
    "-fno-honor-infinities",
    "-freciprocal-math -fapprox-func",
)
REFUSED = {  # by compilers that define macros for them: gcc since 12; clang only for -ffast-math
    "gcc": set(OPTIONS[:7]) | {"-fno-signed-zeros"},
    "clang": {"-ffast-math", "-Ofast", "-ffp-model=fast"},
}
PLAIN = ("-std=c99", "-w")
# With half of -ffast-math, clang computes square roots from an estimate, which processors round differently.
NO_ESTIMATES = {"clang": ("-mrecip=none",)}
OBJECT = "tests.o"
EVERYDAY = ("turtlebot3_burger", "ackermann_car")
PAIRS = [(c, option) for c in COMPILERS for option in (*OPTIONS, *(OF_CLANG if c == "clang" else ()))]


def outcome(folder: Path, compiler: str, flags: str, sources: tuple[str, ...] = (EVERY,)) -> str | list[str]:
    """Return ``refused``, or the self-tests that fail."""
    try:
        arguments = (*PLAIN, "-O2", *NO_ESTIMATES.get(compiler, ()), *flags.split())
        program = compile_program(folder, sources, compiler, arguments)
    except EnvironmentFailure as error:
        assert "#error" in str(error) or 'error: "-f' in str(error), str(error)
        return "refused"
    return failures(run_program(program, ""))


@pytest.mark.parametrize(
    ("compiler", "option"),
    [p if p[0] == COMPILERS[0] else pytest.param(*p, marks=pytest.mark.slow) for p in PAIRS],
)
def test_refused_or_right(compiler: str, option: str, tmp_path: Path) -> None:
    """The everyday tests use one compiler."""
    write(tmp_path, EVERYDAY)
    assert outcome(tmp_path, compiler, option) == ("refused" if option in REFUSED[compiler] else [])


@pytest.fixture(scope="module", params=["float", "double"])
def families(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The C of robots, and their self-tests as an object that knows no option, and so tells a NaN. Without the guards,
    or without one of them, an option that changes a robot of the gallery changes every other."""
    folder = tmp_path_factory.mktemp("options")
    write(folder, FEW, request.param)
    compile_program(folder, [TESTS], COMPILERS[0], (*PLAIN, "-c")).rename(folder / OBJECT)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize(("compiler", "option"), PAIRS)
def test_families_are_refused_or_right(compiler: str, option: str, families: Path) -> None:
    right = "refused" if option in REFUSED[compiler] else []
    assert outcome(families, compiler, option, (FUNCTIONS, OBJECT)) == right


@pytest.mark.parametrize("option", ["-funsafe-math-optimizations", ASSOCIATIVE])
@pytest.mark.slow
def test_right_on_cortex_m4f(option: str, tmp_path: Path) -> None:
    """For a clang that defines neither macro, sums keep their order."""
    assert on_target(M4F, FEW, tmp_path, (*ZIG, *option.split())) == dict.fromkeys(FEW, 0)


@pytest.mark.parametrize("compiler", COMPILERS)
def test_an_option_that_regroups_is_seen(compiler: str, tmp_path: Path) -> None:
    """Without the guard, the self-test of doubles fails, so these tests can fail."""
    write(tmp_path, ("bicycle",), "double")
    source = tmp_path / "bicycle.c"
    head, body = source.read_text().split("#if defined(__FAST_MATH__)", 1)
    source.write_text(head + body[body.index("\n\n") :])
    assert outcome(tmp_path, compiler, ASSOCIATIVE) != []
