"""The errors that wmrgen reports, with their exit codes, and the layout of error messages."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from types import TracebackType
from unicodedata import east_asian_width

MOST_COLUMNS = 160  # characters; a message shows no more of a line of a file, which may be very long
MOST_ERRORS = 20  # errors; a message shows no more of them, because people fix the first ones and run again


@dataclass(frozen=True, slots=True)
class Mark:
    """A place in a file, or in a robot that is given as a mapping."""

    file: str
    line: int  # from 1; in a mapping, the number of the value
    column: int  # from 1
    text: str  # of the line
    path: str = ""  # in a mapping, the keys that lead to the place, such as wheels[0].r

    def __str__(self) -> str:
        return self.path or f"{self.file}:{self.line}:{self.column}"


def message(level: str, code: str, what: str, mark: Mark | None, remarks: Iterable[str]) -> str:
    """Return the text of an error or a warning.

    Args:
        level: ``error`` or ``warning``.
        code: The code that `wmrgen explain` knows, or "".
        what: What is wrong, in one line.
        mark: The place. The message shows its line with a caret below the column.
        remarks: Further lines, such as the reason and what to write. Empty ones are left out.

    Returns:
        The lines of the message, without a line end.
    """
    lines = [f"{level}[{code}]: {what}" if code else f"{level}: {what}"]
    margin = " " * len(str(mark.line)) if mark else ""
    if mark:
        lines.append(f"{margin}--> {mark}")
        if mark.text:
            shown = mark.text[:MOST_COLUMNS]
            wide = "".join("\u3000" if east_asian_width(c) in "WF" else " " for c in shown[: mark.column - 1])
            lines += [f"{mark.line} | {shown}", f"{margin} | {wide}^"]
    return "\n".join([*lines, *(f"{margin} = {text}" for text in remarks if text)])


class Code(StrEnum):
    """The codes of errors; `wmrgen.robotfile.mistakes` explains each. The codes of lint are in its rules."""

    NOT_YAML = "WMR101"
    UNKNOWN_KEY = "WMR102"
    MISSING = "WMR103"
    FORM = "WMR104"
    NAME = "WMR105"
    TWICE = "WMR106"
    UNDECLARED = "WMR107"
    OPEN = "WMR108"
    VALUE = "WMR109"
    FILE = "WMR110"
    DESCRIPTION = "WMR111"
    USAGE = "WMR112"
    UNDERIVABLE = "WMR113"
    ENVIRONMENT = "WMR114"
    CONSEQUENCE = ""  # follows from another error, and is not shown if that error is


class WmrgenError(Exception):
    """Base class of the errors that a user can cause or fix.

    Attributes:
        what: What is wrong.
        mark: Where it is wrong, or None.
        why: Why it matters.
        instead: What to write.
        code: The code that `wmrgen explain` knows.
        parts: The errors that this error combines, in order of place; a single error is its own part.
        again: Other places with the same error.
    """

    exit_code = 1

    def __init__(
        self, what: str, mark: Mark | None = None, why: str = "", instead: str = "", code: str = ""
    ) -> None:
        super().__init__(what)
        self.what, self.mark, self.why, self.instead, self.code = what, mark, why, instead, code
        self.parts: tuple[WmrgenError, ...] = (self,)
        self.again: tuple[Mark, ...] = ()

    def __str__(self) -> str:
        if self.parts != (self,):
            rest = len(self.parts) - MOST_ERRORS
            more = [f"and {rest} more error{'s' * (rest > 1)}"] if rest > 0 else []
            return "\n\n".join([*map(str, self.parts[:MOST_ERRORS]), *more])
        what, *remarks = self.what.split("\n")
        again = f"Also at {', '.join(map(str, self.again[:MOST_ERRORS]))}." if self.again else ""
        remarks = [*(line.strip() for line in remarks), self.why, self.instead, again]
        return message("error", self.code, what, self.mark, remarks)


def _place(mark: Mark | None, files: list[str]) -> tuple[int, int, int]:
    """Return a key that sorts marks by file, line and column; errors without a mark come first."""
    return (files.index(mark.file), mark.line, mark.column) if mark else (-1, 0, 0)


class StaleError(WmrgenError):
    """A generated file differs from what the robot file gives now. Commands also exit with this code on findings."""

    exit_code = 1


class RobotFileError(WmrgenError):
    """A robot file, or a robot description, that wmrgen cannot accept.

    Without a ``code`` it is an invalid value if it has a place, and an invalid description if it has none.
    """

    exit_code = 2

    def __init__(
        self, what: str, mark: Mark | None = None, why: str = "", instead: str = "", code: str | None = None
    ) -> None:
        super().__init__(
            what, mark, why, instead, (Code.VALUE if mark else Code.DESCRIPTION) if code is None else code
        )


class ErrorCollector:
    """Collects the errors of parts that can be read independently, to report all of them in one run.

    Each part is read in a block ``with collector:``, which catches a RobotFileError. `end` raises the collected errors.
    """

    def __init__(self) -> None:
        self.errors: list[WmrgenError] = []

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, trace: TracebackType | None) -> bool:
        if not isinstance(error, RobotFileError):
            return False
        self.add(*error.parts)
        return True

    def add(self, *errors: WmrgenError) -> None:
        """Collect errors. Raise them if there are far more than a message shows."""
        self.errors += errors
        if len(self.errors) > 5 * MOST_ERRORS:
            self.end()

    def end(self) -> None:
        """Raise the collected errors as one RobotFileError, if there are any.

        Errors are in order of place. Equal errors are joined, and errors that follow from others are left out.
        """
        if not self.errors:
            return
        distinct: dict[tuple[str, ...], list[WmrgenError]] = {}
        files = list(dict.fromkeys(error.mark.file for error in self.errors if error.mark))
        for error in sorted(self.errors, key=lambda e: _place(e.mark, files)):
            distinct.setdefault((error.what, error.why, error.instead), []).append(error)
        parts = []
        for first, *others in distinct.values():
            places: list[Mark | None] = []
            for error in (first, *others):
                places += (error.mark, *error.again)
            first.again = tuple(dict.fromkeys(mark for mark in places if mark and mark != first.mark))
            parts.append(first)
        shown = tuple(e for e in parts if e.code or not e.mark) or tuple(parts)
        if len(shown) == 1:
            raise shown[0]
        first = shown[0]
        joined = RobotFileError(first.what, first.mark, first.why, first.instead, first.code)
        joined.parts = shown
        raise joined


class UsageError(WmrgenError):
    """A command that is called with names or values that it does not know."""

    exit_code = 2

    def __init__(self, what: str) -> None:
        super().__init__(what, code=Code.USAGE)


class NotDerivableError(WmrgenError):
    """A robot with a valid file whose model cannot be derived. The mark, if any, is at the part that requests it."""

    exit_code = 3

    def __init__(
        self,
        what: str,
        mark: Mark | None = None,
        why: str = "",
        instead: str = "",
        code: str = Code.UNDERIVABLE,
    ) -> None:
        super().__init__(what, mark, why, instead, code)


class EnvironmentFailure(WmrgenError):
    """A program, a package or a permission that is missing. The output of a tool is shown unchanged."""

    exit_code = 4

    def __init__(self, what: str) -> None:
        super().__init__(what, code=Code.ENVIRONMENT)

    def __str__(self) -> str:
        return f"error[{self.code}]: {self.what}"
