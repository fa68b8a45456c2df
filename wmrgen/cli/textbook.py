"""``wmrgen textbook``: the textbook library, a package of its own beside this one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Annotated, Any, Protocol, cast

from wmrgen.cli.declare import Json, Out, option, verb
from wmrgen.derivation import freshness
from wmrgen.derivation.artifacts import Difference
from wmrgen.derivation.manifest import sha256, unlisted
from wmrgen.errors import EnvironmentFailure

if TYPE_CHECKING:
    from wmrgen.analysis.kinematics.records import Formula

FOLDER, ERRATA = "textbook", "errata.md"  # in the output directory
LIBRARY = "textbook"  # the word that verbs take instead of a robot file
_SOURCE = Path(__file__).resolve().parents[2] / "textbook"  # the modules of the library


class Library(Protocol):
    """The functions of the module ``textbook.command``."""

    def library(self, name: str) -> Any:
        """Return one function with the modules that a Derivation has. Raise UsageError for an unknown name."""

    def formulas(self) -> Sequence[Formula]:
        """Return the functions in symbols, in the order of the report."""

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


def is_library(path: Path) -> bool:
    """Return whether a word of the command line means the textbook library, and no file of that name."""
    return path == Path(LIBRARY) and not path.is_file()


def installed() -> Library:
    """Return the textbook library. Raise EnvironmentFailure if it is not installed."""
    return cast(Library, _part_of_library("textbook.command"))


def _part_of_library(module: str) -> ModuleType:
    """Return a module of the textbook library. Raise EnvironmentFailure if it is not installed."""
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if not (error.name or "").startswith("textbook"):
            raise
        raise EnvironmentFailure(
            f"the textbook library is missing: {_SOURCE} does not exist or is incomplete. Install wmrgen again."
        ) from error


class Index(Protocol):
    """The function of the module ``textbook.index.command``."""

    def run(self, query: str, as_json: bool) -> int:
        """Print the commands for a place in a text. Return the exit code; raise UsageError for no match."""


@verb("textbook")
def textbook(
    out: Out = Path("generated"),
    find: Annotated[
        str | None,
        option(
            "Write nothing; print robot file, command and the numbers to expect for a place in a text: an equation, "
            "figure, table or exercise.",
            "PLACE",
        ),
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen textbook --find "Siegwart 3.19"

    Write DIR/textbook/ (formulas that need no robot: report, C, CasADi, NumPy) and DIR/errata.md (corrections to our
    copies of the texts, each with the check that proves it). `wmrgen eval textbook FUNCTION` computes a formula, and
    `wmrgen functions textbook` lists them.
    """
    if find is not None:
        return cast(Index, _part_of_library("textbook.index.command")).run(find, as_json)
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
