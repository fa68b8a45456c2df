"""Printing: the only module that does. Results go to stdout, everything else to stderr.

Colour (by Rich) only on a terminal. Output is UTF-8 whatever the locale, and control characters that come
from a robot file are shown as escapes.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import os
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from typing import BinaryIO, TextIO, cast

from wmrgen.errors import EnvironmentFailure

PATIENCE = 1.0  # seconds after which a progress line appears
_PIPE = 141  # the exit code of a process that SIGPIPE ended


class _Stream(io.TextIOWrapper):
    """A standard stream in UTF-8. Where it cannot be written the process ends: a command that cannot say how it
    went has not succeeded, and Python's own answer would be exit code 1, which means stale files."""

    def __init__(self, stream: BinaryIO, title: str, lines: bool) -> None:
        super().__init__(stream, encoding="utf-8", errors="backslashreplace", line_buffering=lines)
        self.title = title

    def write(self, text: str, /) -> int:
        with self._or_end():
            return super().write(text)

    def flush(self) -> None:
        with self._or_end():
            super().flush()

    @contextlib.contextmanager
    def _or_end(self) -> Iterator[None]:
        try:
            yield
        except BrokenPipeError:  # a reader that went away (``wmrgen … | head``) is no reason to complain
            os._exit(_PIPE)
        except OSError as error:
            if self is not sys.stderr:
                sys.stderr.write(f"{self.title} cannot be written: {error.strerror}\n")
                sys.stderr.flush()
            os._exit(EnvironmentFailure.exit_code)


def prepare() -> None:
    """Make both streams UTF-8, so that the locale has no say in what is printed, and say when they fail."""
    for handle in (0, 1, 2):  # one that the caller closed: no file that is opened later may take its number
        try:
            os.fstat(handle)
        except OSError:
            os.open(
                os.devnull, os.O_WRONLY if handle == 2 else os.O_RDONLY
            )  # what is printed is missed, a note not
    sys.stdout = _stream(sys.stdout, 1, "standard output")
    sys.stderr = _stream(sys.stderr, 2, "standard error")


def _stream(stream: TextIO | None, handle: int, title: str) -> TextIO:
    if stream is None:
        return _Stream(open(handle, "wb", closefd=False), title, True)
    if not isinstance(stream, io.TextIOWrapper):
        return stream
    lines = handle == 2 or stream.line_buffering
    return _Stream(cast(BinaryIO, stream.detach()), title, lines)


def close() -> None:
    """Write out what is buffered."""
    sys.stdout.flush()
    sys.stderr.flush()


def result(text: str, style: str = "") -> None:
    """A line of the result, to stdout."""
    _line(sys.stdout, text, style)


def values(named: Mapping[str, object]) -> None:
    """Names and values one below the other; a point in parentheses, a text as it is."""
    width = max(map(len, named), default=0)
    for name, value in named.items():
        point = f"({', '.join(map(repr, value))})" if isinstance(value, list) else None
        result(f"{name:<{width}} = {point or (value if isinstance(value, str) else repr(value))}")


def data(value: object) -> None:
    """A result as JSON, which has no word for infinity and NaN: null."""
    result(json.dumps(_finite(value), indent=2, allow_nan=False))


def _finite(value: object) -> object:
    """``value`` with None in place of every number that is not finite."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    return value


def note(text: str) -> None:
    """A remark that is not part of the result, to stderr."""
    _line(sys.stderr, text, "dim")


def failure(text: str) -> None:
    """What went wrong, to stderr."""
    _line(sys.stderr, text, "red")


@contextlib.contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """A line on a terminal's stderr once the work has taken a second. Call what it gives with each step."""
    if not sys.stderr.isatty():
        yield lambda step: None
        return
    steps = [""]
    shown = threading.Event()

    def draw() -> None:
        shown.set()
        sys.stderr.write(f"\r\x1b[K{_clean(steps[-1])[:100]}")
        sys.stderr.flush()

    def say(step: str) -> None:
        steps.append(step)
        if shown.is_set():
            draw()

    timer = threading.Timer(PATIENCE, draw)
    timer.daemon = True
    timer.start()
    try:
        yield say
    finally:
        timer.cancel()
        if shown.is_set():
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()


def _line(stream: TextIO, text: str, style: str) -> None:
    text = _clean(text)
    if not stream.isatty() or not style:
        stream.write(text + "\n")
        return
    from rich.console import Console
    from rich.text import Text

    Console(file=stream, highlight=False, soft_wrap=True).print(Text(text, style))


def _clean(text: str) -> str:
    """``text`` with everything but printable characters and line ends shown as escapes."""
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode() for c in text)
