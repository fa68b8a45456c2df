"""Size of the object code with called kernels (`-DWMRGEN_SMALL`), compared with the former `derive --size`.

Measured with arm-none-eabi-gcc 12.2 at commit c8eac09, flags as `benchmarks.emulator.gcc.FLAGS`.
"""

from __future__ import annotations

import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.emulator.gcc import FLAGS, PROCESSORS, SMALL, Processor
from tests.external_tools import need
from tests.robots import of_gallery
from wmrgen.codegen.c import sources
from wmrgen.ir.kernels.choice import Choice

MOST = 1.05
BEFORE = {  # (m4f, m0)
    "ackermann_car": (1968, 4108),
    "agilex_ranger": (4232, 5200),
    "andino": (852, 1732),
    "bicycle": (2176, 4848),
    "car_with_trailers": (2400, 5420),
    "care_o_bot_4": (1384, 4420),
    "clearpath_a200": (796, 1848),
    "clearpath_do100": (732, 1620),
    "clearpath_r100": (832, 1732),
    "f1tenth": (1700, 4456),
    "festo_robotino": (724, 1516),
    "jpl_osr": (1644, 4828),
    "kelly_4ws": (2032, 4568),
    "kuka_youbot": (832, 1732),
    "lekiwi": (700, 1492),
    "locked_bicycle": (620, 1544),
    "mir_100": (904, 2312),
    "neobotix_mp_400": (900, 2320),
    "neobotix_mpo_700": (2052, 4704),
    "nexus_4wd": (744, 1584),
    "nomad_xr4000": (1648, 4096),
    "office_chair": (924, 2124),
    "pioneer3dx": (900, 1924),
    "pr2": (3136, 5520),
    "ssl_parsian": (828, 1640),
    "synchro_drive": (1236, 3840),
    "textbook_differential": (616, 1380),
    "textbook_omni_steer": (908, 2724),
    "textbook_omnidirectional": (704, 1488),
    "textbook_tricycle": (2056, 3564),
    "textbook_two_steer": (1096, 3456),
    "tidybot2": (2112, 4744),
    "tractor_off_axle": (852, 2344),
    "turtlebot3_burger": (624, 1380),
    "unicycle": (540, 1276),
    "wpilib_swervebot": (1420, 3712),
}
# Bytes by which odometry has grown since: it wraps the heading to [-pi, pi].
HEADING = {"m4f": 42, "m0+": 48}
# Functions that robot files have requested since.
LATER = (
    "limit_twist", "limit_acceleration", "setpoint", "compensate_steering", "desaturate", "steer_toward",
    "joints_from_counts", "forward_covariance", "odometry_covariance", "odometry_from_angles",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("column", "key"), [(0, "m4f"), (1, "m0+")])
def test_called_kernels_need_no_more_flash_than_outlined_parts(column: int, key: str, tmp_path: Path) -> None:
    processor = PROCESSORS[key]
    need(processor.compiler)
    now = {name: text(name, key, tmp_path) for name in BEFORE}
    for name, size in now.items():
        assert size <= MOST * BEFORE[name][column], name
    assert sum(now.values()) <= sum(sizes[column] for sizes in BEFORE.values())


def text(name: str, key: str, folder: Path) -> int:
    processor, module = PROCESSORS[key], of_gallery(name).c_module
    module = replace(module, functions=tuple(f for f in module.functions if f.name not in LATER))
    for suffix, content in zip("hc", sources(module, Choice(target=processor.target)), strict=True):
        (folder / f"{name}.{suffix}").write_text(content)
    words = (processor.compiler, *processor.flags, *FLAGS, *SMALL, "-c", f"{name}.c", "-o", f"{name}.o")
    subprocess.run(words, cwd=folder, check=True)
    size = processor.compiler.replace("gcc", "size")
    done = subprocess.run([size, f"{name}.o"], cwd=folder, check=True, capture_output=True, text=True)
    heading = HEADING[key] * any(f.name == "odometry" for f in module.functions)
    return int(done.stdout.splitlines()[1].split()[0]) - heading - accessor(name, processor, folder)


def accessor(name: str, processor: Processor, folder: Path) -> int:
    """Return the bytes of `<robot>_joint`, which was added with the shared types."""
    words = [processor.compiler.replace("gcc", "nm"), "--print-size", "--radix=d", f"{name}.o"]
    done = subprocess.run(words, cwd=folder, check=True, capture_output=True, text=True)
    lines = (line.split() for line in done.stdout.splitlines())
    return sum(int(line[1]) for line in lines if line[-1] == f"{name}_joint")
