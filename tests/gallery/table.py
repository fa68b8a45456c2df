"""The table of robots that `wmrgen list` prints: ``python -m tests.gallery.table`` writes it."""

from __future__ import annotations

import json

from tests.conftest import ROOT
from wmrgen.cli.gallery import TABLE, table_of_robots

PATH = ROOT / "robots" / TABLE


def content() -> str:
    return json.dumps(table_of_robots(), indent=2, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    PATH.write_text(content(), encoding="utf-8")
