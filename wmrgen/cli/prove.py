"""``wmrgen prove``: ranges, rounding errors, and that no operation of the generated C is undefined."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robot, verb
from wmrgen.cli.loading import print_notes
from wmrgen.codegen import compiler
from wmrgen.errors import NotDerivableError

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.geometry.layout.records import Robot as Loaded
    from wmrgen.ir.bounds.robot import Bounds, FunctionBound, OutputBound
    from wmrgen.ir.nodes import Function

_TOOL = "frama-c"
_INSTALL = "Debian, Ubuntu: apt-get install frama-c-base"


@verb("prove")
def prove(robot: Robot, as_json: Json = False) -> int:
    """Example:  wmrgen prove robots/pioneer3dx.yaml

    Prove, for all inputs within the limits of the robot file, that no function of the generated C divides by zero or
    gives NaN or infinity. Print the range of every output, and a bound of its rounding error. If Frama-C Eva is
    installed, it looks for alarms too. Exit code 3 if a function is not proved, or needs a limit that the robot file
    does not have. Functions are skipped, with a note, if no limit applies to an input, such as an encoder count.
    """
    from wmrgen.ir.bounds.assumptions import wanted
    from wmrgen.ir.bounds.robot import data

    with console.progress() as step:
        step(f"deriving {robot}")
        derivation = wmrgen.derive(print_notes(wmrgen.load(robot)))
        name = derivation.robot.name
        step(f"bounding {name}")
        bounds = derivation.bounds
        if bounds.missing:
            raise NotDerivableError(
                f"{name}: nothing can be proved without limits of {' and '.join(bounds.missing)}. Write in the robot "
                f"file, with the values of your robot [m/s, rad/s]:\n  {wanted(bounds.missing)}"
            )
        needed = {
            f.name: needed_limits(derivation, bounds, f.name, f.unknown)
            for f in bounds.functions
            if f.unknown
        }
        verdict = eva(derivation, bounds, step)
    unproved = []
    for f in bounds.functions:
        unproved += [f"{f.name}: {text}" for text in f.alarms]
        unproved += [f"{f.name}: needs {text}" for text in needed.get(f.name, ())]
    unproved += verdict.get("alarms", [])
    error = NotDerivableError(f"{name}: not proved:\n  " + "\n  ".join(unproved)) if unproved else None
    if as_json:
        failure = console.all_as_data([error]) if error else {}
        console.data({"name": name, **data(bounds), "eva": verdict, **failure})
    else:
        _show(derivation, bounds, needed, verdict)
    if error is None:
        return 0
    console.failure(str(error))
    return error.exit_code


def needed_limits(
    derivation: Derivation, bounds: Bounds, function: str, inputs: Sequence[str]
) -> tuple[str, ...]:
    """Suggest limits that give each of some inputs of a function a range, or a narrower one.

    Each limit that this robot file could have in addition is tried, first for the robot, then for each wheel.

    Args:
        derivation: the robot.
        bounds: its bounds.
        function: the name of a function of the generated C.
        inputs: some of its inputs.

    Returns:
        What to write, as `limits: {steer_rate: 2.0}`, with the name of the wheel for a limit of a wheel. Empty if some
        input has a range that no limit changes, such as an encoder count.
    """
    from wmrgen.ir.bounds.assumptions import domain, wanted
    from wmrgen.ir.bounds.robot import functions

    code = next(f for f in functions(derivation.c_module) if f.name == function)
    commanded = {o.name: (o.low, o.high) for f in bounds.functions if f.name == "inverse" for o in f.outputs}

    def ranges(robot: Loaded) -> dict[str, tuple[float, float]]:
        where = domain(robot)
        where.commanded.update(commanded)
        return where.of(code)[0]

    now = ranges(derivation.robot)
    lacking = list(inputs)
    keys: dict[str, list[str]] = {}  # the wheel, "" for the robot -> keys of limits
    for wheel, key, limited in _with_one_limit_more(derivation.robot):
        then = ranges(limited)
        helped = [name for name in lacking if name in then and then[name] != now.get(name)]
        if helped:
            keys.setdefault(wheel, []).append(key)
            lacking = [name for name in lacking if name not in helped]
    if lacking:
        return ()
    return tuple(
        wanted(tuple(names)) + (f" of the wheel {wheel}" if wheel else "") for wheel, names in keys.items()
    )


def _with_one_limit_more(robot: Loaded) -> Iterator[tuple[str, str, Loaded]]:
    """Yield the robot with one more limit, for each limit that it could have.

    Each item is the name of the wheel that gets the limit ("" for the robot), the key of the limit, and the robot.
    """
    from wmrgen.geometry.exact.number import ONE
    from wmrgen.geometry.layout.records import Interval
    from wmrgen.robotfile.keys import LIMITS

    trial = Interval(-ONE, ONE)
    for field in LIMITS.fields:
        if field.key not in robot.limits:
            yield "", field.key, replace(robot, limits={**robot.limits, field.key: trial})
    for index, wheel in enumerate(robot.wheels):
        for field in LIMITS.fields:
            if field.joint and field.key not in wheel.limits:
                limited = replace(wheel, limits={**wheel.limits, field.key: trial})
                wheels = (*robot.wheels[:index], limited, *robot.wheels[index + 1 :])
                yield wheel.name, field.key, replace(robot, wheels=wheels)


def eva(
    derivation: Derivation, bounds: Bounds, step: Callable[[str], None] = lambda _: None
) -> dict[str, Any]:
    """Run Frama-C Eva on the generated C.

    Args:
        derivation: the robot.
        bounds: its bounds, which have the ranges of the inputs.
        step: is called with what is analysed, to show progress.

    Returns:
        ``run``: whether Eva was run; then its ``alarms``, else the ``reason``.
    """
    from wmrgen.codegen.c.driver import alarms, command, harness
    from wmrgen.ir.bounds.partition import cases
    from wmrgen.ir.bounds.robot import functions

    tool = compiler.find_tool(_TOOL)
    if tool is None:
        return {"run": False, "reason": f"{_TOOL} is not on the PATH ({_INSTALL})"}
    ranges = {f.name: f.inputs for f in bounds.functions if not f.unknown}
    chosen = [f for f in functions(derivation.c_module) if f.name in ranges]

    def alarms_of(code: Sequence[Function], finer: int) -> tuple[str, ...]:
        """Return the alarms for some functions; ``finer`` above 0 cuts the ranges of inputs into smaller parts."""
        parts = {f.name: cases(f, ranges[f.name], finer) for f in code}
        # Smaller parts help only with sines whose range on a part is known.
        files = harness(derivation.c_module, parts, waves=finer > 0)
        count = sum(map(len, parts.values()))
        what = f"{code[0].name}, {count} part{'s' * (count > 1)}" if len(code) == 1 else "all functions"
        step(f"running {_TOOL} on {derivation.robot.name}: {what}")
        return alarms(compiler.run_tool(command(tool, derivation.robot.name, finer > 0), files))

    raised = alarms_of(chosen, 0)
    if raised:
        raised = tuple(text for f in chosen for text in _persistent(partial(alarms_of, [f])))
    return {"run": True, "alarms": list(raised)}


def _persistent(alarms_with: Callable[[int], tuple[str, ...]]) -> tuple[str, ...]:
    """Return the alarms that remain when the ranges of inputs are cut finer and finer, four times."""
    raised: tuple[str, ...] = ()
    for finer in range(5):
        raised = alarms_with(finer)
        if not raised:
            break
    return raised


def _show(
    derivation: Derivation, bounds: Bounds, needed: Mapping[str, Sequence[str]], eva: Mapping[str, Any]
) -> None:
    """Print the limits, the bounds of each function, and what Eva found."""
    from wmrgen.ir.bounds.robot import TIES, described, limit

    limits = ", ".join(limit(n, r) for n, r in bounds.declared.items())
    console.result(f"{derivation.robot.name}: float, {described(bounds.library)}")
    console.result(f"  limits: {limits}")
    if bounds.assumed:
        console.result(f"  assumed: {', '.join(limit(n, r) for n, r in bounds.assumed.items())}")
    if bounds.steers:
        console.result(f"  {TIES}")
    for f in bounds.functions:
        if f.unknown:
            _show_skipped(f, needed[f.name])
        else:
            _show_bounds(f, derivation, bounds)
    if eva["run"]:
        count = len(eva["alarms"])
        console.result(
            f"Frama-C Eva, of --math libm --target host: {count or 'no'} alarm{'s' * (count > 1)}", "bold"
        )
    else:
        console.note(f"Frama-C Eva was not run: {eva['reason']}")


def _show_skipped(f: FunctionBound, needed: Sequence[str]) -> None:
    """Print why a function is not analysed, and the limits that would change it."""
    console.result(f"{f.name}: not analysed, no range for {', '.join(f.unknown)}", "bold")
    for text in needed:
        console.result(f"  needs {text}")
    if not needed:
        console.result("  no limit in a robot file applies to these inputs")


def _show_bounds(f: FunctionBound, derivation: Derivation, bounds: Bounds) -> None:
    """Print what is proved of a function."""
    from wmrgen.ir.bounds.robot import SINGULAR, beyond, limit

    verdict = "no NaN, infinity or division by zero" if f.proved else "not proved"
    console.result(f"{f.name}: {verdict}", "bold")
    wider = beyond(f, bounds)
    if wider:
        console.result(f"  for {', '.join(limit(n, r) for n, r in wider.items())}")
    for text in f.alarms:
        console.result(f"  {text}")
    free = tuple(n for n in f.inputs if n.endswith(".steer") and n not in bounds.declared)
    if free and (f.alarms or any(o.singular for o in f.outputs)):
        for text in needed_limits(derivation, bounds, f.name, free):
            console.result(f"  {', '.join(free)} may have any value; perhaps it needs {text}")
    width = max((len(o.name) for o in f.outputs), default=0)
    for o in f.outputs:
        if o.singular:
            console.result(f"  {o.name:<{width}}  no bound: {SINGULAR}")
            continue
        span = f"[{o.low:.6g}, {o.high:.6g}] {o.unit}"
        console.result(f"  {o.name:<{width}}  {span:<32} error {_error(o)}")


def _error(o: OutputBound) -> str:
    """Return the bound of the rounding error of an output as text."""
    if o.per_length:
        return f"{o.error:.2g} + {o.per_length:.2g}/speed, speed of its pivot >= {o.from_length:.2g} m/s"
    return f"{o.error:.2g}" + (f", pivot's speed >= {o.from_length:.2g} m/s" if o.from_length else "")
