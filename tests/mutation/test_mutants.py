"""The shipped self-tests kill every mutant of the C that is a fault.

The C is that of ``--math libm --target host``. What a self-test cannot see, a last coefficient of a kernel that is off
by less than the bound, is seen where every float is tried: `tests/accuracy`.
"""

from __future__ import annotations

import shutil
from collections import Counter
from pathlib import Path

import pytest

from tests.mutation.equal import Judge
from tests.mutation.mutants import mutate
from tests.mutation.run import survivors
from tests.robots import of_gallery
from wmrgen.derivation.emit import artifacts
from wmrgen.ir.kernels.choice import LIBM, Choice

PLAIN = Choice("float", LIBM)
LEAST = 70
MOST_EQUIVALENT = 0.15  # of all mutants; more would say that the faults are badly chosen
EVERYDAY = {"differential": "turtlebot3_burger"}
FAMILIES = {
    "ackermann": "ackermann_car",
    "swerve": "wpilib_swervebot",
    "tunable": "pioneer3dx",
    "mecanum": "clearpath_do100",
    "omni": "lekiwi",
    "castor": "nomad_xr4000",
}

pytestmark = pytest.mark.skipif(
    not shutil.which("cc") and not shutil.which("gcc"), reason="no C compiler here"
)


def check(robot: str, folder: Path) -> None:
    derivation = of_gallery(robot)
    files = artifacts(derivation, PLAIN)
    tried, alive = survivors(robot, files, folder)
    judge = Judge(derivation.c_module, files[f"{robot}.c"].decode())
    assert [str(m) for m in alive if not judge.equivalent(m)] == []
    assert tried - len(alive) >= LEAST
    assert len(alive) <= MOST_EQUIVALENT * tried


@pytest.mark.parametrize("family", EVERYDAY)
def test_killed(family: str, tmp_path: Path) -> None:
    check(EVERYDAY[family], tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_killed_too(family: str, tmp_path: Path) -> None:
    check(FAMILIES[family], tmp_path)


def test_mutants_are_what_they_say() -> None:
    text = "void f(const f_in *in, f_out *out)\n{\n    const float t0 = 0.5f * in->a - in->b;\n\n    out->c = t0;\n}\n"
    source, found = mutate(text)
    kinds = Counter(m.kind for m in found)
    assert kinds["operator"] == 2 and kinds["operands swapped"] == 1 and kinds["dropped"] == 4
    assert kinds["sign"] == 4 and kinds["constant"] == 1 and kinds["another member"] == 2
    assert (
        found[0].after == "((0.5f * in->a) + in->b)"
        and found[0].before == "const float t0 = 0.5f * in->a - in->b"
    )
    assert f"t0 = (mutant == 1) ? ({found[0].after}) : " in source and ": (0.5f * in->a - in->b);" in source


def test_a_fault_is_not_called_equivalent(tmp_path: Path) -> None:
    """Of the mutants that die, none passes for an equivalent one."""
    derivation = of_gallery("lekiwi")
    files = artifacts(derivation, PLAIN)
    _, alive = survivors("lekiwi", files, tmp_path)
    _, mutants = mutate(files["lekiwi.c"].decode())
    judge = Judge(derivation.c_module, files["lekiwi.c"].decode())
    dead = [m for m in mutants if m not in alive and "params_default" not in m.function]
    assert dead and not [str(m) for m in dead if judge.equivalent(m)]
