"""``wmrgen prove``: ranges, rounding errors, and that no operation of the generated C is undefined."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.loading import noted
from wmrgen.errors import NotDerivableError

if TYPE_CHECKING:
    from wmrgen.bounds.domain import Range
    from wmrgen.bounds.robot import Bounds, FunctionBound, OutputBound
    from wmrgen.ir.nodes import Function
    from wmrgen.robot import Derivation

_TOOL = "frama-c"
_FINER = 5  # how often Eva gets the inputs in smaller parts
_INSTALL = "Debian, Ubuntu: apt-get install frama-c-base"


def run(path: Path, *, as_json: bool) -> int:
    """Our own analysis, then Frama-C Eva where it is installed. NotDerivableError where something is not proved."""
    from wmrgen.bounds.robot import data

    with console.progress() as step:
        step(f"deriving {path}")
        robot = noted(wmrgen.load(path))
        derivation = wmrgen.derive(robot)
        step(f"bounding {robot.name}")
        found = derivation.bounds
        if found.missing:
            raise NotDerivableError(_needed(robot.name, found))
        told = eva(derivation, found, step)
    if as_json:
        console.data({"name": robot.name, **data(found), "eva": told})
    else:
        _show(robot.name, found, told)
    open_ = [f"{f.name}: {text}" for f in found.functions for text in f.alarms] + list(told.get("alarms", []))
    if open_:
        raise NotDerivableError(f"{robot.name}: not proved:\n  " + "\n  ".join(open_))
    return 0


def _needed(name: str, found: Bounds) -> str:
    from wmrgen.bounds.domain import wanted

    return (
        f"{name}: nothing can be proved without limits of {' and '.join(found.missing)}. Write in the robot file, "
        f"with the values of your robot [m/s, rad/s]:\n  {wanted(found.missing)}"
    )


def eva(
    derivation: Derivation, found: Bounds, step: Callable[[str], None] = lambda _: None
) -> dict[str, Any]:
    """What Eva says: its alarms (none is good); why it was not run. ``step`` is told what is looked at."""
    from wmrgen.backends.c99.eva import alarms, command, harness
    from wmrgen.bounds.partition import cases
    from wmrgen.bounds.precision import SINGLE
    from wmrgen.bounds.robot import functions
    from wmrgen.compiler import find_tool, run_tool

    tool = find_tool(_TOOL)
    if tool is None:
        return {"run": False, "reason": f"{_TOOL} is not on the PATH ({_INSTALL})"}
    ranges = {f.name: f.inputs for f in found.functions if not f.unknown}
    chosen = [f for f in functions(derivation.c_module) if f.name in ranges]

    def left(of: Sequence[Function], finer: int) -> tuple[str, ...]:
        """Alarms of some functions. Smaller parts help only with sines that are known on them."""
        parts = {f.name: cases(f, ranges[f.name], SINGLE, finer) for f in of}
        files = harness(derivation.c_module, parts, waves=finer > 0)
        count = sum(map(len, parts.values()))
        what = f"{of[0].name}, {count} part{'s' * (count > 1)}" if len(of) == 1 else "all functions"
        step(f"running {_TOOL} on {derivation.robot.name}: {what}")
        return alarms(run_tool(command(tool, derivation.robot.name, finer > 0), files))

    open_ = left(chosen, 0)
    if open_:
        open_ = tuple(text for f in chosen for text in _persistent(partial(left, [f])))
    return {"run": True, "alarms": list(open_)}


def _persistent(left: Callable[[int], tuple[str, ...]]) -> tuple[str, ...]:
    """The alarms that remain however small the parts are."""
    found: tuple[str, ...] = ()
    for finer in range(_FINER):
        found = left(finer)
        if not found:
            break
    return found


def _show(name: str, found: Bounds, eva: Mapping[str, Any]) -> None:
    from wmrgen.bounds.text import described

    limits = ", ".join(_limit(n, r) for n, r in found.declared.items())
    console.result(f"{name}: float, {described(found.library)}")
    console.result(f"  limits: {limits}")
    if found.assumed:
        console.result(f"  assumed: {', '.join(_limit(n, r) for n, r in found.assumed.items())}")
    for f in found.functions:
        _function(f, found.declared)
    if eva["run"]:
        count = len(eva["alarms"])
        console.result(
            f"Frama-C Eva, of --math libm --target host: {count or 'no'} alarm{'s' * (count > 1)}", "bold"
        )
    else:
        console.note(f"Frama-C Eva was not run: {eva['reason']}")


def _limit(name: str, r: tuple[float, float]) -> str:
    low, high = r
    return f"|{name}| <= {high:g}" if low == -high else f"{low:g} <= {name} <= {high:g}"


def _function(f: FunctionBound, declared: Mapping[str, Range]) -> None:
    from wmrgen.bounds.domain import wanted
    from wmrgen.bounds.robot import SINGULAR

    if f.unknown:
        console.result(f"{f.name}: not looked at, no range for {', '.join(f.unknown)}", "bold")
        console.result(f"  needs {wanted(f.unknown)}")
        return
    console.result(
        f"{f.name}: {'no NaN, infinity or division by zero' if f.proved else 'not proved'}", "bold"
    )
    for text in f.alarms:
        console.result(f"  {text}")
    free = tuple(n for n in f.inputs if n.endswith(".steer") and n not in declared)
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
        return f"{o.error:.2g} + {o.per_length:.2g}/h, pivot's speed h >= {o.from_length:.2g} m/s"
    return f"{o.error:.2g}" + (f", pivot's speed >= {o.from_length:.2g} m/s" if o.from_length else "")
