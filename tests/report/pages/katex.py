"""What KaTeX, strict, says of formulas."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence

from tests.conftest import ROOT
from tests.external_tools import tool

_CHECK = """
const katex = require(process.argv[1]);
const formulas = JSON.parse(require("fs").readFileSync(0, "utf-8"));
const wrong = [];
for (const formula of formulas) {
  try { katex.renderToString(formula, { displayMode: true, strict: "error" }); }
  catch (error) { wrong.push(`${formula}: ${error.message}`); }
}
console.log(JSON.stringify(wrong));
"""


def mistakes(formulas: Sequence[str]) -> list[str]:
    """What is wrong with which."""
    katex = str(ROOT / "templates/html/katex/katex.min.js")
    command = [tool("node"), "-e", _CHECK, katex]
    done = subprocess.run(command, input=json.dumps(formulas), capture_output=True, text=True, check=True)
    return list(json.loads(done.stdout))
