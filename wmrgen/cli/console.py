"""Output and exit codes of a command: the only module that prints.

Results go to stdout, everything else to stderr. Colours (by Rich) appear only on a terminal. Output is UTF-8 in every
locale, and control characters from a robot file are printed as escapes. An error ends a command with a message and its
exit code, a signal with 128 plus its number, as in shells.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import FrameType
from typing import Any, BinaryIO, TextIO, cast

from wmrgen import __version__
from wmrgen.errors import EnvironmentFailure, Mark, UsageError, WmrgenError

PATIENCE = 1.0  # s: when the progress line appears; shorter work needs none
_PIPE = 141  # exit code of a process that SIGPIPE ends in a shell: 128 + 13
_BUG = 70  # exit code of an internal error: EX_SOFTWARE of sysexits.h
_WORDS = {"SIGINT": "interrupted", "SIGTERM": "terminated", "SIGHUP": "the terminal was closed"}


class _Stream(io.TextIOWrapper):
    """A standard stream in UTF-8. If it cannot be written, the process ends with an exit code of its own.

    A command that cannot print its result has failed. Python's own exit code would be 1, which means stale files.
    """

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
        except BrokenPipeError:  # the reader has ended, as in ``wmrgen … | head``: that is no error
            os._exit(_PIPE)
        except OSError as error:
            if self is not sys.stderr:
                sys.stderr.write(f"{self.title} cannot be written: {error.strerror}\n")
                sys.stderr.flush()
            os._exit(EnvironmentFailure.exit_code)


def prepare() -> None:
    """Make stdout and stderr UTF-8 in every locale, and end the process if they cannot be written.

    A stream that the caller has closed is opened on the null device, so that no file that is opened later gets its
    number. Closed stdout is opened for reading: then printing a result fails, as it should. Notes may be lost.
    """
    for handle in (0, 1, 2):
        try:
            os.fstat(handle)
        except OSError:
            os.open(os.devnull, os.O_WRONLY if handle == 2 else os.O_RDONLY)
    sys.stdout = _stream(sys.stdout, 1, "standard output")
    sys.stderr = _stream(sys.stderr, 2, "standard error")


def _stream(stream: TextIO | None, handle: int, title: str) -> TextIO:
    """Return a standard stream in UTF-8; one that is no file, as in tests, unchanged."""
    if stream is None:
        return _Stream(open(handle, "wb", closefd=False), title, True)
    if not isinstance(stream, io.TextIOWrapper):
        return stream
    lines = handle == 2 or stream.line_buffering
    return _Stream(cast(BinaryIO, stream.detach()), title, lines)


def close() -> None:
    """Flush stdout and stderr."""
    sys.stdout.flush()
    sys.stderr.flush()


def result(text: str, style: str = "") -> None:
    """Print a line of the result to stdout."""
    _line(sys.stdout, text, style)


def values(
    named: Mapping[str, object],
    units: Mapping[str, str] | None = None,
    remarks: Mapping[str, str] | None = None,
) -> None:
    """Print a table of names and values to stdout.

    Args:
        named: values by name. A list is printed as a point, (1.0, 2.0).
        units: units by name; missing or "" for none.
        remarks: texts in parentheses after the unit, by name; missing or "" for none.
    """
    width = max(map(len, named), default=0)
    for name, value in named.items():
        if isinstance(value, list):
            text = f"({', '.join(map(repr, value))})"
        else:
            text = value if isinstance(value, str) else repr(value)
        if units and units.get(name):
            text += f" {units[name]}"
        if remarks and remarks.get(name):
            text += f" ({remarks[name]})"
        result(f"{name:<{width}} = {text}")


def data(value: object) -> None:
    """Print a result as JSON to stdout. Infinity and NaN, which JSON does not have, become null."""
    result(json.dumps(_finite(value), indent=2, allow_nan=False))


def _finite(value: object) -> object:
    """Return ``value`` with None in place of each infinity and NaN."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    return value


def note(text: str) -> None:
    """Print a remark, which is not part of the result, to stderr."""
    _line(sys.stderr, text, "dim")


def on_a_terminal() -> bool:
    """Return whether stdout is a terminal."""
    return bool(sys.stdout and sys.stdout.isatty())


def can_ask() -> bool:
    """Return whether a user can answer questions: stdin and stderr are terminals."""
    return bool(sys.stdin and sys.stdin.isatty() and sys.stderr.isatty())


def ask(question: str, default: str, read: Callable[[str], str]) -> str:
    """Ask a question on stderr until the answer is valid.

    Args:
        question: the question.
        default: the answer that an empty line stands for.
        read: returns the value of an answer, or raises a WmrgenError, which is printed before the next attempt.

    Returns:
        What ``read`` returns.

    Raises:
        UsageError: if the input ends.
    """
    while True:
        sys.stderr.write(_clean(f"{question} [{default}] "))
        sys.stderr.flush()
        line = sys.stdin.readline()
        if not line:
            raise UsageError("there is no answer to the question: the input has ended")
        try:
            return read(line.strip() or default)
        except WmrgenError as error:
            failure(str(error))


