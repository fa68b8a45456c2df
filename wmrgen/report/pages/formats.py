"""Write the report as HTML, LaTeX and PDF, if the user asks `wmrgen derive` for them."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from wmrgen.codegen.compiler import print_pages
from wmrgen.derivation.facade import Derivation
from wmrgen.report.pages import live
from wmrgen.report.pages.document import REPORT, Report, chapters, page
from wmrgen.report.pages.tex import tex
from wmrgen.robotfile.shipped import shipped

HTML, TEX, PDF = "report.html", "report.tex", "report.pdf"


def report(derivation: Derivation, files: Mapping[str, bytes]) -> Report:
    """Return the contents of a page: ``files`` from `wmrgen.derivation.emit.artifacts`, and the robot to drive."""
    return Report(derivation.robot.name, files, live.robot(derivation), live.code(derivation))


def formatted(
    derivation: Derivation, files: Mapping[str, bytes], formats: Collection[str]
) -> dict[str, bytes]:
    """Return the report in some formats.

    Args:
        derivation: the derivation.
        files: its files, from `wmrgen.derivation.emit.artifacts`.
        formats: "html", "tex" and "pdf", or some of them.

    Returns:
        The reports, by file name.

    Raises:
        EnvironmentFailure: if no program that prints a PDF is installed.
    """
    pages = {TEX: tex(files[REPORT].decode()).encode()} if "tex" in formats else {}
    if not {"html", "pdf"} & set(formats):
        return pages
    text = page([report(derivation, files)])
    if "html" in formats:
        pages[HTML] = text.encode()
    return {**pages, PDF: _printed(text, files)} if "pdf" in formats else pages


def _printed(text: str, files: Mapping[str, bytes]) -> bytes:
    """Return the PDF of a page, which a browser prints, or of its ``files``, which pandoc prints."""
    texts = {name: content.decode() for name, content in files.items() if name.endswith((".md", ".svg"))}
    texts["paper.lua"] = (shipped("templates") / "paper" / "paper.lua").read_text(encoding="utf-8")
    return print_pages(text, texts, chapters(texts))
