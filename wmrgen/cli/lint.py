"""``wmrgen lint`` and ``wmrgen explain``: what is likely wrong with a robot, and why it is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.loading import linted, paths_and_arguments
from wmrgen.errors import StaleError, UsageError, WmrgenError
from wmrgen.tools.comparing.compare import compare, labelled
from wmrgen.tools.comparing.compare import findings as between
from wmrgen.tools.comparing.record import DESCRIPTION, ROBOT_FILE
from wmrgen.tools.comparing.sources import layouts

if TYPE_CHECKING:
    from wmrgen.robotfile.mistakes import Mistake
    from wmrgen.tools.comparing.record import Layout
    from wmrgen.tools.lint import Finding, Rule

_NAMES_ALONE = (
    "of its wheels, names are held against places, nothing else; `wmrgen import` makes the robot file in which `lint` "
    "looks at all"
)


def lint(robots: Sequence[str], base: str | None, package: Sequence[str] | None, as_json: bool) -> int:
    """Print the findings of all robots, and what parameters and headers, or a description after a robot file, say
    otherwise of the robot before them; beside them what was not looked at. Exit code 1 where there are some, an
    error's where a file is bad."""
    findings: list[Finding] = []
    errors: list[WmrgenError] = []
    unseen: list[str] = []
    robot: Layout | None = None
    paths, arguments = paths_and_arguments(robots)
    for path in paths:
        try:
            for layout in layouts(path, arguments, package or (), base):
                if layout.form == ROBOT_FILE:
                    spec, built = wmrgen.read(path)
                    findings += linted(spec, wmrgen.derive(built))
                    robot = layout
                elif layout.form == DESCRIPTION and (robot is None or robot.form == DESCRIPTION):
                    findings += labelled(layout)
                    unseen.append(f"{layout.source}: {_NAMES_ALONE}")
                    robot = layout
                elif robot is None and errors:
                    continue  # what it belongs to cannot be read
                elif robot is None:
                    raise UsageError(
                        f"{layout.source} has no robot before it: give a robot file or description first"
                    )
                else:
                    compared = compare(robot, layout)
                    findings += between(compared)
                    unseen += [f"not compared: {words}" for words in compared.unsaid]
        except WmrgenError as error:
            errors += error.parts
    if as_json:
        told = {"findings": [_as_data(f) for f in findings], "not_compared": unseen}
        console.data({**told, **console.all_as_data(errors)})
    else:
        for finding in findings:
            console.result(str(finding))
        for failure in errors:
            console.failure(str(failure))
        for words in unseen:
            console.note(f"note: {words}")
        if findings:
            console.note(
                "Mend them, or write # wmrgen: ignore CODE on the line. `wmrgen explain CODE` says more."
            )
        elif not errors:
            seen = " in what was compared" if unseen else ""
            noun = "file" if unseen else "robot"
            console.result(f"{len(paths)} {noun}{'s' * (len(paths) != 1)}: no findings{seen}")
    return errors[0].exit_code if errors else (StaleError.exit_code if findings else 0)


def explained() -> dict[str, Rule | Mistake]:
    """What `explain` knows by its code: rules, and the mistakes for which a robot file is refused."""
    from wmrgen.robotfile.mistakes import CALLS, MISTAKES
    from wmrgen.tools.comparing.rules import BETWEEN
    from wmrgen.tools.lint import RULES

    return {**RULES, **BETWEEN, **MISTAKES, **CALLS}


def explain(code: str | None, as_json: bool) -> int:
    """Print a rule with its examples; without a code, all of them in a line each."""
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


def _lines(rule: Rule | Mistake) -> Iterable[str]:
    from textwrap import fill, indent

    from wmrgen.tools.lint import Rule

    yield f"{rule.code}: {rule.title}"
    yield fill(rule.text, 100)
    for word, example in (("wrong", rule.wrong), ("right", rule.right)):
        yield f"\n{word}:\n{indent(example.rstrip(), '    ')}"
    if isinstance(rule, Rule):
        yield f"\nTo keep a line as it is, write beside it: # wmrgen: ignore {rule.code}"


def _as_data(finding: Finding) -> dict[str, Any]:
    return {
        "code": finding.code,
        **console.place(finding.mark),
        "what": finding.what,
        "instead": finding.instead,
    }
