"""The files of the library, and the page of errata, in memory."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

from textbook.library import Textbook, textbook
from textbook.report import report
from wmrgen import __version__
from wmrgen.codegen.registry import Facts, unasked
from wmrgen.geometry.ports import Port
from wmrgen.report.sections.markdown import page

DESCRIPTION = "Formulas of the texts that need no robot, in their corrected form"


@cache
def artifacts() -> Mapping[str, bytes]:
    """File name -> content of everything in ``DIR/textbook/``, the manifest aside."""
    book = textbook()
    facts = (json.dumps(_functions(book), indent=2, ensure_ascii=False) + "\n").encode()
    digest = hashlib.sha256(facts)
    digest.update(repr(book.raw_module).encode())
    digest.update(f"float {__version__}".encode())
    common = Facts(
        description=DESCRIPTION,
        model_hash=digest.hexdigest()[:32],
        wmrgen_version=__version__,
    )
    files = {"functions.json": facts}
    for entry in unasked():
        if entry.source != "itself":  # those draw and report robots
            files |= entry.load().emit(getattr(book, entry.source), common)
    return MappingProxyType(files | {"report.md": page(report(book)).encode()})


@cache
def errata() -> bytes:
    """The content of ``DIR/errata.md``, from running every check."""
    from textbook.errata.page import blocks

    return page(blocks()).encode()


def _functions(book: Textbook) -> list[dict[str, Any]]:
    """Names, units and words of every function's inputs and outputs."""

    def shown(ports: Iterable[Port]) -> list[dict[str, str]]:
        return [{"name": p.name, "unit": p.unit, "text": p.text} for p in ports]

    return [
        {"name": f.name, "text": f.text, "inputs": shown(f.inputs), "outputs": shown(p for p, _ in f.outputs)}
        for f in book.formulas
    ]
