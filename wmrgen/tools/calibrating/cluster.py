"""The sum over drives on a Dask cluster: each drive is sent once, then a few hundred numbers go and come for a step of
the solver."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from wmrgen.errors import EnvironmentFailure
from wmrgen.tools.calibrating.fit import Each, Problem, Result, Task, own_columns
from wmrgen.tools.calibrating.logs import Drive
from wmrgen.tools.calibrating.path import Reals
from wmrgen.tools.calibrating.stored import Stored


@contextmanager
def cluster(address: str) -> Iterator[Each]:
    """What adds the drives up on the cluster whose scheduler is at ``address``. EnvironmentFailure where there is none,
    or no Dask."""
    try:
        from distributed import Client
    except ImportError:
        raise EnvironmentFailure("--scheduler needs Dask: pip install 'wmrgen[cluster]'") from None
    try:
        client = Client(address, timeout="10s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise EnvironmentFailure(f"no Dask scheduler answers at {address}: {error}") from None
    with client:
        sent: dict[int | Path, tuple[Any, Any]] = {}  # what is kept beside the future has the key to itself

        def each(problem: Problem, unknowns: Reals, task: Task[Result]) -> Sequence[Result]:
            bare = replace(problem, drives=())
            parts = []
            for index in range(len(problem.drives)):
                drives = problem.drives
                key = drives.files[index].path if isinstance(drives, Stored) else id(drives[index])
                if key not in sent:
                    drive = drives[index]
                    kept = drives.folder if isinstance(drives, Stored) else drive
                    sent[key] = kept, client.scatter(drive, hash=False)
                own = unknowns[own_columns(problem, index)]
                parts.append(client.submit(of_drive, task, bare, sent[key][1], own, pure=False))
            return list(client.gather(parts))

        yield each


def of_drive(task: Task[Result], problem: Problem, drive: Drive, unknowns: Reals) -> Result:
    """The task of one drive: ``unknowns`` are the shared ones and its own."""
    return task(replace(problem, drives=(drive,)), unknowns, 0)
