"""``wmrgen schema``: what a robot file may say, for editors and validators, or as a page to read."""

from __future__ import annotations

from wmrgen.cli import console


def run(*, markdown: bool) -> int:
    """Print the JSON Schema of robot files, or their reference in Markdown."""
    from wmrgen.functions.registry import optional_names
    from wmrgen.spec.schema import json_schema, reference

    if markdown:
        console.result(reference().rstrip("\n"))
    else:
        console.data(json_schema(optional_names()))
    return 0
