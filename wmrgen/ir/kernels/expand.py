"""Functions as the C back end computes them: kernels in place of library calls.

Runs after optimisation and its exact checks. The result is float code, operation by operation, whose bits the float32
interpreter predicts on every target. It is no longer exact algebra, so no pass except `schedule` may follow.
"""

from __future__ import annotations

from dataclasses import replace

from wmrgen.geometry.exact.number import ONE
from wmrgen.ir.calls import called, inlined_calls
from wmrgen.ir.kernels.choice import AVR, DEFAULT, INLINE, LIBM, M0, M4F
from wmrgen.ir.kernels.cycles import fused_pays
from wmrgen.ir.kernels.sums import compensated_sum, fuse, rounding_error
from wmrgen.ir.kernels.trigonometry import EVEN32, RINT32, RINT64, Processor, flipped, library, soft
from wmrgen.ir.nodes import Function, Module, Node, Op, rebuilt, schedule, shared, uses_of
from wmrgen.ir.tape import Tape, compared

_INTEGER = {Op.SIN: Op.ISIN, Op.COS: Op.ICOS, Op.ATAN: Op.IATAN}


def expand(module: Module, scalar: str, math: str, target: str = DEFAULT.target) -> Module:
    """Return a module in operations of C: rounding and signs as arithmetic, float functions as kernels or libm calls.

    Args:
        module: the optimised module.
        scalar: "float" or "double".
        math: "inline" or "libm".
        target: the processor, see `wmrgen.ir.kernels.choice.Choice`.

    Returns:
        The module, without calls of kernels.
    """
    return inlined_calls(with_kernels(module, scalar, math, target))


def with_kernels(module: Module, scalar: str, math: str, target: str) -> Module:
    """Return `expand` of a module with calls of kernels: its own, and those of its sines and arctangents.

    Args:
        module: the optimised module.
        scalar: "float" or "double".
        math: "inline" or "libm".
        target: the processor.

    Returns:
        The module, with the kernels that it calls.
    """
    if scalar != "float" or target == AVR:
        math = LIBM
    processor = processor_of(scalar, math, target)
    prepare = module.prepare
    if prepare is not None:
        prepare = _Expansion(prepare, processor_of(scalar, LIBM, target)).run()
    common = library(processor)
    by_library = {kernel.name for kernel in common}
    vectors = "vector_at" in called(module.functions)
    own = tuple(
        _Expansion(f, processor, vectors).run(kernel=True) for f in module.kernels if f.name not in by_library
    )
    functions = tuple(
        _Expansion(f, processor, vectors, _results_of_both(f, module)).run() for f in module.functions
    )
    return replace(module, functions=functions, prepare=prepare, kernels=_needed(functions, (*common, *own)))


def processor_of(scalar: str, math: str, target: str) -> Processor:
    """Return what a processor computes with.

    Args:
        scalar: "float" or "double".
        math: "inline" or "libm".
        target: the processor.

    Returns:
        The properties on which the expansion depends.
    """
    single = scalar == "float"
    inline = math == INLINE
    return Processor(
        inline=inline,
        fused=single and fused_pays(target),
        shared=single and fused_pays(target, copied=True),
        bits=single and target in (M4F, M0),
        integer=inline and target == M0,
        single=single,
    )


def _results_of_both(function: Function, module: Module) -> tuple[int, ...]:
    """Return the numbers of the results that a variant shares with its function, if ``module`` has both."""
    names = {port.name for f in module.functions if f.name == function.variant_of for port in f.outputs}
    return tuple(k for k, port in enumerate(function.outputs) if port.name in names)


def _needed(functions: tuple[Function, ...], kernels: tuple[Function, ...]) -> tuple[Function, ...]:
    """Return the kernels that are called, directly or by other kernels, in their order."""
    wanted = set(called(functions))
    for kernel in reversed(kernels):
        if kernel.name in wanted:
            wanted |= called((kernel,))
    return tuple(kernel for kernel in kernels if kernel.name in wanted)


def rounds(module: Module) -> bool:
    """Return whether an expanded module rounds to whole numbers by adding a large one."""
    large = (RINT32, EVEN32, RINT64)
    functions = (*module.functions, *module.kernels)
    return any(node.value in large for function in functions for node in function.nodes)


