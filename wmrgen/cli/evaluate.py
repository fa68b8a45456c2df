"""``wmrgen eval``: compute functions of a model, with any back end, so that back ends can be compared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Protocol, cast

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.declare import (
    Json,
    Math,
    Robot,
    Scalar,
    Target,
    Words,
    argument,
    option,
    option_with_default,
    verb,
    words,
)
from wmrgen.cli.loading import print_notes, warn_of_gains
from wmrgen.cli.textbook import installed, is_library
from wmrgen.cli.values import Case, from_file, from_words, note_zeros
from wmrgen.codegen.registry import EXACT_WORD, Entry, known_words, of_word
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.ports import Limits, without_time_suffix
from wmrgen.robotfile.text import suggestion

if TYPE_CHECKING:
    from wmrgen.geometry.layout.records import Robot as Loaded
    from wmrgen.ir.kernels.choice import Choice
    from wmrgen.ir.nodes import Function, Module


LONGEST = (
    24  # characters of an exact value that is printed after its decimals: (sqrt(2) + sqrt(6))/4 is shorter
)


class Modules(Protocol):
    """A source of functions: a derivation, or the textbook library."""

    @property
    def raw_module(self) -> Module:
        """The functions as written, which the exact back end evaluates."""

    @property
    def module(self) -> Module:
        """The functions after optimisation."""

    @property
    def c_module(self) -> Module:
        """The functions as C has them."""


def _functions(incomplete: str) -> list[str]:
    from wmrgen.functions.registry import names

    return [name for name in names() if name.startswith(incomplete)]


@verb("eval")
def evaluate(
    robot: Robot,
    function: Annotated[
        str,
        argument(
            "FUNCTION", "One that `wmrgen functions` lists: inverse, forward, motion, goto_pose.", _functions
        ),
    ],
    values: Annotated[Words, words("Inputs in SI units: 0.5, 1/3, pi/2, '45 deg/s'.")] = None,
    backend: Annotated[
        str,
        option_with_default(
            "The back end: exact, c (needs a C compiler), or another; an unknown word lists all.", "WORD"
        ),
    ] = "exact",
    scalar: Annotated[Scalar, option_with_default("Scalar type of back end c.")] = "float",
    math: Math = None,
    target: Target = "m4f",
    cases: Annotated[
        str | None,
        option(
            "Compute every case of a list of {name: value}; prints a list of results. - is stdin.",
            "FILE.json",
        ),
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen eval robots/pioneer3dx.yaml inverse vx=0.5 omega="30 deg/s"

    Compute a function of a robot's model. Inputs that are not given are 0, parameters have their nominal values. With
    the word textbook instead of a robot, compute a formula of the texts that needs no robot: `wmrgen eval textbook
    pursuit distance=3`.
    """
    from wmrgen.ir.kernels.choice import choice

    chosen = choice(scalar, math, target)
    if cases is not None and values:
        raise UsageError("there are NAME=VALUE words and --cases. Give one of them, not both.")
    exactly_wanted = _entry(backend) is None  # before the derivation: an unknown word is reported at once
    with console.progress() as step:
        step(f"deriving {robot}")
        modules = _modules(robot, function)
        written = modules.raw_module.function(function)
        ports = written.inputs
        loaded: Loaded | None = getattr(modules, "robot", None)  # the textbook library has no robot
        if cases is None:
            inputs: Sequence[Case] = [from_words(values or (), ports, loaded)]
        else:
            inputs = from_file(cases, ports, loaded)
        step(f"computing {function} with {backend}")
        _refuse_divisors(written, inputs)
        complete = [{p.name: case.get(p.name, p.default or ZERO) for p in ports} for case in inputs]
        exact: list[dict[str, Exact]] = []
        if exactly_wanted:
            exact = exactly(modules, written, complete)
            results = [_doubles(result) for result in exact]
        else:
            results = computed(modules, written, complete, backend, chosen)
    units = {port.name: port.unit for port in (*ports, *written.outputs)}
    note_zeros([port for port in ports if port.default is None], inputs)
    tunable, limited = _outside(loaded, written, inputs)
    for whose, ranges in (("its range", tunable), ("the robot's limits", limited)):
        for name, (low, high) in ranges.items():
            console.note(f"{name} is beyond {whose}, {low:g} to {high:g} {units[name]}")
    if cases is not None:
        console.data(results)
    elif as_json:
        beyond = (
            {"beyond_limits": {name: list(limits) for name, limits in limited.items()}} if limited else {}
        )
        console.data({**results[0], **beyond})
    else:
        remarks = {name: _short(value) for name, value in exact[0].items()} if exact else {}
        console.values(results[0], units, remarks)
    return 0


def _short(value: Exact) -> str:
    """Return an exact value as a user would write it: sqrt(3)/2, pi/4, 40/13.

    Empty if the decimals are exact already, or if the text is too long to read.
    """
    from wmrgen.geometry.exact.evaluate import over_pi
    from wmrgen.geometry.layout.expressions import multiple_of_pi

    half_turns = over_pi(value)
    largest = max(value.den, *map(abs, value.num))
    if half_turns:
        text = multiple_of_pi(half_turns)
    elif largest > 10**LONGEST or value == Fraction(repr(float(value))):
        return ""
    else:
        text = str(value)
    return text if len(text) <= LONGEST else ""


