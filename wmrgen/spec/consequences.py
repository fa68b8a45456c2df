"""Which mistakes of a robot file follow from others, and are not told beside them."""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.errors import Code, WmrgenError
from wmrgen.spec.expressions import NO_PARAMETER
from wmrgen.spec.tables import Table
from wmrgen.spec.text import MappingNode, SequenceNode
from wmrgen.spec.wheels import declared_types


def causes(table: Table, errors: Sequence[WmrgenError]) -> list[WmrgenError]:
    """``errors`` without: names of parameters that are used where some of them cannot be read, and so those of wheels;
    what stands where the YAML has a slip; keys that stand twice among wheels whose dashes are missing."""
    slips = [error.mark for error in errors if error.code is Code.NOT_YAML]
    in_doubt = _names_in_doubt(table, errors)
    return [
        error
        for error in errors
        if not (error.code is Code.UNDECLARED and error.what.endswith(NO_PARAMETER) in in_doubt)
        and (error.code is Code.NOT_YAML or error.mark not in slips)
        and not (error.code is Code.TWICE and _in_wheels(table, error))
    ]


def _names_in_doubt(table: Table, errors: Sequence[WmrgenError]) -> set[bool]:
    """Of what some name cannot be read, so that where it is used nothing is to be told: True for parameters, False for
    wheels and what else bears one."""
    wheels, parameters = table.get("wheels"), table.get("parameters")
    declared = parameters.entries if isinstance(parameters, MappingNode) else ()
    marks = [key.mark for key, _ in declared]
    doubts = {error.mark in marks for error in errors if error.code is Code.NAME}
    if parameters is not None and not isinstance(parameters, MappingNode):
        doubts.add(True)
    if isinstance(wheels, SequenceNode) and len(declared_types(table)) < len(wheels.items):
        doubts.add(False)
    return doubts


def _in_wheels(table: Table, error: WmrgenError) -> bool:
    """The key stands in what should be a list of wheels and is a mapping."""
    wheels, mark = table.get("wheels"), error.mark
    if not isinstance(wheels, MappingNode) or not mark:
        return False
    after = [key.mark.line for key in table.keys.values() if key.mark.line > wheels.mark.line]
    return wheels.mark.line < mark.line < min(after, default=mark.line + 1)
