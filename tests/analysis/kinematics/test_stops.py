"""Which heading a wheel keeps at its steering stops: noise does not swing it to and fro, and `slip` tells the cost."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import pytest

from tests.analysis.mobility.test_couplings import wheel
from tests.depth import everyday
from tests.laws.common import derived
from tests.oracle.harness import Model
from tests.oracle.stops import STAY, right, stay
from wmrgen.codegen.c.driver import evaluate_c
from wmrgen.ir.interpret import EXACT, evaluate_module
from wmrgen.ir.kernels.choice import Choice

Case = dict[str, float]
AXLE = [wheel("left", "fixed", 0.0, 0.4), wheel("right", "fixed", 0.0, -0.4)]
WIDTHS = (60, 89, 91, 120, 150, 170, 174, 176, 179, 180, 181, 185, 189, 191, 200, 270, 350)
NEAR = (1e-5, 1e-3, 0.02)  # rad, to either side of where something changes


def forklift(low: float, width: float, across: float = 0.0) -> Model:
    """One steered wheel, or two on one motor, ``across`` [m] to either side."""
    names = {"rear": across} | ({"twin": -across} if across else {})
    rear = [wheel(n, "steered", -1.2, y) | {"limits": {"steer": (low, width)}} for n, y in names.items()]
    return derived({"wheels": [*AXLE, *rear], "couplings": [("steer", list(names))] if across else []})


@pytest.mark.parametrize(
    ("low", "width"),
    [
        (-90, 180),
        pytest.param(-75, 150, marks=pytest.mark.slow),
        (-92, 184),
        pytest.param(-120, 180, marks=pytest.mark.slow),
        pytest.param(-110, 220, marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize("across", [0.0, 0.2])
def test_noise_does_not_swing_a_wheel_from_stop_to_stop(low: int, width: int, across: float) -> None:
    """1 mm/s of noise about a turn on the spot, and about every line at which a wheel may swing over: it does once."""
    model = forklift(low, width, across)
    inverse, steered = model.derivation.numpy().inverse, [n for n in model.ports("inverse")[0] if "." in n]
    source, high, middle = random.Random(low), low + width, low + width / 2
    for degrees in (90, low, high, high + 5, low - 5, middle + 90, middle + 92.5, middle - 95):
        for angle in (low, middle, high):
            steer, seen = math.radians(angle), []
            for _ in range(100):
                vx = 0.36 / math.tan(math.radians(degrees)) + source.uniform(-1e-3, 1e-3)
                steer = inverse(vx=vx, vy=0.0, omega=-0.3, **dict.fromkeys(steered, steer))["rear.steer"]
                seen.append(steer)
            swings = [b - a for a, b in pairwise(seen) if abs(b - a) > math.radians(1)]
            assert len(swings) <= 1, (degrees, angle)


def test_a_thousand_steps_at_the_stop_stay_in_the_band() -> None:
    """Lines within 4 degrees of the stop to either side; `slip` tells what clipping costs."""
    inverse = forklift(-90, 180).derivation.numpy().inverse
    source, angle, seen, slips = random.Random(8), -1.0, [], []
    for _ in range(1000):
        line = math.pi / 2 + source.uniform(-1, 1) * math.radians(4)
        out = inverse(vx=0.36 / math.tan(line), vy=0.0, omega=-0.3, **{"rear.steer": angle})
        angle = out["rear.steer"]
        seen.append(angle)
        slips.append(out["slip"])
        assert out["slip"] == pytest.approx(0.36 / math.sin(line) * abs(math.sin(line - angle)), abs=1e-12)
    assert max(seen) - min(seen) < STAY
    assert 0.02 < max(slips) <= 0.361 * math.sin(STAY) and min(slips) == 0


def several(source: random.Random, count: int = 6) -> tuple[Model, list[tuple[float, float]]]:
    """Parallel wheels, each with limits of its own, and those limits [rad]."""
    limits = [(source.randint(-200, 100), source.choice(WIDTHS)) for _ in range(count)]
    wheels = [
        wheel(f"w{i}", "steered", 0.1 * i - 0.3, 0.07 * i * i - 0.5) | {"limits": {"steer": interval}}
        for i, interval in enumerate(limits)
    ]
    radians = [(math.radians(low), math.radians(low + width)) for low, width in limits]
    return derived({"wheels": wheels, "couplings": []}), radians


def edges(source: random.Random, limits: list[tuple[float, float]]) -> Iterator[tuple[float, list[float]]]:
    """Lines beside all that decides for one of the wheels, and where the wheels stand."""
    for low, high in limits:
        middle, half = (low + high) / 2, (high - low) / 2
        for reach in (half, half + stay(low, high), math.pi / 2, math.pi / 2 + stay(low, high) / 2, 0.0):
            for side in (-1, 1):
                for beside in NEAR:
                    line = middle + side * reach + source.choice((-1, 1)) * beside
                    choices = [
                        source.choice((a, b, a - 0.01, b + 0.01, source.uniform(a, b))) for a, b in limits
                    ]
                    yield line, choices
        yield (
            source.choice((0.0, math.pi / 2, math.pi)),
            [source.choice((0.0, -0.0, math.pi / 2))] * len(limits),
        )


@pytest.mark.parametrize("seed", everyday(range(12), [0]))
def test_the_branch_is_that_of_every_branch_tried(seed: int) -> None:
    """On both sides of every threshold, in exact arithmetic, CasADi, and C in float and double."""
    source = random.Random(seed)
    model, limits = several(source)
    cases, wanted = [], []
    for line, standing in edges(source, limits):
        speed, forwards = source.uniform(0.1, 2), source.choice((-1, 1))
        velocity = speed * forwards * math.cos(line), speed * forwards * math.sin(line)
        steers = {f"w{i}.steer": now for i, now in enumerate(standing)}
        cases.append({"vx": velocity[0], "vy": velocity[1], "omega": 0.0} | steers)
        wanted.append((line, speed * forwards, standing))
    d = model.derivation
    exact = [evaluate_module(d.raw_module, "inverse", case, EXACT) for case in cases[::8]]
    requests = [("inverse", case) for case in cases]
    answers: list[tuple[str, int, float, list[Any]]] = [
        ("exact", 8, 1e-9, exact),
        ("casadi", 1, 1e-9, [model.call("inverse", case) for case in cases]),
        ("double", 1, 1e-9, evaluate_c(d.c_module, requests, Choice("double"))),
        ("float", 1, 2e-6, evaluate_c(d.c_module, requests)),
    ]
    for name, step, rounding, outs in answers:
        for out, (line, speed, standing) in zip(outs, wanted[::step], strict=True):
            held = []
            for i, ((low, high), now) in enumerate(zip(limits, standing, strict=True)):
                angle = float(out[f"w{i}.steer"])
                good = right(line, low, high, now, rounding)
                assert any(abs(angle - g) < 3 * rounding for g in good), (name, i, line, now, good, angle)
                spin = speed * math.cos(line - angle) / 0.1
                assert float(out[f"w{i}.spin"]) == pytest.approx(spin, abs=1e3 * rounding)
                if high - low < math.radians(190):
                    held.append(speed * math.sin(line - angle))
            if "slip" in out:
                slip = math.sqrt(sum(v * v for v in held))
                assert float(out["slip"]) == pytest.approx(slip, abs=1e2 * rounding)
