"""The sum over drives on a Dask cluster: each drive is sent once, then a few hundred numbers go and come for a step of
the solver."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from wmrgen.calibrating.fit import Each, Problem, Sums, own_columns, sums
from wmrgen.calibrating.logs import Drive
from wmrgen.calibrating.path import Reals
from wmrgen.errors import EnvironmentFailure


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
        sent: dict[int, tuple[Drive, Any]] = {}  # the drive is kept, so that its id stays its own

        def each(problem: Problem, unknowns: Reals) -> Sequence[Sums]:
            bare = replace(problem, drives=())
            parts = []
            for index, drive in enumerate(problem.drives):
                if id(drive) not in sent:
                    sent[id(drive)] = drive, client.scatter(drive, hash=False)
                own = unknowns[own_columns(problem, index)]
                parts.append(client.submit(part, bare, sent[id(drive)][1], own, pure=False))
            return list(client.gather(parts))

        yield each


def part(problem: Problem, drive: Drive, unknowns: Reals) -> Sums:
    """What one drive adds: ``unknowns`` are the shared ones and its own."""
    return sums(replace(problem, drives=(drive,)), unknowns, 0)
