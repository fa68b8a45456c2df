"""Transformations of functions, one file each. None changes the exact value of an output."""
