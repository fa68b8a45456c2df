"""Rust: a `no_std` crate, straight-line code over structs with named wheels.

In come the functions that C has, with the same kernels; out go the files of a crate, and values computed by the
compiled crate. The crate performs the operations of the C in the same order, so results have the same bits.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from struct import pack, unpack
from typing import NamedTuple

from wmrgen.codegen.compiler import run_rust
from wmrgen.codegen.registry import Request
from wmrgen.codegen.render import render
from wmrgen.codegen.rust.emit import emit, library
from wmrgen.codegen.rust.functions import block, scalar_of, step_of, unit
from wmrgen.codegen.rust.text import crate
from wmrgen.codegen.unit import Unit
from wmrgen.ir.calls import in_order, nominal
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Function, Module, contract

__all__ = ["emit", "evaluate"]


# ---- a program that calls the functions of a crate; it exchanges numbers as the bits of doubles

FLAGS = ("-Copt-level=1",)


def evaluate(
    module: Module, cases: Sequence[Request], flags: Sequence[str] = FLAGS, **words: str
) -> list[dict[str, float]]:
    """Compile the crate and return the outputs of each case by contract name.

    Args:
        module: The functions of the robot.
        cases: Names of functions with their inputs; tunable parameters that are left out are nominal.
        flags: Flags of the compiler.
        **words: Fields of `Choice`: scalar, math, target.

    Raises:
        EnvironmentFailure: There is no Rust compiler, or it fails.
    """
    functions, default = unit(module, Choice(**words)), nominal(module)
    names = dict.fromkeys(name for name, _ in cases)
    calls = {name: _call(functions, module.function(name), default) for name in names}
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
    """A function of the program."""

    inputs: tuple[str, ...]  # contract names
    outputs: Mapping[str, int]  # contract name -> index among the printed values
    lines: tuple[str, ...]  # statements

    def answer(self, line: bytes) -> dict[str, float]:
        values = unpack(f">{len(self.outputs)}d", line)
        return {name: values[k] for name, k in self.outputs.items()}


def _call(functions: Unit, function: Function, tunables: Iterable[str]) -> _Call:
    inputs, step = tuple(port.name for port in contract(function)), step_of(functions, function.name)
    if step is None:
        return _Call(inputs, {}, ("vec![]",))
    if functions.before([step]):
        inputs += tuple(tunables)
    values = {name: f"x[{k}] as {scalar_of(functions)}" for k, name in enumerate(inputs)}
    printed = tuple(port.name for port in function.outputs)

    def doubles(places: Mapping[str, str]) -> str:
        return f"vec![{', '.join(f'f64::from({places[name]})' for name in printed)}]"

    lines = block(functions, step, values, doubles)[1:-1]
    return _Call(inputs, {name: k for k, name in enumerate(printed)}, tuple(lines))
