"""Mutants that no input tells from the original at the proved tolerance: they are not faults.

The mutant is computed, in float32 as it stands, at thousands of inputs, far more and other ones than the self-test
has, and beside the thresholds of the function, which few of them meet. It is set aside only where none of them gives an
output further from the exact value than rounding may bring the original (`wmrgen.ir.selftest.rounding_bounds`): an even
function's sign, a guard that no geometry of the robot reaches, a term of a series below the last bit.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from tests.mutation.mutants import LITERAL, Mutant, unfolded
from wmrgen.codegen.signature import arguments
from wmrgen.ir.calls import inlined_calls
from wmrgen.ir.nodes import Function, Module, Role, contract
from wmrgen.ir.ops.analysis import Bounded
from wmrgen.ir.selftest.points import near_thresholds
from wmrgen.ir.selftest.rounding_bounds import UNITS, bounds
from wmrgen.ir.selftest.vectors import prepared_of

Array = Any
POINTS = 4096


def _fused(a: Array, b: Array, c: Array) -> Array:
    return np.float32(np.float64(a) * np.float64(b) + np.float64(c))


def _flip(a: Array, n: Array) -> Array:
    return np.where(np.asarray(n, np.float32).view(np.uint32) & 1, -a, a)


def _signed(a: Array, b: Array) -> Array:
    return np.where(np.signbit(b), -a, a)


def _within(a: Array, m: Array) -> Array:
    return np.where(a < m, np.where(a < -m, -m, a), m)


def _beyond(a: Array, m: Array) -> Array:
    """Sizes and signs as bits: a mutant's m may be negative."""
    size, least = (np.asarray(v, np.float32).view(np.uint32) for v in (np.abs(a), m))
    return np.where(size < least, np.where(np.signbit(a), -np.abs(m), m), a)


_CALLS = {
    "fabsf": np.abs, "sqrtf": np.sqrt, "sinf": np.sin, "cosf": np.cos, "atanf": np.arctan,
    "atan2f": np.arctan2, "wmr_fma": _fused,
    "wmrgen_negate_if_odd": _flip, "wmrgen_with_sign_of": _signed, "wmrgen_clamp": _within, "wmrgen_at_least": _beyond,
}  # fmt: skip
_LINE = re.compile(r"^    (?:const (?:float|wmrgen_\w+) )?(\*?[\w.>-]+) = ([^;]+);$")
_KERNEL = re.compile(r"^WMRGEN_(?:KERNEL|ONCE) \w+ (\w+)\(([^)]*)\)\n\{\n(.*?)^\}", flags=re.S | re.M)
_CHOICE = re.compile(r"^\((.+) < (.+)\) \? (.+) : (.+)$")
_TYPICAL = {"m/s": 2.0, "rad/s": 8.0, "rad": 3.2, "m": 5.0, "s": 0.25}


def _python(text: str) -> str:
    """A C expression of generated code in NumPy."""
    text = LITERAL.sub(r"f32(\1)", text)
    text = re.sub(r"\b(\w+)->([\w.]+)", lambda m: f"{m[1]}_[{m[2]!r}]", text)
    choice = _CHOICE.match(text)
    return "np.where({} < {}, {}, {})".format(*choice.groups()) if choice else text


def _kernels(source: str) -> dict[str, Callable[..., Any]]:
    """The kernels of a file as functions of NumPy, in their order."""
    functions: dict[str, Callable[..., Any]] = {}
    for name, parameters, text in _KERNEL.findall(source):
        functions[name] = _kernel([p.split()[-1] for p in parameters.split(",")], text, dict(functions))
    return functions


def _kernel(parameters: Sequence[str], text: str, others: Mapping[str, Any]) -> Callable[..., Any]:
    lines = [m.groups() for m in map(_LINE.match, text.splitlines()) if m]
    last = re.search(r"^    return ([^;]+);$", text, flags=re.M)

    def call(*args: Array) -> Any:
        scope: dict[str, Any] = {"np": np, "f32": np.float32, **_CALLS, **others}
        scope |= dict(zip(parameters, args, strict=True))
        result = SimpleNamespace()
        for target, expression in lines:
            value = eval(_python(expression), {}, scope)
            if target.startswith("result."):
                setattr(result, target.removeprefix("result."), value)
            else:
                scope[target] = value
        assert last is not None
        return result if last[1] == "result" else eval(_python(last[1]), {}, scope)

    return call


