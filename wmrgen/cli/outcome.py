"""How a command ends: an exit code, and what is said of an error."""

from __future__ import annotations

from collections.abc import Callable

from wmrgen import __version__
from wmrgen.cli import console
from wmrgen.errors import UsageError, WmrgenError

_BUG = 70  # exit code of an internal error, as in sysexits.h
_INTERRUPTED = 130


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
        console.failure("interrupted")
        return _INTERRUPTED
    except BrokenPipeError:
        raise
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
