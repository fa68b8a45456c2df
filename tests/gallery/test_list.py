"""`wmrgen list` prints a table that agrees with the robot files."""

from __future__ import annotations

import json
import sys

from tests.conftest import GALLERY, process
from tests.gallery.table import PATH, content

PROBE = """
import sys
from wmrgen.__main__ import main
try:
    main()
finally:
    print(sorted({"sympy", "numpy", "casadi", "yaml"} & sys.modules.keys()), file=sys.stderr)
"""


def test_the_table_is_fresh() -> None:
    assert PATH.read_text(encoding="utf-8") == content(), "run: python -m tests.gallery.table"


def test_list_derives_nothing() -> None:
    done = process("list", "--json", python=(sys.executable, "-c", PROBE))
    assert (done.code, done.err) == (0, "[]\n")
    assert [row["name"] for row in json.loads(done.out)["robots"]] == [path.stem for path in GALLERY]
