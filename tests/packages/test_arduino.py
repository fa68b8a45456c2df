"""The Arduino library: its sketches built for an Uno by arduino-builder, run by simavr."""

from __future__ import annotations

from math import cos, sin
from pathlib import Path

import pytest

from tests.packages.arduino import build, needed, said, size
from tests.packages.made import in_folder
from tests.packages.test_documents import PAGE

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("robot", ["pioneer3dx", "ackermann_car"])
def test_the_self_test_says_ok(robot: str, tmp_path: Path) -> None:
    needed()
    library = in_folder(tmp_path, robot, "arduino", "avr")
    program = build(library, f"{robot}_selftest", tmp_path / "build")
    assert said(program, 1) == ["OK"]
    flash, ram = size(program)
    assert flash <= 32256 and ram <= 500


# Fills the memory above the variables, and tells how much of it the stack has reached.
PAINT = """
extern "C" uint8_t __heap_start;
static void __attribute__((noinline)) paint()
{
    for (uint8_t *p = &__heap_start; p < reinterpret_cast<uint8_t *>(SP) - 2; ++p) {
        *p = 0xA5;
    }
}
static unsigned reached()
{
    uint8_t *p = &__heap_start;
    while (*p == 0xA5) {
        ++p;
    }
    return RAMEND + 1 - reinterpret_cast<unsigned>(p);
}
void setup()
{
    paint();
"""


@pytest.mark.parametrize("robot", ["pioneer3dx", "wpilib_swervebot"])
def test_the_loop_drives_in_little_memory(robot: str, tmp_path: Path) -> None:
    """Wheels that do what they are told: after k s the robot has driven 49 + 50 (k - 1) steps of the circle. A
    differential drive takes at most 6 kB of flash and 500 bytes of RAM with its stack."""
    needed()
    library = in_folder(tmp_path, robot, "arduino", "avr")
    sketch = library / "examples" / f"{robot}_loop" / f"{robot}_loop.ino"
    flash, ram = size(build(library, sketch.stem, tmp_path / "build"))
    text = sketch.read_text()
    assert text.count("void setup()\n{\n") == 1 and text.count("Serial.println(") == 1
    told = "Serial.print(reached());\n        Serial.print(' ');\n        Serial.println("
    sketch.write_text(text.replace("void setup()\n{\n", PAINT).replace("Serial.println(", told))
    heard = said(build(library, sketch.stem, tmp_path / "painted"), 3)
    for second, line in enumerate(heard, 1):
        x, y, stack, theta = map(int, line.split())
        turn = 0.05 * 0.02 * (50 * second - 1)
        assert (x, y, theta) == pytest.approx(
            (4000 * sin(turn), 4000 * (1 - cos(turn)), 1000 * turn), abs=1.01
        )
    assert 20 < stack < 500
    (row,) = [line for line in PAGE.splitlines() if line.startswith(f"| `{robot}`")]
    assert row.endswith(f"| {flash} | {ram} | {stack} |"), (flash, ram, stack)
    if robot == "pioneer3dx":
        assert flash <= 6144 and ram + stack <= 500


def test_a_broken_library_does_not(tmp_path: Path) -> None:
    needed()
    library = in_folder(tmp_path, "textbook_differential", "arduino", "avr")
    source = library / "src" / "textbook_differential.c"
    source.write_text(source.read_text().replace(" + ", " - "))
    (heard,) = said(build(library, "textbook_differential_selftest", tmp_path / "build"), 1)
    assert heard.startswith("row ")
