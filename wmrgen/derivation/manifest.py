"""The manifest of a generated folder: the files in it, the options they were made with, and what they were made from.

`wmrgen derive` and `wmrgen check` compare manifests before they import anything heavy, so this module imports only the
standard library.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

MANIFEST = "manifest.json"
BUDGET = "budget.json"  # what the C of a robot may cost; `python -m benchmarks budgets` writes and checks it
PAGES = ("README.md", "index.html")  # pages of all robots, beside their folders
FORMAT = 1
_LARGEST_MANIFEST = 1 << 18  # bytes; a manifest of ours has a few thousand
_LARGEST_FILE = 1 << 26  # bytes; a larger file cannot be one of ours, and hashing it would take long
_PART = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}")


class Manifest(NamedTuple):
    """The content of a manifest."""

    files: Mapping[str, str]  # name of each generated file -> its SHA-256
    made_with: Mapping[str, str]  # the options of `wmrgen derive`
    # Robot file, wmrgen's own files and versions, see `freshness`; empty if not recorded.
    made_from: Mapping[str, str]

    def encoded(self) -> bytes:
        """Return the text of manifest.json. Its ``key`` is a hash of everything above it."""
        entries: dict[str, object] = {"format": FORMAT}
        if self.made_with:
            entries["made_with"] = dict(self.made_with)
        if self.made_from:
            entries["made_from"] = dict(self.made_from)
        entries["files"] = dict(sorted(self.files.items()))
        if self.made_from:
            entries["key"] = sha256(json.dumps(entries).encode())
        return (json.dumps(entries, indent=2) + "\n").encode()


def sha256(content: bytes) -> str:
    """Return the SHA-256 of some bytes in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


def checked_name(name: str) -> str:
    """Return ``name``; raise ValueError unless it is a relative path of plain parts that stays inside its directory."""
    parts = name.split("/")
    if name == MANIFEST or not all(_PART.fullmatch(part) and not part.endswith(".") for part in parts):
        raise ValueError(f"not a name for a generated file: {name!r}")
    return name


def listed_files(directory: Path) -> list[str]:
    """Return the file names in the manifest of ``directory``; none without a readable manifest."""
    files = _read(directory).get("files")
    try:
        return [checked_name(name) for name in sorted(files or [])]
    except (ValueError, TypeError, AttributeError):
        return []


def recorded_options(directory: Path) -> dict[str, str]:
    """Return the options that the manifest in ``directory`` records; none without a readable manifest."""
    return _texts(_read(directory).get("made_with"))


def recorded_inputs(directory: Path) -> dict[str, str]:
    """Return what the manifest in ``directory`` says the files were made from; nothing without a readable manifest."""
    return _texts(_read(directory).get("made_from"))


def intact(directory: Path) -> Manifest | None:
    """Return the manifest of ``directory`` if it and every file that it lists are as they were written.

    An edited, missing or linked file, an edited manifest, and a manifest without ``made_from`` give None.
    """
    entries = _read(directory)
    manifest = Manifest(*(_texts(entries.get(key)) for key in ("files", "made_with", "made_from")))
    path = directory / MANIFEST
    try:
        if not manifest.made_from or path.is_symlink() or path.read_bytes() != manifest.encoded():
            return None
        for name, wanted in manifest.files.items():
            if _hash_of(directory, checked_name(name)) != wanted:
                return None
    except (OSError, ValueError):
        return None
    return manifest


def unlisted(directory: Path, files: Sequence[str]) -> list[Path]:
    """Return what is in ``directory`` beyond ``files``, the manifest and the budget, in order.

    The ``__pycache__`` that Python writes beside an imported module does not count.
    """
    expected = {directory / name for name in (*files, MANIFEST, BUDGET)}
    extra = []
    for path in sorted(directory.rglob("*")):
        is_folder = path.is_dir() and not path.is_symlink()
        if not is_folder and path not in expected and path.parent.name != "__pycache__":
            extra.append(path)
    return extra


def _hash_of(directory: Path, name: str) -> str:
    """Return the SHA-256 of a file of a directory; nothing if a link leads to it, or it cannot be one of ours."""
    path = directory
    for part in name.split("/"):
        path = path / part
        if path.is_symlink():
            return ""
    if not path.is_file() or path.stat().st_size > _LARGEST_FILE:
        return ""
    return sha256(path.read_bytes())


def _texts(entries: object) -> dict[str, str]:
    """Return the entries of a mapping whose values are texts."""
    pairs = entries.items() if isinstance(entries, dict) else ()
    return {key: value for key, value in pairs if isinstance(value, str)}


def _read(directory: Path) -> dict[str, Any]:
    path = directory / MANIFEST
    try:
        readable = path.is_file() and path.stat().st_size <= _LARGEST_MANIFEST
        manifest = json.loads(path.read_bytes()) if readable else {}
    except (OSError, ValueError, RecursionError):
        return {}
    return manifest if isinstance(manifest, dict) else {}
