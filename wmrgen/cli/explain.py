"""``wmrgen explain``: what a code of a finding or an error means, with a wrong and a right example."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated

from wmrgen.cli import console
from wmrgen.cli.declare import Json, argument, verb
from wmrgen.errors import UsageError
from wmrgen.robotfile.text import quoted

if TYPE_CHECKING:
    from wmrgen.robotfile.mistakes import Mistake
    from wmrgen.tools.lint import Rule


def explained() -> dict[str, Rule | Mistake]:
    """Return everything that `wmrgen explain` knows by code: rules of `lint`, and the kinds of errors."""
    from wmrgen.robotfile.mistakes import CALLS, MISTAKES
    from wmrgen.tools.comparing.rules import BETWEEN
    from wmrgen.tools.lint import RULES

    return {**RULES, **BETWEEN, **MISTAKES, **CALLS}


def _codes(incomplete: str) -> list[str]:
    return [code for code in explained() if code.startswith(incomplete.upper())]


@verb("explain")
def explain(
    code: Annotated[str | None, argument("[CODE]", "WMR012; without a code all are listed.", _codes)] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen explain WMR012

    Explain a code of `wmrgen lint`, or of an error: what is wrong and why, with a wrong and a right robot file.
    """
    codes = explained()
    rules = [_explained_by(code, codes)] if code else list(codes.values())
    if as_json:
        keys = ("code", "title", "text", "wrong", "right")
        data = [{key: getattr(rule, key) for key in keys} for rule in rules]
        console.data(data[0] if code else {"rules": data})
    elif code:
        console.result("\n".join(_lines(rules[0])))
    else:
        for rule in rules:
            console.result(f"{rule.code}  {rule.title}")
    return 0


def _explained_by(code: str, codes: Mapping[str, Rule | Mistake]) -> Rule | Mistake:
    """Return what a code means, in upper or lower case. Raise UsageError if there is no such code.

    Codes are numbers, so a code that is written with other zeros or without letters has one meaning. Codes with nearly
    the same digits have nothing in common, so none of them is suggested.
    """
    if code.upper() in codes:
        return codes[code.upper()]
    digits = re.fullmatch(r"\D*0*(\d{1,9})", code)
    near = f"WMR{int(digits[1]):03d}" if digits else ""
    hint = f" Did you mean {near}?" if near in codes else ""
    raise UsageError(f"there is no code {quoted(code)}.{hint} `wmrgen explain` lists all codes.")


def _lines(rule: Rule | Mistake) -> Iterator[str]:
    """Yield the explanation with its examples."""
    from textwrap import fill, indent

    from wmrgen.tools.lint import Rule

    yield f"{rule.code}: {rule.title}"
    yield fill(rule.text, 100)
    for word, example in (("wrong", rule.wrong), ("right", rule.right)):
        yield f"\n{word}:\n{indent(example.rstrip(), '    ')}"
    if isinstance(rule, Rule):
        yield f"\nTo keep a line as it is, add this comment to it: # wmrgen: ignore {rule.code}"