class Body:
    """The statements of one C function, computed in float32."""

    def __init__(self, source: str, function: str) -> None:
        source = unfolded(source)
        text = re.search(rf"^void {function}\(.*?^}}", source, flags=re.S | re.M)
        assert text, function
        self.kernels = _kernels(source)
        bare = re.sub(r"; /\*.*\*/$", ";", text[0], flags=re.M)
        self.lines = [m.groups() for m in map(_LINE.match, bare.splitlines()) if m]

    def run(self, mutant: Mutant, given: Mapping[str, Mapping[str, Array]]) -> dict[str, Array]:
        """What is stored, by place, with the line that ``mutant`` changes as it wants it."""
        scope: dict[str, Any] = {"np": np, "f32": np.float32, **_CALLS, **self.kernels}
        for name, values in given.items():
            scope |= {name: values[""]} if "" in values else {f"{name}_": values}
        stored = {}
        changed = mutant.before.removeprefix("const float ")
        for target, text in self.lines:
            own = mutant.after if f"{target} = {text}" == changed else text
            value = eval(_python(own), {}, scope)
            if "->" in target or target.startswith("*"):
                stored[target] = value
            else:
                scope[target] = value
        return stored


@dataclass(frozen=True)
class Cases:
    """Inputs by parameter and member (nothing of a scalar); by the place of an output its exact value and tolerance;
    where rounding decides nothing."""

    given: dict[str, dict[str, Array]]
    expected: dict[str, tuple[Array, Array]]
    sound: Array


class Judge:
    """Tells equivalent mutants of a robot's C from faults."""

    def __init__(self, module: Module, source: str) -> None:
        self.module, self.source = inlined_calls(module), source
        self._known: dict[str, tuple[Cases, Body]] = {}

    def equivalent(self, mutant: Mutant) -> bool:
        """True where no input tells the mutant from the original."""
        name = mutant.function.removeprefix(f"{self.module.name}_")
        if name not in self._known:
            cases = self._preparation() if name == "prepare" else self._cases(self.module.function(name))
            self._known[name] = cases, Body(self.source, mutant.function)
        cases, body = self._known[name]
        with np.errstate(all="ignore"):
            stored = body.run(mutant, cases.given)
        return all(
            bool(np.all((np.abs(stored[key] - value) <= tolerance) | ~cases.sound))
            for key, (value, tolerance) in cases.expected.items()
        )

    def _cases(self, function: Function) -> Cases:
        ports, fixed = contract(function), prepared_of(self.module, "float")
        drawn = []
        random = np.random.default_rng(20)
        for port in ports:
            size = 30.0 if port.name.endswith(".spin") else _TYPICAL.get(port.unit, 1.0)
            scale = 2.0 ** random.integers(-6, 2, POINTS) * (random.random(POINTS) > 0.05)
            drawn.append((size * scale * random.uniform(-1, 1, POINTS)).astype(np.float32).astype(np.float64))
        rows = np.array(drawn).T.reshape(POINTS, len(ports))
        near = near_thresholds(function, ports, rows, {name: b.value for name, b in fixed.items()})
        rows = np.vstack([rows, *(point for _, point in near)])
        count = len(rows)
        columns = {
            name: Bounded(np.full(count, b.value[0]), np.broadcast_to(b.error, (2, count)))
            for name, b in fixed.items()
        }
        for port, values in zip(ports, rows.T, strict=True):
            columns[port.name] = Bounded(values, np.zeros((2, count)))
        bounded = function.outputs_of(bounds(function, columns, "float", count))
        good = [b.error[0] <= 2.0**13 * UNITS["float"] * (1 + np.abs(b.value)) for b in bounded.values()]
        prepared = [p.name for p in function.inputs if p.role is Role.PREPARED]
        given = {"prepared": {name: columns[name].value.astype(np.float32) for name in prepared}}
        places = {}
        for argument in arguments(function, self.module.joints):
            called = "" if not argument.kind else f"{argument.name}->"
            members = {n: m if argument.kind else "" for n, m in argument.reads.items()}
            given[argument.name] = {m: columns[n].value.astype(np.float32) for n, m in members.items()}
            places |= {
                n: f"{called}{m}" if called else f"*{argument.name}" for n, m in argument.writes.items()
            }
        expected = {places[name]: _expected(b) for name, b in bounded.items()}
        return Cases(given, expected, np.logical_and.reduce(good))

    def _preparation(self) -> Cases:
        """The nominal parameters: the only ones that a self-test has."""
        prepared, prepare = prepared_of(self.module, "float"), self.module.prepare
        assert prepare
        params = {p.name: prepared[p.name].value.astype(np.float32) for p in prepare.inputs}
        expected = {f"prepared->{p.name}": _expected(prepared[p.name]) for p in prepare.outputs}
        return Cases({"params": params}, expected, np.ones(1, dtype=bool))


def _expected(b: Bounded) -> tuple[Array, Array]:
    return b.value, b.error[0] + 2 * UNITS["float"] * np.abs(b.value) + 1e-12
