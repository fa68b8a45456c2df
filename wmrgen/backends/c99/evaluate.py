"""Evaluate generated C: a driver that calls every function of one or many robots, fed through stdin.

Numbers cross the border as hexadecimal floats, so nothing is rounded on the way. Inputs are doubles and
are rounded once, by the driver, to the target type.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from wmrgen.backends.c99.emit import Meta, Unit, sources, unit
from wmrgen.backends.c99.text import Struct
from wmrgen.compiler import DEFAULT_FLAGS, compile_and_run
from wmrgen.errors import UsageError
from wmrgen.ir.kernels.choice import DEFAULT
from wmrgen.ir.nodes import Module
from wmrgen.render import render


@dataclass(frozen=True, slots=True)
class Call:
    """One wrapper of the driver: reads ``inputs`` and writes ``outputs``, contract names in this order."""

    robot: str
    function: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    lines: tuple[str, ...]


def _fill(struct: Struct, variable: str, scalar: str, start: int) -> list[str]:
    return [f"{variable}.{m} = ({scalar})x[{start + k}];" for k, m in enumerate(struct.members.values())]


def calls(made: Unit) -> tuple[Call, ...]:
    """One call per step function; the tunables, where there are any, are its last inputs."""
    by_name = {s.name: s for s in made.steps}
    prepare = by_name.get(f"{made.robot}_prepare")
    result = []
    for step in made.steps:
        if step is prepare or step.name == f"{made.robot}_params_default":
            continue
        out = step.arguments[-1][0]
        declare = [f"{out.name} out;"]
        fill: list[str] = []
        inputs: tuple[str, ...] = ()
        for struct, parameter in step.arguments[:-1]:
            declare.append(f"{struct.name} {parameter};")
            if parameter == "in":
                fill += _fill(struct, "in", made.scalar, 0)
                inputs = tuple(struct.members)
        if prepare is not None and any(parameter == "prepared" for _, parameter in step.arguments):
            if len(prepare.arguments) > 1:
                params = prepare.arguments[0][0]
                declare.append(f"{params.name} params;")
                fill += _fill(params, "params", made.scalar, len(inputs))
                inputs += tuple(params.members)
            passed = ", ".join(f"&{parameter}" for _, parameter in prepare.arguments)
            fill.append(f"{prepare.name}({passed});")
        fill.append(f"{step.name}({', '.join(f'&{parameter}' for _, parameter in step.arguments)});")
        fill += [f"y[{k}] = (double)out.{m};" for k, m in enumerate(out.members.values())]
        unused = [] if inputs else ["(void)x;"]
        result.append(Call(made.robot, step.name, inputs, tuple(out.members), (*declare, *unused, *fill)))
    return tuple(result)


def driver(made: Sequence[Call]) -> str:
    """The C of a program that reads ``index inputs…`` lines and prints the outputs of each."""
    robots = list(dict.fromkeys(call.robot for call in made))
    most_in = max([1, *(len(call.inputs) for call in made)])
    most_out = max([1, *(len(call.outputs) for call in made)])
    return render("c99/driver.c.j2", robots=robots, calls=made, most_in=most_in, most_out=most_out)


def request(index: int, call: Call, values: Mapping[str, float]) -> str:
    """One line for the driver. UsageError where an input has no value."""
    missing = [name for name in call.inputs if name not in values]
    if missing:
        raise UsageError(f"{call.function} needs a value for {', '.join(missing)}")
    return " ".join([str(index), *(float(values[name]).hex() for name in call.inputs)])


def answer(call: Call, line: str) -> dict[str, float]:
    """Outputs by contract name from one line of the driver."""
    return dict(zip(call.outputs, map(float.fromhex, line.split()), strict=True))


def nominal(module: Module) -> dict[str, float]:
    """Nominal values of the tunable parameters of ``module``."""
    ports = [
        port for f in (*module.functions, *([module.prepare] if module.prepare else [])) for port in f.inputs
    ]
    return {port.name: float(port.default) for port in ports if port.default is not None}


def evaluate_c(
    module: Module,
    function: str,
    cases: Sequence[Mapping[str, float]],
    scalar: str = DEFAULT.scalar,
    cc: str | None = None,
    flags: Sequence[str] = DEFAULT_FLAGS,
    math: str = DEFAULT.math,
    target: str = DEFAULT.target,
) -> list[dict[str, float]]:
    """Outputs of ``function`` for each case, from the compiled C. A tunable left out is nominal."""
    made = calls(unit(module, scalar, math, target))
    wanted = [k for k, call in enumerate(made) if call.function == f"{module.name}_{function}"]
    if not wanted:
        return [{} for _ in cases]  # a function without outputs
    call = made[wanted[0]]
    header, source = sources(module, Meta(scalar=scalar, math=math, target=target))
    files = {f"{module.name}.h": header, f"{module.name}.c": source, "wmrgen-driver.c": driver(made)}
    default = nominal(module)
    lines = [request(wanted[0], call, {**default, **case}) for case in cases]
    printed = compile_and_run(files, "\n".join(lines) + "\n", cc, flags)
    return [answer(call, line) for line in printed.splitlines()]


def evaluate(
    module: Module,
    function: str,
    cases: Sequence[Mapping[str, float]],
    scalar: str = DEFAULT.scalar,
    math: str = DEFAULT.math,
    target: str = DEFAULT.target,
) -> list[dict[str, float]]:
    """`evaluate_c` with the system compiler, in the scalar type that derive writes unless told otherwise."""
    return evaluate_c(module, function, cases, scalar, math=math, target=target)
