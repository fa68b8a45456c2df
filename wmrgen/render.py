"""Jinja2, in one place: turn a template folder and finished lines into text.

Templates only loop over lines that are ready to print; they neither compute nor escape.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from wmrgen.errors import EnvironmentFailure

_PACKAGE = Path(__file__).resolve().parent


def template_folder() -> Path:
    """``wmrgen/templates`` in an installed wheel, ``templates`` beside the package in a checkout."""
    for folder in (_PACKAGE / "templates", _PACKAGE.parent / "templates"):
        if folder.is_dir():
            return folder
    raise EnvironmentFailure(f"the templates of wmrgen are missing: neither {_PACKAGE / 'templates'} nor "
                             f"{_PACKAGE.parent / 'templates'} exists. Install wmrgen again.")  # fmt: skip


@lru_cache(maxsize=1)
def _environment() -> Environment:
    return Environment(
        loader=FileSystemLoader(template_folder(), encoding="utf-8"),
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
