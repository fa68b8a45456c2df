"""Every failure wmrgen can report, with the exit code that the command line gives it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Mark:
    """A place in a robot file: 1-based line and column, and the text of that line."""

    file: str
    line: int
    column: int
    text: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


class WmrgenError(Exception):
    """Base of all errors a user can cause or cure."""

    exit_code = 1


class StaleError(WmrgenError):
    """A file under the output directory is not what the robot files give today; also the code of findings."""

    exit_code = 1


class RobotFileError(WmrgenError):
    """A robot file that cannot be accepted.

    ``what`` is wrong, ``mark`` where, ``why`` it matters, ``instead`` what to write.
    """

    exit_code = 2

    def __init__(self, what: str, mark: Mark | None = None, why: str = "", instead: str = "") -> None:
        super().__init__(what)
        self.what, self.mark, self.why, self.instead = what, mark, why, instead

    def __str__(self) -> str:
        lines = placed(self.mark, self.what)
        lines += [f"  {text}" for text in (self.why, self.instead) if text]
        return "\n".join(lines)


def placed(mark: Mark | None, what: str) -> list[str]:
    """What is wrong, with its place and the line that it stands on."""
    lines = [f"{mark}: {what}" if mark else what]
    if mark and mark.text:
        shown = mark.text[:160]
        caret = min(mark.column - 1, len(shown))
        lines += [f"    {shown}", "    " + " " * caret + "^"]
    return lines


class UsageError(WmrgenError):
    """A command called with names or values it does not have."""

    exit_code = 2


class NotDerivableError(WmrgenError):
    """A well-formed robot whose model cannot be derived. ``mark``: the part of the file that asks for it."""

    exit_code = 3

    def __init__(self, what: str, mark: Mark | None = None) -> None:
        super().__init__(what)
        self.what, self.mark = what, mark

    def __str__(self) -> str:
        first, *rest = self.what.split("\n")
        return "\n".join([*placed(self.mark, first), *rest])


class EnvironmentFailure(WmrgenError):
    """Something outside wmrgen is missing or refuses: no compiler, no write permission."""

    exit_code = 4
