"""``wmrgen textbook``: the textbook library, a package of its own beside this one."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any, Protocol, cast

from wmrgen.derivation.artifacts import Difference
from wmrgen.errors import EnvironmentFailure

FOLDER, ERRATA = "textbook", "errata.md"  # in the output directory


class Library(Protocol):
    """What the module ``textbook.command`` offers."""

    def library(self, name: str) -> Any:
        """One function, with modules as a Derivation has them. UsageError for a name that there is not."""

    def run(self, out: Path, as_json: bool) -> int:
        """Write the library and the errata into ``out``, and say so."""

    def differing(self, out: Path) -> list[Difference]:
        """What is not as `run` would leave it."""


def installed() -> Library:
    """The textbook library. EnvironmentFailure where it is not installed."""
    try:
        return cast(Library, import_module("textbook.command"))
    except ModuleNotFoundError as error:
        if error.name not in ("textbook", "textbook.command"):
            raise
        raise EnvironmentFailure(
            "the textbook library is not installed: it is a package of its own. Install wmrgen[textbook], or from a "
            "checkout: pip install ./textbook. In a checkout itself it is there."
        ) from error


def textbook(out: Path, as_json: bool) -> int:
    """Write the library and the errata."""
    return installed().run(out, as_json)


def differing_library(out: Path) -> list[Difference]:
    """What of the library under ``out`` is not fresh; nothing is asked of a directory that holds none of it."""
    if not (out / FOLDER).is_dir() and not (out / ERRATA).exists():
        return []
    return installed().differing(out)
