"""Tests of `wmrgen designs`."""
