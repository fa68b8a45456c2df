"""Counters of encoders that wrap: the C takes their differences as whole numbers do, on the host, a Cortex-M4F and an
AVR, whose int has 16 bits."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.c.harness import COMPILERS, STRICT
from tests.processor.test_boards import on_qemu, on_simavr
from tests.robots import of_text
from wmrgen.backends.c99 import sources
from wmrgen.backends.c99.driver import evaluate_c
from wmrgen.compiler import compile_program, run_program
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Module

TEXT = """\
wmrgen: 1
name: counted
wheels:
  - {name: a, type: fixed, x: 0, y: 1, heading: 0, r: 0.1, encoder: {spin: {counts: 512, bits: 16, reversed: true}}}
  - {name: b, type: fixed, x: 0, y: -1, heading: 0, r: 0.1, encoder: {spin: {counts: 512}}}
  - {name: c, type: castor, x: -1, y: 0, d: 0.1, heading: 0, r: 0.1, actuated: [spin, steer], encoder: {steer: {counts: 300, bits: 16}}}
  - {name: e, type: steered, x: 1, y: 0, heading: 0, r: 0.1, encoder: {steer: {counts: 300}}}
functions: [joints_from_counts]
"""  # noqa: E501
BITS = {"a.spin": 16, "b.spin": 32, "c.steer": 16, "e.steer": 32}
# Readings of one counter: now, last.
PAIRS = [(5, 2), (2, 5), (3, -4), (-4, 3), (0, 0), (-1, -1), (2**15 - 1, 0), (-(2**15), 0), (2**15 + 3, 2**15 - 5),
         (2**15 - 5, 2**15 + 3), (2**31 - 1, 2**31 - 9), (2**31 + 7, 2**31 - 9), (-7, 2**16 - 2)]  # fmt: skip
NAME = "joints_from_counts"


def module() -> Module:
    return of_text(TEXT).c_module


def signed(value: int, bits: int) -> int:
    """The whole number of so many bits that is ``value``, but for wraps."""
    return (value + 2 ** (bits - 1)) % 2**bits - 2 ** (bits - 1)


def counts(now: int, last: int) -> dict[str, int]:
    """What is read of counters that all stand so, by port."""
    ports = {f"{n}.spin_counts": signed(now - last, BITS[f"{n}.spin"]) for n in "ab"}
    ports |= {f"{n}.steer_counts": signed(now, BITS[f"{n}.steer"]) for n in "ce"}
    return ports | {"c.steer_rate_counts": signed(now - last, 16)}


def program(folder: Path, choice: Choice, lie: int = 0) -> list[str]:
    """The C files of ``int check(void)``: how many joints are not those of the differences plus ``lie``."""
    for ending, text in zip("hc", sources(module(), choice), strict=True):
        (folder / f"counted.{ending}").write_text(text)
    lines = ['#include "counted.h"', "int check(void);", "int check(void)", "{", "    int wrong = 0;"]
    joints = ("a.spin", "b.spin", "c.steer", "c.steer_rate", "e.steer")
    for now, last in PAIRS:
        lines += ["    {", "        counted_counters now, last;", "        counted_joints_from_counts_in in;"]
        lines += ["        counted_wheels read, expected;"]
        for name, value in (("now", now), ("last", last)):
            lines += [f"        {name}.{m} = {value % 2**b}u{'l' * (b > 16)};" for m, b in BITS.items()]
        lines += [f"        in.{port} = {value + lie}.0f;" for port, value in counts(now, last).items()]
        lines += ["        in.dt = 0.01f;", "        counted_joints_from_counts(&in, &expected);"]
        lines += ["        counted_joints_from_counters(&now, &last, 0.01f, &read);"]
        lines += [f"        wrong += read.{joint} != expected.{joint};" for joint in joints]
        lines.append("    }")
    (folder / "check.c").write_text("\n".join([*lines, "    return wrong;", "}", ""]))
    return ["counted.c", "check.c"]


MAIN = '#include <stdio.h>\nint check(void);\nint main(void) { printf("%d\\n", check()); return 0; }\n'


@pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
@pytest.mark.parametrize("lie", [0, 1])
def test_on_the_host(lie: int, tmp_path: Path) -> None:
    files = program(tmp_path, Choice(), lie)
    (tmp_path / "main.c").write_text(MAIN)
    for compiler in COMPILERS:
        flags = tuple(flag for flag in STRICT if flag != "-Wfloat-equal")
        wrong = run_program(compile_program(tmp_path, [*files, "main.c"], compiler, flags), "")
        assert (int(wrong) > 0) == bool(lie)


def test_the_function_of_differences_has_them_in_every_case() -> None:
    """What the counters are compared with: 2 pi over counts and dt."""
    cases = [{k: float(v) for k, v in counts(*pair).items()} | {"dt": 0.01} for pair in PAIRS]
    results = evaluate_c(module(), [(NAME, case) for case in cases], Choice("double"))
    for case, result in zip(cases, results, strict=True):
        turn = 6.283185307179586
        assert result["a.spin"] == pytest.approx(-case["a.spin_counts"] / 512 * turn / 0.01, rel=1e-12)
        assert result["c.steer_rate"] == pytest.approx(
            case["c.steer_rate_counts"] / 300 * turn / 0.01, rel=1e-12
        )
        assert result["e.steer"] == pytest.approx(case["e.steer_counts"] / 300 * turn, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("lie", [0, 1])
def test_on_a_cortex_m4f(lie: int, tmp_path: Path) -> None:
    files = program(tmp_path, Choice(target="m4f"), lie)
    assert ("different" if lie else "the same") in on_qemu(tmp_path, files, "m4f", "mps2-an386")


@pytest.mark.slow
@pytest.mark.parametrize("lie", [0, 1])
def test_on_an_avr(lie: int, tmp_path: Path) -> None:
    files = program(tmp_path, Choice(target="avr"), lie)
    assert ("different" if lie else "the same") in on_simavr(tmp_path, files)
