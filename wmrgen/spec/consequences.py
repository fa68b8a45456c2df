"""Which mistakes of a robot file follow from others, and are not told beside them."""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.errors import Code, WmrgenError
from wmrgen.spec.tables import Table
from wmrgen.spec.text import MappingNode, SequenceNode
from wmrgen.spec.wheels import declared_types


def causes(table: Table, errors: Sequence[WmrgenError]) -> list[WmrgenError]:
    """``errors`` without: names that are used, where some name cannot be read; what stands where the YAML has a slip;
    keys that stand twice among wheels whose dashes are missing."""
    slips = [error.mark for error in errors if error.code is Code.NOT_YAML]
    undeclared = Code.UNDECLARED if _names_in_doubt(table, errors) else None
    return [
        error
        for error in errors
        if error.code is not undeclared
        and (error.code is Code.NOT_YAML or error.mark not in slips)
        and not (error.code is Code.TWICE and _in_wheels(table, error))
    ]


def _names_in_doubt(table: Table, errors: Sequence[WmrgenError]) -> bool:
    """Some name cannot be read, so that where it is used nothing is to be told."""
    wheels, parameters = table.get("wheels"), table.get("parameters")
    unnamed = isinstance(wheels, SequenceNode) and len(declared_types(table)) < len(wheels.items)
    no_mapping = parameters is not None and not isinstance(parameters, MappingNode)
    return unnamed or no_mapping or any(error.code is Code.NAME for error in errors)


def _in_wheels(table: Table, error: WmrgenError) -> bool:
    """The key stands in what should be a list of wheels and is a mapping."""
    wheels, mark = table.get("wheels"), error.mark
    if not isinstance(wheels, MappingNode) or not mark:
        return False
    after = [key.mark.line for key in table.keys.values() if key.mark.line > wheels.mark.line]
    return wheels.mark.line < mark.line < min(after, default=mark.line + 1)
