"""Rendering of templates. Only this module uses Jinja2.

Templates loop over finished lines; they neither compute nor escape. They are loaded as Python modules, so that Python
caches their compiled code in ``__pycache__`` next to them, unless it must not write there.
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
    """A template as a Python module. It is compiled again if the template, Jinja or this file has changed."""

    def source_to_code(self, data: Any, path: Any = "<template>", **_: Any) -> CodeType:  # type: ignore[override]
        """Return the code of the template text ``data``, in UTF-8."""
        return _environment().compile(data.decode(), self.name, path)

    def path_stats(self, path: Any) -> Any:
        """Return the size of the template, and the latest change of the files on which its code depends."""
        stats = [super(_Source, self).path_stats(file) for file in (path, jinja2.__file__, __file__)]
        return {**stats[0], "mtime": max(each["mtime"] for each in stats)}


class _Templates(BaseLoader):
    """The templates of the package."""

    def load(
        self, environment: Environment, name: str, context: MutableMapping[str, Any] | None = None
    ) -> Template:
        """Return the template ``name``.

        Args:
            environment: Settings of Jinja.
            name: File name below ``templates``.
            context: Global variables.

        Raises:
            FileNotFoundError: There is no such template.
        """
        code: Any = _Source(name, str(shipped("templates") / name)).get_code(name)
        return environment.template_class.from_code(environment, code, context or {})


@cache
def _environment() -> Environment:
    return Environment(
        loader=_Templates(),
        undefined=StrictUndefined,
        autoescape=False,  # each backend escapes for its language
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        newline_sequence="\n",
    )


def render(template: str, **context: object) -> str:
    """Return the text of ``template`` (``c99/header.h.j2``) with the variables ``context``; all must be defined."""
    return _environment().get_template(template).render(**context)
