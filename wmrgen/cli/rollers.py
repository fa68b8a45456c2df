"""``wmrgen rollers``: sizes of the rollers of a mecanum wheel, Tzafestas (2.86)-(2.91)."""

from __future__ import annotations

from typing import Annotated

from wmrgen.cli import console
from wmrgen.cli.declare import Json, option, verb
from wmrgen.cli.values import from_option
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import Exact

_NAMES = {"length": "D_r", "width": "d", "half_chord": "b"}  # of the outputs, in the text


@verb("rollers")
def rollers(
    radius: Annotated[str, option("Radius of the wheel: 150mm, 0.15.")],
    count: Annotated[str, option("Number of rollers, at least 3.")],
    angle: Annotated[str, option("Angle from hub axis to roller axis: 45deg; 90deg is an omni wheel.")],
    as_json: Json = False,
) -> int:
    """Example:  wmrgen rollers --radius 150mm --count 8 --angle 45deg

    Size the rollers of a mecanum wheel: length of a roller, width of the wheel (Tzafestas (2.86)-(2.91)).
    """
    from wmrgen.analysis.kinematics.contacts import mecanum_roller
    from wmrgen.geometry.exact.evaluate import pi_rational
    from wmrgen.ir.interpret import EXACT, evaluate
    from wmrgen.ir.lower import lower

    function = lower(mecanum_roller())
    words = {"radius": radius, "count": count, "angle": angle}
    case = {port.name: from_option(f"--{port.name}", words[port.name], [port])[0] for port in function.inputs}
    in_degrees = float(case["angle"] / pi_rational()) * 180
    _refuse_impossible(case["radius"], case["count"], in_degrees, angle)
    rounding = 1e-15 * float(case["radius"])  # m: what 60 digits of pi leave of a zero
    sizes = {}
    for name, value in evaluate(function, case, EXACT).items():
        size = float(value)
        sizes[_NAMES[name]] = size if abs(size) > rounding else 0.0
    gamma = round(90 - in_degrees, 9) + 0.0
    if as_json:
        console.data({**sizes, "gamma_deg": gamma})
        return 0
    for port in function.outputs:
        name = _NAMES[port.name]
        console.result(f"{name:<3} = {sizes[name]!r} m  {port.text}")
    sign = "±" if gamma else ""
    console.result(f"gamma of the robot file: {sign}{gamma:g} deg, wheel plane to roller axis at the ground")
    return 0


def _refuse_impossible(radius: Exact, count: Exact, in_degrees: float, angle: str) -> None:
    """Raise UsageError for an impossible wheel; ``in_degrees`` is the angle that the user wrote as ``angle``."""
    if radius.sign <= 0:
        raise UsageError("the radius is not positive. Write the radius of the wheel, as 150mm.")
    if not count.is_rational or count.parts[0].denominator != 1 or count < 3:
        raise UsageError(f"{count} rollers do not close a wheel: the count is a whole number of at least 3.")
    if not 0 < in_degrees <= 90 + 1e-9:  # 1e-9: 90 degrees in radians is not exact
        hint = f" A bare number is in radians: write {angle}deg." if angle.strip()[-1:].isdigit() else ""
        raise UsageError(
            f"a roller angle of {in_degrees:.6g} deg is impossible: the angle from the hub axis to the roller axis is "
            f"more than 0 and at most 90 deg (90 deg is an omni wheel).{hint}"
        )