Ranges = dict[str, tuple[float, float]]


def _outside(robot: Loaded | None, function: Function, cases: Sequence[Case]) -> tuple[Ranges, Ranges]:
    """Return the ranges that some case violates: of tunable parameters, and of inputs that the robot file limits.

    Functions that limit their inputs themselves violate none.
    """
    tunable: Ranges = {}
    limited: Ranges = {}
    if robot is None or function.limits is Limits.ASKED:
        return tunable, limited
    for port in function.inputs:
        limits = port.range or robot.limit_of(without_time_suffix(port.name))
        if not limits:
            continue
        low, high = limits[0], limits[1]
        given = [case[port.name] for case in cases if port.name in case]
        if any(not low <= value <= high for value in given):
            (tunable if port.range else limited)[port.name] = (float(low), float(high))
    return tunable, limited


def _refuse_divisors(function: Function, cases: Sequence[Case]) -> None:
    """Raise UsageError if given tunable parameters make a divisor of the function zero or almost zero.

    The generated code limits such a divisor to a least size, and its results would mean nothing.
    """
    from wmrgen.ir.geometry import geometry_only
    from wmrgen.ir.interpret import EXACT, evaluate_nodes
    from wmrgen.ir.nodes import Op, pruned

    names = [port.name for port in function.inputs if port.range]
    constant = geometry_only(function)
    divisors = [  # (divisor, least size) of each division that depends on the geometry alone
        node.args
        for node, is_constant in zip(function.nodes, constant, strict=True)
        if is_constant and node.op is Op.AT_LEAST
    ]
    if not divisors:
        return
    only_divisors = pruned(replace(function, results=tuple(k for pair in divisors for k in pair)))
    given = set()
    for case in cases:
        given.add(tuple((name, case[name]) for name in names if name in case))
    for parameters in sorted(given - {()}, key=str):
        values = evaluate_nodes(only_divisors, dict(parameters), EXACT)
        results = [values[k] for k in only_divisors.results]
        pairs = zip(results[::2], results[1::2], strict=True)
        if any(abs(divisor) < least for divisor, least in pairs):
            where = " and ".join(f"{name} = {float(value):.6g}" for name, value in parameters)
            raise UsageError(f"with {where}: a divisor of {function.name} is 0. Write other values.")


def _modules(path: Path, name: str) -> Modules:
    """Return the function ``name`` of a robot file; of the textbook library if ``path`` is the word textbook."""
    if is_library(path):
        return cast(Modules, installed().library(name))
    from wmrgen.functions.registry import has_function, names

    robot = print_notes(wmrgen.load(path))
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
    choice: Choice | None = None,
) -> list[dict[str, float]]:
    """Compute a function with a back end.

    Args:
        modules: where the back end finds the function in the form that it needs.
        function: the function as written.
        cases: for each case the value of every input, in SI units.
        backend: the word for the back end on the command line; exact is exact arithmetic.
        choice: scalar type, sines and processor of the C.

    Returns:
        For each case the outputs by name, in SI units.

    Raises:
        UsageError: if there is no such back end, or if a case has no value.
    """
    from wmrgen.ir.kernels.choice import DEFAULT

    choice = choice or DEFAULT
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
    """Compute a function in exact arithmetic.

    Args:
        modules: where the function and the functions that it calls are.
        function: the function as written.
        cases: for each case the value of every input, in SI units.

    Returns:
        For each case the outputs by name, in SI units.

    Raises:
        UsageError: if a case has no value, because of a division by zero or a root of a negative number.
    """
    from wmrgen.ir.interpret import EXACT, evaluate_module

    module = modules.raw_module
    try:
        return [evaluate_module(module, function.name, case, EXACT) for case in cases]
    except (ZeroDivisionError, ValueError) as error:
        raise UsageError(f"{error}: there is no value at these inputs") from error


def _note_overflow(results: Sequence[Mapping[str, float]], entry: Entry, choice: Choice) -> None:
    """Print which outputs are infinite or NaN: they are null in JSON."""
    names = dict.fromkeys(name for result in results for name in result if not isfinite(result[name]))
    if names:
        why = ""
        if "scalar" in entry.options and choice.scalar == "float":
            why = " (float ends at 3.4e38; --scalar double goes further)"
        console.note(f"not finite, null in JSON: {' '.join(names)}{why}")


def _entry(word: str) -> Entry | None:
    """Return the back end of a word of the command line, None for exact arithmetic. Raise UsageError for others."""
    entry = of_word(word)
    if entry is None and word != EXACT_WORD:
        raise UsageError(f"there is no backend {word!r}. There are: {' '.join(known_words())}.")
    return entry


def _doubles(values: Mapping[str, Exact]) -> dict[str, float]:
    """Round each value to the nearest double."""
    try:
        return {name: float(value) for name, value in values.items()}
    except OverflowError as error:
        raise UsageError("a value is beyond the range of a double") from error
