"""`derive --tex`: the formulas and words of report.md, with nothing that TeX would take for markup."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome
from tests.external_tools import tool
from tests.robots import ROBOTS
from wmrgen.report.pages.tex import escaped, tex

Cli = Callable[..., Outcome]
FENCE = re.compile(r"```math\n(.*?)\n```", re.DOTALL)


# A car, a swerve drive, a car with trailers, mecanum wheels, omni wheels and a differential drive with a castor.
PRINTED = (
    "ackermann_car",
    "wpilib_swervebot",
    "car_with_trailers",
    "kuka_youbot",
    "ssl_parsian",
    "pioneer3dx",
)
WIDEST = 20.0  # pt: a line that is wider than the text by this much runs into the margin of 57 pt


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
    assert words.count(r"\begin{shaded}") == len(re.findall(r"(?m)^> \*\*", page))
    assert words.count(r"\drawing{") == page.count("![")
    for environment in ("shaded", "tabular", "itemize", "enumerate", "widetable"):
        assert words.count(rf"\begin{{{environment}}}") == words.count(rf"\end{{{environment}}}")
    plain = re.sub(r"\\[&%$#_{}]", "", words)
    assert plain.count("{") == plain.count("}") and not re.search(r"[#$^~%]|<", plain)
    for table in re.findall(r"\\begin{tabular}{(.*?)}\n(.*?)\\end{tabular}", plain, re.DOTALL):
        columns, rows = re.sub(r">{[^}]*}p{[^}]*}", "p", table[0]), table[1]
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


def printed(folder: Path, name: str) -> str:
    """Compile a document of a folder by LuaLaTeX, with its figures as PDF, and return the log."""
    for figure in folder.glob("*.svg"):
        command = [tool("rsvg-convert"), "-f", "pdf", "-o", figure.with_suffix(".pdf"), figure]
        subprocess.run(command, check=True, capture_output=True)
    command = [tool("lualatex"), "-interaction=nonstopmode", "-halt-on-error", name]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:]
    assert (folder / name).with_suffix(".pdf").read_bytes().startswith(b"%PDF")
    return (folder / name).with_suffix(".log").read_text(encoding="utf-8", errors="replace")


def fits_and_has_every_letter(log: str) -> None:
    assert "Missing character" not in log
    assert [float(pt) for pt in re.findall(r"Overfull \\hbox \(([\d.]+)pt", log) if float(pt) > WIDEST] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", PRINTED)
def test_a_report_compiles(name: str, wmrgen_cli: Cli, tmp_path: Path) -> None:
    assert wmrgen_cli("derive", ROBOTS[name], "-o", tmp_path, "--tex").code == 0
    log = printed(tmp_path / name, "report.tex")
    fits_and_has_every_letter(log)
    assert "layout.pdf" in log.replace("\n", "")


@pytest.mark.slow
def test_an_exercise_compiles(wmrgen_cli: Cli, tmp_path: Path) -> None:
    file = tmp_path / "exercise.tex"
    done = wmrgen_cli("exercise", ROBOTS["ackermann_car"], "--seed", "7", "--solution", "-o", file)
    assert done.code == 0, done.err
    fits_and_has_every_letter(printed(tmp_path, file.name))


@pytest.mark.slow
def test_a_report_compiles_without_figures(tmp_path: Path) -> None:
    page = (ROOT / "generated" / "unicycle" / "report.md").read_text(encoding="utf-8")
    (tmp_path / "alone.tex").write_text(tex(page), encoding="utf-8")
    assert "layout.pdf" not in printed(tmp_path, "alone.tex")
