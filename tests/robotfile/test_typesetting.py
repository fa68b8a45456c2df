"""`wmrgen fmt`: laws of formatting. The oracle for the content of a text is PyYAML's own loader."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

import wmrgen
from tests.conftest import ROOT, Outcome
from wmrgen.robotfile.typesetting import formatted
from wmrgen.tools.lint import RULES

Cli = Callable[..., Outcome]
GALLERY = sorted((ROOT / "robots").glob("*.yaml"))
TEXTS = {p.stem: p.read_text(encoding="utf-8") for p in GALLERY}
EXAMPLES = [text for rule in RULES.values() for text in (rule.wrong, rule.right)]


def comments(text: str) -> list[str]:
    """The comments of a text in order. Our texts have # only there."""
    return [re.sub(r"^#\s*", "", c.strip()) for c in re.findall(r"(?:^|\s)(#.*)$", text, re.MULTILINE)]


def formatted_by_law(text: str) -> str:
    """The formatted ``text``. The content and the comments are the same, and formatting again changes nothing."""
    result = formatted(text, "x.yaml")
    assert yaml.load(result, yaml.BaseLoader) == yaml.load(text, yaml.BaseLoader)
    assert comments(result) == comments(text)
    assert formatted(result, "x.yaml") == result
    assert result.endswith("\n") and not re.search(r" $|\n\n\n|\r|\t", result, re.MULTILINE)
    return result


@pytest.mark.parametrize("text", [*TEXTS.values()])
def test_the_gallery_is_formatted(text: str) -> None:
    assert formatted_by_law(text) == text


@pytest.mark.parametrize("text", EXAMPLES)
def test_examples(text: str) -> None:
    formatted_by_law(text)


def mangled(text: str, seed: int) -> str:
    """``text`` of the gallery with other spaces and indentation, and with more comments and empty lines."""
    rng = random.Random(seed)
    lines = []
    step = rng.choice((1, 3, 5))

    def spaces(least: int = 0) -> str:
        return " " * rng.randint(least, 4)

    for line in text.splitlines():
        words, sign, comment = line.partition("#")
        indent = len(words) - len(words.lstrip())
        words = words.strip()
        if '"' not in words:
            words = re.sub(r", *", lambda _: f"{spaces()},{spaces(1)}", words)
            words = re.sub(r"(?<=[{\[])|(?=[}\]])", lambda _: spaces(), words)
            words = re.sub(r"(?<=\w): ", lambda _: f":{spaces(1)}", words)
        if rng.random() < 0.3:
            lines += rng.choice(([""], ["", "", "   "], [spaces() + "#more"], ["# !", ""]))
        lines.append(" " * (indent * step // 2) + words + (f"{spaces(1)}#{comment}" if sign else ""))
    return "\n".join(lines) + rng.choice(("", "\n", "\n\n\n"))


@pytest.mark.parametrize("seed", range(16))
def test_spaces_comments_and_empty_lines(seed: int) -> None:
    name = GALLERY[seed % len(GALLERY)].stem
    text = mangled(TEXTS[name], seed)
    result = formatted_by_law(text)
    assert [c for c in comments(result) if c not in ("more", "!")] == comments(TEXTS[name])


@pytest.mark.parametrize("style", [None, False, True])
@pytest.mark.parametrize("width", [30, 200])
def test_texts_of_another_writer(style: bool | None, width: int) -> None:
    """Block, mixed and flow style, lines broken anywhere."""
    for name in ("pioneer3dx", "car_with_trailers", "textbook_two_steer"):
        content = yaml.load(TEXTS[name], yaml.BaseLoader)
        for indent in (2, 5):
            formatted_by_law(
                yaml.dump(content, default_flow_style=style, width=width, indent=indent, sort_keys=False)
            )


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("a:   1", "a: 1\n"),
        ("", ""),
        ("# alone", "# alone\n"),
        ("\n\n#a\n\n\n\n#b", "# a\n\n# b\n"),
        ("a: 1 #b\nc:    # d\n        - 1\n        -   2\n", "a: 1   # b\nc:   # d\n  - 1\n  - 2\n"),
        ("a:\n- 1\n# last\n- 2\nb: 3", "a:\n  - 1\n  # last\n  - 2\nb: 3\n"),
        ("a:\n    - 1\n    # of a\n# of b\nb: 3", "a:\n  - 1\n  # of a\n# of b\nb: 3\n"),
        (
            "a:\n- b: 1\n  c: 2\n-    d: 3\n     e:\n       [4,\n  5 ]",
            "a:\n  - b: 1\n    c: 2\n  - d: 3\n    e:\n      [4,\n       5]\n",
        ),
        ("a: {\n  b: 1,   # one\n  # two\n  c: 2\n  }", "a: {\n    b: 1,   # one\n    # two\n    c: 2\n  }\n"),
        ("-   - 1\n    - 2\n-\n  - 3", "- - 1\n  - 2\n-\n  - 3\n"),
        (
            "- {a: 1, b: 2}\n- {a: 100, b: 2, c: 3}\n- {b: 1, a: 2}",
            "- {a: 1,   b: 2}\n- {a: 100, b: 2, c: 3}\n- {b: 1, a: 2}\n",
        ),
        ("- {a: [1, {b: 2}], c: 3, }\n- {a: 2, c: 4}", "- {a: [1, {b: 2}], c: 3,}\n- {a: 2,           c: 4}\n"),
        ("a: 'b   c: {d'\ne: \"#  no\"", "a: 'b   c: {d'\ne: \"#  no\"\n"),
        ("a:\r\n   b: 1\r\n", "a:\n  b: 1\n"),
        ("a:\n     one\n     two\nb: |\n    x  y\n      z\nc: 1", "a:\n  one\n  two\nb: |\n    x  y\n      z\nc: 1\n"),
    ],
)  # fmt: skip
def test_formatted_texts(text: str, result: str) -> None:
    assert formatted(text, "x.yaml") == result
    assert formatted(result, "x.yaml") == result
    assert yaml.load(result, yaml.BaseLoader) == yaml.load(text, yaml.BaseLoader)


