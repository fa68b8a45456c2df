"""What a command says, and how it ends: the only module that prints.

Results go to stdout, everything else to stderr. Colour (by Rich) only on a terminal. Output is UTF-8 whatever the
locale, and control characters that come from a robot file are shown as escapes. An error ends a command with its exit
code and in words, a signal with that of shells.
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

PATIENCE = 1.0  # seconds after which a progress line appears
_PIPE = 141  # the exit code of a process that SIGPIPE ended
_BUG = 70  # exit code of an internal error, as in sysexits.h
_WORDS = {"SIGINT": "interrupted", "SIGTERM": "terminated", "SIGHUP": "the terminal was closed"}


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
            # What is printed is missed, a note not.
            os.open(os.devnull, os.O_WRONLY if handle == 2 else os.O_RDONLY)
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


def values(
    named: Mapping[str, object],
    units: Mapping[str, str] | None = None,
    remarks: Mapping[str, str] | None = None,
) -> None:
    """Names and values one below the other, each with its unit and a remark in parentheses; a point in parentheses, a
    text as it is."""
    width = max(map(len, named), default=0)
    for name, value in named.items():
        point = f"({', '.join(map(repr, value))})" if isinstance(value, list) else None
        unit = f" {units[name]}" if units and units.get(name) else ""
        remark = f" ({remarks[name]})" if remarks and remarks.get(name) else ""
        result(
            f"{name:<{width}} = {point or (value if isinstance(value, str) else repr(value))}{unit}{remark}"
        )


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


def on_a_terminal() -> bool:
    """Whether somebody reads the result."""
    return bool(sys.stdout and sys.stdout.isatty())


def can_ask() -> bool:
    """Whether somebody sits there to answer questions."""
    return bool(sys.stdin and sys.stdin.isatty() and sys.stderr.isatty())


def ask(question: str, default: str, read: Callable[[str], str]) -> str:
    """What ``read`` makes of the answer, asked until it takes one; ``default`` is for an empty line."""
    while True:
        sys.stderr.write(_clean(f"{question} [{default}] "))
        sys.stderr.flush()
        line = sys.stdin.readline()
        if not line:
            raise UsageError("the question has no answer: the input has ended")
        try:
            return read(line.strip() or default)
        except WmrgenError as error:
            failure(str(error))


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


# ---- how a command ends


class Stopped(BaseException):
    """A signal asks the process to end: what is staged is removed, what was started is stopped."""

    def __init__(self, name: str, number: int) -> None:
        super().__init__(name)
        self.name, self.number = name, number


def install_signal_handlers() -> None:
    """End by `Stopped` at signals that ask for an end, but for those that the caller ignores."""
    for name in _WORDS:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _stop)


def _stop(number: int, _: FrameType | None) -> None:
    signal.signal(number, signal.SIG_DFL)  # a second one ends the process at once
    raise Stopped(signal.Signals(number).name, number)


def stopped(stop: Stopped, as_json: bool = False) -> int:
    """The exit code after a signal, as shells have it."""
    return failed(_WORDS[stop.name], 128 + stop.number, as_json)


def outcome(work: Callable[[], int], as_json: bool = False) -> int:
    """The exit code of ``work``; an error is told in words, one of ours in one line, and ``as_json`` on stdout too."""
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
    """Tell a failure, ``as_json`` as the one object on stdout too; its exit code."""
    failure(text)
    if as_json:
        data(_as_data(text, code, errors))
    return code


def place(mark: Mark | None) -> dict[str, Any]:
    """``file``, ``line`` and ``column``, 1-based; null where there is no place."""
    return {key: getattr(mark, key, None) for key in ("file", "line", "column")}


def all_as_data(errors: Sequence[WmrgenError]) -> dict[str, Any]:
    """What a command that goes on after an error adds to its result: ``errors`` alone where there are none."""
    text = "\n\n".join(map(str, errors))
    return _as_data(text, errors[0].exit_code, errors) if errors else {"errors": []}


def _as_data(text: str, exit_code: int, errors: Sequence[WmrgenError]) -> dict[str, Any]:
    """``error``: what stderr says. ``errors``: each with its place; one without where none is ours."""
    entries = [_entry(part, part.exit_code) for error in errors for part in error.parts]
    entries = entries or [_entry(WmrgenError(text), exit_code)]
    return {"error": text, "exit_code": exit_code, "errors": entries}


def _entry(error: WmrgenError, exit_code: int) -> dict[str, Any]:
    """One error: its code and place, what is wrong, why, what to write instead, and where the same is wrong again."""
    words = {key: getattr(error, key) for key in ("code", "what", "why", "instead")}
    again = [place(mark) for mark in error.again]
    return {**place(error.mark), **words, "exit_code": exit_code, "again": again}


def _bug(error: BaseException) -> str:
    """One line about an error that is ours; the stack trace goes to a file."""
    import traceback

    from wmrgen.derivation.artifacts import write_log

    what = f"{type(error).__name__}: {error}".splitlines()[0][:200]
    text = f"this is a bug in wmrgen {__version__}: {what}"
    try:
        log = write_log(f"wmrgen {__version__}\n" + "".join(traceback.format_exception(error)))
    except OSError:
        return text
    return f"{text} (details in {log})"
