"""``wmrgen prove``: ranges, rounding errors, and that no operation of the generated C is undefined."""

from __future__ import annotations
