"""Wheel types."""
