"""The example of a robot on an emulated board: after the figure, the pose has the same bits as on the host."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from tests.codegen.c.example import driven, recorded, written
from tests.codegen.processor.test_boards import BOARDS, on_qemu

CHECK = """
#include <stdint.h>
#include <string.h>
int check(void);
static unsigned count;
static float last[3];
static void record(void) {{ ++count; last[0] = pose.x; last[1] = pose.y; last[2] = pose.theta; }}
int check(void)
{{
    static const uint32_t expected[3] = {{{words}}};
    uint32_t bits[3];
    (void)drive();
    memcpy(bits, last, sizeof bits);
    return (count != 6000u) || (bits[0] != expected[0]) || (bits[1] != expected[1]) || (bits[2] != expected[2]);
}}
"""


@pytest.mark.slow
@BOARDS
@pytest.mark.parametrize("robot", ["pair", "swerve"])
def test_its_figure(robot: str, processor: str, board: str, tmp_path: Path) -> None:
    """Sixty seconds at 100 Hz."""
    d = driven(robot, tmp_path)
    end = recorded(tmp_path, d, processor)[-1, :3]
    words = [f"{struct.unpack('<I', struct.pack('<f', value))[0]:#x}u" for value in end]
    files = written(tmp_path, d, CHECK.format(words=", ".join(words)), processor)
    assert "the same" in on_qemu(tmp_path, files, processor, board)
    files = written(tmp_path, d, CHECK.format(words=", ".join([words[1], words[0], words[2]])), processor)
    assert "different" in on_qemu(tmp_path, files, processor, board)
