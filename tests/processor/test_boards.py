"""Generated C on whole emulated boards, built by the GNU toolchains that firmware uses: the interpreter's bits."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.c.harness import robot_module
from tests.processor import boards
from tests.tools import need

ROBOTS = ("clearpath_do100", "lekiwi", "nomad_xr4000", "wpilib_swervebot")
BOARDS = pytest.mark.parametrize(("processor", "board"), [("m4f", "mps2-an386"), ("m0", "microbit")])


def on_qemu(folder: Path, files: list[str], processor: str, board: str) -> str:
    need("arm-none-eabi-gcc", "qemu-system-arm")
    program = boards.cortex_m(folder, files, processor)
    words = ("-nographic", "-semihosting-config", "enable=on,target=native")
    return boards.said("qemu-system-arm", "-M", board, *words, "-kernel", program)


def on_simavr(folder: Path, files: list[str]) -> str:
    need("avr-gcc", "simavr")
    return boards.said("simavr", "-m", "atmega328p", "-f", "16000000", boards.atmega(folder, files))


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
    files = boards.write(tmp_path, [robot_module(name) for name in ROBOTS], processor, 20)
    assert "the same" in on_qemu(tmp_path, files, processor, board)


@pytest.mark.slow
@BOARDS
def test_a_wrong_bit_is_seen_on_cortex_m(processor: str, board: str, tmp_path: Path) -> None:
    files = boards.write(tmp_path, [robot_module(ROBOTS[0])], processor, 2)
    spoil(tmp_path)
    assert "different" in on_qemu(tmp_path, files, processor, board)


@pytest.mark.slow
def test_atmega(tmp_path: Path) -> None:
    files = boards.write(tmp_path, [robot_module("lekiwi")], "avr", 4)
    assert "the same" in on_simavr(tmp_path, files)


@pytest.mark.slow
def test_a_wrong_bit_is_seen_on_atmega(tmp_path: Path) -> None:
    files = boards.write(tmp_path, [robot_module("lekiwi")], "avr", 2)
    spoil(tmp_path)
    assert "different" in on_simavr(tmp_path, files)
