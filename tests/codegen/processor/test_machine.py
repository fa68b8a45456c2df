"""The emulator itself, on functions whose instructions are known."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import pytest

from benchmarks.emulator import M4F, Image, Machine, compile_objects, link

CODE = """
#include <math.h>
__attribute__((naked)) int three(int a, int b)
{
    __asm__("cmp r0, r1\\n it lt\\n movlt r0, r1\\n bx lr");
}
__attribute__((naked)) int four(int a, int b)
{
    __asm__("cmp r0, r1\\n ite lt\\n movlt r0, r1\\n movge r0, r0\\n bx lr");
}
__attribute__((naked)) void floats(float *x)
{
    __asm__("vldr s0, [r0]\\n vldr s1, [r0, #4]\\n vmul.f32 s2, s0, s1\\n vadd.f32 s2, s2, s0\\n vfma.f32 s2, s0, s1\\n"
            "vdiv.f32 s3, s2, s1\\n vsqrt.f32 s3, s3\\n vabs.f32 s3, s3\\n vcmp.f32 s3, s0\\n vmrs APSR_nzcv, fpscr\\n"
            "vmov s4, r0\\n vstr s3, [r0, #8]\\n bx lr");
}
__attribute__((naked)) void words(int *x)
{
    __asm__("push {r4, lr}\\n ldr r1, [r0]\\n ldr.w r2, [r0, #4]\\n ldrd r2, r3, [r0]\\n ldm r0, {r1, r2, r3}\\n"
            "vldmia r0, {s0-s3}\\n vpush {s0, s1}\\n vpop {s0, s1}\\n str r1, [r0]\\n muls r1, r2, r1\\n pop {r4, pc}");
}
void root(float *x) { x[2] = sqrtf(x[0]) * sinf(x[1]); }
int stack(volatile int *x)
{
    volatile int kept[10];
    for (int k = 0; k < 10; k++) { kept[k] = x[k]; }
    return kept[3];
}
void forever(void) { for (;;) { __asm__ volatile (""); } }
const unsigned char bytes[] = {1, 2, 3};
"""
STUBS = "float sinf(float x); float sinf(float x) { return x; }\n"


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Machine:
    folder = tmp_path_factory.mktemp("machine")
    (folder / "code.c").write_text(CODE)
    (folder / "stubs.c").write_text(STUBS)
    image = Image(link(folder, compile_objects(folder, ("code.c", "stubs.c"), M4F), "code.elf", M4F))
    return Machine(image, {"sinf": (1, math.sin)}, stack=True)


@pytest.mark.parametrize(("name", "count"), [("three", 4), ("four", 5)])
def test_the_count_does_not_depend_on_what_an_it_block_skips(machine: Machine, name: str, count: int) -> None:
    assert machine.call(name, 1, 2).instructions == machine.call(name, 2, 1).instructions == count


@pytest.mark.parametrize(
    ("name", "cycles"),
    [
        ("floats", 2 + 2 + 1 + 1 + 3 + 14 + 14 + 1 + 1 + 1 + 1 + 2 + 3),
        ("words", 3 + 2 + 2 + 3 + 4 + 5 + 3 + 3 + 2 + 1 + 5),
        ("three", 1 + 1 + 1 + 3),
    ],
)
def test_cycles_are_those_of_the_manual(machine: Machine, name: str, cycles: int) -> None:
    """For each instruction in turn."""
    assert machine.call(name, 0x2000_1000).cycles == cycles


def test_a_trap_answers_in_float_and_costs_nothing(machine: Machine) -> None:
    place = 0x2000_1000
    machine.write(place, struct.pack("<2f", 4.0, 0.5))
    run = machine.call("root", place)
    (answer,) = struct.unpack("<f", machine.read(place + 8, 4))
    assert answer == struct.unpack("<f", struct.pack("<f", 2 * math.sin(0.5)))[0]
    assert run.calls == {"sinf": 1}
    assert 6 < run.instructions < 14


def test_the_stack_is_measured(machine: Machine) -> None:
    assert machine.call("stack", 0x2000_1000).stack >= 40
    assert machine.call("three", 1, 2).stack == 0


def test_a_function_that_does_not_return_is_an_error(
    machine: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("benchmarks.emulator.machine.LIMIT", 1000)
    with pytest.raises(RuntimeError, match="forever did not return"):
        machine.call("forever")


def test_objects_are_read_from_the_image(machine: Machine) -> None:
    assert machine.image.content("bytes") == bytes([1, 2, 3])
    assert machine.image.undefined == frozenset()


def test_a_c_error_is_reported(tmp_path: Path) -> None:
    (tmp_path / "wrong.c").write_text("int f(void) { return missing; }\n")
    with pytest.raises(RuntimeError, match="missing"):
        compile_objects(tmp_path, ("wrong.c",), M4F)