def failure(text: str) -> None:
    """Print an error message to stderr."""
    _line(sys.stderr, text, "red")


@contextlib.contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """Show progress in a line on stderr, if it is a terminal and the work takes longer than `PATIENCE`.

    Yields a function to call with a description of each step. The line is removed at the end.
    """
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
    timer.start()
    try:
        yield say
    finally:
        timer.cancel()
        if shown.is_set():
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()


def _line(stream: TextIO, text: str, style: str) -> None:
    """Print a line, on a terminal in a style of Rich."""
    text = _clean(text)
    if not stream.isatty() or not style:
        stream.write(text + "\n")
        return
    from rich.console import Console
    from rich.text import Text

    Console(file=stream, highlight=False, soft_wrap=True).print(Text(text, style))


def _clean(text: str) -> str:
    """Return ``text`` with escapes in place of characters that are not printable, except line ends."""
    shown = [c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode() for c in text]
    return "".join(shown)


# ---- how a command ends


class Stopped(BaseException):
    """A signal that asks the process to end. Handlers on the way remove temporary files and stop other programs."""

    def __init__(self, name: str, number: int) -> None:
        super().__init__(name)
        self.name, self.number = name, number


def install_signal_handlers() -> None:
    """Raise `Stopped` at SIGINT, SIGTERM and SIGHUP, except those that the caller of the process ignores."""
    for name in _WORDS:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _stop)


def _stop(number: int, _: FrameType | None) -> None:
    """Handle a signal: raise `Stopped`."""
    signal.signal(number, signal.SIG_DFL)  # a second signal ends the process at once
    raise Stopped(signal.Signals(number).name, number)


def stopped(stop: Stopped, as_json: bool = False) -> int:
    """Print which signal has ended the command; return its exit code, 128 plus the number of the signal."""
    return failed(_WORDS[stop.name], 128 + stop.number, as_json)


def outcome(work: Callable[[], int], as_json: bool = False) -> int:
    """Run a command and return its exit code.

    An error is printed to stderr, a bug of wmrgen in one line; with ``as_json`` also as JSON to stdout.
    """
    try:
        return work()
    except WmrgenError as error:
        return failed(str(error), error.exit_code, as_json, [error])
    except OverflowError:
        wide = UsageError("a result is beyond the range of a double. Give smaller values.")
        return failed(str(wide), wide.exit_code, as_json, [wide])
    except KeyboardInterrupt:
        return stopped(Stopped("SIGINT", 2), as_json)
    except Stopped as stop:
        return stopped(stop, as_json)
    except (Exception, RecursionError) as error:
        return failed(_bug(error), _BUG, as_json)


def failed(text: str, code: int, as_json: bool, errors: Sequence[WmrgenError] = ()) -> int:
    """Print why a command fails.

    Args:
        text: the message for stderr.
        code: the exit code.
        as_json: print the failure as JSON to stdout too.
        errors: the errors that ``text`` describes, for JSON.

    Returns:
        The exit code.
    """
    failure(text)
    if as_json:
        data(_as_data(text, code, errors))
    return code


def place(mark: Mark | None) -> dict[str, Any]:
    """Return ``file``, ``line`` and ``column`` of a place, counted from 1; None for each if there is no place."""
    return {key: getattr(mark, key, None) for key in ("file", "line", "column")}


def all_as_data(errors: Sequence[WmrgenError]) -> dict[str, Any]:
    """Return what a command that continues after errors adds to its JSON; without errors an empty list ``errors``."""
    text = "\n\n".join(map(str, errors))
    return _as_data(text, errors[0].exit_code, errors) if errors else {"errors": []}


def _as_data(text: str, exit_code: int, errors: Sequence[WmrgenError]) -> dict[str, Any]:
    """Return a failure for JSON: ``error`` is the text on stderr, ``errors`` has an entry for each error."""
    entries = [_entry(part, part.exit_code) for error in errors for part in error.parts]
    entries = entries or [_entry(WmrgenError(text), exit_code)]
    return {"error": text, "exit_code": exit_code, "errors": entries}


def _entry(error: WmrgenError, exit_code: int) -> dict[str, Any]:
    """Return one error for JSON: place, code, texts, and other places with the same error."""
    words = {key: getattr(error, key) for key in ("code", "what", "why", "instead")}
    again = [place(mark) for mark in error.again]
    return {**place(error.mark), **words, "exit_code": exit_code, "again": again}


def _bug(error: BaseException) -> str:
    """Return one line about a bug of wmrgen, and write the stack trace to a file."""
    import traceback

    from wmrgen.derivation.artifacts import write_log

    what = f"{type(error).__name__}: {error}".splitlines()[0][:200]
    text = f"this is a bug in wmrgen {__version__}: {what}"
    try:
        log = write_log(f"wmrgen {__version__}\n" + "".join(traceback.format_exception(error)))
    except OSError:
        return text
    return f"{text} (details in {log})"
