"""Sketches built by arduino-builder with Debian's core for AVR, and run by simavr."""

from __future__ import annotations

import re
import subprocess
import threading
from pathlib import Path

from tests.codegen.packages.made import run
from tests.external_tools import missing, need

SHARE = Path("/usr/share")  # where Debian's arduino-core-avr puts the core
# The core takes DECIMAL_DIG from <float.h>, which Debian's avr-g++ 5.4 has in C alone.
OLD_COMPILER = "compiler.cpp.extra_flags=-DDECIMAL_DIG=__DECIMAL_DIG__"


def needed() -> None:
    need("avr-gcc", "avr-size", "arduino-builder", "simavr")
    if not (SHARE / "arduino" / "hardware" / "arduino" / "avr" / "platform.txt").is_file():
        missing("not installed: arduino-core-avr")


def build(library: Path, sketch: str, folder: Path, flags: str = "") -> Path:
    """Build an example of a library for an Uno, with ``flags`` for the C. Tests of one process share the core."""
    core = folder.parents[1] / "arduino-core"
    core.mkdir(exist_ok=True)
    folder.mkdir()
    options = {
        "-hardware": [SHARE / "arduino-builder", SHARE / "arduino" / "hardware"],
        "-tools": ["/usr/bin"],
        "-fqbn": ["arduino:avr:uno"],
        "-prefs": [OLD_COMPILER, f"compiler.c.extra_flags={flags}"],
        "-libraries": [library.parent],
        "-build-path": [folder],
        "-build-cache": [core],
    }
    words = [word for option, values in options.items() for value in values for word in (option, value)]
    run(folder, "arduino-builder", "-compile", *words, library / "examples" / sketch / f"{sketch}.ino")
    return folder / f"{sketch}.ino.elf"


def size(program: Path) -> tuple[int, int]:
    """Return the bytes of flash and of RAM, without the stack."""
    lines = run(program.parent, "avr-size", "-A", program)
    sections = {line.split()[0]: int(line.split()[1]) for line in lines.splitlines() if line.startswith(".")}
    data = sections.get(".data", 0)
    return sections[".text"] + data, data + sections.get(".bss", 0) + sections.get(".noinit", 0)


def serial_lines(program: Path, lines: int, patience: float = 60) -> list[str]:
    """Return the first lines that a program prints on the serial port of an ATmega328P; a sketch never ends."""
    command = ["simavr", "-m", "atmega328p", "-f", "16000000", str(program)]
    running = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    alarm = threading.Timer(patience, running.kill)
    alarm.start()
    heard: list[str] = []
    try:
        assert running.stdout is not None
        for line in running.stdout:
            plain = re.sub(r"\x1b\[[\d;]*m", "", line).rstrip()
            if plain.endswith("."):  # simavr writes dots for the ends of lines
                heard.append(plain.rstrip("."))
            if len(heard) == lines:
                break
    finally:
        alarm.cancel()
        running.kill()
        running.wait()
    return heard
