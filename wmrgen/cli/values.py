"""Input values of commands: NAME=VALUE words or a JSON file, in the number grammar of robot files."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from wmrgen.cli import console
from wmrgen.errors import EnvironmentFailure, Mark, RobotFileError, UsageError
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.expressions import evaluate
from wmrgen.geometry.ports import Port
from wmrgen.robotfile.numbers import Kind
from wmrgen.robotfile.quantities import Scope, read_quantity
from wmrgen.robotfile.text import Scalar, bytes_of, quoted, read_stream, suggestion

if TYPE_CHECKING:
    from wmrgen.geometry.layout.records import Robot

MAX_BYTES = 16 << 20  # of a file of cases: some 100,000 of them
_KINDS = {"m": Kind.LENGTH, "rad": Kind.ANGLE, "m/s": Kind.SPEED, "rad/s": Kind.RATE}
Case = Mapping[str, Exact]
_PLAIN = re.compile(r"[+-]?(\d{1,40}(\.\d{0,40})?|\.\d{1,40})([eE][+-]?\d{1,3})?")
_LARGEST = Fraction(2) ** 1024
_MINUS_ZERO = re.compile(r"\s*-\s*(0+\.?0*|\.0+)([eE][+-]?\d+)?\s*[a-z/]*\s*")


class _MinusZero(Exact):
    """Zero, which floats take in as -0.0: generated C reads the sign."""

    __slots__ = ()

    def __float__(self) -> float:
        return -0.0


def from_words(words: Iterable[str], ports: Sequence[Port], robot: Robot | None = None) -> Case:
    """``vx=0.5 omega='30 deg'`` as exact SI values. UsageError for a name that is not among ``ports``, and for tunable
    parameters for which the ``robot`` has no geometry."""
    case: dict[str, Exact] = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals:
            raise UsageError(f"{word!r} is not NAME=VALUE. Inputs are: {_names(ports)}.")
        port = _port(name.strip(), ports, "")
        if port.name in case:
            raise UsageError(f"{port.name} is given twice")
        case[port.name] = _number(text, port, "")
    if robot is not None:
        robot.refuse(case)
    return case


def spelled(words: Iterable[str], robot: Robot, joint: str, ports: Sequence[Port] = ()) -> list[str]:
    """``left=4`` is ``left.spin=4``: a bare wheel name stands for its ``joint``, or for the only one in ``ports``."""
    wheels = {w.name for w in robot.wheels}
    result = []
    for word in words:
        name, equals, value = word.partition("=")
        name = name.strip()
        own = [p.name for p in ports if p.name.startswith(f"{name}.")]
        full = own[0] if len(own) == 1 else f"{name}.{joint}"
        result.append(f"{full}={value}" if equals and name in wheels else word)
    return result


def note_zeros(ports: Iterable[Port], cases: Sequence[Case]) -> None:
    """Say which of ``ports`` some case leaves out: they are taken as 0."""
    names = [port.name for port in ports if any(port.name not in case for case in cases)]
    if names:
        console.note(f"not given, taken as 0: {' '.join(names)}")


def from_file(file: str, ports: Sequence[Port], robot: Robot | None = None) -> list[Case]:
    """The list of {name: value} in a JSON file (``-``: stdin). Values are numbers or strings like "pi/2". ``robot``: as
    of `from_words`."""
    name = "standard input" if file == "-" else file
    data = _content(file, name)
    try:
        # Numbers stay text until our own grammar has read them: exact, and NaN is no number.
        cases = json.loads(data, parse_float=str, parse_int=str, parse_constant=str, object_pairs_hook=_once)
    except (ValueError, RecursionError) as error:
        raise UsageError(
            f'{name} is not JSON: {error}. Write a list of objects: [{{"vx": 0.5}}, …]'
        ) from error
    if not isinstance(cases, list) or not all(isinstance(case, dict) for case in cases):
        raise UsageError(f'{name} must hold a list of objects: [{{"vx": 0.5}}, …]')
    read = [_case(case, f"{name}, case {k}: ", ports) for k, case in enumerate(cases)]
    if robot is not None:
        _refuse(robot, read, name)
    return read


def _refuse(robot: Robot, cases: Sequence[Case], file: str) -> None:
    """UsageError for the first case whose tunable parameters give no geometry."""
    names = [p.name for p in robot.tunable]
    seen = set[tuple[Exact | None, ...]]()
    for k, case in enumerate(cases):
        of = tuple(case.get(name) for name in names)
        if of not in seen:
            seen.add(of)
            try:
                robot.refuse(case)
            except UsageError as error:
                raise UsageError(f"{file}, case {k}: {error.what}") from None


def _content(file: str, name: str) -> bytes:
    """The bytes of a file of cases, ``-`` for stdin; ``name`` in messages."""
    if file != "-":
        data = bytes_of(file, MAX_BYTES + 1)
    elif sys.stdin is None:
        raise EnvironmentFailure(f"cannot read {name}: it is closed")
    else:
        try:
            data = read_stream(sys.stdin.buffer, MAX_BYTES + 1)
        except OSError as error:
            raise EnvironmentFailure(f"cannot read {name}: {error.strerror}") from error
    if len(data) > MAX_BYTES:
        raise UsageError(
            f"{name} is larger than {MAX_BYTES >> 20} MiB. Split it: each case is computed by itself."
        )
    return data


def _once(pairs: list[tuple[str, object]]) -> dict[str, object]:
    """An object of JSON whose names differ."""
    members: dict[str, object] = {}
    for name, value in pairs:
        if name in members:
            raise UsageError(f"{name[:60]} is given twice")
        members[name] = value
    return members


def _case(case: Mapping[str, object], place: str, ports: Sequence[Port]) -> Case:
    result = {}
    for name, value in case.items():
        port = _port(name, ports, place)
        if not isinstance(value, str):
            raise UsageError(f"{place}{name} is {json.dumps(value)[:60]}, not a number")
        result[name] = _number(value, port, place)
    return result


def _names(ports: Sequence[Port]) -> str:
    return " ".join(port.name for port in ports)


def _port(name: str, ports: Sequence[Port], place: str) -> Port:
    for port in ports:
        if port.name == name:
            return port
    hint = suggestion(name, [port.name for port in ports])
    every = "" if hint.startswith("Valid") else f" Inputs are: {_names(ports)}."
    if not ports:
        raise UsageError(f"{place}there is no input {quoted(name)}: the function takes none")
    raise UsageError(f"{place}there is no input {quoted(name)}. {hint}{every}")


def _number(text: str, port: Port, place: str) -> Exact:
    """The exact SI value of ``text``, which may have a unit that fits the port. A zero keeps its sign."""
    value = _unsigned_zero(text, port, place)
    return value if value or not _MINUS_ZERO.fullmatch(text) else _MinusZero(0)


def _unsigned_zero(text: str, port: Port, place: str) -> Exact:
    what = f"{place}{port.name}"
    text = _without_unit(text, port, what)
    if _PLAIN.fullmatch(text) and abs(value := Fraction(text)) < _LARGEST:
        return Exact(value)  # what another program prints: 1e-40 m/s is a speed, if not one of a robot file
    scalar = Scalar(Mark("", 1, 1, ""), text, True)
    try:
        return evaluate(read_quantity(scalar, _KINDS.get(port.unit, Kind.ANY), port.name, Scope()), {})
    except RobotFileError as error:
        hint = " ".join(part for part in (error.why, error.instead) if part)
        raise UsageError(f"{what} = {text[:60]!r}: {error.what}. {hint}".rstrip()) from error


def _without_unit(text: str, port: Port, what: str) -> str:
    """``2.3 s`` as ``2.3`` where the port's unit is one that robot files have no use for; UsageError for another."""
    unit = port.unit
    if not unit or unit in _KINDS:
        return text
    space = r"\s+" if unit[0].isdigit() else r"\s*"
    match = re.fullmatch(rf"(.*[\d.)]){space}{re.escape(unit)}\s*", text)
    if match:
        return match[1]
    if re.search(r"[\d.)]\s*[a-zµ°\"]", re.sub(r"[\d.][eE][+-]?\d", "", text)):
        raise UsageError(f"{what} = {text[:60]!r}: {port.name} is in {unit}. Write the number alone.")
    return text
