"""docs/lint.md, from the table of rules: ``python -m tests.tools.lint.page`` writes it."""

from __future__ import annotations

from tests.conftest import ROOT
from wmrgen.cli.explain import explained
from wmrgen.robotfile.mistakes import Mistake
from wmrgen.tools.lint import Rule

INTRO = """# Likely mistakes

`wmrgen lint ROBOT.yaml...` says what is likely wrong with a robot that can be derived, each finding with its place and
a code; `wmrgen derive` says the same on stderr and derives. `wmrgen explain WMR012` prints what stands here of one
code. Exit code 1 means that there are findings.

What is right about a robot keeps its line by a comment on it, and a sentence that says why:

```yaml
wheels:   # base_link lies behind the axle
  - {name: left, type: fixed, x: 18.5 mm, y: 67.5 mm, heading: 0, r: 33.1 mm}   # wmrgen: ignore WMR014
```

Several codes stand one after the other. A finding about the whole robot stands at its first wheel concerned.

`wmrgen lint ROBOT.yaml controllers.yaml` and `wmrgen compare` hold other files against the robot before them: URDF and
SDF, parameters of wheel controllers, headers that wmrgen wrote. What they say differently has the codes from WMR040 on;
their examples are two files, parted by `---`. Lengths within 0.2 % and angles within 0.002 rad are equal. A comment
beside the number in either file keeps it. What only one of them says is told as not compared; of a description
alone the names of wheels are held against their places, nothing else.

Codes from WMR101 on are not findings: they are the kinds of errors for which a robot file, another file or a call is
refused, with exit code 2.
All errors of a file are told in one run, in the order of the file; what only follows from another one is not.
"""


def page() -> str:
    """The whole page."""
    rows = [f"| [{code}](#{code.lower()}) | {rule.title} |" for code, rule in explained().items()]
    sections = map(_section, explained().values())
    return "\n".join([INTRO, "| code | mistake |", "|---|---|", *rows, *sections])


def _section(rule: Rule | Mistake) -> str:
    form = getattr(rule, "form", "yaml")
    examples = (
        f"{word}:\n\n```{form}\n{text}```\n" for word, text in (("Wrong", rule.wrong), ("Right", rule.right))
    )
    return "\n".join(
        [f"\n## {rule.code}\n\n{rule.title[0].upper()}{rule.title[1:]}. {rule.text}\n", *examples]
    )


if __name__ == "__main__":
    (ROOT / "docs" / "lint.md").write_text(page(), encoding="utf-8")
