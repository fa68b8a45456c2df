"""Deterministic inputs for the functions of a module."""

from __future__ import annotations

import random

from wmrgen.ir.nodes import Function, Module, Role

_RANGE = {"m": 2.0, "m/s": 2.0, "rad": 3.2, "rad/s": 4.0, "s": 0.2}


def input_names(module: Module, function: Function) -> list[str]:
    """Return the inputs that a caller sets, then the tunable parameters, also those that only `prepare` reads."""
    names = [port.name for port in function.inputs if port.role is not Role.PREPARED]
    if module.prepare and any(port.role is Role.PREPARED for port in function.inputs):
        names += [port.name for port in module.prepare.inputs if port.name not in names]
    return names


def samples(module: Module, function: Function, count: int) -> list[dict[str, float]]:
    """Standstill, each input alone, then random ones; tunables within 10 % of their nominal values."""
    source = random.Random(f"{module.name}.{function.name}")
    ports = {port.name: port for port in function.inputs}
    ports |= {port.name: port for port in (module.prepare.inputs if module.prepare else ())}
    names = input_names(module, function)
    cases = [{n: float(ports[n].default or 0) for n in names}]
    for name in names:
        if ports[name].default is None:
            cases.append({**cases[0], name: 0.75})
    for _ in range(count):
        case = {}
        for name in names:
            nominal = ports[name].default
            size = _RANGE.get(ports[name].unit, 1.0)
            case[name] = (
                source.uniform(-size, size) if nominal is None else float(nominal) * source.uniform(0.9, 1.1)
            )
        cases.append(case)
    return cases
