"""``wmrgen explain``: what a code of a finding or an error means, with a wrong and a right example."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from wmrgen.cli import console
from wmrgen.cli.declare import Json, argument, verb

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
    from wmrgen.tools.lint import rule_called

    codes = explained()
    rules = [rule_called(code, codes)] if code else list(codes.values())
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
