"""The CMake package: it builds, tests itself and installs; other projects find it, or use it as a sub-folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.codegen.packages.made import in_folder, run
from tests.external_tools import need

pytestmark = pytest.mark.slow

MAIN = """\
#include "{0}.h"
#include "{0}_checked.h"
int main(void) {{ return {0}_forward == 0; }}
"""
FOUND = """\
cmake_minimum_required(VERSION 3.15)
project(firmware LANGUAGES C)
{1}
add_executable(firmware main.c)
target_link_libraries(firmware PRIVATE {0}::{0})
"""


def project(folder: Path, robot: str, line: str) -> Path:
    folder.mkdir()
    (folder / "main.c").write_text(MAIN.format(robot))
    (folder / "CMakeLists.txt").write_text(FOUND.format(robot, line))
    return folder


@pytest.mark.parametrize("robot", ["pioneer3dx", "wpilib_swervebot"])
def test_builds_tests_itself_and_is_found(robot: str, tmp_path: Path) -> None:
    need("cmake", "ctest", "gcc")
    package = in_folder(tmp_path, robot, "cmake")
    run(package, "cmake", "-B", "build", "-DCMAKE_BUILD_TYPE=Release")
    run(package, "cmake", "--build", "build")
    tested = run(package, "ctest", "--test-dir", "build")
    assert f"{robot}_selftest" in tested and "100% tests passed, 0 tests failed out of 1" in tested
    run(package, "cmake", "--build", "build", "--target", f"{robot}_example")
    run(package, package / "build" / f"{robot}_example")
    run(package, "cmake", "--install", "build", "--prefix", tmp_path / "installed")
    assert (tmp_path / "installed" / "include" / robot / f"{robot}.h").is_file()

    user = project(tmp_path / "user", robot, f"find_package({robot} 0.1 REQUIRED)")
    run(user, "cmake", "-B", "build", f"-DCMAKE_PREFIX_PATH={tmp_path / 'installed'}")
    run(user, "cmake", "--build", "build")
    run(user, user / "build" / "firmware")


def test_a_broken_build_fails_its_test(tmp_path: Path) -> None:
    need("cmake", "ctest", "gcc")
    package = in_folder(tmp_path, "textbook_differential", "cmake")
    source = package / "src" / "textbook_differential.c"
    source.write_text(source.read_text().replace(" + ", " - "))
    run(package, "cmake", "-B", "build")
    run(package, "cmake", "--build", "build")
    with pytest.raises(AssertionError, match="0% tests passed, 1 tests failed out of 1"):
        run(package, "ctest", "--test-dir", "build")


def test_as_a_sub_folder_it_adds_no_tests_of_its_own(tmp_path: Path) -> None:
    need("cmake", "gcc")
    package = in_folder(tmp_path, "pioneer3dx", "cmake")
    user = project(tmp_path / "user", "pioneer3dx", f"add_subdirectory({package} kinematics)")
    run(user, "cmake", "-B", "build")
    run(user, "cmake", "--build", "build")
    run(user, user / "build" / "firmware")
    assert not list(user.rglob("*selftest*.o"))
