"""Static checkers for the C of a robot: findings as (file, check, text)."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterable, Sequence
from pathlib import Path

from tests.conftest import put
from tests.external_tools import BIN, missing, tool
from tests.ir.selftest.every import files_of, place_of

Finding = tuple[str, str, str]
TIDY_CHECKS = "-*,bugprone-*,cert-*,clang-analyzer-*,misc-*"
CALLER = "caller.c"


def write(folder: Path, robot: str) -> list[str]:
    """Write the C of a robot and a caller of all its functions; return the names of the sources."""
    put(folder, files_of(robot))
    header = "".join(content.decode() for name, content in files_of(robot).items() if name.endswith(".h"))
    (folder / CALLER).write_text(caller(robot, header))
    return [f"{robot}.c", f"{robot}_checked.c", CALLER, place_of(robot)]


def caller(robot: str, header: str) -> str:
    """Return a translation unit that calls every function that ``header`` declares."""
    lines = [f'#include "{robot}.h"', f'#include "{robot}_checked.h"', "", f"int {robot}_selftest(void);", ""]
    lines += ["int main(void)", "{"]
    calls: list[str] = []
    kinds: dict[str, str] = {}
    for name, arguments in re.findall(
        rf"^(?:void|\w+_status) ({robot}_\w+)\(([^)]*)\);", header, flags=re.S | re.M
    ):
        given = []
        for kind, star in re.findall(r"(\w+) (\*?)\w+(?:,|$)", arguments):
            variable = kinds.setdefault(kind, f"v{len(kinds)}")
            given.append(f"&{variable}" if star else variable)
        call = f"{name}({', '.join(given)})"
        calls.append(
            f"    failed += ({call} == {robot.upper()}_OK) ? 0 : 1;"
            if name.endswith("_checked")
            else f"    {call};"
        )
    if f"*{robot}_joint(" in header:
        wheels = kinds.setdefault(f"{robot}_wheels", f"v{len(kinds)}")
        calls.append(f"    failed += ({robot}_joint(&{wheels}, 1) != ({robot}_joint(&{wheels}, 0))) ? 0 : 1;")
    lines += [f"    static {kind} {variable};" for kind, variable in kinds.items()]
    return "\n".join(
        [*lines, f"    int failed = {robot}_selftest();", "", *calls, "    return failed;", "}", ""]
    )


def cppcheck(folder: Path, sources: Sequence[str]) -> list[Finding]:
    """Run Cppcheck with its MISRA C:2012 add-on and all checks; the -D options leave one configuration."""
    command = [
        tool("cppcheck"), "--enable=all", "--inconclusive", "--std=c99", "--addon=misra", "--quiet", "-DNDEBUG",
        "--suppress=missingIncludeSystem", "--suppress=checkersReport", "--template={file}|{id}|{line}: {message}",
        *sources,
    ]  # fmt: skip
    # Cppcheck starts the add-on for each file with the first python3; a shim of pyenv would double the time.
    env = {**os.environ, "PATH": f"{BIN}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run(
        command, cwd=folder, env=env, capture_output=True, text=True, timeout=300, check=True
    )
    lines = (line.split("|", 2) for line in done.stderr.splitlines() if "|" in line)
    return [(Path(file).name, check, text) for file, check, text in lines if file != CALLER]


def clang_tidy(folder: Path, sources: Iterable[str]) -> list[Finding]:
    """Run clang-tidy with the families bugprone, cert, clang-analyzer and misc."""
    command = [tool("clang-tidy"), "--quiet", f"--checks={TIDY_CHECKS}", *sources, "--", "-std=c99"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=False)
    found = re.findall(r"^(\S+?):(\d+):\d+: (?:warning|error): (.*) \[([\w.,-]+)\]$", done.stdout, flags=re.M)
    assert found or done.returncode == 0, done.stderr
    return [(Path(file).name, check, f"{line}: {text}") for file, line, text, check in found]


def gcc_analyzer(folder: Path, sources: Sequence[str]) -> str:
    """Run gcc -fanalyzer and return its findings."""
    version = subprocess.run([tool("gcc"), "-dumpversion"], capture_output=True, text=True, check=True).stdout
    if int(version.split(".")[0]) < 10 or "clang" in version:
        missing("gcc with -fanalyzer (10 or newer) is not installed")
    flags = ("-std=c99", "-O2", "-fanalyzer", "-Wall", "-Wextra", "-c")
    done = subprocess.run(
        [tool("gcc"), *flags, *sources], cwd=folder, capture_output=True, text=True, timeout=300, check=False
    )
    return done.stderr
