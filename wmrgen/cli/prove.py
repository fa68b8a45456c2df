"""``wmrgen prove``: ranges, rounding errors, and that no operation of the generated C is undefined."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.loading import noted
from wmrgen.codegen import compiler
from wmrgen.codegen.c.driver import alarms, command, harness
from wmrgen.errors import NotDerivableError
from wmrgen.ir.bounds.assumptions import wanted
from wmrgen.ir.bounds.partition import cases
from wmrgen.ir.bounds.robot import (
    SINGULAR,
    TIES,
    Bounds,
    FunctionBound,
    OutputBound,
    beyond,
    data,
    described,
    functions,
    limit,
)

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.ir.nodes import Function

_TOOL = "frama-c"
_FINER = 5  # how often Eva gets the inputs in smaller parts
_INSTALL = "Debian, Ubuntu: apt-get install frama-c-base"


def prove(robot: Path, as_json: bool) -> int:
    """Our own analysis, then Frama-C Eva where it is installed. NotDerivableError where something is not proved."""
    with console.progress() as step:
        step(f"deriving {robot}")
        derivation = wmrgen.derive(noted(wmrgen.load(robot)))
        name = derivation.robot.name
        step(f"bounding {name}")
        bounds = derivation.bounds
        if bounds.missing:
            raise NotDerivableError(
                f"{name}: nothing can be proved without limits of {' and '.join(bounds.missing)}. Write in the robot "
                f"file, with the values of your robot [m/s, rad/s]:\n  {wanted(bounds.missing)}"
            )
        verdict = eva(derivation, bounds, step)
    if as_json:
        console.data({"name": name, **data(bounds), "eva": verdict})
    else:
        _show(name, bounds, verdict)
    unproved = [f"{f.name}: {text}" for f in bounds.functions for text in f.alarms] + list(
        verdict.get("alarms", [])
    )
    if unproved:
        raise NotDerivableError(f"{name}: not proved:\n  " + "\n  ".join(unproved))
    return 0


def eva(
    derivation: Derivation, bounds: Bounds, step: Callable[[str], None] = lambda _: None
) -> dict[str, Any]:
    """What Eva says: its alarms (none is good); why it was not run. ``step`` is told what is looked at."""
    tool = compiler.find_tool(_TOOL)
    if tool is None:
        return {"run": False, "reason": f"{_TOOL} is not on the PATH ({_INSTALL})"}
    ranges = {f.name: f.inputs for f in bounds.functions if not f.unknown}
    chosen = [f for f in functions(derivation.c_module) if f.name in ranges]

    def alarms_of(of: Sequence[Function], finer: int) -> tuple[str, ...]:
        """Alarms of some functions. Smaller parts help only with sines that are known on them."""
        parts = {f.name: cases(f, ranges[f.name], finer) for f in of}
        files = harness(derivation.c_module, parts, waves=finer > 0)
        count = sum(map(len, parts.values()))
        what = f"{of[0].name}, {count} part{'s' * (count > 1)}" if len(of) == 1 else "all functions"
        step(f"running {_TOOL} on {derivation.robot.name}: {what}")
        return alarms(compiler.run_tool(command(tool, derivation.robot.name, finer > 0), files))

    raised = alarms_of(chosen, 0)
    if raised:
        raised = tuple(text for f in chosen for text in _persistent(partial(alarms_of, [f])))
    return {"run": True, "alarms": list(raised)}


def _persistent(alarms_with: Callable[[int], tuple[str, ...]]) -> tuple[str, ...]:
    """The alarms that remain however small the parts are."""
    raised: tuple[str, ...] = ()
    for finer in range(_FINER):
        raised = alarms_with(finer)
        if not raised:
            break
    return raised


def _show(name: str, bounds: Bounds, eva: Mapping[str, Any]) -> None:
    limits = ", ".join(limit(n, r) for n, r in bounds.declared.items())
    console.result(f"{name}: float, {described(bounds.library)}")
    console.result(f"  limits: {limits}")
    if bounds.assumed:
        console.result(f"  assumed: {', '.join(limit(n, r) for n, r in bounds.assumed.items())}")
    if bounds.steers:
        console.result(f"  {TIES}")
    for f in bounds.functions:
        _function(f, bounds)
    if eva["run"]:
        count = len(eva["alarms"])
        console.result(
            f"Frama-C Eva, of --math libm --target host: {count or 'no'} alarm{'s' * (count > 1)}", "bold"
        )
    else:
        console.note(f"Frama-C Eva was not run: {eva['reason']}")


def _function(f: FunctionBound, bounds: Bounds) -> None:
    if f.unknown:
        console.result(f"{f.name}: not looked at, no range for {', '.join(f.unknown)}", "bold")
        console.result(f"  needs {wanted(f.unknown)}")
        return
    console.result(
        f"{f.name}: {'no NaN, infinity or division by zero' if f.proved else 'not proved'}", "bold"
    )
    if wider := beyond(f, bounds):
        console.result(f"  of {', '.join(limit(n, r) for n, r in wider.items())}")
    for text in f.alarms:
        console.result(f"  {text}")
    free = tuple(n for n in f.inputs if n.endswith(".steer") and n not in bounds.declared)
    if free and (f.alarms or any(o.singular for o in f.outputs)):
        console.result(f"  {', '.join(free)} may have any value; perhaps it needs {wanted(free)}")
    width = max((len(o.name) for o in f.outputs), default=0)
    for o in f.outputs:
        if o.singular:
            console.result(f"  {o.name:<{width}}  no bound: {SINGULAR}")
            continue
        span = f"[{o.low:.6g}, {o.high:.6g}] {o.unit}"
        console.result(f"  {o.name:<{width}}  {span:<32} error {_error(o)}")


def _error(o: OutputBound) -> str:
    if o.per_length:
        return f"{o.error:.2g} + {o.per_length:.2g}/speed, speed of its pivot >= {o.from_length:.2g} m/s"
    return f"{o.error:.2g}" + (f", pivot's speed >= {o.from_length:.2g} m/s" if o.from_length else "")
