"""Write files: the only module that does.

The files of a directory are first written to a folder beside it. Then the old files that change are moved out, the new
ones are moved in one by one, and the manifest last. A run that is killed in between leaves a directory that lacks
files, never one that mixes old and new ones. Files with equal bytes are not touched. Files that the old manifest lists
and that are no longer produced are removed. No symbolic link is followed. Nothing waits for the disk: after a power cut
the hashes in the manifest show which files are damaged, and `wmrgen derive` makes them again.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from wmrgen.derivation.manifest import (
    MANIFEST,
    Manifest,
    checked_name,
    listed_files,
    recorded_inputs,
    sha256,
    unlisted,
)
from wmrgen.errors import EnvironmentFailure, UsageError

_STAGE = ".wmrgen-stage-"


class Difference(NamedTuple):
    """A file that is not what it should be."""

    path: Path
    why: str  # missing, differs or not produced


class Written(NamedTuple):
    """The files that a write changed, left alone and removed, as relative paths in order."""

    changed: tuple[str, ...]
    unchanged: tuple[str, ...]
    removed: tuple[str, ...]


def with_manifest(
    files: Mapping[str, bytes],
    made_with: Mapping[str, str] | None,
    made_from: Mapping[str, str] | None = None,
) -> dict[str, bytes]:
    """Return files and, as the last one, their manifest.

    Args:
        files: Name -> content.
        made_with: The options of `derive`.
        made_from: The inputs that the files were made from, see `freshness`; None: they are not recorded.

    Returns:
        Name -> content, in the order of names.
    """
    sums = {checked_name(name): sha256(files[name]) for name in sorted(files)}
    manifest = Manifest(sums, made_with or {}, made_from or {})
    return {**{name: files[name] for name in sums}, MANIFEST: manifest.encoded()}


def write_tree(
    directory: Path,
    files: Mapping[str, bytes],
    made_with: Mapping[str, str] | None = None,
    made_from: Mapping[str, str] | None = None,
) -> Written:
    """Write files and their manifest to a directory, and remove what its old manifest lists beyond them.

    All files are written beside the directory before the first one is replaced, so a full disk or a missing right
    changes nothing.

    Args:
        directory: Where to write.
        files: Name -> content.
        made_with: The options of `derive`, for the manifest.
        made_from: The inputs that the files were made from, for the manifest.

    Returns:
        Which files changed.

    Raises:
        EnvironmentFailure: The directory cannot be written, or a link, a device or a folder is in the way.
    """
    wanted = with_manifest(files, made_with, made_from)
    try:
        with _made(directory.parent):
            for path in (directory.parent, directory):
                _refuse_link(path)
            with _locked(directory.parent):
                return _replace(directory, wanted)
    except OSError as error:
        place = error.filename if isinstance(error.filename, str) else str(directory)
        raise EnvironmentFailure(f"cannot write {directory}: {error.strerror or error} ({place})") from error


def differences(
    directory: Path, files: Mapping[str, bytes], made_with: Mapping[str, str] | None = None
) -> list[Difference]:
    """Return how a directory differs from what `write_tree` would leave there.

    The inputs that its manifest records do not count: another version of a library may give the same files.

    Args:
        directory: The directory.
        files: Name -> content.
        made_with: The options of `derive`.

    Returns:
        The differences, in the order of files. A budget, and what Python writes beside an imported module, are none.
    """
    wanted = with_manifest(files, made_with, recorded_inputs(directory))
    found = []
    for name, content in wanted.items():
        found += file_difference(directory / name, content)
    return found + [Difference(path, "not produced") for path in unlisted(directory, list(wanted))]


def write_file(path: Path, content: bytes) -> bool:
    """Write one file that belongs to no directory of ours.

    Returns:
        Whether the file changed.

    Raises:
        UsageError: The name cannot be a file's.
        EnvironmentFailure: The file cannot be written.
    """
    try:
        checked_name(path.name)
    except ValueError as error:
        raise UsageError(str(error)) from None
    try:
        with _made(path.parent):
            for place in (path.parent, path):
                _refuse_link(place)
            with _locked(path.parent):
                if _holds(path, content):
                    return False
                if path.exists() and not path.is_file():
                    what = f"{path} is a device or a pipe, no regular file; wmrgen would replace it"
                    raise EnvironmentFailure(what)
                with tempfile.TemporaryDirectory(prefix=_STAGE, dir=path.parent) as staging:
                    _stage({Path(staging) / path.name: content})
                    (Path(staging) / path.name).replace(path)
                return True
    except OSError as error:
        raise EnvironmentFailure(f"cannot write {path}: {error.strerror or error}") from error


def file_difference(path: Path, content: bytes) -> list[Difference]:
    """Return how one file differs from what `write_file` would leave there: one difference or none."""
    try:
        if not path.is_symlink() and not path.is_file():
            return [Difference(path, "missing")]
        same = not path.is_symlink() and _same(path, content)
    except OSError:
        return [Difference(path, "missing")]
    return [] if same else [Difference(path, "differs")]


def write_log(text: str) -> Path:
    """Write the details of a failure to a new temporary file, and return its path."""
    handle, name = tempfile.mkstemp(prefix="wmrgen-", suffix=".log")
    with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace") as stream:
        stream.write(text)
    return Path(name)


def _refuse_links(directory: Path, name: str) -> None:
    """Refuse a link at ``name`` or at a folder between it and ``directory``."""
    path = directory
    for part in name.split("/"):
        path = path / part
        _refuse_link(path)


def _refuse_files(directory: Path, name: str) -> None:
    """Refuse a file where ``name`` has a folder."""
    for parent in PurePosixPath(name).parents:
        if (directory / parent).is_file():
            raise EnvironmentFailure(
                f"{directory / parent} is a file; wmrgen would make a folder of that name"
            )


def _refuse_link(path: Path) -> None:
    if path.is_symlink():
        raise EnvironmentFailure(
            f"{path} is a symbolic link; wmrgen writes only to real directories and files"
        )


def _replace(directory: Path, wanted: dict[str, bytes]) -> Written:
    old = listed_files(directory)
    for name in {*wanted, *old}:
        _refuse_links(directory, name)
    for name in wanted:
        _refuse_files(directory, name)
    changed = [name for name, content in wanted.items() if not _holds(directory / name, content)]
    removed = [name for name in old if name not in wanted and (directory / name).is_file()]
    if not changed and not removed:
        return Written((), tuple(wanted), ())
    with tempfile.TemporaryDirectory(prefix=_STAGE, dir=directory.parent) as staging:
        before, after = Path(staging) / "before", Path(staging) / "after"
        _stage({after / name: wanted[name] for name in changed})
        directory.mkdir(exist_ok=True)
        moved = [name for name in changed if name != MANIFEST]
        _exchange(directory, [*moved, *removed], moved, before, after)
        for folder in {(directory / name).parent for name in removed}:
            with contextlib.suppress(OSError):  # something else is in the folder
                folder.rmdir()
        if MANIFEST in changed:
            (after / MANIFEST).replace(directory / MANIFEST)
    return Written(tuple(changed), tuple(n for n in wanted if n not in changed), tuple(removed))


def _exchange(directory: Path, old: Sequence[str], new: Sequence[str], before: Path, after: Path) -> None:
    """Move all ``old`` files out to ``before``, then the ``new`` ones in from ``after``; both are never there together.
    If a file cannot be moved, every move is undone."""
    out = [(directory / name, before / name) for name in old if (directory / name).exists()]
    completed: list[tuple[Path, Path]] = []
    try:
        for moves in (out, [(after / name, directory / name) for name in new]):
            for source, target in moves:
                target.parent.mkdir(parents=True, exist_ok=True)
                source.replace(target)
                completed.append((source, target))
    except BaseException:
        for source, target in reversed(completed):
            target.replace(source)
        raise


def _holds(path: Path, content: bytes) -> bool:
    if path.is_dir():
        raise EnvironmentFailure(f"{path} is a directory; wmrgen would write a file of that name")
    return path.is_file() and _same(path, content)


def _same(path: Path, content: bytes) -> bool:
    """Whether a file holds ``content``; one of another size is not read."""
    return path.stat().st_size == len(content) and path.read_bytes() == content


def _stage(contents: Mapping[Path, bytes]) -> None:
    for path, content in contents.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


@contextlib.contextmanager
def _made(directory: Path) -> Iterator[None]:
    """Make a folder and those above it; if the work inside fails, remove the folders that were made."""
    new = [path for path in (directory, *directory.parents) if not path.exists()]
    try:
        directory.mkdir(parents=True, exist_ok=True)
        yield
    except BaseException:
        for path in new:
            with contextlib.suppress(OSError):  # another run has put something there
                path.rmdir()
        raise


@contextlib.contextmanager
def _locked(directory: Path) -> Iterator[None]:
    """Lock the directory against another wmrgen, and remove what a killed run staged there.

    On a file system without locks the work goes on without one.
    """
    try:
        import fcntl
    except ImportError:
        yield
        return
    handle = os.open(directory, os.O_RDONLY)
    try:
        with contextlib.suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)
            for stage in directory.glob(_STAGE + "*"):
                shutil.rmtree(stage, ignore_errors=True)
        yield
    finally:
        os.close(handle)
