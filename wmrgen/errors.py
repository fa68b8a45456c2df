"""Every failure wmrgen can report, with the exit code that the command line gives it, and the one form of messages."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from types import TracebackType
from unicodedata import east_asian_width

WIDEST = 160  # characters of a line of a robot file that a message shows
MOST = 20  # errors that a message shows


@dataclass(frozen=True, slots=True)
class Mark:
    """A place in a robot file: 1-based line and column, and the text of that line. ``path``: the keys that lead to a
    place in a robot that is no file, ``wheels[0].r``; its lines count its values."""

    file: str
    line: int
    column: int
    text: str
    path: str = ""

    def __str__(self) -> str:
        return self.path or f"{self.file}:{self.line}:{self.column}"


def message(level: str, code: str, what: str, mark: Mark | None, remarks: Iterable[str]) -> str:
    """An error or a warning: what is wrong, its place with the line that it stands on, and ``remarks``."""
    lines = [f"{level}[{code}]: {what}" if code else f"{level}: {what}"]
    margin = " " * len(str(mark.line)) if mark else ""
    if mark:
        lines.append(f"{margin}--> {mark}")
        if mark.text:
            shown = mark.text[:WIDEST]
            wide = "".join("\u3000" if east_asian_width(c) in "WF" else " " for c in shown[: mark.column - 1])
            lines += [f"{mark.line} | {shown}", f"{margin} | {wide}^"]
    return "\n".join([*lines, *(f"{margin} = {text}" for text in remarks if text)])


class Code(StrEnum):
    """The kinds of mistakes in robot files, in other files and in calls, and of what stops a command besides;
    `wmrgen.robotfile.mistakes` explains them. Those of lint are in its rules."""

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
    CONSEQUENCE = ""  # of another mistake; never told


class WmrgenError(Exception):
    """Base of all errors a user can cause or cure.

    ``what`` is wrong, ``mark`` where, ``why`` it matters, ``instead`` what to write; ``code``: of `wmrgen explain`.
    ``parts``: the errors that this one stands for, in order of place; itself where it is one. ``again``: where else
    the same is wrong.
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
            rest = len(self.parts) - MOST
            more = [f"and {rest} error{'s' * (rest > 1)} more"] if rest > 0 else []
            return "\n\n".join([*map(str, self.parts[:MOST]), *more])
        what, *remarks = self.what.split("\n")
        again = f"The same at {', '.join(map(str, self.again[:MOST]))}." if self.again else ""
        remarks = [*(line.strip() for line in remarks), self.why, self.instead, again]
        return message("error", self.code, what, self.mark, remarks)


def _place(mark: Mark | None, files: list[str]) -> tuple[int, int, int]:
    return (files.index(mark.file), mark.line, mark.column) if mark else (-1, 0, 0)


class StaleError(WmrgenError):
    """A file under the output directory is not what the robot files give today; also the code of findings."""

    exit_code = 1


class RobotFileError(WmrgenError):
    """A robot file that cannot be accepted. ``code``, where nothing else is said: that of a value, or of a file as a
    whole where it has no place."""

    exit_code = 2

    def __init__(
        self, what: str, mark: Mark | None = None, why: str = "", instead: str = "", code: str | None = None
    ) -> None:
        super().__init__(
            what, mark, why, instead, (Code.VALUE if mark else Code.DESCRIPTION) if code is None else code
        )


class ErrorCollector:
    """Mistakes in parts of a robot file that can be read one without the other: each part stands in a block
    ``with collector:``, and `end` raises what was wrong in them as one error."""

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
        """Take errors; RobotFileError with those until now where they are more than anybody reads."""
        self.errors += errors
        if len(self.errors) > 5 * MOST:
            self.end()

    def end(self) -> None:
        """RobotFileError where something was wrong: in order of place, the same once, without consequences."""
        if not self.errors:
            return
        distinct: dict[tuple[str, ...], list[WmrgenError]] = {}
        files = list(dict.fromkeys(error.mark.file for error in self.errors if error.mark))
        for error in sorted(self.errors, key=lambda e: _place(e.mark, files)):
            distinct.setdefault((error.what, error.why, error.instead), []).append(error)
        parts = []
        for first, *others in distinct.values():
            marks = [m for e in (first, *others) for m in (e.mark, *e.again) if m and m != first.mark]
            first.again = tuple(dict.fromkeys(marks))
            parts.append(first)
        told = tuple(e for e in parts if e.code or not e.mark) or tuple(parts)
        if len(told) == 1:
            raise told[0]
        joined = RobotFileError(told[0].what, told[0].mark, told[0].why, told[0].instead, told[0].code)
        joined.parts = told
        raise joined


class UsageError(WmrgenError):
    """A command called with names or values it does not have."""

    exit_code = 2

    def __init__(self, what: str) -> None:
        super().__init__(what, code=Code.USAGE)


class NotDerivableError(WmrgenError):
    """A well-formed robot whose model cannot be derived. ``mark``: the part of the file that asks for it."""

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
    """Something outside wmrgen is missing or refuses: no compiler, no write permission. What a tool said stays as it
    is."""

    exit_code = 4

    def __init__(self, what: str) -> None:
        super().__init__(what, code=Code.ENVIRONMENT)

    def __str__(self) -> str:
        return f"error[{self.code}]: {self.what}"
