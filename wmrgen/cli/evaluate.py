"""``wmrgen eval``: a calculator over the functions of a model, and the way backends are compared."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, cast

import wmrgen
from wmrgen.backends.registry import EXACT_WORD, Entry, known_words, of_word
from wmrgen.cli import console
from wmrgen.cli.gains import warn
from wmrgen.cli.loading import noted
from wmrgen.cli.values import Case, from_file, from_words
from wmrgen.errors import UsageError
from wmrgen.exact.number import ZERO, Exact
from wmrgen.ir.kernels.choice import DEFAULT, Choice

if TYPE_CHECKING:
    from wmrgen.ir.nodes import Function, Module


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


def run(
    path: Path,
    name: str,
    words: Sequence[str],
    *,
    backend: str,
    choice: Choice,
    cases: str | None,
    as_json: bool,
) -> int:
    """Evaluate one case from the words, or every case of a file."""
    if cases is not None and words:
        raise UsageError("give NAME=VALUE words or --cases, not both")
    if backend != EXACT_WORD:
        _entry(backend)  # which says what there is
    with console.progress() as step:
        step(f"deriving {path}")
        derivation = _source(path, name)
        function = derivation.raw_module.function(name)
        ports = function.inputs
        given = [from_words(words, ports)] if cases is None else from_file(cases, ports)
        step(f"computing {name} with {backend}")
        complete = [_completed(function, case) for case in given]
        results = _compute(derivation, function, complete, backend, choice)
    _say_zeros(function, given)
    if cases is not None:
        console.data(results)
    elif as_json:
        console.data(results[0])
    else:
        console.values(results[0])
    return 0


def _source(path: Path, name: str) -> Modules:
    """The function of a robot; of the library where ``path`` is the word textbook and no such file is there."""
    if path == Path("textbook") and not path.is_file():
        from wmrgen.cli.textbook import installed

        return cast(Modules, installed().library(name))
    robot = noted(wmrgen.load(path))
    if name == "goto_pose" and robot.gains:
        warn(robot)
    return wmrgen.derive(robot, [known(robot.name, name)])


def known(robot: str, name: str) -> str:
    """The name, when a function has it."""
    from wmrgen.functions.registry import has_function, names

    if not has_function(name):
        raise UsageError(
            f"{robot} has no function {name!r}; functions that a robot may have: {' '.join(names())}"
        )
    return name


def _completed(function: Function, case: Case) -> dict[str, Exact]:
    """Every input: as given, else nominal for a tunable parameter, else 0."""
    return {p.name: case.get(p.name, ZERO if p.default is None else p.default) for p in function.inputs}


def _say_zeros(function: Function, cases: Sequence[Case]) -> None:
    zeros = [p.name for p in function.inputs if p.default is None and any(p.name not in c for c in cases)]
    if zeros:
        console.note(f"not given, taken as 0: {' '.join(zeros)}")


def _compute(
    derivation: Modules,
    function: Function,
    cases: Sequence[dict[str, Exact]],
    backend: str,
    choice: Choice = DEFAULT,
) -> list[dict[str, float]]:
    if backend == EXACT_WORD:
        from wmrgen.ir.interpret import EXACT, evaluate_module

        module = derivation.raw_module
        return [_doubles(evaluate_module(module, function.name, case, EXACT)) for case in cases]
    entry = _entry(backend)
    module = getattr(derivation, entry.source)
    has = [f.name for f in module.functions]
    # A backend may give the residual in a function of its own, so that who does not need it does not pay.
    parts = [f.name for f in module.functions if (f.variant_of or f.name) == function.name]
    if not parts:
        raise UsageError(
            f"{backend} has no function {function.name!r} of {module.name}; it has: {' '.join(has)}"
        )
    doubles = [_doubles(case) for case in cases]
    results: list[dict[str, float]] = [{} for _ in cases]
    for part in parts:
        found = entry.evaluate(module, part, doubles, choice.words())
        for result, more in zip(results, found, strict=True):
            result.update(more)
    order = [port.name for port in function.outputs]
    return [{name: result[name] for name in order if name in result} for result in results]


def _entry(word: str) -> Entry:
    """The backend that the command line calls ``word``."""
    entry = of_word(word)
    if entry is None:
        raise UsageError(f"there is no backend {word!r}; there are: {' '.join(known_words())}")
    return entry


def _doubles(values: dict[str, Exact]) -> dict[str, float]:
    """Each value rounded to the nearest double."""
    try:
        return {name: float(value) for name, value in values.items()}
    except OverflowError as error:
        raise UsageError("a value is beyond the range of a double") from error
