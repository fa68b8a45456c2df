"""``wmrgen rollers``: sizes of the rollers of a mecanum wheel (Tzafestas (2.86)-(2.91))."""

from __future__ import annotations

from wmrgen.cli import console
from wmrgen.cli.values import from_words
from wmrgen.errors import UsageError
from wmrgen.exact.evaluate import pi_rational
from wmrgen.exact.number import Exact

FEWEST = 3
NEGLIGIBLE = 1e-15
_NAMES = {"length": "D_r", "width": "d", "half_chord": "b"}


def run(radius: str, count: str, angle: str, *, as_json: bool) -> int:
    """Print roller length D_r, wheel width d and half chord b in metres."""
    from wmrgen.ir.interpret import EXACT, evaluate
    from wmrgen.kinematics.rollers import mecanum_roller
    from wmrgen.lower import lower

    function = lower(mecanum_roller())
    case = dict(from_words([f"radius={radius}", f"count={count}", f"angle={angle}"], function.inputs))
    _refuse_impossible(case, angle)
    sizes = evaluate(function, case, EXACT)
    size = float(case["radius"])
    values = {_NAMES[k]: v if abs(v) > NEGLIGIBLE * size else 0.0 for k, v in
              ((k, float(v)) for k, v in sizes.items())}  # fmt: skip
    gamma = 90 - float(case["angle"] / pi_rational()) * 180
    gamma = round(gamma, 9) + 0.0
    if as_json:
        console.data({**values, "gamma_deg": gamma})
        return 0
    for port in function.outputs:
        name = _NAMES[port.name]
        console.result(f"{name:<3} = {values[name]!r} m  {port.text}")
    sign = "±" if gamma else ""
    console.result(f"gamma of the robot file: {sign}{gamma:g} deg, wheel plane to roller axis at the ground")
    return 0


def _refuse_impossible(case: dict[str, Exact], angle: str) -> None:
    if case["radius"].sign <= 0:
        raise UsageError("the radius is not positive. Write the radius of the wheel, as 150mm.")
    count = case["count"]
    if not count.is_rational or count.parts[0].denominator != 1 or count < FEWEST:
        raise UsageError(
            f"{count} rollers do not close a wheel: the count is a whole number of at least {FEWEST}."
        )
    turn = float(case["angle"] / pi_rational()) * 180
    if not 0 < turn <= 90 + 1e-9:
        hint = f" A bare number is in radians: write {angle}deg." if angle.strip()[-1:].isdigit() else ""
        raise UsageError(
            f"a roller angle of {turn:.6g} deg is impossible: from the hub axis to the roller axis there are more "
            f"than 0 and at most 90 deg (90 deg is an omni wheel).{hint}"
        )
