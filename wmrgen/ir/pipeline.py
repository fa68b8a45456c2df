"""The order of the passes, and the check of what they did."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

from wmrgen.ir.calls import inlined_calls
from wmrgen.ir.nodes import Function, Module, Port, Role
from wmrgen.ir.passes.dead_code import drop_dead_code
from wmrgen.ir.passes.forms import share_linear_forms
from wmrgen.ir.passes.hoist import hoist
from wmrgen.ir.passes.schedule import schedule
from wmrgen.ir.passes.simplify import canonicalise, factor, reduce_strength, regroup_products, settle_signs
from wmrgen.ir.verify import check_module, verify_function, verify_module

Pass = Callable[[Function], Function]

BEFORE_HOIST: tuple[Pass, ...] = (
    canonicalise, reduce_strength, factor, share_linear_forms, regroup_products, settle_signs,
)  # fmt: skip
AFTER_HOIST: tuple[Pass, ...] = (drop_dead_code, schedule)


def optimise(
    functions: tuple[Function, ...],
    name: str,
    verify: bool = False,
    kernels: tuple[Function, ...] = (),
    meaning: tuple[Function, ...] | None = None,
) -> Module:
    """The module of ``functions``, which call ``kernels``, in as few operations as the passes find.

    The result is always checked against ``meaning``, the functions in base operations (``functions`` themselves where
    they call nothing), at one point, modulo a prime; ``verify`` checks every pass at several exact points.
    """
    steps = tuple(_run(function, BEFORE_HOIST, verify) for function in functions)
    module = replace(hoist(steps, name), kernels=kernels)
    if verify:
        verify_module(steps, module, "hoist")
    steps = tuple(_run(function, AFTER_HOIST, verify) for function in module.functions)
    prepare = None if module.prepare is None else _prepare(module.prepare, verify)
    said = zip(steps, functions, strict=True)
    steps = tuple(replace(step, variant_of=f.variant_of, limits=f.limits) for step, f in said)
    module = Module(name, steps, prepare, kernels)
    plain, functions = inlined_calls(module), functions if meaning is None else meaning
    if verify:
        verify_module(functions, plain, "the pipeline", 3)
    else:
        check_module(functions, plain, "the pipeline")
    return module


@lru_cache(maxsize=64)  # the two modules of a robot have functions in common
def _run(function: Function, passes: tuple[Pass, ...], verify: bool) -> Function:
    for step in passes:
        changed = step(function)
        if verify:
            verify_function(function, changed, step.__name__)
        function = changed
    return function


def _prepare(prepare: Function, verify: bool) -> Function:
    """`prepare` through the same passes, its parameters taken for ordinary inputs."""
    roles = {port.name: port for port in prepare.inputs}

    def plain(port: Port) -> Port:
        return replace(port, role=Role.STATE)

    ordinary = replace(prepare, inputs=tuple(plain(port) for port in prepare.inputs))
    run = _run(ordinary, BEFORE_HOIST + AFTER_HOIST, verify)
    return replace(run, inputs=tuple(roles[port.name] for port in run.inputs))
