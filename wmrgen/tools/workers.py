"""Where many items are worked on: in this process, in a pool of processes, or on a Dask cluster.

Results are equal to the last bit, wherever they are computed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from typing import Any, Protocol, TypeVar

from wmrgen.errors import EnvironmentFailure

Item = TypeVar("Item")
Result = TypeVar("Result")


class Map(Protocol):
    """Applies a function to every item, in order."""

    def __call__(self, function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]: ...


def serial(function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    """Apply the function here, one item after the other."""
    return [function(item) for item in items]


@contextmanager
def pool(processes: int) -> Iterator[Map]:
    """Yield a map over a pool of processes."""
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as executor:

        def apply(function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
            return list(executor.map(function, items))

        yield apply


@contextmanager
def cluster(address: str) -> Iterator[Map]:
    """Yield a map over the workers of the Dask scheduler at an address. EnvironmentFailure if none answers."""
    try:
        from distributed import Client
    except ImportError:
        raise EnvironmentFailure("--scheduler needs Dask: pip install 'wmrgen[cluster]'") from None
    try:
        client: Any = Client(address, timeout="10s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise EnvironmentFailure(f"no Dask scheduler answers at {address}: {error}") from None
    with client:

        def apply(function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
            return list(client.gather(client.map(function, items, pure=False)))

        yield apply