class _Expansion:
    """The expansion of one function, node by node."""

    def __init__(
        self, function: Function, processor: Processor, vectors: bool = False, common: tuple[int, ...] = ()
    ) -> None:
        """Prepare the expansion; `run` does it.

        Args:
            function: the function.
            processor: what it is computed with.
            vectors: whether the module has the kernel for vectors, which then also gives directions (size 1).
            common: results that must have the same bits as in another function. Their nodes are expanded as if there
                were no other results.
        """
        self.processor, self.directions = processor, not vectors
        self.function = function
        self.tape = Tape()
        self.place: list[int] = []
        self.common, self.part = common, shared(function, common)
        self.uses = uses_of(function)
        self.products = {node.args: i for i, node in enumerate(function.nodes) if node.op is Op.MUL}
        self.constants = {i for i, node in enumerate(function.nodes) if node.value is not None}

    def run(self, kernel: bool = False) -> Function:
        """Return the expanded function; ``kernel``: see `wmrgen.ir.kernels.sums.fuse`."""
        for i, node in enumerate(self.function.nodes):
            self.place.append(self._node(i, node))
        expanded = rebuilt(self.function, self.tape.nodes, dict(enumerate(self.place)))
        expanded = fuse(expanded, kernel, self.common) if self.processor.fused else expanded
        return schedule(soft(expanded) if self.processor.integer else expanded)

    def _node(self, i: int, node: Node) -> int:
        tape, args, p = self.tape, tuple(self.place[a] for a in node.args), self.processor
        match node.op:
            case Op.COMPENSATED:
                return compensated_sum(tape, args[0], args[1], p.fused) if p.single else tape.add(*args)
            case Op.ROUNDING_ERROR:
                return rounding_error(tape, *args)
            case Op.RINT:
                magic = tape.const(p.magic)
                return tape.sub(tape.add(args[0], magic), magic)
            case Op.MIN | Op.MAX if node.args[0] in self.constants:
                args = args[::-1]  # the constant last, wherever it was
            case Op.FLIP:
                return self._flip(args[0], node.args[1])
            case Op.MUL:
                quotient = self._quotient(node, i in self.part.nodes)
                return tape.mul(*args) if quotient is None else quotient
            case Op.DIV if not p.bits and self.function.nodes[node.args[1]].op is Op.AT_LEAST:
                return self._quotient_off_zero(args[0], *self.function.nodes[node.args[1]].args)
            case Op.CLAMP | Op.AT_LEAST | Op.WITH_SIGN_OF if not p.bits:
                return compared(tape, node.op, *args)
            case Op.SIN | Op.COS | Op.ATAN if p.integer:
                return tape.put(_INTEGER[node.op], *args)
            case Op.SIN | Op.COS if p.inline:
                size = () if self.directions else (tape.const(ONE),)
                call = tape.call("direction" if self.directions else "vector_at", *size, *args)
                return tape.result(call, int(node.op is Op.SIN))
            case Op.ATAN if p.inline:
                return tape.call("arctangent", *args)
            case Op.ATAN2 if p.inline:
                return tape.call("arctangent2", *args)
        return tape.copy(node, args)

    def _quotient_off_zero(self, above: int, a: int, least: int) -> int:
        """Write above / at_least(a, least) with the sign in the dividend, so that the divisor is visibly positive."""
        tape, a, least = self.tape, self.place[a], self.place[least]
        size = tape.put(Op.MAX, tape.put(Op.ABS, a), least)
        return tape.div(compared(tape, Op.WITH_SIGN_OF, above, a), size)

    def _quotient(self, node: Node, common: bool) -> int | None:
        """Return a (1/b) as a/b, and c (a/b) as (c a)/b if c a is computed anyway; None for other products."""
        nodes, uses = self.function.nodes, self.part.uses if common else self.uses
        for factor, other in (node.args, node.args[::-1]):
            quotient = nodes[other]
            if quotient.op is not Op.DIV or uses[other] > 1:
                continue
            a, b = quotient.args
            if nodes[a].value == ONE:
                return self.tape.div(self.place[factor], self.place[b])
            product = self.products.get((factor, a))
            if product is not None and (not common or product in self.part.nodes):
                return self.tape.div(self.tape.mul(self.place[factor], self.place[a]), self.place[b])
        return None

    def _flip(self, a: int, n: int) -> int:
        """Return a if the whole number n, a node of the function, is even, else -a."""
        tape, whole = self.tape, self.place[n]
        if self.function.nodes[n].op is Op.RINT:
            raised = tape.nodes[whole].args[0]
        else:
            raised = tape.add(whole, tape.const(self.processor.magic))
        return flipped(tape, a, raised, self.processor)
