"""``wmrgen eval``: a calculator over the functions of a model, and the way backends are compared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, cast

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.loading import noted, warn_of_gains
from wmrgen.cli.textbook import installed
from wmrgen.cli.values import Case, from_file, from_words, note_zeros
from wmrgen.codegen.registry import EXACT_WORD, Entry, known_words, of_word
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.evaluate import over_pi
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.layout.expressions import multiple_of_pi
from wmrgen.geometry.ports import Limits, timeless
from wmrgen.ir.kernels.choice import DEFAULT, Choice, choice
from wmrgen.robotfile.text import suggestion

if TYPE_CHECKING:
    from wmrgen.geometry.layout.records import Robot
    from wmrgen.ir.nodes import Function, Module


LONGEST = 24  # characters of an exact value printed beside its decimals: (sqrt(2) + sqrt(6))/4 is shorter
_WHOSE = ("the robot's limits", "its range")


class Modules(Protocol):
    """Where functions are taken from: a derivation, or the textbook library."""

    @property
    def raw_module(self) -> Module:
        """As written: what the exact backend evaluates."""

    @property
    def module(self) -> Module:
        """Optimised."""

    @property
    def c_module(self) -> Module:
        """Cut for C."""


def evaluate(
    robot: Path,
    function: str,
    values: Sequence[str] | None,
    backend: str,
    scalar: str,
    math: str | None,
    target: str,
    cases: str | None,
    as_json: bool,
) -> int:
    """Evaluate one case from the words ``values``, or every case of the file ``cases``."""
    chosen = choice(scalar, math, target)
    if cases is not None and values:
        raise UsageError("there are NAME=VALUE words and --cases. Give one of them, not both.")
    _entry(backend)  # before anything is derived: UsageError for an unknown word
    with console.progress() as step:
        step(f"deriving {robot}")
        modules = _modules(robot, function)
        written = modules.raw_module.function(function)
        ports = written.inputs
        robot_of: Robot | None = getattr(modules, "robot", None)  # the textbook library has none
        inputs = (
            [from_words(values or (), ports, robot_of)]
            if cases is None
            else from_file(cases, ports, robot_of)
        )
        step(f"computing {function} with {backend}")
        _refuse_divisors(written, inputs)
        whole = [{p.name: case.get(p.name, p.default or ZERO) for p in ports} for case in inputs]
        exact = exactly(modules, written, whole) if _entry(backend) is None else None
        results = [*map(_doubles, exact)] if exact else computed(modules, written, whole, backend, chosen)
    units = {port.name: port.unit for port in (*ports, *written.outputs)}
    note_zeros([port for port in ports if port.default is None], inputs)
    beyond = _beyond(modules, written, inputs)
    tunable = {port.name for port in ports if port.range}
    for name, (low, high) in beyond.items():
        console.note(
            f"{name} is beyond {_WHOSE[name in tunable]}, {float(low):g} to {float(high):g} {units[name]}"
        )
    if cases is not None:
        console.data(results)
    elif as_json:
        limits = {
            name: [float(low), float(high)] for name, (low, high) in beyond.items() if name not in tunable
        }
        console.data({**results[0], **({"beyond_limits": limits} if limits else {})})
    else:
        console.values(results[0], units, {name: _short(v) for name, v in exact[0].items()} if exact else {})
    return 0


def _short(value: Exact) -> str:
    """What a number is exactly, in the grammar of inputs: sqrt(3)/2, pi/4, 40/13; "" where its decimals say as much or
    it is long."""
    half_turns, size = over_pi(value), max(value.den, *map(abs, value.num))
    if half_turns:
        text = multiple_of_pi(half_turns)
    elif size > 10**LONGEST or value == Fraction(repr(float(value))):
        return ""
    else:
        text = str(value)
    return text if len(text) <= LONGEST else ""


def _beyond(modules: Modules, function: Function, cases: Sequence[Case]) -> dict[str, tuple[Exact, Exact]]:
    """The inputs that a case has outside the limits of the robot file, and parameters outside their ranges, with these;
    none of a function whose work is to keep limits."""
    robot: Robot | None = getattr(modules, "robot", None)  # the textbook library has none
    if robot is None or function.limits is Limits.ASKED:
        return {}
    beyond = {}
    for port in function.inputs:
        limit = port.range or robot.limit_of(timeless(port.name))
        if limit and any(port.name in c and not limit[0] <= c[port.name] <= limit[1] for c in cases):
            beyond[port.name] = (limit[0], limit[1])
    return beyond


def _refuse_divisors(function: Function, cases: Sequence[Case]) -> None:
    """UsageError for tunable parameters with which a divisor of the function is too small to divide by: one that the
    code keeps from 0, and gives numbers that mean nothing."""
    from wmrgen.ir.geometry import geometry_only
    from wmrgen.ir.interpret import EXACT, evaluate_nodes
    from wmrgen.ir.nodes import Op, pruned

    names = [port.name for port in function.inputs if port.range]
    early = geometry_only(function)
    divisors = [
        node.args for node, of in zip(function.nodes, early, strict=True) if of and node.op is Op.AT_LEAST
    ]
    own = pruned(replace(function, results=tuple(k for args in divisors for k in args)))
    tried = {tuple((name, case[name]) for name in names if name in case) for case in cases}
    for given in sorted(tried, key=str) if divisors else ():
        values = evaluate_nodes(own, dict(given), EXACT)
        results = iter([values[k] for k in own.results])
        if given and any(abs(divisor) < least for divisor, least in zip(results, results, strict=True)):
            where = " and ".join(f"{name} = {float(value):.6g}" for name, value in given)
            raise UsageError(f"with {where}: a divisor of {function.name} is 0. Write other values.")


def _modules(path: Path, name: str) -> Modules:
    """The function of a robot; of the library where ``path`` is the word textbook and no such file is there."""
    if path == Path("textbook") and not path.is_file():
        return cast(Modules, installed().library(name))
    from wmrgen.functions.registry import has_function, names

    robot = noted(wmrgen.load(path))
    if name == "goto_pose":
        warn_of_gains(robot, asked=True)
    if not has_function(name):
        hint = suggestion(name, names())
        raise UsageError(f"{robot.name} has no function {name!r}. {hint} `wmrgen functions` lists them.")
    return wmrgen.derive(robot, [name])


def computed(
    modules: Modules,
    function: Function,
    cases: Sequence[Mapping[str, Exact]],
    backend: str,
    choice: Choice = DEFAULT,
) -> list[dict[str, float]]:
    """Outputs of ``function`` for each case, as the backend that the command line calls ``backend`` computes them."""
    entry = _entry(backend)
    if entry is None:
        return [_doubles(result) for result in exactly(modules, function, cases)]
    module = getattr(modules, entry.source)
    results = entry.evaluate(module, [(function.name, _doubles(case)) for case in cases], choice.words())
    _note_overflow(results, entry, choice)
    order = [port.name for port in function.outputs]
    return [{name: result[name] for name in order if name in result} for result in results]


def exactly(
    modules: Modules, function: Function, cases: Sequence[Mapping[str, Exact]]
) -> list[dict[str, Exact]]:
    """Outputs of ``function`` for each case, in exact arithmetic. UsageError where a case has no value."""
    from wmrgen.ir.interpret import EXACT, evaluate_module

    module = modules.raw_module
    try:
        return [evaluate_module(module, function.name, case, EXACT) for case in cases]
    except (
        ZeroDivisionError,
        ValueError,
    ) as error:  # of the interpreter: a quotient or a root without a value
        raise UsageError(f"{error}: there is no value at these inputs") from error


def _note_overflow(results: Sequence[Mapping[str, float]], entry: Entry, choice: Choice) -> None:
    """Say which outputs are no finite numbers: JSON has null for them."""
    names = dict.fromkeys(name for result in results for name in result if not isfinite(result[name]))
    if names:
        why = ""
        if "scalar" in entry.options and choice.scalar == "float":
            why = " (the numbers of float end at 3.4e38; --scalar double goes further)"
        console.note(f"not finite, null in JSON: {' '.join(names)}{why}")


def _entry(word: str) -> Entry | None:
    """The backend that the command line calls ``word``; None is exact arithmetic. UsageError where there is none."""
    entry = of_word(word)
    if entry is None and word != EXACT_WORD:
        raise UsageError(f"there is no backend {word!r}. There are: {' '.join(known_words())}.")
    return entry


def _doubles(values: Mapping[str, Exact]) -> dict[str, float]:
    """Each value rounded to the nearest double."""
    try:
        return {name: float(value) for name, value in values.items()}
    except OverflowError as error:
        raise UsageError("a value is beyond the range of a double") from error
