"""docs/lint.md, from the table of rules: ``python -m tests.tools.lint.page`` writes it."""

from __future__ import annotations

from tests.conftest import ROOT
from wmrgen.cli.explain import explained
from wmrgen.robotfile.mistakes import Mistake
from wmrgen.tools.lint import Rule

INTRO = """# Likely mistakes

`wmrgen lint ROBOT.yaml...` reports likely mistakes in robots that can be derived. Each finding has a place and a code.
`wmrgen derive` prints the same findings on stderr and derives the robot. `wmrgen explain WMR012` prints the section of
one code. Exit code 1 means that there are findings.

To keep a line that `lint` questions, add a comment to it, with a sentence that says why the line is right:

```yaml
wheels:   # base_link is behind the axle
  - {name: left, type: fixed, x: 18.5 mm, y: 67.5 mm, heading: 0, r: 33.1 mm}   # wmrgen: ignore WMR014
```

A comment may list several codes. A finding about the whole robot is reported at the first wheel concerned.

`wmrgen lint ROBOT.yaml controllers.yaml` and `wmrgen compare` check other files against the robot file that precedes
them: URDF and SDF, parameters of wheel controllers, and headers that wmrgen wrote. Differences have the codes from
WMR040 on; their examples are two files, separated by `---`. Lengths within 0.2 % and angles within 0.002 rad are equal.
A comment next to the number in either file keeps it. Values that only one file gives are listed as "not compared". If
there is only a description, `lint` compares the names of its wheels with their positions, and applies no other rule.

Codes from WMR101 on are not findings. They are the kinds of errors for which a robot file, another file or a call is
refused, with exit code 2. All errors are reported in one run, in the order of the file. Errors that merely follow from
another error are suppressed.
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
