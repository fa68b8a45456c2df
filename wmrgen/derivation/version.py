"""The version of wmrgen; every generated file names it."""

__version__ = "0.1.0"
