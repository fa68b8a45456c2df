"""Words that languages keep: macros of AVR count as they are written, other words in any case."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.packages.arduino import SHARE
from tests.spec.files import read
from tests.tools import missing, need
from wmrgen.backends.words import AVR, C
from wmrgen.errors import RobotFileError

CORE = SHARE / "arduino" / "hardware" / "arduino" / "avr"
ROBOT = "wmrgen: 1\nname: pair\nwheels:\n  - {{name: {}, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}}\n"


@pytest.mark.parametrize("name", ["SE", "SP", "XL", "PB0", "LOW", "B11"])
def test_macros_of_avr_are_refused_as_they_are_written(name: str) -> None:
    with pytest.raises(RobotFileError, match="macro of that name") as refused:
        read(ROBOT.format(name))
    assert refused.value.instead == f"Write {name.lower()}."
    assert read(ROBOT.format(name.lower())).wheels[0].name == name.lower()


@pytest.mark.parametrize("name", ["FL", "fr", "SW", "NE", "M1", "P1", "B2", "L", "F", "High", "spl"])
def test_other_names_are_taken(name: str) -> None:
    assert read(ROBOT.format(name)).wheels[0].name == name


def test_words_of_c_are_kept_in_any_case() -> None:
    assert C.keeps("Float") and C.keeps("FLOAT") and not AVR.keeps("float") and not AVR.keeps("se")


@pytest.mark.slow
@pytest.mark.parametrize(
    "chip", ["atmega8", "atmega328p", "atmega2560", "atmega32u4", "attiny84", "attiny85"]
)
def test_no_short_macro_is_missing(chip: str, tmp_path: Path) -> None:
    """Of what a sketch includes: macros without arguments that may be names, of up to three letters."""
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
    assert [name for name in sorted(short) if not AVR.keeps(name)] == []
