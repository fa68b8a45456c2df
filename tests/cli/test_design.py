"""`wmrgen rollers`: sizes from Tzafestas (2.86)-(2.91), and designs that cannot be."""

from __future__ import annotations

import json
import math
from collections.abc import Callable

import pytest

from tests.conftest import Outcome

Cli = Callable[..., Outcome]


def rollers(cli: Cli, radius: str, count: str, angle: str, *more: str) -> Outcome:
    return cli("rollers", "--radius", radius, "--count", count, "--angle", angle, *more)


@pytest.mark.parametrize("words", [("150mm", "8", "45deg"), ("0.15", "8", "pi/4"), ("15 cm", "8", "45 deg")])
def test_rollers_of_tzafestas_2_88(wmrgen_cli: Cli, words: tuple[str, str, str]) -> None:
    done = rollers(wmrgen_cli, *words)
    assert done.code == 0 and done.err == ""
    half = 0.15 * math.sin(math.pi / 8)
    found = {line.split()[0]: float(line.split()[2]) for line in done.out.splitlines()[:3]}
    assert found == pytest.approx({"D_r": 2 * half * math.sqrt(2), "d": 2 * half, "b": half})
    assert all(" m  " in line for line in done.out.splitlines()[:3])
    assert "gamma of the robot file: ±45 deg" in done.out


def test_rollers_as_json(wmrgen_cli: Cli) -> None:
    found = json.loads(rollers(wmrgen_cli, "150mm", "6", "90deg", "--json").out)
    assert found["d"] == 0.0 and found["gamma_deg"] == 0.0
    assert found["D_r"] == pytest.approx(2 * 0.15 * math.sin(math.pi / 6))


@pytest.mark.parametrize(
    ("words", "names"),
    [
        (("0", "8", "45deg"), "radius"),
        (("-150mm", "8", "45deg"), "radius"),
        (("150mm", "2", "45deg"), "3"),
        (("150mm", "7.5", "45deg"), "15/2"),
        (("150mm", "8", "0deg"), "0 deg"),
        (("150mm", "8", "91deg"), "91 deg"),
        (("150mm", "8", "45"), " 45deg"),
        (("150kg", "8", "45deg"), "'kg'"),
        (("150deg", "8", "45deg"), "'150deg'"),
        (("150mm", "eight", "45deg"), "'eight'"),
    ],
)
def test_rollers_refuse_what_cannot_be(wmrgen_cli: Cli, words: tuple[str, str, str], names: str) -> None:
    done = rollers(wmrgen_cli, *words)
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("error[WMR112]") and names in done.err


def test_gains_in_words(wmrgen_cli: Cli) -> None:
    """Roots of s + 0.5 and of s^2 + 10 s + 3."""
    done = wmrgen_cli("gains", "k_rho=0.5", "k_alpha=10.5", "k_beta=-6")
    assert "stable          = yes\n" in done.out and "violated        = nothing\n" in done.out
    assert "polynomial      = +1 s^3 +10.5 s^2 +8 s +1.5\n" in done.out
    assert "eigenvalues     = -0.5, -0.309584, -9.69042 1/s\n" in done.out
    assert done.err == "not from every pose: k_alpha + 2 k_beta - 2/pi k_rho > 0 fails\n"
