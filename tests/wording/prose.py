"""Count patterns of hard sentences in Markdown, docstrings, comments and messages: a guide for writers, and no test.

python -m tests.wording.prose FILE...              hits per 100 sentences of each file, and the worst sentences
python -m tests.wording.prose --worst 20 FILE...   more of the worst sentences
"""

from __future__ import annotations

import re
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

LONGEST = 32  # words in a sentence
PATTERNS = {
    "tell": r"\b(tells?|told|untold)\b",
    "what as a noun": r"(^|[,;:] |\b(of|in|by|for|from|and|with|beside|makes?) )what [a-z]+ ",
    "Of in front": r"(^|[.;:] )Of [a-z]",
    "stands": r"\b(stands?|stood)\b(?! still)",
    "nobody": r"\b(nobody|nothing|none)\b",
    "that of": r"\b(that|those) of\b|\bone of them\b|\bof such\b",
    "ways": r"\b(ways|turns) (and|or|of|in)\b|\bway of\b",
    "for meaning because": r", for (it|they|he|a|an|the|what|there|this|its|their|nothing|which) ",
    "beside": r"\b(beside|besides|but for)\b",
    "kept": r"\b(kept (from|off|to)|taken for|counts? as|holds? to|led astray|goes? astray|lose[s]? (its|their) way)\b",
    "mend": r"\b(mend|mends|mended|bears?)\b",
    "it was": r"; (it|they|that|which|he) (was|were|had|said|could)\b",
}


class Hit(NamedTuple):
    """A sentence with the patterns that it has."""

    patterns: list[str]
    path: Path
    sentence: str


def texts(path: Path) -> Iterator[str]:
    """Yield the text of a page, or comments, docstrings and longer strings of a module."""
    if path.suffix in (".md", ".txt", ".rst"):
        page = re.sub(r"```.*?```", "", path.read_text(encoding="utf-8"), flags=re.S)
        yield re.sub(r"^\|.*$|^#.*$", lambda m: m[0].replace("|", ". "), page, flags=re.M)
        return
    with path.open("rb") as file:
        for token in tokenize.tokenize(file.readline):
            if token.type == tokenize.COMMENT:
                yield token.string.lstrip("# ")
            elif token.type == tokenize.STRING and token.string.count(" ") > 3:
                yield token.string.strip("rfbRFB\"'")
            elif token.type == getattr(tokenize, "FSTRING_MIDDLE", -1):  # from Python 3.12
                yield token.string


def sentences(path: Path) -> Iterator[str]:
    """Yield sentences of four words or more."""
    for text in texts(path):
        for part in re.split(r"(?<=[.!?])\s+|\n\s*\n|\n\s*[*-] ", text):
            sentence = " ".join(part.split())
            if sentence.count(" ") >= 3:
                yield sentence


def patterns(sentence: str) -> list[str]:
    """Return the names of the patterns that a sentence has."""
    found = [name for name, pattern in PATTERNS.items() if re.search(pattern, sentence)]
    return found + ["long"] * (len(sentence.split()) > LONGEST)


def main(arguments: list[str]) -> None:
    worst = 5
    if arguments[:1] == ["--worst"]:
        worst, arguments = int(arguments[1]), arguments[2:]
    hits = list[Hit]()
    total = 0
    for path in map(Path, arguments):
        every = list(sentences(path))
        own = [Hit(found, path, s) for s in every if (found := patterns(s))]
        if every:
            print(f"{100 * len(own) / len(every):5.0f} % of {len(every):4} sentences  {path}")
        total, hits = total + len(every), hits + own
    print(f"{100 * len(hits) / max(total, 1):5.0f} % of {total:4} sentences in all")
    for hit in sorted(hits, key=lambda h: -len(h.patterns))[:worst]:
        print(f"\n{hit.path}: {', '.join(hit.patterns)}\n    {hit.sentence[:300]}")


if __name__ == "__main__":
    main(sys.argv[1:])
