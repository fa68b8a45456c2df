"""Drives that are many: files of a temporary folder, of which one is in memory at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple, overload

import numpy as np

from wmrgen.tools.calibrating.logs import Drive, Truth


class _File(NamedTuple):
    """Where the numbers of a drive are, its name, its joints, at how many times they were read, its `start_error`."""

    path: Path
    name: str
    joints: tuple[str, ...]
    times: int
    start_error: float


@lru_cache(maxsize=1)
def _read(file: _File) -> Drive:
    """The drive in a file, which never changes."""
    sizes = [4, file.times, len(file.joints) * (file.times - 1)]  # a column has what passes between two times
    start, t, columns, truth = np.split(np.fromfile(file.path), np.cumsum(sizes))
    joints = dict(zip(file.joints, columns.reshape(len(file.joints), -1), strict=True))
    return Drive(file.name, t, joints, Truth(*truth.reshape(4, -1)), tuple(start.tolist()), file.start_error)


class Stored(Sequence[Drive]):
    """Drives in files, in the order of ``files``; the ``folder`` goes with the last that holds it."""

    def __init__(self, folder: TemporaryDirectory[str], files: Sequence[_File]) -> None:
        self.folder, self.files = folder, tuple(files)

    def __len__(self) -> int:
        return len(self.files)

    @overload
    def __getitem__(self, index: int) -> Drive: ...
    @overload
    def __getitem__(self, index: slice) -> Stored: ...
    def __getitem__(self, index: int | slice) -> Drive | Stored:
        if isinstance(index, slice):
            return Stored(self.folder, self.files[index])
        return _read(self.files[index])

    def __iter__(self) -> Iterator[Drive]:
        return (self[index] for index in range(len(self)))


def stored(drives: Iterable[Drive]) -> Stored:
    """Drives, each put into a file when it comes."""
    folder, files = TemporaryDirectory(prefix="wmrgen-drives-"), list[_File]()
    for drive in drives:
        truth, file = drive.truth, Path(folder.name) / str(len(files))
        of_truth = (truth.t, truth.x, truth.y, truth.theta)
        np.concatenate([np.array(drive.start), drive.t, *drive.columns.values(), *of_truth]).tofile(file)
        files.append(_File(file, drive.name, tuple(drive.columns), len(drive.t), drive.start_error))
    return Stored(folder, files)


def changed(drives: Sequence[Drive], change: Callable[[int, Drive], Iterable[Drive]]) -> Sequence[Drive]:
    """What each of the drives becomes, in files where they are in files. A ``change`` has the drive's number, too."""
    every = (result for index, drive in enumerate(drives) for result in change(index, drive))
    return stored(every) if isinstance(drives, Stored) else tuple(every)


def chosen(drives: Sequence[Drive], which: Sequence[int]) -> Sequence[Drive]:
    """Some of the drives."""
    if isinstance(drives, Stored):
        return Stored(drives.folder, [drives.files[index] for index in which])
    return tuple(drives[index] for index in which)
