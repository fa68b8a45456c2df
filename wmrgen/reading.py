"""Reading: the only module that opens a file which a user names.

Regular files are read, and what the caller has opened (stdin, a shell's ``<(…)``). A pipe in the file system
waits for a writer that may never come, and a device has no end: both are refused.
"""

from __future__ import annotations

import stat
from pathlib import Path
from typing import BinaryIO

_OPENED = ("/dev/stdin", "/dev/fd/", "/proc/self/fd/")  # names of what the caller has opened
_KINDS = {
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


def read_at_most(path: str | Path, limit: int) -> bytes:
    """The first ``limit`` bytes of a file. OSError where it cannot be read, ValueError where it is no regular file."""
    kind = _KINDS.get(stat.S_IFMT(Path(path).stat().st_mode))
    if kind and not str(path).startswith(_OPENED):
        raise ValueError(f"it is {kind}, not a regular file")
    with Path(path).open("rb") as file:
        return read_stream(file, limit)


def read_stream(stream: BinaryIO, limit: int) -> bytes:
    """What ``stream`` gives until its end, at most ``limit`` bytes; a pipe may give it in parts."""
    parts: list[bytes] = []
    rest = limit
    while rest and (part := stream.read(rest)):
        parts.append(part)
        rest -= len(part)
    return b"".join(parts)
