"""Run C on a model of a Cortex-M, with packages from PyPI alone: ziglang compiles, unicorn runs and counts."""

from benchmarks.emulator.image import Image
from benchmarks.emulator.machine import Machine, Run
from benchmarks.emulator.zig import M0, M4F, Target, compile_objects, link

__all__ = ["M0", "M4F", "Image", "Machine", "Run", "Target", "compile_objects", "link"]
