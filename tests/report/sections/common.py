"""Derivations of the gallery, each made once, and report pages."""

from __future__ import annotations

from functools import cache

from tests.robots import of_gallery, of_text
from wmrgen.codegen.registry import Facts
from wmrgen.report import sections as report

FACTS = Facts(model_hash="0123456789abcdef", wmrgen_version="9.9")


@cache
def pages_of(name: str) -> dict[str, str]:
    return {file: text.decode() for file, text in report.emit(of_gallery(name), FACTS).items()}


def page_of(name: str) -> str:
    return pages_of(name)[report.FILE]


def numerics_of(name: str) -> str:
    return pages_of(name)["numerics.md"]


@cache
def page_written(text: str) -> str:
    """The report of a robot file given as text."""
    return report.emit(of_text(text), FACTS)[report.FILE].decode()


def result(name: str) -> str:
    return box(page_of(name))


def box(page: str) -> str:
    return page.partition("## The result")[2].partition("\n## 1 ")[0]


def part(name: str, head: str, end: str) -> str:
    return between(result(name), head, end)


def between(text: str, head: str, end: str) -> str:
    text = text.partition(f"**{head}")[2].partition(f"**{end}")[0]
    return text.replace(r"\Bigl", r"\left").replace(r"\Bigr", r"\right")
