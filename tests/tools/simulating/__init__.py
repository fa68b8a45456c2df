"""Tests of `wmrgen simulate`."""
