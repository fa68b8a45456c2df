"""``wmrgen list``: the robots that come with wmrgen."""

from __future__ import annotations

from wmrgen.cli.declare import Json, verb


@verb("list")
def list_(as_json: Json = False) -> int:
    """Example:  wmrgen list

    List the robots that come with wmrgen: name, type (mobility, steerability) and description.
    """
    from wmrgen.cli.gallery import list_robots

    return list_robots(as_json)
