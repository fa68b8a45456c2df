"""Arithmetic in integers, of target m0: the bits of IEEE 754, so of this processor."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from benchmarks.kernels.verify import FLAGS, compiler
from wmrgen.codegen.c import sources
from wmrgen.geometry.ports import Port, Role
from wmrgen.ir.build import Builder
from wmrgen.ir.kernels.choice import M0, Choice
from wmrgen.ir.nodes import Function, Module

DRIVER = Path(__file__).with_name("soft.c")


def arithmetic() -> Module:
    """A product, a quotient and a root."""
    b = Builder()
    x, y = b.input("x"), b.input("y")
    results = [b.mul(x, y), b.div(x, y), b.sqrt(x)]
    ports = tuple(Port(name, Role.STATE, "", name) for name in ("x", "y"))
    outputs = tuple(Port(name, Role.COMMAND, "", name) for name in ("product", "quotient", "root"))
    function: Function = b.function("every", ports, outputs, results)
    return Module("soft", (function,))


def wrong(folder: Path, pairs: int, step: int, change: tuple[str, str] = ("", "")) -> tuple[int, ...]:
    """How many products, quotients and roots differ, of the C with a text changed."""
    header, source = sources(arithmetic(), Choice(target=M0))
    assert change[0] in source
    (folder / "soft.h").write_text(header)
    (folder / "soft.c").write_text(source.replace(*change, 1) if change[0] else source)
    (folder / "driver.c").write_text(DRIVER.read_text())
    command = (compiler(), *FLAGS, "-I", str(folder), "driver.c", "-o", "driver", "-lm")
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    words = (str(folder / "driver"), str(pairs), str(step))
    done = subprocess.run(words, check=True, capture_output=True, text=True)
    return tuple(int(word) for word in done.stdout.split())


def test_a_sample(tmp_path: Path) -> None:
    assert wrong(tmp_path, 4_000_000, 7) == (0, 0, 0)


@pytest.mark.slow
def test_every_root_and_many_more(tmp_path: Path) -> None:
    """Of what is planted below, the rarest is met by 22 of a million pairs."""
    assert wrong(tmp_path, 100_000_000, 1) == (0, 0, 0)


SLIPS = [
    (("0xffffff00U", "0xffffffffU"), 0),  # half-way is not to the even one
    (("(high >> 1) | (high & 1U)", "high >> 1"), 0),
    (("(base > 251U)", "(base > 253U)"), 0),
    (("65535U - ", "65536U - "), 1),  # the reciprocal may be too large
    (("(rest + rest) > d", "(rest + rest) > (d + 2U)"), 1),
    (("49150U", "49152U"), 2),
    (("rest > root", "rest > (root + 4U)"), 2),
]


# Everyday the first of each: a product, a quotient and a root.
@pytest.mark.parametrize(
    ("change", "place"),
    [pytest.param(*s, marks=() if s in (SLIPS[0], SLIPS[3], SLIPS[5]) else pytest.mark.slow) for s in SLIPS],
)
def test_a_slip_is_seen(change: tuple[str, str], place: int, tmp_path: Path) -> None:
    assert wrong(tmp_path, 4_000_000, 1, change)[place] > 0


def test_reciprocal_is_below_and_near() -> None:
    """r <= 2**39 / d, with which both digits of a quotient are too small by less than 2, so one correction each."""
    for q in range(2**15 + 1, 2**16 + 1):
        r = 92580 - (61681 * q >> 16)
        assert r < 2**16
        r = r * (65536 - (r * q >> 16)) >> 15
        r = r * (65535 - (r * q >> 16)) >> 15
        assert 2**31 * (1 - 7.1e-5) < r * q <= 2**31
