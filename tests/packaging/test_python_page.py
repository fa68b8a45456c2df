"""docs/python.md has everything public, as the docstrings have it."""

from __future__ import annotations

import re

from tests.packaging.python_page import PAGE, page
from wmrgen.derivation.facade import Derivation


def test_the_reference_is_that_of_the_docstrings() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()


def test_what_users_call_is_on_the_page() -> None:
    text = page()
    for name in (
        "J1",
        "C1",
        "null_space",
        "mobility",
        "inverse",
        "forward",
        "nominal",
        "symbols",
        "casadi",
        "numpy",
    ):
        assert hasattr(Derivation, name) and f"| `{name}" in text
    assert not re.search(r"(-> |: |\[)Any\b", text)
