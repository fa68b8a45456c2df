"""Generated C gives the interpreter's bits on emulated boards, built with the GNU toolchains that firmware uses."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import pytest

from benchmarks.emulator import gcc
from benchmarks.emulator.image import Image
from tests.codegen.processor import boards
from tests.depth import everyday
from tests.external_tools import need
from tests.ir.selftest.every import NAMES
from tests.robots import of_gallery

RAM = 64  # bytes of RAM for the self-test without its stack, of an ATmega328P's 2,048
FLASH = 32_256  # bytes of flash that Arduino's boot loader leaves
ROBOTS = ("clearpath_do100", "lekiwi", "nomad_xr4000", "wpilib_swervebot")
BOARDS = pytest.mark.parametrize(("processor", "board"), [("m4f", "mps2-an386"), ("m0", "microbit")])


def on_qemu(folder: Path, files: list[str], processor: str, board: str) -> str:
    need("arm-none-eabi-gcc", "qemu-system-arm")
    program = boards.cortex_m(folder, files, processor)
    words = ("-nographic", "-semihosting-config", "enable=on,target=native")
    return boards.said("qemu-system-arm", "-M", board, *words, "-kernel", program)


def on_simavr(folder: Path, files: list[str], flags: Sequence[str] = (), chip: str = "atmega328p") -> str:
    need("avr-gcc", "simavr")
    program = boards.atmega(folder, files, flags, chip)
    return boards.said("simavr", "-m", chip, "-f", "16000000", program)


def spoil(folder: Path) -> None:
    """Change the last bit of one expected output."""
    text = (folder / "check.c").read_text()
    before, mark, rest = text.partition("uint32_t out_")
    start = rest.index("{0x") + 1
    word = int(rest[start : start + 10], 16) ^ 1
    (folder / "check.c").write_text(f"{before}{mark}{rest[:start]}{word:#010x}{rest[start + 10 :]}")


@pytest.mark.slow
@BOARDS
def test_cortex_m(processor: str, board: str, tmp_path: Path) -> None:
    files = boards.write(tmp_path, [of_gallery(name).c_module for name in ROBOTS], processor, 20)
    assert "the same" in on_qemu(tmp_path, files, processor, board)


@pytest.mark.slow
@BOARDS
def test_a_wrong_bit_is_seen_on_cortex_m(processor: str, board: str, tmp_path: Path) -> None:
    files = boards.write(tmp_path, [of_gallery(ROBOTS[0]).c_module], processor, 2)
    spoil(tmp_path)
    assert "different" in on_qemu(tmp_path, files, processor, board)


@pytest.mark.slow
def test_atmega(tmp_path: Path) -> None:
    files = boards.write(tmp_path, [of_gallery("lekiwi").c_module], "avr", 4)
    assert "the same" in on_simavr(tmp_path, files)


@pytest.mark.slow
def test_a_wrong_bit_is_seen_on_atmega(tmp_path: Path) -> None:
    files = boards.write(tmp_path, [of_gallery("lekiwi").c_module], "avr", 2)
    spoil(tmp_path)
    assert "different" in on_simavr(tmp_path, files)


def static(program: Path) -> tuple[int, int]:
    """Return the bytes of RAM and of flash of a program for an AVR."""
    sizes = Image(program).sizes()
    ram = sizes.get(".data", 0) + sizes.get(".bss", 0) + sizes.get(".rodata", 0)
    return ram, sizes[".text"] + sizes.get(".data", 0)


@pytest.mark.parametrize("few", [False, True], ids=["all", "few"])
@pytest.mark.parametrize("robot", everyday(NAMES, ("turtlebot3_burger", "ackermann_car")))
def test_the_self_test_on_atmega(robot: str, few: bool, tmp_path: Path) -> None:
    """The tables are in flash; with SELFTEST_FEW only a quarter of them is compiled."""
    files = boards.self_test(tmp_path, robot, "avr")
    # All tables and the code take 33 to 35 kB of 32.
    few = few or robot in ("pioneer3dx", "kelly_4ws", "neobotix_mpo_700")
    large = robot in ("wpilib_swervebot", "pr2")  # the code of all their functions takes 32 kB
    flags = (f"-D{robot.upper()}_SELFTEST_FEW",) if few else ()
    assert "the same" in on_simavr(tmp_path, files, flags, "atmega1280" if large else "atmega328p")
    ram, flash = static(tmp_path / "avr.elf")
    assert ram <= RAM and (large or flash <= FLASH)


def test_a_compiler_that_tells_of_no_option_keeps_the_order_of_sums(tmp_path: Path) -> None:
    """avr-gcc 5.4 gives the same machine code with -funsafe-math-optimizations as without; unguarded code differs."""
    need("avr-gcc")
    avr = gcc.PROCESSORS["avr"]
    boards.self_test(tmp_path, "ackermann_car", "avr")
    guarded = (tmp_path / "ackermann_car.c").read_text()
    (tmp_path / "unguarded.c").write_text(re.sub("^#pragma GCC .*$", "", guarded, flags=re.M))
    for source, same in (("ackermann_car.c", True), ("unguarded.c", False)):
        for name, flags in (("plain.o", ()), ("unsafe.o", ("-funsafe-math-optimizations",))):
            gcc.run(tmp_path, avr.compiler, *avr.flags, *gcc.FLAGS, *flags, "-c", source, "-o", name)
        plain, unsafe = ((tmp_path / name).read_bytes() for name in ("plain.o", "unsafe.o"))
        assert (plain == unsafe) is same


@pytest.mark.parametrize("few", [False, True], ids=["all", "few"])
def test_the_self_test_on_atmega_sees_a_wrong_build(few: bool, tmp_path: Path) -> None:
    files = boards.self_test(tmp_path, "lekiwi", "avr")
    good = (tmp_path / "lekiwi.c").read_text()
    (tmp_path / "lekiwi.c").write_text(good.replace("twist->vx", "(1.001f * twist->vx)", 1))
    assert "different" in on_simavr(tmp_path, files, ("-DLEKIWI_SELFTEST_FEW",) if few else ())
