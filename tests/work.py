"""Work counted in calls instead of seconds: the same on every machine, at any load."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any


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

    before = sys.getprofile()
    sys.setprofile(entered)
    try:
        function()
    finally:
        sys.setprofile(before)
    return count
