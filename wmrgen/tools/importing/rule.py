"""The record of a rule of the importer: what it checks, why, and the description that needs it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

Check = TypeVar("Check", bound=Callable[..., object])


@dataclass(frozen=True, slots=True)
class Rule(Generic[Check]):
    """One reason to accept, to reject, or to ask about a joint."""

    code: str
    why: str  # the mistake that the rule prevents
    witness: str  # the description that needs it
    check: Check


def rule(rules: list[Rule[Check]], code: str, why: str, witness: str) -> Callable[[Check], Check]:
    """Add the decorated function to a list of rules.

    Args:
        rules: The list, in the order in which its rules apply.
        code: The name of the rule, which no other rule has.
        why: The mistake that the rule prevents.
        witness: The published description, report or test that needs the rule.

    Returns:
        The decorator, which returns the function unchanged.
    """

    def add(check: Check) -> Check:
        rules.append(Rule(code, why, witness, check))
        return check

    return add
