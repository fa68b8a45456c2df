"""Derivations of the gallery, each made once, and report pages."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from tests.conftest import GALLERY
from wmrgen import derive, load
from wmrgen.backends import report
from wmrgen.backends.registry import Facts
from wmrgen.robot import Derivation

ROBOTS = {p.stem: p for p in GALLERY}
FACTS = Facts(model_hash="0123456789abcdef", wmrgen_version="9.9")


@cache
def derivation(name: str) -> Derivation:
    return derive(load(ROBOTS[name]))


@cache
def pages_of(name: str) -> dict[str, str]:
    return {file: text.decode() for file, text in report.emit(derivation(name), FACTS).items()}


def page_of(name: str) -> str:
    return pages_of(name)[report.FILE]


def numerics_of(name: str) -> str:
    return pages_of(name)["numerics.md"]


def derived(folder: Path, text: str) -> Derivation:
    """The robot of a robot file given as text."""
    path = folder / "robot.yaml"
    path.write_text(text, encoding="utf-8")
    return derive(load(path))


def page_written(folder: Path, text: str) -> str:
    """The report of a robot file given as text."""
    return report.emit(derived(folder, text), FACTS)[report.FILE].decode()
