"""Writing files: the only module that does.

A set of files is staged beside its directory and synced; what changes is moved out, then the new files are moved in one
by one, the manifest last: what a killed run leaves lacks files, and never has old and new ones. Files whose bytes are
equal are left alone; files that the old manifest lists and that are no longer produced are removed. Nothing follows a
symbolic link.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

from wmrgen.errors import EnvironmentFailure, UsageError

MANIFEST = "manifest.json"
BUDGET = "budget.json"  # what the C of a robot may cost; measured, written and held by `python -m benchmarks budgets`
_STAGE = ".wmrgen-stage-"
_MOST_MANIFEST = 1 << 18  # bytes; ours have some thousand
_PART = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}")


class Difference(NamedTuple):
    """A file that is not what it should be: ``why`` is ``missing``, ``differs`` or ``not produced``."""

    path: Path
    why: str


class Written(NamedTuple):
    """What a write did, as relative paths in order."""

    changed: tuple[str, ...]
    unchanged: tuple[str, ...]
    removed: tuple[str, ...]


def with_manifest(files: Mapping[str, bytes], made_with: Mapping[str, str] | None) -> dict[str, bytes]:
    """``files`` and, last, their manifest: the SHA-256 of each, by name, and the options they were made with."""
    sums = {_checked(name): hashlib.sha256(files[name]).hexdigest() for name in sorted(files)}
    options = {"made_with": dict(made_with)} if made_with else {}
    text = json.dumps({"format": 1, **options, "files": sums}, indent=2) + "\n"
    return {**{name: files[name] for name in sums}, MANIFEST: text.encode()}


def write_tree(
    directory: Path, files: Mapping[str, bytes], made_with: Mapping[str, str] | None = None
) -> Written:
    """Make ``directory`` hold ``files`` and their manifest. EnvironmentFailure when that cannot be done.

    Every file is staged before the first is replaced, so a full disk or a missing right changes nothing.
    """
    wanted = with_manifest(files, made_with)
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
    """How ``directory`` differs from what `write_tree` would leave there, by file, in order; `BUDGET` may be there, and
    what Python keeps beside a module that was imported."""
    wanted = with_manifest(files, made_with)
    unlike = []
    for name, content in wanted.items():
        unlike += file_difference(directory / name, content)
    kept = {directory / name for name in (*wanted, BUDGET)}
    extra = [p for p in sorted(directory.rglob("*")) if (p.is_symlink() or not p.is_dir()) and p not in kept]
    return unlike + [Difference(p, "not produced") for p in extra if p.parent.name != "__pycache__"]


def write_file(path: Path, content: bytes) -> bool:
    """Make one file, which belongs to no set, hold ``content``. True when it had to change. UsageError for a file name
    that cannot be."""
    try:
        _checked(path.name)
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
                _sync(path.parent)
                return True
    except OSError as error:
        raise EnvironmentFailure(f"cannot write {path}: {error.strerror or error}") from error


def file_difference(path: Path, content: bytes) -> list[Difference]:
    """How one file differs from what `write_file` would leave there."""
    try:
        if not path.is_symlink() and not path.is_file():
            return [Difference(path, "missing")]
        same = not path.is_symlink() and _same(path, content)
    except OSError:
        return [Difference(path, "missing")]
    return [] if same else [Difference(path, "differs")]


def write_log(text: str) -> Path:
    """Keep the details of a failure in a new temporary file; its path."""
    handle, name = tempfile.mkstemp(prefix="wmrgen-", suffix=".log")
    with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace") as stream:
        stream.write(text)
    return Path(name)


def _checked(name: str) -> str:
    """``name`` when it is a relative path of plain parts that stays inside its directory."""
    parts = name.split("/")
    if name == MANIFEST or not all(_PART.fullmatch(part) and not part.endswith(".") for part in parts):
        raise ValueError(f"not a name for a generated file: {name!r}")
    return name


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
    old = _listed(directory)
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
            with contextlib.suppress(OSError):  # the folder stays when something else is in it
                folder.rmdir()
        if MANIFEST in changed:
            (after / MANIFEST).replace(directory / MANIFEST)
    _sync(directory)
    return Written(tuple(changed), tuple(n for n in wanted if n not in changed), tuple(removed))


def _exchange(directory: Path, old: Sequence[str], new: Sequence[str], before: Path, after: Path) -> None:
    """Move ``old`` out to ``before``, all of it, then ``new`` in from ``after``: at no moment do both stand there.
    Where one cannot be moved, all stand as they did."""
    out = [(directory / name, before / name) for name in old if (directory / name).exists()]
    completed: list[tuple[Path, Path]] = []
    try:
        for moves in (out, [(after / name, directory / name) for name in new]):
            for source, target in moves:
                target.parent.mkdir(parents=True, exist_ok=True)
                source.replace(target)
                completed.append((source, target))
            for folder in {path.parent for move in moves for path in move if path.is_relative_to(directory)}:
                _sync(folder)
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
    """Write all files before the disk is waited for: it takes them together in a fraction of the time."""
    for path, content in contents.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    for path in contents:
        _sync(path)


def _listed(directory: Path) -> list[str]:
    """The names in the manifest that stands in ``directory``; none when there is no readable one."""
    try:
        return [_checked(name) for name in sorted(_manifest(directory)["files"])]
    except (ValueError, TypeError, KeyError):
        return []


def made_with(directory: Path) -> dict[str, str]:
    """The options that the manifest in ``directory`` notes; none where there is no readable one."""
    options = _manifest(directory).get("made_with")
    pairs = options.items() if isinstance(options, dict) else ()
    return {key: value for key, value in pairs if isinstance(value, str)}


def _manifest(directory: Path) -> dict[str, Any]:
    path = directory / MANIFEST
    try:
        readable = path.is_file() and path.stat().st_size <= _MOST_MANIFEST
        manifest = json.loads(path.read_bytes()) if readable else {}
    except (OSError, ValueError, RecursionError):
        return {}
    return manifest if isinstance(manifest, dict) else {}


def _sync(path: Path) -> None:
    """Wait until the disk holds a file, or what a folder lists; POSIX alone can do the latter."""
    folder = path.is_dir()
    if folder and os.name != "posix":
        return
    handle = os.open(path, os.O_RDONLY if folder else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


@contextlib.contextmanager
def _made(directory: Path) -> Iterator[None]:
    """With a folder and those above it; where what is done there fails, those that were made go again."""
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
    """Hold the directory against another wmrgen. Where a file system has no locks, go on without.

    Who holds the lock may clear away the staging of a run that was killed.
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
