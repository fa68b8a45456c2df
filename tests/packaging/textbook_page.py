"""``python -m tests.packaging.textbook_page`` writes docs/textbook.md."""

from __future__ import annotations

from tests.conftest import ROOT
from textbook.index.page import content

PAGE = ROOT / "docs" / "textbook.md"

if __name__ == "__main__":
    PAGE.write_text(content(), encoding="utf-8")
