"""Frama-C Eva finds nothing in generated C within the limits, and finds what is wrong in the controls."""

from __future__ import annotations
