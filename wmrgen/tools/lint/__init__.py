"""Rules that find likely mistakes in robots that can be derived, each with a code.

Each rule is registered next to its check, in one of the modules here; `RULES` is the table of all rules.
"""

from __future__ import annotations

from wmrgen.tools.lint import driving, halves, mirror, numbers, places, ranks
from wmrgen.tools.lint.record import RULES, Finding, Rule, Subject, findings

__all__ = ["RULES", "Finding", "Rule", "Subject", "findings", "modules"]

modules = (numbers, halves, places, mirror, driving, ranks)  # importing them fills the table
