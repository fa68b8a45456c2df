"""Test vectors: where a function is tried, what it gives there, and how far rounding may take it."""
