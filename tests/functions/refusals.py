"""Checks of functions that a robot cannot have: the reason, and the names and numbers in the message."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from wmrgen.errors import Code, RobotFileError, WmrgenError
from wmrgen.functions.registry import Reason, UnderivableError


@contextmanager
def refused(reason: Reason, *names: str) -> Iterator[None]:
    """Expect an UnderivableError for ``reason`` whose message has ``names``: wheels, keys to write, numbers."""
    with pytest.raises(UnderivableError) as caught:
        yield
    assert caught.value.reason is reason
    assert missing_names(caught.value, names) == []


@contextmanager
def mistaken(code: Code, place: str, *names: str) -> Iterator[None]:
    """Expect a RobotFileError with a code, whose mark is where the line goes on with ``place``."""
    with pytest.raises(RobotFileError) as caught:
        yield
    error = caught.value
    assert error.code == code and error.mark is not None
    assert error.mark.text[error.mark.column - 1 :].startswith(place)
    assert missing_names(error, names) == []


def missing_names(error: WmrgenError, names: tuple[str, ...]) -> list[str]:
    """Return the names that the message of an error does not have as whole words."""
    return [n for n in names if not re.search(rf"(?<![\w.]){re.escape(n)}(?![\w])", error.what)]
