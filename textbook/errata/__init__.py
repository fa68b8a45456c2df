"""Errata of the source texts: what is printed, what holds, and the check that decides it."""

from textbook.errata.records import Judgement, Record, judge
from textbook.errata.texts import RECORDS

__all__ = ["RECORDS", "Judgement", "Record", "judge"]
