"""Printing: the only module that does. Results go to stdout, everything else to stderr.

Colour (by Rich) only on a terminal. Output is UTF-8 whatever the locale, and control characters that come
from a robot file are shown as escapes.
"""

from __future__ import annotations

import contextlib
import io
import os
import sys
import threading
from collections.abc import Callable, Iterator
from typing import NoReturn, TextIO

from wmrgen.errors import EnvironmentFailure

PATIENCE = 1.0  # seconds after which a progress line appears


def prepare() -> None:
    """Make both streams UTF-8, so that the locale has no say in what is printed."""
    if sys.stderr is None:  # closed by the caller
        sys.stderr = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(encoding="utf-8", errors="backslashreplace")


def close() -> None:
    """Flush stdout; a reader that went away (``wmrgen … | head``) is no reason to complain."""
    if sys.stdout is None:
        return
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        _reader_left()
    except OSError as error:
        failure(f"standard output cannot be written: {error.strerror}")
        sys.stderr.flush()
        os._exit(EnvironmentFailure.exit_code)


def _reader_left() -> NoReturn:
    """End as a process killed by SIGPIPE would."""
    os._exit(141)


def result(text: str, style: str = "") -> None:
    """A line of the result, to stdout."""
    if sys.stdout is None:
        raise EnvironmentFailure("standard output is closed")
    try:
        _line(sys.stdout, text, style)
    except BrokenPipeError:
        _reader_left()
    except OSError as error:
        raise EnvironmentFailure(f"standard output cannot be written: {error.strerror}") from error


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
