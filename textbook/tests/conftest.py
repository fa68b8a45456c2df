"""The fixtures of wmrgen's own tests."""

from tests.conftest import robot_file, wmrgen_cli

__all__ = ["robot_file", "wmrgen_cli"]
