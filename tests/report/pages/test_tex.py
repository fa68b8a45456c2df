"""`derive --tex`: the formulas and words of report.md, with nothing that TeX would take for markup."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome
from tests.robots import ROBOTS
from wmrgen.report.pages.tex import escaped, tex

Cli = Callable[..., Outcome]
FENCE = re.compile(r"```math\n(.*?)\n```", re.DOTALL)


def body(text: str) -> str:
    return text.partition("\\begin{document}")[2].partition("\\end{document}")[0]


@pytest.mark.parametrize("name", ROBOTS)
def test_it_has_the_formulas_and_headings_of_the_report(name: str) -> None:
    page = (ROOT / "generated" / name / "report.md").read_text(encoding="utf-8")
    text = body(tex(page))
    formulas = re.findall(r"\\\[\n\\fitted{(.*?)}\n\\\]", text, re.DOTALL)
    assert formulas == FENCE.findall(page)
    words = re.sub(r"\\\[.*?\\\]", "", text, flags=re.DOTALL)
    assert words.count(r"\subsection*{") == len(re.findall(r"(?m)^## ", page))
    assert words.count(r"\begin{quote}") == len(re.findall(r"(?m)^> \*\*", page))
    assert words.count(r"\drawing{") == page.count("![")
    for environment in ("quote", "tabular", "itemize", "enumerate", "widetable"):
        assert words.count(rf"\begin{{{environment}}}") == words.count(rf"\end{{{environment}}}")
    plain = re.sub(r"\\[&%$#_{}]", "", words)
    assert plain.count("{") == plain.count("}") and not re.search(r"[#$^~%]|<", plain)
    for table in re.findall(r"\\begin{tabular}{(\w+)}\n(.*?)\\end{tabular}", plain, re.DOTALL):
        columns, rows = table
        assert {row.count("&") for row in rows.split(r" \\") if row.replace(r"\hline", "").strip()} == {
            len(columns) - 1
        }


def test_free_text_is_no_tex() -> None:
    assert escaped(r"a_b \input{x} $1 #2 50% ^~ & <b>").replace(r"\textbackslash{}", "").count("\\") == 11
    page = tex("a \\\\input{/etc/passwd} `x_1 % y` <script> 50 % & $x$\n")
    assert r"\input" not in body(page) and r"\texttt{x\_1 \% y}" in page and r"\textless{}script" in page


def test_the_option_writes_it_and_check_knows_it(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert wmrgen_cli("derive", robot_file, "-o", out, "--tex").code == 0
    file = out / "pair" / "report.tex"
    assert file.read_text(encoding="utf-8").startswith("\\documentclass")
    assert wmrgen_cli("check", robot_file, "-o", out).code == 0
    file.write_text("mine", encoding="utf-8")
    assert wmrgen_cli("check", robot_file, "-o", out).code == 1
    assert wmrgen_cli("derive", robot_file, "-o", out).code == 0 and not file.exists()
