"""Simulate a robot: its motion under commands, as numbers and as a picture."""
