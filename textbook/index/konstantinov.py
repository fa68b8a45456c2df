"""Konstantinov: a robot with three omni wheels."""

from __future__ import annotations

from textbook.index.records import Row

TEXT = "Konstantinov"
ROBOT = "texts/konstantinov"
SPINS = "w1.spin,w2.spin,w3.spin=wheel_rates"
RATES = "x_rate,y_rate,theta_rate=twist_world"


def row(places: str, says: str, command: str, inputs: str, outputs: str, case: str = "") -> Row:
    """Return a row of this text; see `Row`."""
    return Row(TEXT, places, says, ROBOT, command, inputs, outputs, case)


ROWS: tuple[Row, ...] = (
    row("(1), (2)", "velocity of each wheel at phi = 0 ((2) corrected)", "eval projections",
        "vx=0.35 vy=-0.2 omega=0.7",
        "w1.x_rate,w1.y_rate=[0.35,-0.025000000000000022] w2.x_rate,w2.y_rate=[0.1984455543377232,-0.2875] "
        "w3.x_rate,w3.y_rate=[0.5015544456622767,-0.2875000000000001]"),
    row("(3), mu_i", "lambda and mu of each wheel at phi = 0", "eval projections", "vx=0.35 vy=-0.2 omega=0.7",
        "w1.along,w2.along,w3.along=[0.025000000000000022,0.028108891324553575,-0.5781088913245536] "
        "w1.across,w2.across,w3.across=[0.35,-0.34820508075688766,-0.0017949192431124805]"),
    row("(4)", "wheel speeds", "eval inverse_world", f"theta=phi {RATES}", SPINS, "K-4"),
    row("(4)", "wheel speeds, in detail (first line corrected)", "eval inverse_world", f"theta=phi {RATES}", SPINS,
        "K-4-detail"),
    row("(5)", "world velocity", "eval forward_world", f"theta=phi {SPINS}", RATES, "K-5"),
    row("(6)", "heading from the angles of the wheels", "eval heading",
        "theta=0.5 w1.angle=1 w2.angle=2 w3.angle=3", "theta=0.02"),
    row("case Omega = 0", "constant speeds whose sum is 0: a straight line", "eval motion",
        f"{SPINS} x,y,theta=state0 dt=t", "x,y,theta=state", "K-straight"),
    row("case Omega != 0", "constant speeds: the pose after 2.3 s", "eval motion",
        f"{SPINS} x,y,theta=state0 dt=t", "x,y,theta=state", "K-circle-a"),
    row("circle of constant speeds, v^2", "constant speeds: centre, radius and speed (R and v^2 corrected)",
        "eval circle", f"{SPINS} x,y,theta=state0", "x_centre,y_centre=center radius=R speed=v", "K-circle-a"),
)  # fmt: skip
