"""The version of wmrgen, which every generated file names."""

__version__ = "0.1.0"
