"""Errata of the source texts: what is printed, what holds, and the check that decides it."""
