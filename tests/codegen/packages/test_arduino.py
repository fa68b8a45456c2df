"""The Arduino library: its sketches built for an Uno by arduino-builder, run by simavr."""

from __future__ import annotations

from math import cos, inf, radians, sin
from pathlib import Path

import pytest

from tests.codegen.packages.arduino import build, needed, serial_lines, size
from tests.codegen.packages.made import in_folder
from tests.codegen.packages.test_documents import PAGE

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("robot", "flags"),
    [("turtlebot3_burger", ""), ("ackermann_car", ""), ("pioneer3dx", "-DPIONEER3DX_SELFTEST_FEW")],
)
def test_the_self_test_says_ok(robot: str, flags: str, tmp_path: Path) -> None:
    needed()
    library = in_folder(tmp_path, robot, "arduino", "avr")
    program = build(library, f"{robot}_selftest", tmp_path / "build", flags)
    assert serial_lines(program, 1) == ["OK"]
    flash, ram = size(program)
    assert flash <= 32256 and ram <= 500


# Fills the memory above the variables, and returns how much of it the stack has used.
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


VX, OMEGA, DT = 0.2, 0.05, 0.02  # of the sketch


def driven(seconds: int, rates: tuple[float, float]) -> tuple[float, float, float]:
    """Pose in thousandths after the steps of a second times ``seconds``: wheels follow commands at once, and the
    twist goes straight to the wanted one inside the limits of ``rates``."""
    x = y = theta = vx = omega = 0.0
    for _ in range(50 * seconds):
        turn = omega * DT
        chord = vx * DT * (sin(turn / 2) / (turn / 2) if turn else 1)
        x, y, theta = x + chord * cos(theta + turn / 2), y + chord * sin(theta + turn / 2), theta + turn
        time = max(abs(VX - vx) / rates[0], abs(OMEGA - omega) / rates[1], DT)
        vx, omega = vx + (VX - vx) * DT / time, omega + (OMEGA - omega) * DT / time
    return 1000 * x, 1000 * y, 1000 * theta


RATES = {
    "turtlebot3_burger": (inf, inf),
    "pioneer3dx": (0.6, radians(200)),
    "wpilib_swervebot": (9.0, radians(540)),
}


@pytest.mark.parametrize("robot", RATES)
def test_the_loop_drives_in_little_memory(robot: str, tmp_path: Path) -> None:
    """A differential drive takes at most 6 kB of flash and 500 bytes of RAM with its stack."""
    needed()
    library = in_folder(tmp_path, robot, "arduino", "avr")
    sketch = library / "examples" / f"{robot}_loop" / f"{robot}_loop.ino"
    flash, ram = size(build(library, sketch.stem, tmp_path / "build"))
    text = sketch.read_text()
    assert text.count("void setup()\n{\n") == 1 and text.count("        tell(pose.theta") == 1
    replacement = "Serial.print(reached());\n        Serial.write(' ');\n        tell(pose.theta"
    sketch.write_text(text.replace("void setup()\n{\n", PAINT).replace("tell(pose.theta", replacement))
    printed = serial_lines(build(library, sketch.stem, tmp_path / "painted"), 3)
    for second, line in enumerate(printed, 1):
        x, y, stack, theta = map(int, line.split())
        assert (x, y, theta) == pytest.approx(driven(second, RATES[robot]), abs=1.01)
    assert 20 < stack < 500
    (row,) = [line for line in PAGE.splitlines() if line.startswith(f"| `{robot}`")]
    assert row.endswith(f"| {flash} | {ram} | {stack} |"), (flash, ram, stack)
    if robot == "turtlebot3_burger":
        assert flash <= 6144 and ram + stack <= 500


def test_a_broken_library_does_not(tmp_path: Path) -> None:
    needed()
    library = in_folder(tmp_path, "textbook_differential", "arduino", "avr")
    source = library / "src" / "textbook_differential.c"
    source.write_text(source.read_text().replace(" + ", " - "))
    (printed,) = serial_lines(build(library, "textbook_differential_selftest", tmp_path / "build"), 1)
    assert printed.startswith("row ")
