"""Programs that call generated C: the exchange of numbers, and bounds of sines for an analyser."""

from __future__ import annotations

import math
import re
from functools import cache

import pytest

from tests.robots import of_gallery
from wmrgen.codegen.c.driver import HARNESS, answer, calls, command, driver, harness, nominal, request
from wmrgen.codegen.c.emit import unit
from wmrgen.errors import UsageError
from wmrgen.ir.kernels.choice import DEFAULT
from wmrgen.ir.nodes import Module

PIECE = re.compile(r"if \(x >= (\S+?)f && x <= (\S+?)f\) return Frama_C_float_interval\((\S+?)f, (\S+?)f\);")


@cache
def module() -> Module:
    return of_gallery("pioneer3dx").c_module


def test_sines_for_the_analyser() -> None:
    """In each step of 1/8 the bounds hold for a library with errors of 1e-6, and they are not much wider."""
    text = harness(module(), {}, waves=True)[HARNESS]
    assert "eva_sin" not in harness(module(), {})[HARNESS]
    for name, wave in (("sin", math.sin), ("cos", math.cos)):
        body = text.split(f"float eva_{name}f(float x)\n{{")[1].split("\n}")[0]
        pieces = [tuple(map(float, piece)) for piece in PIECE.findall(body)]
        assert pieces[0][0] <= -math.pi < pieces[0][1] and pieces[-1][0] < math.pi <= pieces[-1][1]
        for (a, b, low, high), following in zip(pieces, [*pieces[1:], None], strict=True):
            assert b - a == 1 / 8 and (following is None or following[0] == b)
            values = [wave(a + k * (b - a) / 500) for k in range(501)]
            assert max(-1.0, min(values) - 0.9e-6) >= low >= min(values) - 0.0081
            assert min(1.0, max(values) + 0.9e-6) <= high <= max(values) + 0.0081
            assert -1 <= low < high <= 1
            if max(abs(v) for v in values) < 0.99:  # no extremum nearby
                assert high - low < max(values) - min(values) + 3e-6
        assert "return Frama_C_float_interval(-1.0f, 1.0f);" in body.splitlines()[-1]


def test_the_analyser_gets_the_bounds_of_sines() -> None:
    assert command("frama-c", "bot")[-2:] == [HARNESS, "bot.c"]
    assert "-cpp-extra-args=-Dsinf=eva_sinf -Dcosf=eva_cosf" in command("frama-c", "bot", waves=True)
    assert not any("eva_sin" in word for word in command("frama-c", "bot"))


def test_a_function_per_case() -> None:
    inverse = dict.fromkeys(("vx", "vy", "omega", "track", "radius"), (-0.5, 0.25))
    names = {
        p.name for f in (module().function("inverse"), module().prepare) if f is not None for p in f.inputs
    }
    cases = {"inverse": [dict.fromkeys({*inverse, *names}, (-0.5, 0.25))] * 3}
    text = harness(module(), cases)[HARNESS]
    assert [text.count(f"static void case_{k}(void)") for k in range(4)] == [1, 1, 1, 0]
    assert [text.count(f"    case_{k}();") for k in range(4)] == [1, 1, 1, 0]
    assert text.count(f"twist.vx = Frama_C_float_interval({(-0.5).hex()}f, {(0.25).hex()}f);") == 3


def test_numbers_cross_unchanged() -> None:
    (call,) = [c for c in calls(unit(module(), DEFAULT)) if c.function.endswith("inverse")]
    values = {name: -(0.1**k) for k, name in enumerate(call.inputs)}
    index, *words = request(7, call, values).split()
    assert index == "7" and [float.fromhex(w) for w in words] == [values[n] for n in call.inputs]
    results = [0.1 * 3**k for k in range(len(call.outputs))]
    assert list(answer(call, " ".join(v.hex() for v in results)).items()) == list(
        zip(call.outputs, results, strict=True)
    )
    with pytest.raises(UsageError, match=r"\bvx\b"):
        request(0, call, {k: v for k, v in values.items() if k != "vx"})
    with pytest.raises(ValueError):  # fewer numbers than outputs
        answer(call, "0x0p+0")


def test_a_program_has_room_for_the_longest_call() -> None:
    every = calls(unit(module(), DEFAULT))
    text = driver(every)
    assert (
        f"x[{max(len(c.inputs) for c in every)}]" in text
        and f"y[{max(len(c.outputs) for c in every)}]" in text
    )
    assert "x[1]" in driver([]) and "y[1]" in driver([])


def test_nominal_values_are_those_of_the_file() -> None:
    values = nominal(module())
    tunable = {p.name: p.default for f in module().functions for p in f.inputs if p.role.value == "geometry"}
    tunable |= {p.name: p.default for p in module().prepare.inputs} if module().prepare is not None else {}
    assert values == {name: float(default) for name, default in tunable.items() if default is not None}
    assert values["radius"] == 0.0975