def test_a_text_whose_content_would_change_is_kept(wmrgen_cli: Cli) -> None:
    """Empty lines of a block text are content."""
    text = "a: |\n  b\n\n\n  c\n"
    assert formatted(text, "x.yaml") == text


def test_the_command_changes_the_text_and_not_the_robot(wmrgen_cli: Cli, tmp_path: Path) -> None:
    path, neat = tmp_path / "pioneer3dx.yaml", GALLERY[0]
    path.write_text(mangled(TEXTS["pioneer3dx"], 7))
    before = path.read_bytes()
    done = wmrgen_cli("fmt", path, neat, "--check")
    first, last = done.out.splitlines()
    assert done.code == 1 and first.startswith(f"{path}: ") and re.findall(r"\d+", last) == ["1", "2"]
    assert path.read_bytes() == before
    codes = [wmrgen.derive(wmrgen.load(path)).module]
    assert wmrgen_cli("fmt", path, neat).code == 0
    codes.append(wmrgen.derive(wmrgen.load(path)).module)
    assert codes[0] == codes[1] and path.read_bytes() != before
    again = wmrgen_cli("fmt", path, neat, "--check", "--json")
    assert (again.code, json.loads(again.out)) == (0, {"changed": [], "unchanged": [str(path), str(neat)]})


def test_a_file_that_is_no_yaml_leaves_the_others_alone(wmrgen_cli: Cli, tmp_path: Path) -> None:
    messy, broken = tmp_path / "messy.yaml", tmp_path / "broken.yaml"
    messy.write_text("a:    1\n")
    broken.write_text("a: [1\nb: 2\n")
    done = wmrgen_cli("fmt", messy, broken)
    assert (done.code, done.out, messy.read_text()) == (2, "", "a:    1\n")
    assert "broken.yaml:" in done.err
    assert wmrgen_cli("fmt", tmp_path / "none.yaml").code == 2
