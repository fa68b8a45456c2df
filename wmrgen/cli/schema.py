"""``wmrgen schema``: the keys of robot files, for editors and validators, or as a page to read."""

from __future__ import annotations

from typing import Annotated

from wmrgen.cli import console
from wmrgen.cli.declare import Json, flag, verb
from wmrgen.errors import UsageError


@verb("schema")
def schema(
    as_markdown: Annotated[bool, flag("--markdown", "Print the reference of all keys in Markdown.")] = False,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen schema > robot.schema.json

    Print the JSON Schema of robot files, for editors and validators. With --markdown, print the reference of all keys.
    """
    from wmrgen.functions.registry import optional_names
    from wmrgen.robotfile.reference import reference
    from wmrgen.robotfile.schema import json_schema

    if as_markdown and as_json:
        raise UsageError("there are --json and --markdown. Give one of them, not both.")
    if as_markdown:
        console.result(reference().rstrip("\n"))
    else:
        console.data(json_schema(optional_names()))
    return 0
