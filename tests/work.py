"""Work counted in calls instead of seconds: the same on every machine, at any load."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any


@contextmanager
def ends(seconds: float = 60) -> Iterator[None]:
    """AssertionError where the body works the processor for longer: a guard against what never ends, no measurement."""

    def stop(_signal: int, _frame: object) -> None:
        raise AssertionError(f"it had not ended after {seconds} s")

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


def calls(function: Callable[[], object], most: int) -> int:
    """How many Python and C functions ``function`` enters; AssertionError as soon as it is over ``most``."""
    count = 0

    def entered(_frame: object, event: str, _arg: Any) -> None:
        nonlocal count
        if event in ("call", "c_call"):
            count += 1
            if count > most:
                sys.setprofile(None)
                raise AssertionError(f"more than {most} calls")

    _watched(function, entered)
    return count


def arguments(work: Callable[[], object], *functions: Callable[..., Any]) -> list[tuple[str, Any]]:
    """Of each call of one of ``functions`` that ``work`` makes the function's name and its first argument."""
    codes = {function.__code__ for function in functions}
    called: list[tuple[str, Any]] = []

    def entered(frame: FrameType, event: str, _arg: Any) -> None:
        code = frame.f_code
        if event == "call" and code in codes:
            called.append((code.co_name, frame.f_locals[code.co_varnames[0]]))

    _watched(work, entered)
    return called


def _watched(work: Callable[[], object], entered: Callable[[FrameType, str, Any], None]) -> None:
    """Do ``work`` and tell ``entered`` of every function that it enters or leaves."""
    before = sys.getprofile()
    sys.setprofile(entered)
    try:
        work()
    finally:
        sys.setprofile(before)
