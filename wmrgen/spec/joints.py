"""Reading what a robot file says of joints, of the robot's or of a wheel's: limits, noise, encoders, lag."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from wmrgen.errors import Several
from wmrgen.spec.expressions import read_quantity
from wmrgen.spec.fields import Interval, Section
from wmrgen.spec.numbers import Scope
from wmrgen.spec.part_keys import ENCODER, LAG, LIMITS, NOISE
from wmrgen.spec.records import EncoderSpec, Limit, Neg, NoiseSpec, Quantity
from wmrgen.spec.tables import Table, table_of
from wmrgen.spec.text import Node, SequenceNode

T = TypeVar("T")


def read_limits(
    node: Node | None, what: str, scope: Scope, several: Several, valid: tuple[str, ...] | None = None
) -> tuple[Limit, ...]:
    """Limits in the order of the file, of those that are ``valid``. A single value v means [-v, v]."""
    return _each(
        node, LIMITS, several, f"limits of {what}", valid, lambda name, table, _: _limit(name, table, scope)
    )


def _limit(name: str, table: Table, scope: Scope) -> Limit:
    node, value, what = table.values[name], LIMITS.field(name).value, f"limit {name}"
    assert isinstance(value, Interval)
    if isinstance(node, SequenceNode):
        if len(node.items) != 2:
            raise node.error(
                f"{what} has {len(node.items)} value{'s' * (len(node.items) != 1)}",
                "A range has two.",
                f"Write {name}: [low, high], or one value.",
            )
        low, high = (read_quantity(item, value.kind, what, scope) for item in node.items)
    else:
        high = read_quantity(node, value.kind, what, scope)
        low = replace(high, expr=Neg(high.expr), text=_negated(high.text))
    return Limit(name, low, high, node.mark)


def _negated(text: str) -> str:
    """The text of the negative of a quantity: -1.2, 30 deg, -(a + b)."""
    bare = text.removeprefix("-").strip()
    if not re.fullmatch(r"[\w. ]+", bare):
        return f"-({text})"
    return f"-{bare}" if bare == text else bare


def read_noise(
    node: Node | None, what: str, scope: Scope, several: Several, valid: tuple[str, ...] | None = None
) -> tuple[NoiseSpec, ...]:
    """The noise of joints, of those that are ``valid``."""

    def noise(joint: str, table: Table, several: Several) -> NoiseSpec:
        of, name = _of(joint, table, f"noise of {what}", several), f"the noise of {joint}"
        return NoiseSpec(joint, of.amount("proportional", name, scope), of.amount("constant", name, scope))

    return _each(node, NOISE, several, f"noise of {what}", valid, noise)


def read_encoders(
    node: Node | None, what: str, scope: Scope, several: Several, valid: tuple[str, ...] | None = None
) -> tuple[EncoderSpec, ...]:
    """The encoders of joints, of those that are ``valid``."""

    def encoder(joint: str, table: Table, several: Several) -> EncoderSpec | None:
        of, name = _of(joint, table, f"encoder of {what}", several), f"the encoder of {joint}"
        of.require_all(name, several)
        counts, gear, bits = (of.amount(key, name, scope) for key in ("counts", "gear", "bits"))
        return None if counts is None else EncoderSpec(joint, counts, gear, of.word("reversed"), bits)

    return _each(node, ENCODER, several, f"encoder of {what}", valid, encoder)


def read_lag(
    node: Node | None, what: str, scope: Scope, several: Several, valid: tuple[str, ...] | None = None
) -> tuple[tuple[str, Quantity], ...]:
    """Joints, of those that are ``valid``, each with its time constant."""

    def lag(joint: str, table: Table, _: Several) -> tuple[str, Quantity]:
        return joint, table.required_amount(joint, f"the lag of {what}", scope)

    return _each(node, LAG, several, f"lag of {what}", valid, lag)


def _each(
    node: Node | None,
    section: Section,
    several: Several,
    title: str,
    valid: tuple[str, ...] | None,
    read: Callable[[str, Table, Several], T | None],
) -> tuple[T, ...]:
    """What can be read of every key of a mapping, in the order of the file; ``several`` takes the rest."""
    if node is None:
        return ()
    results: list[T | None] = []
    table = table_of(node, section, several, title, valid)
    for name in table.values:
        with several:
            results.append(read(name, table, several))
    return tuple(result for result in results if result is not None)


def _of(joint: str, table: Table, title: str, several: Several) -> Table:
    """The mapping that stands behind a joint."""
    section = table.section.field(joint).value
    assert isinstance(section, Section)
    return table_of(table.values[joint], section, several, f"{joint} of the {title}")
