"""AA274, lecture 1."""

from __future__ import annotations

from textbook.index.records import LIBRARY, Row

TEXT = "AA274"
DEGREES = "degree_of_mobility,degree_of_steerability,degree_of_maneuverability=degrees"


def row(places: str, says: str, robot: str, command: str, inputs: str, outputs: str, case: str = "") -> Row:
    """Return a row of this text; see `Row`."""
    return Row(TEXT, places, says, robot, command, inputs, outputs, case)


ROWS: tuple[Row, ...] = (
    row("no slip disk", "a rolling disk does not slide", LIBRARY, "eval disk_constraint",
        "phi=pi/6 x_rate=0.8660254037844387 y_rate=0.5", "w1=0.5 w2=-0.8660254037844387 slide=0"),
    row("unicycle", "the unicycle", LIBRARY, "eval unicycle",
        "theta=state.phi v=input.v omega=input.omega", "x_rate,y_rate,theta_rate=rate", "A-unicycle"),
    row("definitions 1 and 2", "holonomic: the constraints integrate", "texts/aa274_three_fixed", "structure", "",
        "holonomic=holonomic ddof=ddof dof=dof", "A-three-fixed-concurrent"),
    row("degree of mobility", "three fixed wheels whose axles meet: mobility 1, not 0", "texts/aa274_three_fixed",
        "derive -o build", "", DEGREES, "A-three-fixed-concurrent"),
    row("degree of mobility", "three fixed wheels whose axles do not meet: mobility 0",
        "texts/siegwart_three_fixed", "derive -o build", "", DEGREES, "S-rank3"),
    row("tricycle", "the tricycle, wheelbase 1", "texts/aa274_tricycle", "eval posture",
        "theta=state.phi front.steer=state.psi front.spin=8 front.steer_rate=input.u2",
        "x_rate,y_rate,theta_rate,front.steer_rate=rate", "A-tricycle"),
    row("simplified car", "a car as a unicycle", LIBRARY, "eval car_reduction", "u1=u1 xi=xi wheelbase=1",
        "v=v omega=omega", "A-reduction"),
    row("bounds of the simplified car", "bounds of speed and turning rate", LIBRARY, "eval car_bounds",
        "u1_max=u1_max zeta_max=zeta_max v=v wheelbase=1",
        "v_max=v_max omega_max=omega_max reeds_shepp=reeds_shepp_abs_v dubins=dubins_v", "A-bounds"),
)  # fmt: skip
