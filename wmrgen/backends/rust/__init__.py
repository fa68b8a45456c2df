"""Rust: a `no_std` crate, straight-line code over structs with named wheels; the operations of the C, so its bits."""

from __future__ import annotations

from wmrgen.backends.rust.driver import evaluate
from wmrgen.backends.rust.emit import emit

__all__ = ["emit", "evaluate"]
