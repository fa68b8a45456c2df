"""Work on several robots side by side, in processes."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")
_FEW = 4  # robots; for fewer, starting processes takes as long as it saves


def processes_for(count: int, wanted: int | None) -> int:
    """Return how many processes work on ``count`` robots; ``wanted``: the user's choice, None to choose."""
    if wanted is None:
        wanted = _processors() if count >= _FEW else 1
    return max(1, min(wanted, count))


def in_order(work: Callable[[Item], Result], items: Sequence[Item], processes: int) -> Iterator[Result]:
    """Do the same work on every item, and yield the results in the order of the items.

    Args:
        work: A function of a module; it returns what can be pickled.
        items: Its arguments, which can be pickled.
        processes: How many processes share the work; with 1 it is done in this one.

    Yields:
        The results.
    """
    if processes == 1:
        yield from map(work, items)
        return
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    # A fork inherits the imported libraries. Elsewhere than on Linux it is unsafe or missing.
    context = get_context("fork" if sys.platform == "linux" else "spawn")
    pool = ProcessPoolExecutor(processes, context, initializer=_let_the_parent_stop)
    try:
        yield from pool.map(work, items)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _let_the_parent_stop() -> None:
    """Leave Ctrl-C to the parent process, and end at once when it is asked to."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None:
            signal.signal(number, signal.SIG_DFL)


def _processors() -> int:
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on Linux
        return os.cpu_count() or 1
