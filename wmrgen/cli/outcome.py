"""How a command ends: an exit code, and what is said of an error."""

from __future__ import annotations

import signal
from collections.abc import Callable
from types import FrameType

from wmrgen import __version__
from wmrgen.cli import console
from wmrgen.errors import UsageError, WmrgenError

_BUG = 70  # exit code of an internal error, as in sysexits.h
_WORDS = {"SIGINT": "interrupted", "SIGTERM": "terminated", "SIGHUP": "the terminal was closed"}


class Stopped(BaseException):
    """A signal asks the process to end: what is staged is removed, what was started is stopped."""

    def __init__(self, name: str, number: int) -> None:
        super().__init__(name)
        self.name, self.number = name, number


def heed_signals() -> None:
    """End by `Stopped` at signals that ask for an end, but for those that the caller ignores."""
    for name in _WORDS:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _stop)


def _stop(number: int, _: FrameType | None) -> None:
    signal.signal(number, signal.SIG_DFL)  # a second one ends the process at once
    raise Stopped(signal.Signals(number).name, number)


def stopped(stop: Stopped) -> int:
    """The exit code after a signal, as shells have it."""
    console.failure(_WORDS[stop.name])
    return 128 + stop.number


def outcome(work: Callable[[], int]) -> int:
    """The exit code of ``work``; an error is told in words, one of ours in one line."""
    try:
        return work()
    except WmrgenError as error:
        console.failure(str(error))
        return error.exit_code
    except OverflowError:
        console.failure("a result is beyond the range of a double: give smaller values")
        return UsageError.exit_code
    except KeyboardInterrupt:
        return stopped(Stopped("SIGINT", 2))
    except Stopped as stop:
        return stopped(stop)
    except (Exception, RecursionError) as error:
        console.failure(_bug(error))
        return _BUG


def _bug(error: BaseException) -> str:
    """One line about an error that is ours; the stack trace goes to a file."""
    import traceback

    from wmrgen.artifacts import write_log

    what = f"{type(error).__name__}: {error}".splitlines()[0][:200]
    text = f"this is a bug in wmrgen {__version__}: {what}"
    try:
        log = write_log(f"wmrgen {__version__}\n" + "".join(traceback.format_exception(error)))
    except OSError:
        return text
    return f"{text} (details in {log})"
