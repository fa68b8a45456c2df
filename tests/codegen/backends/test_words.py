"""Words that languages reserve.

Wheels and parameters may have names of AVR's macros. If a build defines such a macro, the header reports it.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

import wmrgen
from tests.codegen.packages.arduino import SHARE
from tests.external_tools import missing, need, tool
from tests.robotfile.files import read
from wmrgen.derivation.emit import artifacts
from wmrgen.errors import Code, RobotFileError
from wmrgen.robotfile.reserved_words import AVR_MACROS, C, why_reserved

CORE = SHARE / "arduino" / "hardware" / "arduino" / "avr"
ROBOT = "wmrgen: 1\nname: pair\nwheels:\n  - {{name: {}, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}}\n"


@pytest.mark.parametrize("name", ["SE", "SP", "XL", "PB0", "LOW", "B11"])
def test_a_robot_may_not_have_the_name_of_an_avr_macro(name: str) -> None:
    with pytest.raises(RobotFileError) as refused:
        read(ROBOT.replace("pair", name).format("left"))
    assert refused.value.code == Code.NAME and name.lower() in refused.value.instead.strip(".").split()
    assert read(ROBOT.replace("pair", name.lower()).format("left")).name == name.lower()


def test_a_header_is_read_where_its_names_are_no_macros(tmp_path: Path) -> None:
    """Wheels SE and FL and a parameter PB0 keep their names. The C compiles unless a macro hides one of them."""
    path = tmp_path / "pair.yaml"
    path.write_text(
        "wmrgen: 1\nname: pair\nparameters: {PB0: {value: 0.1, tunable: true}}\nwheels:\n"
        "  - {name: SE, type: fixed, x: 0, y: 0.2, heading: 0, r: PB0}\n"
        "  - {name: FL, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}\n"
    )
    for name, text in artifacts(wmrgen.derive(wmrgen.load(path))).items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(text)
    assert "} SE; " in (tmp_path / "pair.h").read_text()
    command = [tool("gcc"), "-std=c99", "-Wall", "-Werror", "-c", "pair.c", "-o", "pair.o"]
    for macro, hides in (("SW", False), ("SE", True), ("PB0", True)):
        done = subprocess.run([*command, f"-D{macro}=0"], cwd=tmp_path, capture_output=True, text=True)
        assert bool(re.search(rf'#error ".*\b{macro}\b', done.stderr)) == hides, done.stderr
        assert (done.returncode == 0) == (not hides)


@pytest.mark.parametrize(
    "name", ["SE", "PB0", "LOW", "FL", "fr", "SW", "NE", "M1", "P1", "B2", "L", "F", "High", "spl"]
)
def test_other_names_are_accepted(name: str) -> None:
    assert read(ROBOT.format(name)).wheels[0].name == name


def test_words_of_c_are_reserved_in_any_case() -> None:
    assert (
        C.keeps("Float") and C.keeps("FLOAT") and not AVR_MACROS.keeps("float") and not AVR_MACROS.keeps("se")
    )


def test_no_macro_of_what_the_c_includes_is_a_name() -> None:
    """Macros without arguments of these headers in gcc are reserved, because `out->M_PI` would not compile."""
    headers = "".join(f"#include <{name}.h>\n" for name in ("math", "stdint", "float"))
    command = [tool("gcc"), "-x", "c", "-dM", "-E", "-"]
    done = subprocess.run(command, input=headers, capture_output=True, text=True, check=True)
    macros = re.findall(r"#define ([A-Za-z]\w*) ", done.stdout)
    assert {"M_PI", "math_errhandling", "INT_LEAST16_MIN", "UINTPTR_MAX"} <= set(macros)
    assert [name for name in macros if "__" not in name and not why_reserved(name)] == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "chip", ["atmega8", "atmega328p", "atmega2560", "atmega32u4", "attiny84", "attiny85"]
)
def test_no_short_macro_is_missing(chip: str, tmp_path: Path) -> None:
    """Macros without arguments and with up to three letters, in the headers that a sketch includes."""
    need("avr-g++")
    if not CORE.is_dir():
        missing("not installed: arduino-core-avr")
    (tmp_path / "sketch.cpp").write_text("#include <Arduino.h>\n")
    folders = (f"-I{CORE / 'cores' / 'arduino'}", f"-I{CORE / 'variants' / 'standard'}")
    command = (
        "avr-g++",
        f"-mmcu={chip}",
        "-DF_CPU=16000000L",
        "-DARDUINO=10800",
        *folders,
        "-dM",
        "-E",
        "sketch.cpp",
    )
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    names = {line.split()[1] for line in done.stdout.splitlines()}
    short = {name for name in names if name.isalnum() and name[0].isalpha() and len(name) <= 3}
    assert {"SP", "PI"} <= short
    assert [name for name in sorted(short) if not AVR_MACROS.keeps(name)] == []
