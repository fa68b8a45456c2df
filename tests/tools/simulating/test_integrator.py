"""Simulated drives against a general integrator for ordinary differential equations, written from the definitions."""

from __future__ import annotations

import cmath
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.conftest import ROOT
from tests.tools.simulating.test_simulate import Twists, model, poses
from wmrgen.tools.simulating.drive import simulate

pytestmark = pytest.mark.slow

# Robots with castors, with trailers, with steered wheels, and without any of them.
ROBOTS = (
    "pioneer3dx", "nomad_xr4000", "turtlebot3_burger", "tractor_off_axle", "festo_robotino", "wpilib_swervebot",
    "mir_100", "neobotix_mp_400", "kuka_youbot", "textbook_differential",
)  # fmt: skip
# Seconds, vx, vy [m/s] and omega [rad/s]; robots that cannot drive sideways drive with vy = 0.
COURSE = ((1.0, 0.3, 0.1, 0.5), (0.7, -0.25, 0.0, 0.4), (0.5, 0.0, 0.0, -1.2), (0.8, 0.4, -0.2, 0.0))
START = (0.3, -0.2, 0.7)


def castor_rate(wheel: object, psi: float, twist: tuple[float, float, float]) -> float:
    """-(n . v + d omega) / d, where v is the velocity of the pivot: the contact point does not slide."""
    x, y = wheel.pivot.real, wheel.pivot.imag  # type: ignore[attr-defined]
    heading, d = wheel.heading + psi, float(wheel.nominal.d)  # type: ignore[attr-defined]
    vx, vy, omega = twist
    v = complex(vx - y * omega, vy + x * omega)
    n = 1j * cmath.exp(1j * heading)
    return -((v * n.conjugate()).real + d * omega) / d


@pytest.mark.parametrize("name", ROBOTS)
def test_pose_and_angles_are_those_of_a_general_integrator(name: str, tmp_path: Path) -> None:
    robot = model(ROOT / "robots" / f"{name}.yaml", tmp_path)
    sideways = robot.derivation.mobility.degree_of_mobility == 3 or "swerve" in name
    course = [(t, vx, vy if sideways else 0.0, w) for t, vx, vy, w in COURSE]
    castors = [w for w in robot.robot.wheels if w.kind.swivels]
    trailers = robot.robot.trailers
    angles = {f"{w.name}.steer": 0.3 + 0.2 * k for k, w in enumerate(castors)}
    angles |= {f"{t.name}.theta": 0.4 - 0.1 * k for k, t in enumerate(trailers)}
    drive = simulate(robot, robot.start(poses(START), angles), Twists(*course))
    _, _, axle_x, axle_y = robot.leading

    state = np.array([*START, *angles.values()])
    for seconds, vx, vy, omega in course:

        def rates(
            _: float, q: np.ndarray, twist: tuple[float, float, float] = (vx, vy, omega)
        ) -> list[float]:
            x_rate = twist[0] * math.cos(q[2]) - twist[1] * math.sin(q[2])
            y_rate = twist[0] * math.sin(q[2]) + twist[1] * math.cos(q[2])
            found = [x_rate, y_rate, twist[2]]
            found += [castor_rate(w, q[3 + k], twist) for k, w in enumerate(castors)]
            # Velocity of the axle in front, along the world's axes; the axle of a trailer does not slide.
            v = complex(x_rate, y_rate) + 1j * twist[2] * complex(axle_x, axle_y) * cmath.exp(1j * q[2])
            heading, turning = q[2], twist[2]
            for k, t in enumerate(trailers):
                own = q[3 + len(castors) + k]
                hitch, length = float(t.hitch.nominal), float(t.length.nominal)
                v -= 1j * turning * hitch * cmath.exp(1j * heading)
                turning = (v * (1j * cmath.exp(1j * own)).conjugate()).real / length
                v -= 1j * turning * length * cmath.exp(1j * own)
                heading = own
                found.append(turning)
            return found

        state = solve_ivp(rates, (0.0, seconds), state, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    names = ["x", "y", "theta", *angles]
    np.testing.assert_allclose([drive.columns[n][-1, 0] for n in names], state, atol=1e-9)
    np.testing.assert_allclose(drive.pose(-1, 0), state[:3], atol=1e-11)
