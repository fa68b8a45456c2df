"""Jinja2, in one place: turn a template folder and finished lines into text.

Templates only loop over lines that are ready to print; they neither compute nor escape. To Python they are modules: it
keeps what they are compiled to in ``__pycache__`` beside them, where it may write and is not told otherwise.
"""

from __future__ import annotations

from collections.abc import MutableMapping
from functools import cache
from importlib.machinery import SourceFileLoader
from types import CodeType
from typing import Any

import jinja2
from jinja2 import BaseLoader, Environment, StrictUndefined, Template

from wmrgen.robotfile.shipped import shipped


class _Source(SourceFileLoader):
    """A template as Python's source of a module. It is compiled anew once it, Jinja or this file is another."""

    def source_to_code(self, data: Any, path: Any = "<template>", **_: Any) -> CodeType:  # type: ignore[override]
        """The code of the text ``data``, in UTF-8."""
        return _environment().compile(data.decode(), self.name, path)

    def path_stats(self, path: Any) -> Any:
        """Size of the template and the time of the last change of what its code depends on."""
        stats = [super(_Source, self).path_stats(file) for file in (path, jinja2.__file__, __file__)]
        return {**stats[0], "mtime": max(each["mtime"] for each in stats)}


class _Templates(BaseLoader):
    """The templates that come with the package."""

    def load(
        self, environment: Environment, name: str, context: MutableMapping[str, Any] | None = None
    ) -> Template:
        """The template ``name``. FileNotFoundError where there is none."""
        code: Any = _Source(name, str(shipped("templates") / name)).get_code(name)
        return environment.template_class.from_code(environment, code, context or {})


@cache
def _environment() -> Environment:
    return Environment(
        loader=_Templates(),
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
