"""The self-tests of many robots as one translation unit: one start of a compiler for all of them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from tests.conftest import GALLERY, put
from tests.robots import of_gallery
from wmrgen.codegen.c import emit
from wmrgen.codegen.registry import Facts
from wmrgen.derivation.emit import site
from wmrgen.ir.kernels.choice import DEFAULT

NAMES = tuple(path.stem for path in GALLERY)
FEW = (
    "turtlebot3_burger",
    "pioneer3dx",
    "clearpath_do100",
    "lekiwi",
    "wpilib_swervebot",
    "nomad_xr4000",
    "ackermann_car",
)
FUNCTIONS, TESTS, EVERY = "functions.c", "tests.codegen.c", "every.c"
_OWN = re.compile(r"\b(miss|fetch|\w+_rows|\w+_misses)\b")  # what is static in a self-test
_MAIN = """
#include <stdio.h>
int main(void)
{{
{calls}
    return 0;
}}
"""


@cache
def files_of(robot: str, scalar: str = "float", target: str = DEFAULT.target) -> Mapping[str, bytes]:
    """The C that derive writes for a robot of the gallery, and what goes with it."""
    derivation = of_gallery(robot)
    return emit(
        derivation.c_module, Facts(site=site(derivation), options={"scalar": scalar, "target": target})
    )


def place_of(robot: str) -> str:
    """Where the self-test stands."""
    return f"test/{robot}_selftest.c"


def write(folder: Path, robots: Sequence[str], scalar: str = "float", checks: bool = False) -> None:
    """`FUNCTIONS`: the C of every robot; `TESTS`: the self-tests, and a main that prints a line for each, or with
    ``checks`` a function for each; `EVERY`: both."""
    tests = []
    for robot in robots:
        files = files_of(robot, scalar)
        text = _OWN.sub(lambda m, robot=robot: f"{robot}_{m[1]}", files[place_of(robot)].decode())  # type: ignore[misc]
        put(
            folder,
            {**{name: files[name] for name in (f"{robot}.h", f"{robot}.c")}, place_of(robot): text.encode()},
        )
        tests.append(f'#include "{place_of(robot)}"')
        if checks:
            tests += [
                f"void check_{robot}(int *y);",
                f"void check_{robot}(int *y) {{ *y = {robot}_selftest(); }}",
            ]
    if not checks:
        calls = [f'    printf("{robot} %d\\n", {robot}_selftest());' for robot in robots]
        tests.append(_MAIN.format(calls="\n".join(calls)))
    (folder / FUNCTIONS).write_text("".join(f'#include "{robot}.c"\n' for robot in robots))
    (folder / TESTS).write_text("\n".join(tests) + "\n")
    (folder / EVERY).write_text(f'#include "{FUNCTIONS}"\n#include "{TESTS}"\n')


def failures(printed: str) -> list[str]:
    """The lines that do not say 0."""
    return [line for line in printed.splitlines() if not line.endswith(" 0")]
