"""Sketches built as Arduino's tools do: by the recipes of the core's own platform.txt and boards.txt; and simavr."""

from __future__ import annotations

import re
import shlex
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path

from tests.packages.made import run
from tests.tools import missing, need

AVR = Path("/usr/share/arduino/hardware/arduino/avr")  # where Debian's arduino-core-avr puts it
# The core takes DECIMAL_DIG from <float.h>, which Debian's avr-g++ 5.4 has in C alone.
OLD_COMPILER = {"compiler.cpp.extra_flags": "-DDECIMAL_DIG=__DECIMAL_DIG__"}


def needed() -> None:
    need("avr-gcc", "avr-g++", "avr-gcc-ar", "avr-size", "simavr")
    if not (AVR / "platform.txt").is_file():
        missing("not installed: arduino-core-avr")


def _properties(path: Path, board: str = "") -> Iterator[tuple[str, str]]:
    for line in path.read_text().splitlines():
        name, equals, value = line.partition("=")
        if equals and not line.startswith("#") and name.startswith(board):
            yield name.removeprefix(board), value


def _recipe(properties: dict[str, str], name: str) -> list[str]:
    text = properties[name]
    while True:
        filled = re.sub(r"\{([\w.]+)\}", lambda match: properties[match[1]], text)
        if filled == text:
            return shlex.split(text)
        text = filled


def build(library: Path, sketch: str, folder: Path, board: str = "uno") -> Path:
    """The program of an example of a library, with all below the library's ``src``, as Arduino's tools compile it."""
    properties = dict(_properties(AVR / "platform.txt"))
    properties |= dict(_properties(AVR / "boards.txt", f"{board}."))
    variant, core = properties["build.variant"], AVR / "cores" / properties["build.core"]
    places = (core, AVR / "variants" / variant, library / "src")
    properties |= OLD_COMPILER | {
        "includes": " ".join(f'"-I{place}"' for place in places),
        "runtime.ide.version": "10819",
        "build.arch": "AVR",
        "build.path": str(folder),
        "build.project_name": sketch,
        "archive_file": "core.a",
    }
    folder.mkdir()
    program = folder / f"{sketch}.cpp"
    text = (library / "examples" / sketch / f"{sketch}.ino").read_text()
    program.write_text(f"#include <Arduino.h>\n{text}")

    def compiled(source: Path) -> str:
        words = {"source_file": str(source), "object_file": str(folder / f"{source.name}.o")}
        recipe = f"recipe.{source.suffix[1:]}.o.pattern"
        run(folder, *_recipe({**properties, **words}, recipe))
        return words["object_file"]

    def sources(place: Path) -> list[Path]:
        return sorted(p for p in place.rglob("*") if p.suffix in (".c", ".cpp", ".S"))

    for source in sources(core):
        words = {"object_file": compiled(source)}
        run(folder, *_recipe({**properties, **words}, "recipe.ar.pattern"))
    objects = [compiled(source) for source in (program, *sources(library / "src"))]
    words = {"object_files": " ".join(f'"{name}"' for name in objects)}
    run(folder, *_recipe({**properties, **words}, "recipe.c.combine.pattern"))
    return folder / f"{sketch}.elf"


def size(program: Path) -> tuple[int, int]:
    """Bytes of flash and of RAM, the stack aside."""
    lines = run(program.parent, "avr-size", "-A", program)
    sections = {line.split()[0]: int(line.split()[1]) for line in lines.splitlines() if line.startswith(".")}
    data = sections.get(".data", 0)
    return sections[".text"] + data, data + sections.get(".bss", 0) + sections.get(".noinit", 0)


def said(program: Path, lines: int, patience: float = 60) -> list[str]:
    """The first lines that a program prints on the serial port of an ATmega328P: a sketch never ends."""
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
            if plain.endswith(".."):  # two dots stand for the carriage return and the line feed of a port
                heard.append(plain.removesuffix(".."))
            if len(heard) == lines:
                break
    finally:
        alarm.cancel()
        running.kill()
        running.wait()
    return heard
