"""What is likely wrong with a robot that can be derived: rules, each with a code, and what they find.

A rule stands beside its check in one of the modules of this room; `RULES` is the table of all of them.
"""

from __future__ import annotations

from wmrgen.tools.lint import driving, halves, mirror, numbers, places, ranks
from wmrgen.tools.lint.record import RULES, Finding, Rule, Subject, findings, rule_called

__all__ = ["RULES", "Finding", "Rule", "Subject", "findings", "modules", "rule_called"]

modules = (numbers, halves, places, mirror, driving, ranks)  # importing them fills the table
