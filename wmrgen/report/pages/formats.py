"""What `wmrgen derive` writes beside the rest where it is asked for: the report for a browser, and on paper."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from wmrgen.codegen.compiler import print_pages
from wmrgen.derivation.facade import Derivation
from wmrgen.report.pages import live
from wmrgen.report.pages.document import Report, chapters, page
from wmrgen.robotfile.shipped import shipped

HTML, PDF = "report.html", "report.pdf"


def report(derivation: Derivation, files: Mapping[str, bytes]) -> Report:
    """The report of a robot, ``files`` being its `wmrgen.derivation.emit.artifacts`, and the robot to drive."""
    return Report(derivation.robot.name, files, live.robot(derivation), live.code(derivation))


def formatted(
    derivation: Derivation, files: Mapping[str, bytes], formats: Collection[str]
) -> dict[str, bytes]:
    """The report in ``formats`` (html, pdf), by file name. EnvironmentFailure where nothing prints the PDF."""
    if not formats:
        return {}
    text = page([report(derivation, files)])
    pages = {HTML: text.encode()} if "html" in formats else {}
    return {**pages, PDF: _printed(text, files)} if "pdf" in formats else pages


def _printed(text: str, files: Mapping[str, bytes]) -> bytes:
    """The PDF of a page, or of the ``files`` that are on it."""
    texts = {name: content.decode() for name, content in files.items() if name.endswith((".md", ".svg"))}
    texts["paper.lua"] = (shipped("templates") / "paper" / "paper.lua").read_text(encoding="utf-8")
    return print_pages(text, texts, chapters(texts))
