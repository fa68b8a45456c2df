"""Failures as JSON: what `--json` prints on stdout in the place of a result."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wmrgen.errors import Mark, WmrgenError


def place(mark: Mark | None) -> dict[str, Any]:
    """``file``, ``line`` and ``column``, 1-based; null where there is no place."""
    return {key: getattr(mark, key, None) for key in ("file", "line", "column")}


def entry(error: WmrgenError) -> dict[str, Any]:
    """One error: its code and place, what is wrong, why, what to write instead, and where the same is wrong again."""
    words = {key: getattr(error, key) for key in ("code", "what", "why", "instead", "exit_code")}
    return {**place(error.mark), **words, "again": [place(mark) for mark in error.again]}


def all_as_data(errors: Sequence[WmrgenError]) -> dict[str, Any]:
    """What a command that goes on after an error adds to its result: ``errors`` alone where there are none."""
    text = "\n\n".join(map(str, errors))
    return as_data(text, errors[0].exit_code, errors) if errors else {"errors": []}


def as_data(text: str, exit_code: int, errors: Sequence[WmrgenError] = ()) -> dict[str, Any]:
    """``error``: what stderr says. ``errors``: each with its place."""
    entries = [entry(part) for error in errors for part in error.parts] or [
        {
            **place(None),
            "code": "",
            "what": text,
            "why": "",
            "instead": "",
            "exit_code": exit_code,
            "again": [],
        }
    ]
    return {"error": text, "exit_code": exit_code, "errors": entries}
