"""The C compiler and linker of the ziglang package: clang and lld for every Cortex-M, without a system toolchain."""

from __future__ import annotations

import importlib.metadata
import os
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CACHE = ROOT / "build" / "zig-cache"
INCLUDE = Path(__file__).resolve().parent / "include"
CODE, DATA, STACK = 0x0001_0000, 0x2000_0000, 0x2004_0000
FLAGS = (
    "-O2", "-std=c99", "-ffp-contract=off", "-fno-math-errno", "-g0", "-fomit-frame-pointer", "-ffunction-sections",
    "-fno-unwind-tables", "-fno-asynchronous-unwind-tables",
)  # fmt: skip
# zig passes -ffreestanding, which makes a call of sqrtf and fabsf, each one instruction of the FPU.
_HOSTED = ("-fhosted", "-fbuiltin", "-isystem", str(INCLUDE))
_PLACES = f"""SECTIONS {{
  .text {CODE:#x} : {{ *(.text .text.*) *(.rodata .rodata.*) }}
  .data {DATA:#x} : {{ *(.data .data.*) *(.bss .bss.*) *(COMMON) }}
  /DISCARD/ : {{ *(.ARM.exidx .ARM.exidx.*) *(.ARM.extab .ARM.extab.*) }}
}}
"""


@dataclass(frozen=True, slots=True)
class Target:
    """A processor: ``triple`` and ``cpu`` as zig names them."""

    name: str
    triple: str
    cpu: str
    fpu: bool


M4F = Target("m4f", "thumb-freestanding-eabihf", "cortex_m4+vfp4d16sp", True)
M0 = Target("m0", "thumb-freestanding-eabi", "cortex_m0", False)


def version() -> str:
    """Return the version of the compiler, which decides the machine code of given C."""
    return f"ziglang {importlib.metadata.version('ziglang')}"


def _zig(folder: Path, *words: str) -> None:
    env = {**os.environ, "ZIG_GLOBAL_CACHE_DIR": str(CACHE), "ZIG_LOCAL_CACHE_DIR": str(CACHE)}
    command = (sys.executable, "-m", "ziglang", *words)
    done = subprocess.run(
        command, cwd=folder, env=env, stdin=subprocess.DEVNULL, capture_output=True, text=True
    )
    if done.returncode:
        raise RuntimeError(f"zig {' '.join(words)} failed:\n{done.stderr[:4000]}")


def compile_objects(
    folder: Path, sources: Sequence[str], target: Target, flags: Sequence[str] = FLAGS
) -> list[Path]:
    """Compile each of ``sources`` (names of C files in ``folder``) to an object in the same folder."""
    chosen = ("-target", target.triple, f"-mcpu={target.cpu}", *flags, *_HOSTED)

    def one(source: str) -> Path:
        name = f"{Path(source).stem}.{target.name}.o"
        _zig(folder, "cc", *chosen, "-c", source, "-o", name)
        return folder / name

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(one, sources))


def link(folder: Path, objects: Sequence[Path], name: str, target: Target) -> Path:
    """An executable without an entry point: code at `CODE`, data at `DATA`. What is undefined is an error.

    A processor without FPU gets zig's compiler-rt; one with an FPU gets nothing.
    """
    paths = [str(path) for path in objects]
    if target.fpu:
        places = (f"-Ttext={CODE:#x}", f"-Tdata={DATA:#x}", "--entry=0", "--no-gc-sections")
        _zig(folder, "ld.lld", *places, *paths, "-o", name)
        return folder / name
    (folder / "places.ld").write_text(_PLACES)
    # --gc-sections would drop everything, as nothing is reached from an entry point.
    words = ("-nostdlib", "-rtlib=compiler-rt", "-Wl,-T,places.ld", "-Wl,--no-gc-sections", "-Wl,--entry=0")
    _zig(folder, "cc", "-target", target.triple, f"-mcpu={target.cpu}", "-O2", *words, *paths, "-o", name)
    return folder / name
