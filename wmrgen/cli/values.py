"""Input values of ``wmrgen eval``: NAME=VALUE words or a JSON file, in the number grammar of robot files."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from wmrgen.errors import EnvironmentFailure, RobotFileError, UsageError
from wmrgen.exact.number import Exact
from wmrgen.layout.expressions import evaluate
from wmrgen.spec import quantity
from wmrgen.spec.text import suggestion

_MAX_BYTES = 64 * 1024 * 1024
Case = Mapping[str, Exact]


def from_words(words: Iterable[str], names: Sequence[str]) -> Case:
    """``vx=0.5 omega='30 deg'`` as exact SI values. UsageError for a name that is not in ``names``."""
    case: dict[str, Exact] = {}
    for word in words:
        name, equals, text = word.partition("=")
        name = name.strip()
        if not equals:
            raise UsageError(f"{word!r} is not NAME=VALUE; inputs are: {' '.join(names)}")
        if name in case:
            raise UsageError(f"{name} is given twice")
        _known(name, names)
        case[name] = _number(text, name)
    return case


def from_file(file: str, names: Sequence[str]) -> list[Case]:
    """The list of {name: value} in a JSON file (``-``: stdin). Values are numbers or strings like "pi/2"."""
    try:
        data = sys.stdin.buffer.read(_MAX_BYTES) if file == "-" else Path(file).read_bytes()
    except OSError as error:
        raise EnvironmentFailure(f"cannot read {file}: {error.strerror}") from error
    try:
        # Numbers stay text until our own grammar has read them: exact, and NaN is no number.
        cases = json.loads(data, parse_float=str, parse_int=str, parse_constant=str)
    except (ValueError, RecursionError) as error:
        raise UsageError(f"{file} is not JSON: {error}") from error
    if not isinstance(cases, list) or not all(isinstance(case, dict) for case in cases):
        raise UsageError(f'{file} must hold a list of objects: [{{"vx": 0.5}}, …]')
    return [_case(case, f"{file}, case {k}", names) for k, case in enumerate(cases)]


def _case(case: Mapping[str, object], place: str, names: Sequence[str]) -> Case:
    result = {}
    for name, value in case.items():
        _known(name, names, f"{place}: ")
        if not isinstance(value, str):
            raise UsageError(f"{place}: {name} is {json.dumps(value)}, not a number")
        result[name] = _number(value, f"{place}: {name}")
    return result


def _known(name: str, names: Sequence[str], place: str = "") -> None:
    if name not in names:
        hint = suggestion(name, names)
        every = "" if hint.startswith("Valid") else f" Inputs are: {' '.join(names)}."
        raise UsageError(f"{place}there is no input {name!r}. {hint}{every}")


def _number(text: str, what: str) -> Exact:
    try:
        return evaluate(quantity(text), {})
    except RobotFileError as error:
        hint = " ".join(part for part in (error.why, error.instead) if part)
        raise UsageError(f"{what} = {text!r}: {error.what}. {hint}".rstrip()) from error
