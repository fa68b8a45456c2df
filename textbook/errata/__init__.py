"""Corrections to our copies of the texts: what a copy has, what holds, and the check that decides it."""
