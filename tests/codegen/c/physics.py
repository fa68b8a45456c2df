"""The motion of a robot for the commands of its example: rigid-body motion in which no driven wheel slides.

The examples of many robots are one program, and print the wanted twist and the commands of every step.
"""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tests.codegen.c.example import DT, HOOKED, STEPS, integrated
from tests.conftest import put
from tests.oracle import oracle
from wmrgen.codegen.c import emit
from wmrgen.codegen.compiler import compile_program
from wmrgen.codegen.registry import Facts
from wmrgen.derivation.emit import site
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.layout.records import Wheel

Array = NDArray[np.float64]
EVERY = 10  # steps: one of them is checked
FLAGS = ("-std=c99", "-O0", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror")
RECORD = """
#include <stdio.h>
int drive_{name}(void);
static void record(void)
{{
    float row[3 + {joints}];
    int i;

    row[0] = asked.vx;
    row[1] = asked.vy;
    row[2] = asked.omega;
    for (i = 0; i < {joints}; ++i) {{
        row[3 + i] = *{name}_joint(&commands, i);
    }}
    (void)fwrite(row, sizeof row, 1, stdout);
}}
int drive_{name}(void) {{ return drive(); }}
"""


def driven(robots: Sequence[Derivation], folder: Path) -> list[Array]:
    """Return for each robot the steps of its example: wanted twist [m/s, m/s, rad/s], then the commands of all
    joints."""
    sources, cases, declared = [], [], []
    for d in robots:
        name = d.robot.name
        own = folder / name
        own.mkdir()
        put(own, emit(d.c_module, Facts(site=site(d), options={"target": "m4f"})))
        text = (own / "example/main.c").read_text()
        for old, new in (
            ("    hardware();\n}", "    record();\n    hardware();\n}"),
            ("static void step(void)", "static void record(void);\nstatic void step(void)"),
            ("        step();", "        asked = wanted;\n        step();"),
            (f"static {name}_twist wanted;", f"static {name}_twist wanted, asked;"),
            ("int main(void)", "static int main(void)"),
        ):
            assert text.count(old) == 1
            text = text.replace(old, new)
        (own / "example/main.c").write_text(text)
        record = RECORD.format(name=name, joints=len(d.c_module.joints or ()))
        (own / "program.c").write_text(HOOKED.format(upper=name.upper()) + record)
        sources += [f"{name}/{name}.c", f"{name}/program.c"]
        declared.append(f"int drive_{name}(void);")
        cases.append(f"case {len(cases)}: return drive_{name}();")
    chosen = f"switch (n > 1 ? atoi(words[1]) : 0) {{ {' '.join(cases)} default: return 1; }}"
    main = f"int main(int n, char **words) {{ {chosen} }}"
    (folder / "all.c").write_text("\n".join(["#include <stdlib.h>", *declared, main, ""]))
    program = compile_program(folder, ["all.c", *sources], None, FLAGS)
    rows = []
    for k in range(len(robots)):
        done = subprocess.run([program, str(k)], stdout=subprocess.PIPE, check=True)
        rows.append(np.frombuffer(done.stdout, dtype=np.float32).astype(float).reshape(STEPS, -1))
    return rows


class Drive(NamedTuple):
    """``length`` of the figure [m]; how far the robot is from it at most, as a share of that, and in heading [rad];
    how fast a wheel slides at most, as a share of the largest speed; whether the commands determine the motion."""

    length: float
    off: float
    turned: float
    slides: float
    determined: bool


def drive(d: Derivation, rows: Array) -> Drive:
    """Return the motion for the commands.

    If they do not determine it, the motion nearest to the wanted one is taken.
    """
    joints = {name: 3 + k for k, name in enumerate(d.c_module.joints or ())}
    rates = {w.name: rows[:, joints[f"{w.name}.steer_rate"]] for w in d.robot.wheels
             if w.kind.swivels and f"{w.name}.steer_rate" in joints}  # fmt: skip
    swivelled = {name: DT * (np.cumsum(rate) - rate) for name, rate in rates.items()}
    wanted = rows[::EVERY, :3]
    twists, slides, determined = [], 0.0, True
    for k, row in enumerate(rows[::EVERY]):
        commands = {name: float(row[i]) for name, i in joints.items()}
        a, b = constraints(d, commands, {name: float(angle[k * EVERY]) for name, angle in swivelled.items()})
        more, _, rank, _ = np.linalg.lstsq(a, b - a @ row[:3], rcond=1e-6)
        twists.append(row[:3] + more)
        slides = max(slides, float(np.abs(a @ twists[-1] - b).max()))
        determined &= rank == 3
    figure, path = integrated(wanted, EVERY * DT), integrated(np.array(twists), EVERY * DT)
    length = float(np.hypot(*np.diff(figure[:, :2], axis=0).T).sum())
    off = figure - path
    fastest = float(np.hypot(*wanted[:, :2].T).max())
    return Drive(
        length,
        float(np.hypot(*off[:, :2].T).max()) / max(length, 1e-9),
        float(np.abs(np.angle(np.exp(1j * off[:, 2]))).max()),
        slides / max(fastest, 1e-9),
        determined,
    )


def constraints(
    d: Derivation, commands: Mapping[str, float], swivelled: Mapping[str, float]
) -> tuple[Array, Array]:
    """Return (A, b) with A twist = b: driven wheels roll at their commands, and wheels do not slide sideways."""
    rows, values = [np.zeros(3)], [0.0]
    for w in d.robot.wheels:
        steer = swivelled.get(w.name, 0.0) if w.kind.swivels else commands.get(f"{w.name}.steer", 0.0)
        rate = commands.get(f"{w.name}.steer_rate", 0.0)
        spin = commands.get(f"{w.name}.spin", 0.0) - float(w.nominal.per_steer) * rate
        for kind, row, per_spin, per_rate in oracle.wheel_rows(record(w), steer):
            driven = (
                "spin" in w.actuated if kind == "rolling" else "steer" in w.actuated or not w.kind.swivels
            )
            if driven and not (w.type == "spherical" and not w.ball):
                rows.append(row)
                values.append(-per_spin * spin - per_rate * rate)
    return np.array(rows), np.array(values)


def record(w: Wheel) -> oracle.Wheel:
    """Return the wheel in the form of the oracle."""
    g = w.nominal
    return {
        "type": "spherical" if w.ball else w.type, "x": w.pivot.real, "y": w.pivot.imag, "heading": w.heading,
        "r": float(g.r), "gamma": w.gamma, "d": float(g.d), "o": float(g.o), "driven": bool(w.ball),
    }  # fmt: skip
