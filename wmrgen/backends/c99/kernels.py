"""The kernels of a C file: static functions of its own, which its other functions call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from wmrgen.backends.c99.comment import WIDTH, block_comment
from wmrgen.backends.c99.style import style
from wmrgen.backends.expression import Results, body
from wmrgen.ir.nodes import Function, Op

PREFIX = "wmrgen_"
_TYPES: dict[tuple[str, ...], str] = {
    ("x", "y"): "vector",
    ("spin", "steer"): "wheel",
}  # of results; other kernels have one that is called as they are


@dataclass(frozen=True, slots=True)
class Kernel:
    """A static function, ready to print. ``struct``: (type, members) of its results where there are several."""

    guard: str
    comment: tuple[str, ...]
    prototype: str
    lines: tuple[str, ...]
    ops: frozenset[Op]
    struct: tuple[str, tuple[str, ...]] | None = None


def results_of(kernels: Sequence[Function], scalar: str) -> dict[str, Results]:
    """How the results of each kernel are named in C."""
    found = {}
    for kernel in kernels:
        members = tuple(port.name for port in kernel.outputs)
        kind = scalar if len(members) == 1 else _type(kernel)
        found[kernel.name] = Results(PREFIX + kernel.name, kind, members)
    return found


def printed_kernels(kernels: Sequence[Function], scalar: str) -> tuple[Kernel, ...]:
    """``kernels``, those that are called before those that call."""
    results = results_of(kernels, scalar)
    return tuple(_kernel(kernel, scalar, results) for kernel in kernels)


def _type(kernel: Function) -> str:
    members = tuple(port.name for port in kernel.outputs)
    return PREFIX + _TYPES.get(members, f"{kernel.name}_result")


def _kernel(kernel: Function, scalar: str, results: Mapping[str, Results]) -> Kernel:
    code = body(kernel, str, style(scalar), kernels=results, names=_names(kernel), apart=_shared(kernel))
    own = results[kernel.name]
    lines = [*code.statements, *([""] if code.statements else [])]
    struct = None
    if len(own.members) == 1:
        lines.append(f"return {code.results[0]};")
    else:
        struct = own.type, own.members
        lines = [f"{own.type} result;", *lines]
        lines += [f"result.{m} = {text};" for m, text in zip(own.members, code.results, strict=True)]
        lines.append("return result;")
    parameters = [f"{scalar} {port.name}" for port in kernel.inputs]
    return Kernel(
        own.function.upper(),
        tuple(block_comment([kernel.text])),
        _prototype(own.type, own.function, parameters),
        tuple(lines),
        code.ops,
        struct,
    )


def _names(kernel: Function) -> dict[int, str]:
    """Nodes as the formula calls them, but for names of parameters."""
    taken = {"result", *(port.name for port in kernel.inputs)}
    names = {k: name for name, k in reversed(kernel.named) if name not in taken}
    return names if len(set(names.values())) == len(names) else {}


def _shared(kernel: Function) -> set[int]:
    """Sizes and signs of inputs: calls have inputs in common, and a compiler shares what no choice depends on."""
    nodes = kernel.nodes
    return {
        k
        for k, node in enumerate(nodes)
        if node.op in (Op.ABS, Op.WITH_SIGN_OF)
        and all(nodes[a].op in (Op.INPUT, Op.CONST) for a in node.args)
    }


def _prototype(kind: str, name: str, parameters: Sequence[str]) -> str:
    head = f"WMRGEN_KERNEL {kind} {name}("
    line = f"{head}{', '.join(parameters)})"
    return line if len(line) < WIDTH else head + "\n    " + ", ".join(parameters) + ")"
