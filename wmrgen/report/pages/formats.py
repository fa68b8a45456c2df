"""Write the report as HTML, LaTeX and PDF, if the user asks `wmrgen derive` for them."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from wmrgen.codegen.compiler import print_pages
from wmrgen.derivation.facade import Derivation
from wmrgen.report.pages import live
from wmrgen.report.pages.document import REPORT, Report, chapters, page
from wmrgen.report.pages.tex import tex

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
    pages: dict[str, bytes] = {}
    if "tex" in formats:
        pages[TEX] = tex(files[REPORT].decode()).encode()
    if "html" in formats:
        pages[HTML] = page([report(derivation, files)]).encode()
    if "pdf" in formats:
        pages[PDF] = _printed(derivation, files)
    return pages


def _printed(derivation: Derivation, files: Mapping[str, bytes]) -> bytes:
    """Return the PDF of all pages of a report."""
    document = tex(*(files[name].decode() for name in chapters(files)))
    figures = {name: content.decode() for name, content in files.items() if name.endswith(".svg")}
    return print_pages(document, page([report(derivation, files)]), figures)
