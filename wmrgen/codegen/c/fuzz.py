"""``test/<robot>_fuzz.c``, with ``--fuzz``: a libFuzzer harness of the checked functions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from wmrgen.codegen.c.checked import Guarded, Safe, about, guarded
from wmrgen.codegen.c.records import Unit
from wmrgen.codegen.render import render
from wmrgen.geometry.ports import Site
from wmrgen.ir.nodes import Module

ABOUT = (
    "Fuzzing harness for libFuzzer: clang -g -O1 -fsanitize=fuzzer,address,undefined,float-divide-by-zero "
    "test/{0}_fuzz.c {0}_checked.c {0}.c -lm. Every function gets inputs of any bit pattern and inputs spread over "
    "their range. What was accepted must give numbers, and commanded steering angles inside their limits; what was "
    "refused must give the safe outputs.",
)


def fuzz(module: Module, unit: Unit, site: Site, common: Mapping[str, object]) -> str:
    """The text of the file; arguments as of `checked`."""
    accepting = [*guarded(module, unit, site)]
    prepare = next((g for g in accepting if g.prepares), None)
    tried = [_tried(unit, g, prepare) for g in accepting]
    return render("c99/fuzz.c.j2", **common, about=about(ABOUT, unit.robot), functions=tried)


def _tried(unit: Unit, guarded: Guarded, prepare: Guarded | None) -> dict[str, Any]:
    """A function that is tried, ready to print; ``prepare``: what checks its parameters, which are tried too."""
    step = guarded.step
    variables = unit.variables(step)
    changed = {variable for output in guarded.outputs if (variable := _changed(guarded, output))}
    before = [p for p in step.parameters if p.name in changed]
    fill = _any(guarded)
    if guarded.prepares:
        variables |= {"nominal": variables["params"], "expected": variables["prepared"]}
    elif prepare is not None and "prepared" in variables:
        fill = [*_any(prepare), f"(void){_call(prepare)};", *fill]
    else:
        fill = [*(f"{called.call()};" for called in unit.before([step])), *fill]
    return {
        "name": step.name.removeprefix(f"{unit.robot}_"),
        "declare": [f"{kind} {name};" for name, kind in variables.items()]
        + [f"{p.type} {p.name}_before;" for p in before],
        "poisoned": [p.name for p in step.parameters if p.writes and not p.reads],
        "fill": [*fill, *(f"{p.name}_before = {p.name};" for p in before)],
        "call": _call(guarded),
        "accepted": _accepted(guarded),
        "refused": _refused(guarded, unit.robot),
    }


def _call(guarded: Guarded) -> str:
    return guarded.step.call(ending="_checked")


def _any(guarded: Guarded) -> list[str]:
    """The statements that fill the inputs."""
    inputs = guarded.step.inputs
    return [f"{inputs[r.port.name]} = any(&bytes, {r.low}, {r.high});" for r in guarded.ranges]


def _accepted(guarded: Guarded) -> list[str]:
    """The statements that hold after inputs were accepted."""
    if guarded.prepares:
        reads = [(guarded.step.inputs[r.port.name], r) for r in guarded.ranges]
        near = [f"must(({read} >= {r.low}) && ({read} <= {r.high}));" for read, r in reads]
        return [*near, f"{guarded.step.call({'prepared': 'expected'})};", *_as_expected(guarded)]
    return [f"must({test});" for output in guarded.outputs for test in _numbers(guarded, output)]


def _refused(guarded: Guarded, robot: str) -> list[str]:
    """The statements that hold after inputs were refused."""
    if guarded.prepares:
        nominal = {"params": "nominal", "prepared": "expected"}
        calls = [f"{robot}_params_default(&nominal);", f"{guarded.step.call(nominal)};"]
        return [*calls, *_as_expected(guarded)]
    return [f"must({_is_safe(guarded, output)});" for output in guarded.outputs]


def _as_expected(guarded: Guarded) -> Iterator[str]:
    for member in guarded.step.outputs.values():
        expected = member.replace("prepared.", "expected.")
        yield f"must(is_number({member}) && ({member} == {expected}));"


def _numbers(guarded: Guarded, output: Safe) -> Iterator[str]:
    read = guarded.step.outputs[output.port.name]
    yield f"is_number({read})"
    if output.limit and guarded.keeps:
        yield f"({read} >= {output.limit[0]}) && ({read} <= {output.limit[1]})"


def _changed(guarded: Guarded, output: Safe) -> str:
    """The variable in whose place an output that is held is written."""
    present = guarded.step.inputs[output.port.name] if output.held and not output.limit else ""
    return present.partition(".")[0] if present == guarded.step.outputs[output.port.name] else ""


def _is_safe(guarded: Guarded, output: Safe) -> str:
    read = guarded.step.outputs[output.port.name]
    if output.limit:
        return f"({read} >= {output.limit[0]}) && ({read} <= {output.limit[1]})"
    if output.held:
        present = guarded.step.inputs[output.port.name]
        if variable := _changed(guarded, output):
            present = f"{variable}_before{present.removeprefix(variable)}"
        return f"is_number({present}) ? ({read} == {present}) : ({read} == 0)"
    return f"{read} == 0"
