"""What `wmrgen derive` writes beside the rest where it is asked for: the report for a browser, and on paper."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from wmrgen.compiler import print_page
from wmrgen.pages import live
from wmrgen.pages.document import Report, page
from wmrgen.robot import Derivation

HTML, PDF = "report.html", "report.pdf"


def report(derivation: Derivation, files: Mapping[str, bytes]) -> Report:
    """The report of a robot, ``files`` being its `wmrgen.emit.artifacts`, and the robot to drive."""
    return Report(derivation.robot.name, files, live.robot(derivation), live.code(derivation))


def formatted(
    derivation: Derivation, files: Mapping[str, bytes], formats: Collection[str]
) -> dict[str, bytes]:
    """The report in ``formats`` (html, pdf), by file name. EnvironmentFailure where no browser prints the PDF."""
    if not formats:
        return {}
    text = page([report(derivation, files)])
    pages = {HTML: text.encode()} if "html" in formats else {}
    return {**pages, PDF: print_page(text)} if "pdf" in formats else pages
