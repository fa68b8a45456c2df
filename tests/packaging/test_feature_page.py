"""docs/features.md agrees with the functions of the gallery."""

from __future__ import annotations

import re

from tests.packaging.feature_page import HAS, KEY, LACKS, PAGE, page
from wmrgen.codegen.registry import BACKENDS
from wmrgen.functions.registry import names


def test_the_page_is_fresh() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()


def test_every_function_and_back_end_has_a_row() -> None:
    text = PAGE.read_text(encoding="utf-8")
    listed = [name for row in re.findall(r"^\| (`.*?) \| ", text, re.MULTILINE) for name in row.split(", ")]
    assert sorted(listed) == sorted(f"`{name}`" for name in names())
    assert all(f"| `{entry.word}` |" in text for entry in BACKENDS.values() if entry.word)
    assert all(f" {sign} |" in text for sign in (HAS, KEY, LACKS))
