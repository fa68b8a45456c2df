"""An order that keeps fewer values alive than depth first, for code that shares much.

Depth first is best for trees. Where wheels share sums, the next thing to compute is better the one that leaves the
fewest values alive: list scheduling, with all that a value still needs as one step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.passes.schedule import registers, reordered

_MANY = 128  # nodes; of more, only those that several need are tried as the next


@dataclass(frozen=True, slots=True)
class Step:
    """Computing one value next. ``alive``: values more than before, ``most``: at most meanwhile.

    ``touched``: bit mask of the nodes that this depends on.
    """

    alive: int
    most: int
    nodes: tuple[int, ...]
    touched: int


def _rank(step: Step) -> tuple[int, ...]:
    """Fewest values left alive, then the most work done."""
    return step.alive, -len(step.nodes), step.most


def nearest(function: Function) -> Function:
    """``function`` in an order that leaves few values alive; results are stored at once."""
    state = _State(function)
    order = [i for i, node in enumerate(function.nodes) if node.value is not None]
    steps = {i: state.step(i) for i in state.targets()}
    while steps:
        chosen = min((_rank(step), i) for i, step in steps.items())[1]
        order += steps[chosen].nodes
        changed = state.do(steps[chosen].nodes)
        steps = {
            i: state.step(i) if step.touched & changed else step
            for i, step in steps.items()
            if not state.done[i]
        }
    return reordered(function, order)


@dataclass
class _State:
    """What is computed, and how many nodes still need each. Inputs are read when they are first needed."""

    function: Function
    left: list[int] = field(init=False)
    done: bytearray = field(init=False)
    together: Mapping[int, list[int]] = field(init=False)  # a call and all its results

    def __post_init__(self) -> None:
        nodes = self.nodes = self.function.nodes
        self.left = [0] * len(nodes)
        for node in nodes:
            for arg in set(node.args):
                self.left[arg] += 1
        self.needs = registers(nodes)
        self.done = bytearray(node.value is not None for node in nodes)
        self.together = _together(nodes)
        self.masks = [sum(1 << a for a in {i, *node.args}) for i, node in enumerate(nodes)]
        self.results = set(self.function.results)

    def targets(self) -> list[int]:
        """Nodes to try: results, and those that several need; all of short functions."""
        every = len(self.nodes) <= _MANY
        chosen = (
            i for i, n in enumerate(self.left) if (every and self.nodes[i].args) or n > 1 or i in self.results
        )
        return [i for i in chosen if i not in self.together and not self.done[i]]

    def do(self, nodes: Sequence[int]) -> int:
        """Bit mask of what this changes."""
        changed = 0
        for i in nodes:
            self.done[i] = 1
            changed |= self.masks[i]
            for arg in set(self.nodes[i].args):
                self.left[arg] -= 1
        return changed

    def step(self, target: int) -> Step:
        """``target`` and all that it still needs."""
        order = self._needed(target)
        alive = most = 0
        left: dict[int, int] = {}
        touched = 0
        for i in order:
            touched |= self.masks[i]
            alive += self.left[i] > 0 and i not in self.together
            for arg in set(self.nodes[i].args):
                left[arg] = left.get(arg, self.left[arg]) - 1
                alive -= left[arg] == 0 and self.nodes[arg].value is None and arg not in self.together
            most = max(most, alive)
        return Step(alive, most, tuple(order), touched)

    def _needed(self, target: int) -> list[int]:
        order: list[int] = []
        seen: set[int] = set()
        stack = [target]
        while stack:
            i = stack[-1]
            waiting = {a for a in self.nodes[i].args if not self.done[a] and a not in seen}
            if i in seen:
                stack.pop()
            elif waiting:
                stack += sorted(waiting, key=lambda a: (self.needs[a], -a))
            else:
                stack.pop()
                found = [i, *self.together.get(i, ())]
                order += found
                seen.update(found)
        return order


def _together(nodes: Sequence[Node]) -> dict[int, list[int]]:
    found: dict[int, list[int]] = {}
    for i, node in enumerate(nodes):
        if node.op is Op.PART:
            found.setdefault(node.args[0], []).append(i)
    return found
