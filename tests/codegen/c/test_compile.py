"""Compilation of generated C: warnings, C++, mixed pairs, hostile texts, and a machine without a compiler."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.codegen.backends.modules import MODULES, mecanum, swerve, tunable
from tests.codegen.c.harness import COMPILERS, EACH, STRICT, Program, gallery
from tests.external_tools import need
from wmrgen.codegen.c import sources
from wmrgen.codegen.c.driver import evaluate_c
from wmrgen.codegen.compiler import compile_program, find_compiler, run_program
from wmrgen.codegen.registry import Facts
from wmrgen.errors import EnvironmentFailure
from wmrgen.ir.kernels.choice import DEFAULT, Choice
from wmrgen.ir.nodes import Module

pytestmark = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
NO_FACTS = Facts()
DRIVERLESS = ("-c", "-O0")


def write(folder: Path, module: Module, choice: Choice = DEFAULT, facts: Facts = NO_FACTS) -> None:
    header, source = sources(module, choice, facts)
    (folder / f"{module.name}.h").write_text(header)
    (folder / f"{module.name}.c").write_text(source)


@pytest.mark.parametrize("compiler", EACH)
def test_each_file_stands_alone(compiler: str, tmp_path: Path) -> None:
    """No source depends on the includes of another, and each header compiles alone and twice."""
    for module in (*MODULES, *gallery()[::6]):
        write(tmp_path, module)
        (tmp_path / "user.c").write_text(
            f'#include "{module.name}.h"\n#include "{module.name}.h"\nint user;\n'
        )
        for file in (f"{module.name}.c", "user.c"):
            compile_program(tmp_path, [file], compiler, (*STRICT, *DRIVERLESS))


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("g++"), reason="no C++ compiler here")
def test_every_header_from_cpp(tmp_path: Path) -> None:
    program = Program((*MODULES, *gallery()), "float", 0)
    program.write(tmp_path)
    lines = [f'#include "{module.name}.h"\n' for module in program.modules]
    use = (
        "int main() { mecanum_inverse_in in = {}; mecanum_inverse_out out; in.vx = 1.0f;\n"
        "  mecanum_inverse(&in, &out); return out.front_left.spin > 0.0f ? 0 : 1; }\n"
    )
    (tmp_path / "main.cpp").write_text("".join(lines) + use)
    compile_program(tmp_path, ["mecanum.c"], COMPILERS[0], (*STRICT, "-c"))
    (tmp_path / "program").rename(tmp_path / "mecanum.o")
    flags = ("-std=c++11", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
    compile_program(tmp_path, ["main.cpp", "mecanum.o"], "g++", flags)


def test_kernels_of_two_targets_do_not_share_a_file(tmp_path: Path) -> None:
    """Robots of one target may be in one translation unit. Kernels of another target would replace theirs."""
    first, second = (m for m in (swerve(), *gallery()) if m.name in ("swerve", "wpilib_swervebot"))
    (tmp_path / "both.c").write_text(f'#include "{first.name}.c"\n#include "{second.name}.c"\n')
    write(tmp_path, first)
    write(tmp_path, second)
    compile_program(tmp_path, ["both.c"], COMPILERS[0], (*STRICT, *DRIVERLESS))
    for other in (Choice(target="host"), Choice(math="libm"), Choice("double", "libm")):
        write(tmp_path, second, other)
        with pytest.raises(EnvironmentFailure, match=r"#error.*--target"):
            compile_program(tmp_path, ["both.c"], COMPILERS[0], (*STRICT, *DRIVERLESS))


def test_a_mixed_pair_does_not_compile(tmp_path: Path) -> None:
    write(tmp_path, mecanum(), facts=Facts(model_hash="1"))
    header, _ = sources(mecanum(), facts=Facts(model_hash="2"))
    (tmp_path / "mecanum.h").write_text(header)
    with pytest.raises(EnvironmentFailure, match=r"#error.*mecanum\.h"):
        compile_program(tmp_path, ["mecanum.c"], None, DRIVERLESS)


@pytest.mark.parametrize("compiler", COMPILERS)
def test_hostile_texts(compiler: str, tmp_path: Path) -> None:
    evil = '*/ int x; /* ??/\n \\ // /* é \\\n#error no\n??/ "'
    for module in (swerve(), tunable()):
        write(tmp_path, module, facts=Facts(description=evil, wheel_lines=(evil, evil * 9)))
        for extra in ((), ("-trigraphs",)):
            compile_program(tmp_path, [f"{module.name}.c"], compiler, (*STRICT, *DRIVERLESS, *extra))


def test_without_a_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(EnvironmentFailure, match="gcc") as caught:
        evaluate_c(mecanum(), [("inverse", {"vx": 1.0, "vy": 0.0, "omega": 0.0})])
    assert caught.value.exit_code == 4
    monkeypatch.setenv("CC", "no-such-cc")
    with pytest.raises(EnvironmentFailure, match="no-such-cc"):
        find_compiler()


def test_evaluate_in_both_scalars() -> None:
    asked = ("inverse", {"vx": 0.3, "vy": 0.1, "omega": -2.0})
    single, double = (evaluate_c(mecanum(), [asked, asked], Choice(scalar)) for scalar in ("float", "double"))
    assert single[0] == single[1] and double[0] == double[1]
    assert single[0] != double[0]
    assert single[0]["front_left.spin"] == pytest.approx(double[0]["front_left.spin"], rel=1e-6)


def compiled(folder: Path, *words: str) -> bytes:
    """Compile a swerve drive for a processor with a fused multiply-add by ``words`` and return the object."""
    write(folder, swerve())
    subprocess.run([*words, "-std=c99", "-c", "swerve.c", "-o", "swerve.o"], cwd=folder, check=True)
    return (folder / "swerve.o").read_bytes()


@pytest.mark.parametrize("compiler", EACH)
def test_options_for_size_call_the_kernels(compiler: str, tmp_path: Path) -> None:
    """-Os gives the same object as -DWMRGEN_SMALL, smaller than with inlined kernels."""
    small, fast = compiled(tmp_path, compiler, "-Os"), compiled(tmp_path, compiler, "-O2")
    assert small == compiled(tmp_path, compiler, "-Os", "-DWMRGEN_SMALL")
    assert len(small) < len(fast)


@pytest.mark.parametrize("compiler", EACH)
def test_a_processor_without_the_instruction_does_not_call_fmaf(compiler: str, tmp_path: Path) -> None:
    bare = "-U__FP_FAST_FMAF", "-U__FMA__", "-U__ARM_FEATURE_FMA", "-U__riscv_flen"
    assert b"fmaf" not in compiled(tmp_path, compiler, "-O1", *bare)


# Floats of few bits, with magnitudes up to 2**30 apart: many sums are halfway between two floats.
AGAINST_LIBRARY = """
#include "swerve.c"
#include <string.h>
static uint32_t state = 1U;
static uint32_t drawn(void) { state = state * 1664525U + 1013904223U; return state >> 8; }
static float number(void)
{
    uint32_t bits = (drawn() << 9) & ((drawn() & 1U) ? 0x807f0000U : 0x807fffffU);
    float value;
    bits |= (97U + drawn() % 60U) << 23;
    memcpy(&value, &bits, sizeof value);
    return value;
}
int main(void)
{
    int k, wrong = 0, twice = 0;
    for (k = 0; k < 2000000; ++k) {
        const float a = number(), b = number(), c = number(), once = fmaf(a, b, c);
        wrong += wmr_fma(a, b, c) != once;
        twice += (float)((double)a * (double)b + (double)c) != once;
    }
    return (wrong == 0 && twice > 0) ? 0 : 1;
}
"""


@pytest.mark.parametrize("compiler", EACH)
def test_without_the_instruction_sums_are_those_of_the_library(compiler: str, tmp_path: Path) -> None:
    write(tmp_path, swerve())
    (tmp_path / "main.c").write_text(AGAINST_LIBRARY)
    flags = ("-std=c99", "-O2", "-ffp-contract=off", "-U__FP_FAST_FMAF", "-U__FMA__", "-U__ARM_FEATURE_FMA")
    run_program(compile_program(tmp_path, ["main.c"], compiler, flags), "")


@pytest.mark.parametrize(
    ("words", "target"),
    [(("arm-none-eabi-gcc", "-mcpu=cortex-m0", "-mthumb"), "m0"), (("avr-gcc", "-mmcu=atmega328p"), "avr")],
    ids=["m0", "avr"],
)
def test_a_processor_without_floating_point_is_refused(
    words: tuple[str, ...], target: str, tmp_path: Path
) -> None:
    need(words[0])
    write(tmp_path, swerve())
    done = subprocess.run([*words, "-c", "swerve.c"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode != 0 and f"--target {target}" in done.stderr
    write(tmp_path, swerve(), Choice(target=target))
    subprocess.run([*words, "-std=c99", "-c", "swerve.c"], cwd=tmp_path, check=True)
