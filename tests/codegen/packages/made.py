"""Packages of robots, in memory or in a folder."""

from __future__ import annotations

import subprocess
from functools import cache
from pathlib import Path

from tests.conftest import ROOT, put
from tests.external_tools import tool
from wmrgen import derive, load
from wmrgen.codegen.packages import PACKAGES
from wmrgen.derivation.emit import artifacts, package
from wmrgen.derivation.facade import Derivation
from wmrgen.ir.kernels.choice import Choice, choice

KINDS = tuple(kind for kind, package in PACKAGES.items() if not package.backend)  # those around the C


@cache
def files_of(robot: Path, kind: str, target: str = "host", scalar: str = "float") -> dict[str, bytes]:
    """File name -> content of the package of a robot file."""
    derivation, chosen, files = _derived(robot, target, scalar)
    return package(PACKAGES[kind], derivation, chosen, files)


@cache
def _derived(robot: Path, target: str, scalar: str) -> tuple[Derivation, Choice, dict[str, bytes]]:
    derivation, chosen = derive(load(robot)), choice(scalar, target=target)
    return derivation, chosen, artifacts(derivation, chosen)


def of_gallery(robot: str, kind: str, target: str = "host") -> dict[str, bytes]:
    return files_of(ROOT / "robots" / f"{robot}.yaml", kind, target)


def in_folder(folder: Path, robot: str, kind: str, target: str = "host") -> Path:
    """The folder of the package of a robot of the gallery, as `derive --package` leaves it."""
    place = folder / robot
    put(place, of_gallery(robot, kind, target))
    return place


def reader() -> str:
    """The Python that has PlatformIO and what reads the packages of others."""
    return str(Path(tool("pio")).resolve().parent / "python")


def run(folder: Path, *words: str | Path) -> str:
    """What a command prints; it must succeed."""
    command = [str(word) for word in words]
    done = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}\n{done.stderr}"
    return done.stdout
