"""``wmrgen textbook``: the textbook library, a separate package that is installed next to this one."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any, Protocol, cast

from wmrgen.cli.declare import Json, Out, verb
from wmrgen.derivation.artifacts import Difference
from wmrgen.errors import EnvironmentFailure

FOLDER, ERRATA = "textbook", "errata.md"  # in the output directory


class Library(Protocol):
    """The functions of the module ``textbook.command``."""

    def library(self, name: str) -> Any:
        """Return one function with the modules that a Derivation has. Raise UsageError for an unknown name."""

    def run(self, out: Path, as_json: bool) -> int:
        """Write the library and the errata into ``out`` and print their names."""

    def differing(self, out: Path) -> list[Difference]:
        """Return the files under ``out`` that `run` would change."""


def installed() -> Library:
    """Return the textbook library. Raise EnvironmentFailure if it is not installed."""
    try:
        return cast(Library, import_module("textbook.command"))
    except ModuleNotFoundError as error:
        if error.name not in ("textbook", "textbook.command"):
            raise
        raise EnvironmentFailure(
            "the textbook library is not installed: it is a separate package. Install wmrgen[textbook], or from a "
            "checkout: pip install ./textbook. A command that runs in a checkout finds it without installation."
        ) from error


@verb("textbook")
def textbook(out: Out = Path("generated"), as_json: Json = False) -> int:
    """Example:  wmrgen textbook -o generated

    Write DIR/textbook/ (formulas that need no robot: report, C, CasADi, NumPy) and DIR/errata.md (corrections to our
    copies of the texts, each with the check that proves it). `wmrgen eval textbook FUNCTION` computes a formula.
    """
    return installed().run(out, as_json)


def differing_library(out: Path) -> list[Difference]:
    """Return the files of the library under ``out`` that are out of date; none if ``out`` does not have the library."""
    if not (out / FOLDER).is_dir() and not (out / ERRATA).exists():
        return []
    return installed().differing(out)
