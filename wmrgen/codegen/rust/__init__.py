"""Rust: a `no_std` crate, straight-line code over structs with named wheels; the operations of the C, so its bits."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from struct import pack, unpack
from typing import NamedTuple

from wmrgen.codegen.compiler import run_rust
from wmrgen.codegen.registry import Request
from wmrgen.codegen.render import render
from wmrgen.codegen.rust.emit import emit, library
from wmrgen.codegen.rust.functions import unit
from wmrgen.codegen.rust.records import Unit
from wmrgen.codegen.rust.types import crate
from wmrgen.ir.calls import in_order, nominal
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Function, Module, contract

__all__ = ["emit", "evaluate"]


# ---- a program that calls the functions of a crate: how the printed Rust is run. Numbers cross the border as bits

FLAGS = ("-Copt-level=1",)


def evaluate(
    module: Module, cases: Sequence[Request], flags: Sequence[str] = FLAGS, **words: str
) -> list[dict[str, float]]:
    """Outputs by contract name of each case, from the Rust of the `Choice` that ``words`` say, compiled with ``flags``.
    A tunable left out is nominal."""
    functions, default = unit(module, Choice(**words)), nominal(module)
    calls = {
        name: _call(functions, module.function(name), default) for name in dict.fromkeys(n for n, _ in cases)
    }
    place = {name: number for number, name in enumerate(calls)}
    requests = []
    for name, case in cases:
        values = in_order(name, calls[name].inputs, {**default, **case})
        requests.append(" ".join([str(place[name]), *(pack(">d", value).hex() for value in values)]))
    program = render(
        "rust/driver.rs.j2", crate=crate(module.name), calls=[call.lines for call in calls.values()]
    )
    printed = run_rust(crate(module.name), library(functions), program, "\n".join(requests), flags)
    answers = zip(cases, printed.splitlines(), strict=True)
    return [calls[name].answer(bytes.fromhex(line)) for (name, _), line in answers]


class _Call(NamedTuple):
    """A function of the program. ``outputs``: those of the contract, each with its place among what is printed."""

    inputs: tuple[str, ...]
    outputs: Mapping[str, int]
    lines: tuple[str, ...]

    def answer(self, line: bytes) -> dict[str, float]:
        values = unpack(f">{len(self.outputs)}d", line)
        return {name: values[k] for name, k in self.outputs.items()}


def _call(functions: Unit, function: Function, tunables: Iterable[str]) -> _Call:
    inputs, step = tuple(port.name for port in contract(function)), functions.step(function.name)
    if step is None:
        return _Call(inputs, {}, ("vec![]",))
    if any(p.name == "prepared" for p in step.parameters):
        inputs += tuple(tunables)
    values = {name: f"x[{k}] as {functions.scalar}" for k, name in enumerate(inputs)}
    lines = functions.block(step, values, _doubles)[1:-1]
    place = {name: k for k, name in enumerate(step.outputs)}
    return _Call(inputs, {port.name: place[port.name] for port in function.outputs}, tuple(lines))


def _doubles(places: Mapping[str, str]) -> str:
    return f"vec![{', '.join(f'f64::from({place})' for place in places.values())}]"
