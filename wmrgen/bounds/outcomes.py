"""Outcomes of analyses: a function whose results another one computes by the same operations has its claims."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from wmrgen.bounds.assumptions import SINGLE, Library
from wmrgen.ir.kernels.compensated import compensated_sums
from wmrgen.ir.nodes import Function

if TYPE_CHECKING:
    from wmrgen.bounds.assumptions import Range
    from wmrgen.bounds.boxes import Outcome


class Outcomes:
    """The outcomes of functions over ranges of inputs that are the same for all of them."""

    def __init__(self, functions: Sequence[Function], library: Library) -> None:
        self.library = library
        self.numbers: dict[tuple[object, ...], int] = {}
        self.keys = {f.name: self._numbered(f) for f in functions}
        self.larger = {
            f.name: g
            for f in functions
            for g in functions
            if g is not f and set(self.keys[f.name]) < set(self.keys[g.name])
        }
        self.done: dict[str, Outcome] = {}

    def of(self, function: Function, ranges: Mapping[str, Range]) -> Outcome:
        """The outcome of ``function``: from a function that computes more, if nothing is amiss there."""
        from wmrgen.bounds.boxes import Outcome

        larger = self.larger.get(function.name)
        if larger is not None and all(p.name in ranges for p in larger.inputs):
            outcome = self._analysed(larger, ranges)
            if not outcome.alarms:
                claims = dict(zip(self.keys[larger.name], outcome.claims, strict=True))
                return Outcome(tuple(claims[k] for k in self.keys[function.name]), ())
        return self._analysed(function, ranges)

    def _analysed(self, function: Function, ranges: Mapping[str, Range]) -> Outcome:
        from wmrgen.bounds.boxes import analysed  # not needed where there are no limits

        if function.name not in self.done:
            self.done[function.name] = analysed(
                function, ranges, SINGLE, self.library, compensated_sums(function)
            )
        return self.done[function.name]

    def _numbered(self, function: Function) -> list[int]:
        """A number per result; equal for equal operations on equal inputs."""
        keys: list[int] = []
        for node in function.nodes:
            key = node.op, tuple(keys[k] for k in node.args), node.value, node.name
            keys.append(self.numbers.setdefault(key, len(self.numbers)))
        return [keys[k] for k in function.results]
