"""The example of a robot, on the host or built for a board, and the figure that it should drive, computed
independently."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.conftest import put
from wmrgen import derive, load
from wmrgen.codegen.c import emit
from wmrgen.codegen.compiler import compile_program, run_program
from wmrgen.codegen.registry import Facts
from wmrgen.derivation.emit import site
from wmrgen.derivation.facade import Derivation

STEPS, DT = 6000, 0.01
WHEELS = {
    "pair": """
parameters: {radius: {value: 0.0975, tunable: true}}
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.1655,  heading: 0, r: radius,
     encoder: {spin: {counts: 500, gear: 38.3, bits: 16}}}
  - {name: right, type: fixed, x: 0, y: -0.1655, heading: 0, r: radius,
     encoder: {spin: {counts: 500, gear: 38.3, bits: 16, reversed: true}}}
  - {name: tail,  type: castor, x: -0.22, y: 0, heading: pi, d: 0.04, r: 0.05}
noise: {spin: {proportional: 0.02, constant: 0.01}}
limits: {vx: 1.2, omega: 4, spin: 14, vx_rate: 1, omega_rate: 2}
functions: [joints_from_counts, forward_covariance, odometry_covariance, limit_twist, limit_acceleration, desaturate]
""",
    "swerve": """
wheels:
  - {name: fl, type: steered, x: 0.4,  y: 0.3,  heading: 0, r: 0.05,
     encoder: {spin: {counts: 4096, gear: 6.75}, steer: {counts: 16384, gear: 12.8}}}
  - {name: fr, type: steered, x: 0.4,  y: -0.3, heading: 0, r: 0.05,
     encoder: {spin: {counts: 4096, gear: 6.75}, steer: {counts: 16384, gear: 12.8}}}
  - {name: bl, type: steered, x: -0.4, y: 0.3,  heading: 0, r: 0.05,
     encoder: {spin: {counts: 4096, gear: 6.75}, steer: {counts: 16384, gear: 12.8}}}
  - {name: br, type: steered, x: -0.4, y: -0.3, heading: 0, r: 0.05,
     encoder: {spin: {counts: 4096, gear: 6.75}, steer: {counts: 16384, gear: 12.8}}}
limits: {vx: 3, vy: 3, omega: 4, spin: 80, vx_rate: 4, vy_rate: 4, omega_rate: 8, steer_rate: 10}
functions: [joints_from_counts, odometry_compensated, limit_twist, limit_acceleration, desaturate]
""",
    "castors": """
wheels:
  - {name: a, type: castor, x: 0.2,  y: 0.15, heading: 0, d: -0.03, r: 0.055, actuated: [spin, steer]}
  - {name: b, type: castor, x: -0.2, y: 0.1,  heading: 0, d: -0.03, r: 0.055, actuated: [spin, steer]}
  - {name: c, type: castor, x: 0,    y: -0.2, heading: 0, d: -0.03, r: 0.055, actuated: [spin, steer]}
""",
    "mecanum": """
wheels:
  - {name: fl, type: swedish, x: 0.3,  y: 0.2,  heading: 0, gamma: -45 deg, r: 0.1}
  - {name: fr, type: swedish, x: 0.3,  y: -0.2, heading: 0, gamma: 45 deg, r: 0.1}
  - {name: bl, type: swedish, x: -0.3, y: 0.2,  heading: 0, gamma: 45 deg, r: 0.1}
  - {name: br, type: swedish, x: -0.3, y: -0.2, heading: 0, gamma: -45 deg, r: 0.1}
limits: {vx: 1, vy: 1, omega: 4, spin: 40}
noise: {spin: {proportional: 0.05}}
functions: [forward_covariance, odometry_covariance, desaturate]
""",
    "car": """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.06}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.06}
  - {name: fl, type: steered, x: 0.5, y: 0.2,  heading: 0, r: 0.06, actuated: [steer], limits: {steer: 45 deg}}
  - {name: fr, type: steered, x: 0.5, y: -0.2, heading: 0, r: 0.06, actuated: [steer], limits: {steer: 45 deg}}
limits: {vx: 1, omega: 4, spin: 40, vx_rate: 1, omega_rate: 1}
functions: [limit_twist, limit_acceleration, desaturate]
""",
}  # fmt: skip
# Prints the wanted twist and the measured pose of every step.
HOOKED = """
#define {upper}_EXAMPLE_MAIN
#define main drive
#include "example/main.c"
#undef main
"""
PRINTED = """
#include <stdio.h>
static void record(void)
{
    printf("%.9g %.9g %.9g %.9g %.9g %.9g\\n", (double)pose.x, (double)pose.y, (double)pose.theta,
        (double)wanted.vx, (double)wanted.vy, (double)wanted.omega);
}
"""
MAIN = "int main(void) { return drive(); }\n"


def driven(robot: str, folder: Path) -> Derivation:
    """Return a robot of `WHEELS` with the name ``driven``."""
    (folder / "driven.yaml").write_text(f"wmrgen: 1\nname: driven\n{WHEELS[robot]}")
    return derive(load(folder / "driven.yaml"))


def written(folder: Path, d: Derivation, program: str, target: str = "m4f") -> list[str]:
    """The C files of a robot in ``folder``: ``program`` behind its example, whose main is called `drive` and calls
    `record` in every step, before the motors."""
    put(folder, emit(d.c_module, Facts(site=site(d), options={"target": target})))
    text = (folder / "example/main.c").read_text()
    assert text.count("    hardware();\n}") == text.count("int main(void)") == 1
    text = text.replace("    hardware();\n}", "    record();\n    hardware();\n}")
    text = text.replace("static void step(void)", "static void record(void);\nstatic void step(void)")
    text = text.replace("int main(void)", "int main(void);\nint main(void)")
    (folder / "example/main.c").write_text(text)
    (folder / "program.c").write_text(HOOKED.format(upper=d.robot.name.upper()) + program)
    return [f"{d.robot.name}.c", "program.c"]


def recorded(folder: Path, d: Derivation, target: str = "m4f", program: str = PRINTED + MAIN) -> np.ndarray:
    """Return for each step of the example the measured x, y, theta [m, m, rad] and the wanted twist [m/s, m/s,
    rad/s]."""
    sources = written(folder, d, program, target)
    flags = ("-std=c99", "-O1", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror")
    printed = run_program(compile_program(folder, sources, None, flags), "")
    return np.array([[float(v) for v in line.split()] for line in printed.splitlines()])


def integrated(twists: np.ndarray, dt: float = DT) -> np.ndarray:
    """The poses of a point that drives ``twists``, steps x 3, from one to the next, each for ``dt``.

    The turn in a step is small: its matrix exponential as a series.
    """
    place, path = np.eye(3), []
    for vx, vy, omega in twists:
        path.append((place[0, 2], place[1, 2], np.arctan2(place[1, 0], place[0, 0])))
        a = dt * np.array([[0, -omega, vx], [omega, 0, vy], [0, 0, 0]])
        place = place @ (np.eye(3) + a + a @ a / 2 + a @ a @ a / 6)
    return np.array(path)
