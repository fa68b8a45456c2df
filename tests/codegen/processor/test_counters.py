"""Readings of encoders that wrap: the C computes correct differences on the host, a Cortex-M4F and an AVR, whose int
has 16 bits."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.codegen.c.harness import COMPILERS, STRICT
from tests.codegen.processor.test_boards import on_qemu, on_simavr
from tests.robots import of_text
from wmrgen.codegen.c import sources
from wmrgen.codegen.c.driver import evaluate_c
from wmrgen.codegen.compiler import compile_program, run_program
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Module

TEXT = """\
wmrgen: 1
name: counted
wheels:
  - {name: a, type: fixed, x: 0, y: 1, heading: 0, r: 0.1, encoder: {spin: {counts: 512, bits: 16, reversed: true}}}
  - {name: b, type: fixed, x: 0, y: -1, heading: 0, r: 0.1, encoder: {spin: {counts: 512}}}
  - {name: c, type: castor, x: -1, y: 0, d: 0.1, heading: 0, r: 0.1, actuated: [spin, steer], encoder: {steer: {counts: 2048, gear: 150/7, bits: 16}}}
  - {name: e, type: steered, x: 1, y: 0, heading: 0, r: 0.1, encoder: {spin: {counts: 90, modulus: 9000}, steer: {counts: 4096, bits: 12, offset: 77}}}
  - {name: f, type: fixed, x: 0, y: 2, heading: 0, r: 0.1, encoder: {spin: {counts: 512, bits: 24}}}
  - {name: g, type: castor, x: 1, y: 1, d: 0.1, heading: 0, r: 0.1, actuated: [steer], encoder: {steer: {counts: 255, modulus: 255, offset: 3}}}
functions: [joints_from_counts]
"""  # noqa: E501
# Encoder: its modulus, the bits of its member.
WRAPS = {"a.spin": (2**16, 16), "b.spin": (2**32, 32), "c.steer": (2**16, 16), "e.spin": (9000, 16),
         "e.steer": (4096, 16), "f.spin": (2**24, 32), "g.steer": (255, 8)}  # fmt: skip
OFFSETS = {"e.steer": 77, "g.steer": 3}
JOINTS = (
    "a.spin",
    "b.spin",
    "c.steer",
    "c.steer_rate",
    "e.spin",
    "e.steer",
    "f.spin",
    "g.steer",
    "g.steer_rate",
)
# Readings of one encoder: now, last.
PAIRS = [(5, 2), (2, 5), (3, -4), (-4, 3), (0, 0), (-1, -1), (2**15 - 1, 0), (-(2**15), 0), (2**15 + 3, 2**15 - 5),
         (2**15 - 5, 2**15 + 3), (2**31 - 1, 2**31 - 9), (2**31 + 7, 2**31 - 9), (-7, 2**16 - 2)]  # fmt: skip
NAME = "joints_from_counts"
BEFORE = 1.5  # [rad] the steering angle of the last step


def module() -> Module:
    return of_text(TEXT).c_module


def difference(encoder: str, now: int, last: int) -> int:
    """Return the difference of two readings that is nearest to zero."""
    modulus = WRAPS[encoder][0]
    return (now - last + modulus // 2) % modulus - modulus // 2


def counts(now: int, last: int) -> dict[str, int]:
    """Return the counts of encoders with these readings, by port."""
    ports = {f"{e}_counts": difference(e, now, OFFSETS.get(e, last)) for e in WRAPS}
    return ports | {"g.steer_rate_counts": difference("g.steer", now, last)}


def program(folder: Path, choice: Choice, lie: int = 0) -> list[str]:
    """Write the C files of ``int check(void)``, which counts joints that are not those of the differences plus
    ``lie``."""
    for ending, text in zip("hc", sources(module(), choice), strict=True):
        (folder / f"counted.{ending}").write_text(text)
    lines = ['#include "counted.h"', "int check(void);", "int check(void)", "{", "    int wrong = 0;"]
    for now, last in PAIRS:
        lines += ["    {", "        counted_counters now, last;", "        counted_joints_from_counts_in in;"]
        lines += ["        counted_wheels read = {0}, expected = {0};"]
        lines += [f"        {v}.c.steer = {BEFORE}f;" for v in ("read", "expected")]
        for name, value in (("now", now), ("last", last)):
            lines += [f"        {name}.{m} = {value % n}u{'l' * (w > 16)};" for m, (n, w) in WRAPS.items()]
        lines += [f"        in.{port} = {value + lie}.0f;" for port, value in counts(now, last).items()]
        lines += ["        in.dt = 0.01f;", "        counted_joints_from_counts(&expected, &in);"]
        lines += ["        counted_joints_from_counters(&read, &now, &last, 0.01f);"]
        lines += [f"        wrong += read.{joint} != expected.{joint};" for joint in JOINTS]
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
    """The expected joints: 2 pi over counts and dt."""
    cases = [
        {k: float(v) for k, v in counts(*pair).items()} | {"dt": 0.01, "c.steer": BEFORE} for pair in PAIRS
    ]
    results = evaluate_c(module(), [(NAME, case) for case in cases], Choice("double"))
    turn, per_turn = 6.283185307179586, 2048 * 150 / 7
    whole = round(BEFORE / turn * per_turn)
    for case, result in zip(cases, results, strict=True):
        wanted = {
            "a.spin": -case["a.spin_counts"] / 512 * turn / 0.01,
            "c.steer": (whole + case["c.steer_counts"]) / per_turn * turn,
            "c.steer_rate": case["c.steer_counts"] / per_turn * turn / 0.01,
            "e.spin": case["e.spin_counts"] / 90 * turn / 0.01,
            "e.steer": case["e.steer_counts"] / 4096 * turn,
            "g.steer_rate": case["g.steer_rate_counts"] / 255 * turn / 0.01,
        }
        assert {name: result[name] for name in wanted} == pytest.approx(wanted, rel=1e-12)


WINDING = """
#include "counted.h"
#include <math.h>
int check(void);
int check(void)
{
    counted_counters now = {0}, last = {0};
    counted_wheels wheels = {0};
    long total = 0, k;
    int wrong = 0;
    for (k = 0; k < 60000; ++k) {
        const long step = (k % 7) * ((k / 10000) % 2 ? -31 : 31);
        total += step;
        now.c.steer = (uint16_t)(now.c.steer + step);
        counted_joints_from_counters(&wheels, &now, &last, 0.01f);
        last = now;
        wrong += fabs(wheels.c.steer - total * (6.283185307179586 * 7 / (2048.0 * 150))) > 2e-5;
    }
    return wrong;
}
"""


@pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
def test_a_steering_angle_beyond_its_counter(tmp_path: Path) -> None:
    """A 16-bit counter with 43,886 counts per revolution wraps after 1.5 revolutions.

    The joint makes 21 revolutions and returns, in floats: errors do not accumulate.
    """
    files = program(tmp_path, Choice())
    (tmp_path / "check.c").write_text(WINDING)
    (tmp_path / "main.c").write_text(MAIN)
    assert (
        int(run_program(compile_program(tmp_path, [*files, "main.c"], COMPILERS[0], ("-O2", "-lm")), "")) == 0
    )


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
