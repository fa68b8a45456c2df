"""Jinja2, in one place: turn a template folder and finished lines into text.

Templates only loop over lines that are ready to print; they neither compute nor escape.
"""

from __future__ import annotations

from functools import lru_cache

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from wmrgen.shipped import shipped


@lru_cache(maxsize=1)
def _environment() -> Environment:
    return Environment(
        loader=FileSystemLoader(shipped("templates"), encoding="utf-8"),
        undefined=StrictUndefined,
        autoescape=False,  # the targets are C, Python and Markdown: each backend escapes for its own
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        newline_sequence="\n",
    )


def render(template: str, **context: object) -> str:
    """The text of ``template`` (``c99/header.h.j2``) with ``context``. An undefined name is an error."""
    return _environment().get_template(template).render(**context)
