"""The PlatformIO library, built by `pio run` for the host and offline; platform and SCons are provided locally."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest

from tests.codegen.packages.made import in_folder, reader, run
from tests.conftest import put
from tests.external_tools import need, tool

pytestmark = pytest.mark.slow

PLATFORM = {
    "name": "native",
    "title": "Native",
    "description": "the host",
    "version": "1.0.0",
    "packages": {},
}
CLASS = "from platformio.public import PlatformBase\n\n\nclass NativePlatform(PlatformBase):\n    pass\n"
BUILD = """\
from SCons.Script import Default, DefaultEnvironment

env = DefaultEnvironment()
env.Replace(AR="gcc-ar", CC="gcc", CXX="g++", LINK="g++", RANLIB="gcc-ranlib")
Default(env.BuildProgram())
"""
MAIN = """\
#include "{0}.h"
#include "{0}_checked.h"
int {0}_selftest(void);
int main(void) {{ return {0}_selftest(); }}
"""


def _core(folder: Path) -> None:
    """Provide what PlatformIO would download: a platform with the host's gcc, and SCons from PyPI."""
    ask = "from platformio.dependencies import get_core_dependencies as of; print(of()['tool-scons'].lstrip('~'))"
    version = run(folder, reader(), "-c", ask).strip()
    scons = {"name": "tool-scons", "version": version}
    spec = {"owner": "platformio", "id": None, "name": "tool-scons", "requirements": None, "uri": None}
    put(
        folder,
        {
            "packages/tool-scons/package.json": json.dumps({**scons, "description": "SCons"}).encode(),
            "packages/tool-scons/.piopm": json.dumps({**scons, "type": "tool", "spec": spec}).encode(),
            "packages/tool-scons/scons.py": b"import SCons.Script\n\nSCons.Script.main()\n",
            "platforms/native/platform.json": json.dumps(PLATFORM).encode(),
            "platforms/native/platform.py": CLASS.encode(),
            "platforms/native/builder/main.py": BUILD.encode(),
        },
    )


@pytest.mark.parametrize("robot", ["pioneer3dx"])
def test_pio_finds_and_builds_it(robot: str, tmp_path: Path) -> None:
    need("pio", "gcc", "g++")
    core, project = tmp_path / "core", tmp_path / "project"
    core.mkdir()
    _core(core)
    in_folder(project / "lib", robot, "platformio")
    put(
        project,
        {"platformio.ini": b"[env:host]\nplatform = native\n", "src/main.c": MAIN.format(robot).encode()},
    )
    settings = {
        "PLATFORMIO_CORE_DIR": str(core),
        "PLATFORMIO_SETTING_ENABLE_TELEMETRY": "No",
        "PLATFORMIO_SETTING_CHECK_PLATFORMIO_INTERVAL": "9999",
    }
    done = subprocess.run(
        [tool("pio"), "run", "-d", project],
        env={**os.environ, **settings},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"|-- {robot} @ " in done.stdout
    run(project, project / ".pio" / "build" / "host" / "program")
