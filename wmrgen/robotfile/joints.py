"""Read the limits, noise, encoders, lags and names of joints, for the whole robot or for one wheel."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from wmrgen.errors import ErrorCollector
from wmrgen.robotfile.fields import Interval, Section
from wmrgen.robotfile.keys import LIMITS, WRAPS
from wmrgen.robotfile.names import outer_name
from wmrgen.robotfile.quantities import Scope, read_quantity
from wmrgen.robotfile.records import EncoderSpec, JointName, Limit, Neg, NoiseSpec, Quantity
from wmrgen.robotfile.tables import Table, table_of
from wmrgen.robotfile.text import SequenceNode, scalar_of


def read_of_joints(
    key: str,
    owner: Table,
    what: str,
    scope: Scope,
    collector: ErrorCollector,
    joints: tuple[str, ...] | None = None,
) -> tuple[Any, ...]:
    """Read what a robot or a wheel gives for its joints.

    Args:
        key: ``limits``, ``noise``, ``encoder``, ``lag`` or ``joints``.
        owner: The table of the robot or the wheel.
        what: Names the owner in messages.
        scope: The parameters that expressions may use.
        collector: Receives the errors.
        joints: The joints that the owner has; by default any.

    Returns:
        A record for each entry that can be read, in the order of the file.
    """
    node, section = owner.get(key), owner.section.field(key).value
    assert isinstance(section, Section)
    if node is None:
        return ()
    entries: list[Any] = []
    valid = None if joints is None else section.keys_of(joints)
    table = table_of(node, section, collector, f"{key} of {what}", valid)
    for name in table.values:
        with collector:
            entries.append(_READERS[key](name, table, what, scope, collector))
    return tuple(entry for entry in entries if entry is not None)


def _limit(name: str, table: Table, _what: str, scope: Scope, _collector: ErrorCollector) -> Limit:
    """Read a limit: a list [low, high], or one value v, which means [-v, v]."""
    node, value, limit = table.values[name], LIMITS.field(name).value, f"limit {name}"
    assert isinstance(value, Interval)
    if isinstance(node, SequenceNode):
        if len(node.items) != 2:
            raise node.error(
                f"{limit} has {len(node.items)} value{'s' * (len(node.items) != 1)}",
                "A range has two values.",
                f"Write {name}: [low, high], or one value.",
            )
        low, high = (read_quantity(item, value.kind, limit, scope) for item in node.items)
    else:
        high = read_quantity(node, value.kind, limit, scope)
        low = replace(high, expr=Neg(high.expr), text=_negated(high.text))
    return Limit(name, low, high, node.mark)


def _negated(text: str) -> str:
    """Return the text of the negative of a quantity, such as -1.2, 30 deg or -(a + b)."""
    bare = text.removeprefix("-").strip()
    if not re.fullmatch(r"[\w. ]+", bare):
        return f"-({text})"
    return f"-{bare}" if bare == text else bare


def _noise(joint: str, table: Table, what: str, scope: Scope, collector: ErrorCollector) -> NoiseSpec:
    """Read the noise of a joint."""
    entry, name = _entry(joint, table, f"noise of {what}", collector), f"the noise of {joint}"
    proportional = entry.amount("proportional", name, scope)
    constant = entry.amount("constant", name, scope)
    return NoiseSpec(joint, proportional, constant)


def _encoder(
    joint: str, table: Table, what: str, scope: Scope, collector: ErrorCollector
) -> EncoderSpec | None:
    """Read the encoder of a joint; return None if it has no counts, which has been reported."""
    entry, name = _entry(joint, table, f"encoder of {what}", collector), f"the encoder of {joint}"
    entry.require_all(name, collector)
    entry.choose(WRAPS, name)
    counts, gear, bits, modulus = (
        entry.amount(key, name, scope) for key in ("counts", "gear", "bits", "modulus")
    )
    offset = entry.amount("offset", name, scope) if "offset" in entry.section.keys else None
    if counts is None:
        return None
    return EncoderSpec(joint, counts, gear, entry.word("reversed"), bits, modulus, offset)


def _lag(
    joint: str, table: Table, what: str, scope: Scope, _collector: ErrorCollector
) -> tuple[str, Quantity]:
    """Read the time constant of a joint."""
    time = table.amount(joint, f"the lag of {what}", scope)
    assert time is not None
    return joint, time


def _name(
    joint: str, table: Table, _what: str, _scope: Scope, _collector: ErrorCollector
) -> tuple[str, JointName]:
    """Read the name of a joint in other tools; a minus sign before it means that its axis is opposite."""
    node = scalar_of(table.values[joint], joint)
    text = node.text.strip()
    unsigned = text.removeprefix("-")
    return joint, JointName(outer_name(replace(node, text=unsigned), "joint"), unsigned != text)


# What reads one entry of each key: takes the name of the entry, the table of entries, the owner, scope and collector.
_READERS = {"limits": _limit, "noise": _noise, "encoder": _encoder, "lag": _lag, "joints": _name}


def _entry(joint: str, table: Table, title: str, collector: ErrorCollector) -> Table:
    """Return the table that a joint has as its value."""
    section = table.section.field(joint).value
    assert isinstance(section, Section)
    return table_of(table.values[joint], section, collector, f"{joint} of the {title}")
