"""Report pages of gallery robots and of robot files, each made once; and the keys of their sentences."""

from __future__ import annotations

from functools import cache

from tests.robots import of_gallery, of_text
from wmrgen.codegen.registry import Facts
from wmrgen.report import sections as report
from wmrgen.report.sections import numerics, wiring
from wmrgen.report.sections.markdown import keys

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
    """Return the report of a robot file given as text."""
    return report.emit(of_text(text), FACTS)[report.FILE].decode()


@cache
def keyed_page_of(name: str) -> str:
    """Return the report of a gallery robot with the keys of its sentences still in it."""
    return "\n\n".join(report.blocks_of(of_gallery(name)))


@cache
def keys_of(name: str) -> list[str]:
    """Return the keys of the sentences in the report of a gallery robot, in their order."""
    return keys(keyed_page_of(name))


@cache
def keyed_page_written(text: str) -> str:
    """Return the report of a robot file given as text, with the keys of its sentences still in it."""
    return "\n\n".join(report.blocks_of(of_text(text)))


@cache
def keys_written(text: str) -> list[str]:
    """Return the keys of the sentences in the report of a robot file given as text."""
    return keys(keyed_page_written(text))


def keys_of_numerics(name: str) -> list[str]:
    return keys("\n\n".join(numerics.numerics(of_gallery(name), FACTS)))


def keys_of_wiring(name: str) -> list[str]:
    return keys("\n\n".join(wiring.wiring(of_gallery(name), FACTS)))


def sentence(keyed_page: str, key: str) -> str:
    """Return the text from a key to the end of its paragraph; "" without the key."""
    return keyed_page.partition(f"\0{key}\0")[2].partition("\n")[0]


def result(name: str) -> str:
    return box(page_of(name))


def box(page: str) -> str:
    return page.partition("## The result")[2].partition("\n## 1 ")[0]


def part(name: str, head: str, end: str) -> str:
    return between(result(name), head, end)


def between(text: str, head: str, end: str) -> str:
    text = text.partition(f"**{head}")[2].partition(f"**{end}")[0]
    return text.replace(r"\Bigl", r"\left").replace(r"\Bigr", r"\right")
