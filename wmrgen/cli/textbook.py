"""``wmrgen textbook``: the textbook library, a package of its own beside this one."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol, cast

from wmrgen.cli.declare import Json, Out, verb
from wmrgen.derivation import freshness
from wmrgen.derivation.artifacts import Difference
from wmrgen.derivation.manifest import sha256, unlisted
from wmrgen.errors import EnvironmentFailure

FOLDER, ERRATA = "textbook", "errata.md"  # in the output directory
_SOURCE = Path(__file__).resolve().parents[2] / "textbook"  # the modules of the library


class Library(Protocol):
    """The functions of the module ``textbook.command``."""

    def library(self, name: str) -> Any:
        """Return one function with the modules that a Derivation has. Raise UsageError for an unknown name."""

    def run(self, out: Path, as_json: bool, made_from: Mapping[str, str]) -> int:
        """Write the library and the errata, and print what changed.

        Args:
            out: the folder that contains the folder of the library.
            as_json: whether to print JSON instead of lines to read.
            made_from: hash of each file that the library is made from, by name.

        Returns:
            The exit code.
        """

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
            f"the textbook library is missing: {_SOURCE} does not exist or is incomplete. Install wmrgen again."
        ) from error


@verb("textbook")
def textbook(out: Out = Path("generated"), as_json: Json = False) -> int:
    """Example:  wmrgen textbook -o generated

    Write DIR/textbook/ (formulas that need no robot: report, C, CasADi, NumPy) and DIR/errata.md (corrections to our
    copies of the texts, each with the check that proves it). `wmrgen eval textbook FUNCTION` computes a formula.
    """
    made_from = freshness.inputs(folders=[_SOURCE]) if freshness.can_compare() else {}
    return installed().run(out, as_json, made_from)


def differing_library(out: Path, comparable: bool) -> list[Difference]:
    """Return which files of the library in ``out`` are out of date; none if it holds no file of it.

    Args:
        out: The output directory.
        comparable: Whether files are taken as fresh by their manifest, see `freshness.can_compare`.

    Returns:
        The files.
    """
    if not (out / FOLDER).is_dir() and not (out / ERRATA).exists():
        return []
    if comparable and _fresh(out):
        return []
    return installed().differing(out)


def _fresh(out: Path) -> bool:
    """Return whether the library is fresh, and the errata are those that its manifest records."""
    try:
        errata = sha256((out / ERRATA).read_bytes())
    except OSError:
        return False
    inputs = freshness.inputs(folders=[_SOURCE])
    manifest = freshness.fresh(out / FOLDER, {**inputs, ERRATA: errata} if inputs else {})
    return manifest is not None and not unlisted(out / FOLDER, list(manifest.files))
