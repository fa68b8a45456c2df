"""Reading what a robot file says of joints, of the robot's or of a wheel's: limits, noise, encoders, lag."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from wmrgen.errors import Several
from wmrgen.spec.expressions import read_quantity
from wmrgen.spec.fields import Interval, Section
from wmrgen.spec.joint_keys import ENCODER, LAG, LIMITS, NOISE
from wmrgen.spec.numbers import Scope
from wmrgen.spec.records import EncoderSpec, Limit, Neg, NoiseSpec, Quantity
from wmrgen.spec.tables import Table, table_of
from wmrgen.spec.text import Node, SequenceNode


def read_limits(
    node: Node | None, what: str, scope: Scope, valid: tuple[str, ...] | None = None
) -> tuple[Limit, ...]:
    """Limits in the order of the file, of those that are ``valid``. A single value v means [-v, v]."""
    if node is None:
        return ()
    several, limits = Several(), []
    table = table_of(node, LIMITS, several, f"limits of {what}", valid)
    for name in table.values:
        with several:
            limits.append(_limit(name, table, scope))
    several.end()
    return tuple(limits)


def _limit(name: str, table: Table, scope: Scope) -> Limit:
    node, value, what = table.values[name], LIMITS.field(name).value, f"limit {name}"
    assert isinstance(value, Interval)
    if isinstance(node, SequenceNode):
        if len(node.items) != 2:
            raise node.error(
                f"{what} has {len(node.items)} values",
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
    node: Node | None, what: str, scope: Scope, valid: tuple[str, ...] | None = None
) -> tuple[NoiseSpec, ...]:
    """The noise of joints, of those that are ``valid``."""
    if node is None:
        return ()
    several, noise = Several(), []
    for joint, of in _by_joint(node, NOISE, "noise", what, several, valid):
        name = f"the noise of {joint}"
        with several:
            noise.append(
                NoiseSpec(joint, of.amount("proportional", name, scope), of.amount("constant", name, scope))
            )
    several.end()
    return tuple(noise)


def read_encoders(
    node: Node | None, what: str, scope: Scope, valid: tuple[str, ...] | None = None
) -> tuple[EncoderSpec, ...]:
    """The encoders of joints, of those that are ``valid``."""
    if node is None:
        return ()
    several, encoders = Several(), []
    for joint, of in _by_joint(node, ENCODER, "encoder", what, several, valid):
        name = f"the encoder of {joint}"
        of.require_all(name, several)
        with several:
            counts, gear, bits = (of.amount(key, name, scope) for key in ("counts", "gear", "bits"))
            if counts is not None:
                encoders.append(EncoderSpec(joint, counts, gear, of.word("reversed"), bits))
    several.end()
    return tuple(encoders)


def read_lag(
    node: Node | None, what: str, scope: Scope, valid: tuple[str, ...] | None = None
) -> tuple[tuple[str, Quantity], ...]:
    """Joints, of those that are ``valid``, each with its time constant."""
    if node is None:
        return ()
    several, lags = Several(), []
    table = table_of(node, LAG, several, f"lag of {what}", valid)
    for joint in table.values:
        with several:
            value = table.amount(joint, f"the lag of {what}", scope)
            lags += [] if value is None else [(joint, value)]
    several.end()
    return tuple(lags)


def _by_joint(
    node: Node, section: Section, called: str, what: str, several: Several, valid: tuple[str, ...] | None
) -> Iterator[tuple[str, Table]]:
    """Each joint of a mapping, with the mapping that stands behind it."""
    for joint, value in table_of(node, section, several, f"{called} of {what}", valid).values.items():
        of = section.field(joint).value
        assert isinstance(of, Section)
        with several:
            yield joint, table_of(value, of, several, f"{joint} of the {called} of {what}")
