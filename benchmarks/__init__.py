"""Benchmarks of wmrgen: speed, start-up, freshness check, size of the generated code."""
