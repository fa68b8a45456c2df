"""The files beside ``<robot>.c`` that an integrator needs."""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.backends.c99.checked import checked
from wmrgen.backends.c99.meta import Meta
from wmrgen.backends.c99.selftest import selftest
from wmrgen.backends.c99.step import Step
from wmrgen.ir.nodes import Module


def companions(
    module: Module, steps: Sequence[Step], meta: Meta, banner: Sequence[str], pair: str
) -> dict[str, str]:
    """File name -> text; ``steps`` are the C functions of ``module``, ``pair`` the digest of header and source."""
    robot = module.name
    header, source = checked(module, steps, meta.scalar, meta.site, banner, pair)
    files = {
        f"{robot}_checked.h": header,
        f"{robot}_checked.c": source,
        f"{robot}_selftest.c": selftest(module, steps, meta.scalar, meta.site, banner, pair),
    }
    if meta.fuzz:
        from wmrgen.backends.c99.fuzz import fuzz

        files[f"{robot}_fuzz.c"] = fuzz(module, steps, meta.scalar, meta.site, banner, pair)
    return files
