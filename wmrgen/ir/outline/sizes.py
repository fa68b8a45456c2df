"""Bytes of code that operations take, roughly: what a part that is written once must save."""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.ir.kernels.choice import AVR, M0
from wmrgen.ir.nodes import Node, Op

LEAST_OPERATIONS = 3  # of a part
MOST_PARAMETERS = 6
MOST_RESULTS = 4  # a struct of four floats is handed back in registers by processors with an FPU


@dataclass(frozen=True, slots=True)
class Sizes:
    """``operation``: an arithmetic one; ``constant``: to have one at hand; ``move``: to hand a value over.

    ``call``: the branch, and ``frame`` what a function takes beside its operations.
    """

    operation: int
    constant: int
    move: int
    call: int
    frame: int

    def of(self, node: Node) -> int:
        """Bytes of an operation without its constants."""
        match node.op:
            case Op.SELECT:
                return 3 * self.operation
            case Op.MIN | Op.MAX | Op.FLIP_BIT:
                return 2 * self.operation
            case Op.CALL:
                return self.call + self.move * len(node.args)
            case Op.PART:
                return self.move
        return self.operation if node.args else 0


FPU = Sizes(operation=5, constant=6, move=3, call=4, frame=8)
SOFT = Sizes(operation=10, constant=6, move=4, call=4, frame=12)
BYTES = Sizes(operation=14, constant=8, move=8, call=4, frame=40)  # eight bits: a float is moved byte by byte


def sizes(target: str) -> Sizes:
    """What operations take on a processor of ``target``."""
    return {M0: SOFT, AVR: BYTES}.get(target, FPU)
