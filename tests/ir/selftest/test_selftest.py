"""The shipped self-tests: right numbers, and passed by the shipped C on the host and on emulated processors."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from benchmarks.emulator.zig import FLAGS, M0, M4F, Target
from tests.codegen.c.harness import COMPILERS, EACH, STRICT, WARNINGS
from tests.conftest import put
from tests.ir.selftest.every import EVERY, FEW, NAMES, failures, files_of, place_of, write
from tests.ir.selftest.target import on_target
from tests.robots import of_gallery
from wmrgen.codegen.compiler import compile_program, run_program
from wmrgen.derivation.emit import site
from wmrgen.errors import EnvironmentFailure
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.interpret import EXACT, evaluate
from wmrgen.ir.kernels.choice import TARGETS
from wmrgen.ir.rounding import to_float32, to_float64
from wmrgen.ir.selftest.vectors import FLOOR, LEAST_ROWS, rounded, tables

LARGEST = (
    54_000  # bytes for each four tables of eight steered wheels, which have 73 columns; half stay below 27 kB
)
needs_compiler = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")


@needs_compiler
@pytest.mark.parametrize("compiler", EACH)
def test_passes_on_the_host(compiler: str, tmp_path: Path) -> None:
    write(tmp_path, FEW)
    printed = run_program(compile_program(tmp_path, [EVERY], compiler, (*STRICT, "-O1")), "")
    assert len(printed.splitlines()) == len(FEW) and failures(printed) == []


@needs_compiler
@pytest.mark.parametrize("target", TARGETS)
def test_passes_with_the_code_of_every_target(target: str, tmp_path: Path) -> None:
    """Of a robot that takes the cosine of a difference of commands: sines in integers lose digits beyond 100 rad."""
    robot = "wpilib_swervebot"
    put(tmp_path, files_of(robot, target=target))
    sources, main = [f"{robot}.c", place_of(robot)], f"-D{robot.upper()}_SELFTEST_MAIN"
    run_program(compile_program(tmp_path, sources, None, (*STRICT, "-O1", main)), "")


FUSED = ("-O2", "-ffp-contract=fast", "-march=native")


@needs_compiler
@pytest.mark.slow
@pytest.mark.parametrize(("scalar", "flags"), [("double", ("-O0",)), ("float", ("-Os",)), ("float", FUSED)])
def test_passes_however_it_is_compiled(flags: tuple[str, ...], scalar: str, tmp_path: Path) -> None:
    """Contraction to fused multiply-add changes bits, and stays within the tolerance."""
    write(tmp_path, NAMES, scalar)
    for compiler in COMPILERS if flags is FUSED else COMPILERS[:1]:
        program = compile_program(tmp_path, [EVERY], compiler, ("-std=c99", *WARNINGS, *flags))
        assert failures(run_program(program, "")) == []


@pytest.mark.slow
@pytest.mark.parametrize("target", [M4F, M0], ids=["m4f", "m0"])
def test_gallery_passes_on_target(target: Target, tmp_path: Path) -> None:
    flags = (*FLAGS, "-DWMRGEN_SLOW_FMA")  # the same C on both
    assert on_target(target, NAMES, tmp_path, flags) == dict.fromkeys(NAMES, 0)


def wrong_numbers(robot: str, scalar: str, every: int) -> list[str]:
    """Expectations that are not the exact value of the formula as derived, rounded once; each ``every``-th row."""
    derivation = of_gallery(robot)
    raw = {f.name: f for f in derivation.raw_module.functions}
    enter = to_float32 if scalar == "float" else to_float64
    wrong = []
    for table in tables(derivation.c_module, scalar, site(derivation)):
        if table.law:
            continue
        function = raw[
            table.functions[0].removesuffix("_slip")
        ]  # of a robot that commands nothing, slip alone
        for vector in table.vectors[::every]:
            given = {
                p.name: Exact(0) for p in function.inputs if p.default is None
            }  # passive joints: not in C
            given |= {name: Exact(Fraction(x)) for name, x in zip(table.inputs, vector.inputs, strict=True)}
            exact = evaluate(function, given, EXACT)
            for name, expected in zip(table.outputs, vector.expected, strict=True):
                if enter(exact[name]) != expected and not (expected == 0 and abs(float(exact[name])) < 1e-12):
                    wrong.append(
                        f"{function.name} {vector.text} {name}: {expected!r}, is {float(exact[name])!r}"
                    )
    return wrong


@pytest.mark.parametrize("robot", ["turtlebot3_burger", "wpilib_swervebot"])
def test_numbers_are_the_exact_ones(robot: str) -> None:
    assert wrong_numbers(robot, "float", 3) == []


@pytest.mark.parametrize("numbers", [0, 150, 400])
def test_a_short_table_has_rows_of_the_whole_at_even_distances(numbers: int) -> None:
    """From the first on, in order: no more than are allowed, and more than half as many."""
    module = of_gallery("unicycle").c_module
    short = 0
    for table, whole in zip(tables(module, "float", numbers=numbers), tables(module, "float"), strict=True):
        rows, every = ([v.inputs for v in t.vectors] for t in (table, whole))
        step = -(-len(every) // len(rows))
        most = max(LEAST_ROWS, numbers // (len(table.inputs) + 2 * len(table.outputs)))
        short += len(rows) < len(every)
        assert table.law or len(rows) <= most
        assert rows == every[::step] and 2 * len(rows) > min(most, len(every))
    assert short


@pytest.mark.slow
@pytest.mark.parametrize("robot", NAMES)
def test_all_numbers_are_the_exact_ones(robot: str) -> None:
    assert wrong_numbers(robot, "float", 1) == []
    assert wrong_numbers(robot, "double", 6) == []


@pytest.mark.slow
def test_small_and_the_same_every_time() -> None:
    texts = {robot: files_of(robot)[place_of(robot)] for robot in NAMES}
    sizes = {robot: len(text) for robot, text in texts.items()}
    assert not [r for r, text in texts.items() if len(text) > LARGEST * max(1.0, text.count(b"_rows[][") / 4)]
    assert sorted(sizes.values())[len(sizes) // 2] <= 27_000
    robot = "ackermann_car"
    again = files_of.__wrapped__(robot)
    assert again[place_of(robot)] == files_of(robot)[place_of(robot)]


def test_covers_every_function() -> None:
    for robot in FEW:
        source, selftest = (files_of(robot)[name].decode() for name in (f"{robot}.c", place_of(robot)))
        functions = re.findall(rf"^void ({robot}_\w+)\(", source, flags=re.M)
        missing = [name for name in functions if f"    {name}(" not in selftest]
        # What reads counters is tried in tests/codegen/processor/test_counters.py; what it calls is in the self-test.
        assert functions and not [name for name in missing if name != f"{robot}_joints_from_counters"]


@needs_compiler
def test_ends_with_its_verdict(tmp_path: Path) -> None:
    """As a program of its own: 0, and 1 for a wrong build or one that gives NaN; mixed files do not compile."""
    robot = "lekiwi"
    put(tmp_path, files_of(robot))
    sources, main = [f"{robot}.c", place_of(robot)], f"-D{robot.upper()}_SELFTEST_MAIN"
    run_program(compile_program(tmp_path, sources, None, (*STRICT, "-O1", main)), "")
    good = (tmp_path / f"{robot}.c").read_text()
    for wrong in ("1.001f * twist->vx", "(twist->vx - twist->vx) / (twist->vx - twist->vx)"):
        (tmp_path / f"{robot}.c").write_text(good.replace("twist->vx", f"({wrong})", 1))
        with pytest.raises(EnvironmentFailure, match="status 1"):
            run_program(compile_program(tmp_path, sources, None, ("-std=c99", "-O1", main)), "")
    header = (tmp_path / f"{robot}.h").read_text()
    (tmp_path / f"{robot}.h").write_text(re.sub(r"_PAIR_\w+ 1", "_PAIR_0 1", header))
    with pytest.raises(EnvironmentFailure, match="not generated together"):
        compile_program(tmp_path, [place_of(robot)], None, ("-c",))


@needs_compiler
def test_few_rows_on_request(tmp_path: Path) -> None:
    """A quarter of the rows of each table, the first among them: half of the size, and still its verdict."""
    robot = "turtlebot3_burger"
    put(tmp_path, files_of(robot))
    few = f"-D{robot.upper()}_SELFTEST_FEW"
    sizes = [
        compile_program(tmp_path, [place_of(robot)], None, ("-c", *STRICT, "-Os", *flags)).stat().st_size
        for flags in ((), (few,))
    ]
    assert sizes[1] < 0.6 * sizes[0]
    flags = (*STRICT, "-O1", f"-D{robot.upper()}_SELFTEST_MAIN", few)
    run_program(compile_program(tmp_path, [f"{robot}.c", place_of(robot)], None, flags), "")
    good = (tmp_path / f"{robot}.c").read_text()
    (tmp_path / f"{robot}.c").write_text(good.replace("twist->vx", "(1.001f * twist->vx)", 1))
    with pytest.raises(EnvironmentFailure, match="status 1"):
        run_program(compile_program(tmp_path, [f"{robot}.c", place_of(robot)], None, flags), "")


def test_no_library() -> None:
    """Nothing is included but the robot's own header, and what reads flash on an AVR."""
    for robot in FEW:
        text = files_of(robot)[place_of(robot)].decode()
        assert re.findall(r"^#include (.*)$", text, flags=re.M) == [
            f'"../{robot}.h"',
            "<avr/pgmspace.h>",
        ]


def test_a_number_is_sure_where_everything_within_its_error_rounds_to_it() -> None:
    chance = np.random.default_rng(7)
    value = chance.normal(size=2000) * 10.0 ** chance.uniform(-16, 3, 2000)
    error = np.abs(value) * 10.0 ** chance.uniform(-12, 1, 2000)
    near, sure = rounded(value, error, "float")
    ends = value - error, value + error
    nothing = np.maximum(*np.abs(ends)) < FLOOR
    assert (nothing <= (sure & (near == 0))).all()
    alike = np.logical_and(*(np.float32(end) == near for end in ends))
    assert ((sure & ~nothing) == (alike & ~nothing)).all() and 0.2 < sure.mean() < 0.8
