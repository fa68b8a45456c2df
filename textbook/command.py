"""``wmrgen textbook``: the library and the errata; ``wmrgen eval textbook FUNCTION``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from textbook.emit import artifacts, errata
from textbook.library import FUNCTIONS, Textbook, textbook
from wmrgen.analysis.kinematics.records import Formula
from wmrgen.cli import console
from wmrgen.cli.textbook import ERRATA, FOLDER
from wmrgen.derivation.artifacts import Difference, differences, file_difference, write_file, write_tree
from wmrgen.derivation.manifest import sha256
from wmrgen.errors import UsageError
from wmrgen.robotfile.text import suggestion


def library(name: str) -> Textbook:
    """One function of the library. UsageError for a name that it does not have."""
    if name not in FUNCTIONS:
        hint = suggestion(name, list(FUNCTIONS))
        every = "" if hint.startswith("Valid") else f" It has: {' '.join(FUNCTIONS)}."
        raise UsageError(f"the textbook library has no function {name!r}. {hint}{every}")
    return textbook(name)


def formulas() -> tuple[Formula, ...]:
    """Return the functions of the library in symbols, in the order of the report."""
    return textbook().formulas


def run(out: Path, as_json: bool = False, made_from: Mapping[str, str] | None = None) -> int:
    """Write the library and the errata, and print what changed.

    Args:
        out: The output directory.
        as_json: Print JSON.
        made_from: The inputs of today, for the manifest of the library; see `wmrgen.derivation.freshness`.

    Returns:
        The exit code.
    """
    with console.progress() as step:
        step("writing down the library")
        files = artifacts()
        step("running the checks of the errata")
        page = errata()
    inputs = {**made_from, ERRATA: sha256(page)} if made_from else {}
    written = write_tree(out / FOLDER, files, None, inputs)
    changed = write_file(out / ERRATA, page)
    if as_json:
        kinds = ("changed", "unchanged", "removed")
        lists = {kind: [f"{FOLDER}/{name}" for name in getattr(written, kind)] for kind in kinds}
        lists["changed" if changed else "unchanged"].append(ERRATA)
        console.data(lists)
        return 0
    state = f"{len(written.changed)} new or changed" if written.changed else "all up to date"
    console.result(f"{(out / FOLDER).as_posix()}/ ({state}): {len(files)} files")
    console.result(f"{(out / ERRATA).as_posix()} ({'new or changed' if changed else 'up to date'})")
    for name in written.removed:
        console.note(f"{FOLDER}: removed {name}, which is no longer produced")
    return 0


def differing(out: Path) -> list[Difference]:
    """What is not as `run` would leave it."""
    return [*differences(out / FOLDER, artifacts()), *file_difference(out / ERRATA, errata())]
