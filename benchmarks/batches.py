"""Time of `forward` per state over many states [ns]: the array module, hand-written NumPy, CasADi's map and C."""

from __future__ import annotations

import importlib.util
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median
from typing import Any

import casadi
import numpy as np

import wmrgen
from benchmarks.speed import ROOT
from wmrgen.codegen.arrays import emit
from wmrgen.codegen.registry import Facts

STATES = 1_000_000
ROBOT = ROOT / "robots" / "wpilib_swervebot.yaml"
WHEELS = ("front_left", "front_right", "back_left", "back_right")
RADIUS, HALF = 0.0508, 0.381
TARGET = 1.1


def by_hand(s0: Any, a0: Any, s1: Any, a1: Any, s2: Any, a2: Any, s3: Any, a3: Any) -> tuple[Any, Any, Any]:
    """Return the least-squares twist of a square swerve base, as one writes it by hand."""
    x0, y0, x1, y1 = s0 * np.cos(a0), s0 * np.sin(a0), s1 * np.cos(a1), s1 * np.sin(a1)
    x2, y2, x3, y3 = s2 * np.cos(a2), s2 * np.sin(a2), s3 * np.cos(a3), s3 * np.sin(a3)
    vx = RADIUS / 4 * (x0 + x1 + x2 + x3)
    vy = RADIUS / 4 * (y0 + y1 + y2 + y3)
    omega = RADIUS / (8 * HALF) * (-x0 + y0 + x1 + y1 - x2 - y2 + x3 - y3)
    return vx, vy, omega


def with_slip(*joints: Any) -> tuple[Any, ...]:
    """Return the twist of `by_hand` and the norm of the residual."""
    vx, vy, omega = by_hand(*joints)
    total = 0
    for k, (x, y) in enumerate(((HALF, HALF), (HALF, -HALF), (-HALF, HALF), (-HALF, -HALF))):
        speed, angle = RADIUS * joints[2 * k], joints[2 * k + 1]
        total = total + (speed * np.cos(angle) - (vx - y * omega)) ** 2
        total = total + (speed * np.sin(angle) - (vy + x * omega)) ** 2
    return vx, vy, omega, np.sqrt(total)


def in_turn(calls: dict[str, Callable[[], Any]], runs: int) -> dict[str, list[float]]:
    """Return the times of each call [s]. Each round makes all calls once; a first round is not counted."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for k in range(runs + 1):
        for name, call in calls.items():
            start = time.perf_counter()
            call()
            if k:
                times[name].append(time.perf_counter() - start)
    return times


def table(runs: int) -> Iterator[str]:
    """Yield the table. Calls alternate, so a busy machine slows all of them; ratios are medians over the rounds."""
    derivation = wmrgen.derive(wmrgen.load(ROBOT))
    source = np.random.default_rng(0)
    joints = [source.uniform(-3, 3, STATES) for _ in range(2 * len(WHEELS))]
    names = [f"{wheel}_{joint}" for wheel in WHEELS for joint in ("spin", "steer")]
    inputs = dict(zip(names, joints, strict=True))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "swervebot.py"
        path.write_bytes(emit(derivation.array_module, Facts())["wpilib_swervebot.py"])
        spec = importlib.util.spec_from_file_location("swervebot", path)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    double, single = derivation.compiled(), derivation.compiled("float")
    narrow = {name: column.astype(np.float32) for name, column in inputs.items()}
    mapped = derivation.casadi()["forward"].map(STATES)
    rows = [casadi.DM(column).T for column in joints]
    calls: dict[str, Callable[[], Any]] = {
        "NumPy by hand": lambda: by_hand(*joints),
        "`<robot>.py`, `forward_twist`": lambda: module.forward_twist(**inputs),
        "NumPy by hand, with slip": lambda: with_slip(*joints),
        "`<robot>.py`, `forward`": lambda: module.forward(**inputs),
        "CasADi's map, `forward`": lambda: mapped(*rows),
        "`compiled()`, `forward_twist`": lambda: double.forward_twist(**inputs),
        "`compiled()`, `forward`": lambda: double.forward(**inputs),
        '`compiled("float")`, `forward_twist`': lambda: single.forward_twist(**narrow),
        '`compiled("float")`, `forward`': lambda: single.forward(**narrow),
    }
    times = in_turn(calls, runs)
    yield f"| `forward` of a swerve base, {STATES} states | ns a state | to NumPy by hand | target |"
    yield "|---|---:|---:|---:|"
    for name, seconds in times.items():
        slip = "twist" not in name and name != "NumPy by hand"
        reference = times["NumPy by hand, with slip" if slip else "NumPy by hand"]
        ratio = median(own / other for own, other in zip(seconds, reference, strict=True))
        target = f"{TARGET}" if name.startswith("`<robot>.py`") else ""
        yield f"| {name} | {median(seconds) / STATES * 1e9:.1f} | {ratio:.2f} | {target} |"


if __name__ == "__main__":
    for line in table(int(sys.argv[1]) if len(sys.argv) > 1 else 7):
        print(line)
