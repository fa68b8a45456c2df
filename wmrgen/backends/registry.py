"""The backends: one line each. A module is imported only when its backend is asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Protocol, cast

from wmrgen.backends.meta import Meta
from wmrgen.ir.nodes import Module


class Backend(Protocol):
    """What the module of a backend offers."""

    def emit(self, module: Module, meta: Meta) -> dict[str, bytes]:
        """File name -> content, for every file of this backend."""

    def evaluate(
        self, module: Module, function: str, cases: Sequence[Mapping[str, float]]
    ) -> list[dict[str, float]]:
        """Outputs by contract name for each case (inputs by contract name; a tunable may be left out)."""


@dataclass(frozen=True, slots=True)
class Entry:
    """``module`` is the import path; ``source`` the attribute of Derivation that the backend reads.

    A backend for readers has no ``evaluate`` and reads the Derivation ``itself``.
    """

    name: str
    module: str
    source: str

    def load(self) -> Backend:
        return cast(Backend, import_module(self.module))

    def offers(self, name: str) -> Any:
        """What this backend offers beyond the protocol, as ``functions`` of CasADi and NumPy."""
        return getattr(self.load(), name)


BACKENDS: dict[str, Entry] = {
    entry.name: entry
    for entry in (
        Entry("c99", "wmrgen.backends.c99", "c_module"),
        Entry("casadi", "wmrgen.backends.casadi", "module"),
        Entry("numpy", "wmrgen.backends.numpy", "module"),
        Entry("drawing", "wmrgen.backends.drawing", "itself"),
        Entry("report", "wmrgen.backends.report", "itself"),
    )
}
