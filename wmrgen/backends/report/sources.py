"""What each further function reproduces: equations of the texts in their corrected form, or that it is ours."""

from __future__ import annotations

CHAIN_UNICYCLE = "Tzafestas (2.61)-(2.63)"
CHAIN_CAR = "Tzafestas (2.66)-(2.69)"

SOURCES: dict[str, str] = {
    "motion": "Konstantinov, case of constant speeds; Tzafestas (2.36), (2.38) integrated",
    "circle": "Konstantinov, x_C, y_C and R (corrected); Tzafestas (2.43)",
    "icr": "Kelly 4.2.1.1; Tzafestas (2.43)",
    "axles": "Kelly 4.2.1.2 (Jeantaud); Siegwart 3.3.1; Tzafestas (2.48)",
    "steer_to": "Kelly 4.2.1.2 (Jeantaud), 4.2.2.1.1",
    "reach": "Siegwart figures 3.15 and 3.16, the twist of a segment",
    "contact_velocity": "Kelly (4.39), (4.40), Box 4.2, (4.62)",
    "projections": "Konstantinov (1)-(3), (2) corrected; Tzafestas (2.71)",
    "inverse_world": "Siegwart (3.2); Tzafestas (2.41c), (2.75) corrected, (2.85); Konstantinov (4)",
    "forward_world": "Siegwart (3.9), (3.10); Tzafestas (2.37d), (2.83); Konstantinov (5)",
    "vaf": "Tzafestas 2.4.1, (2.71)",
    "compatibility": "Tzafestas (2.84), the relation of its rows",
    "heading": "Konstantinov (6); Tzafestas (2.36)",
    "goto_pose": "Siegwart (3.50)-(3.58), (3.55) corrected",
    "pursuit": "Tzafestas (2.57)",
    "posture": "Tzafestas (2.28), (2.38), (2.46), (2.55), (2.56a); AA274",
    "configuration": "Siegwart (3.24)-(3.28), solved for the joint rates",
    "virtual_steering": "Tzafestas (2.49)-(2.51); Kelly 4.2.1.2, Ackermann",
    "virtual_angle": "Tzafestas (2.49)-(2.51); Kelly 4.2.1.2, Ackermann",
    "zeta": "Tzafestas (2.56b)",
    "trailer": "Tzafestas 2.3.6, (2.70) corrected; off the axle it is ours",
    "trailer_positions": "Tzafestas 2.3.6",
    "steady_circle": "Tzafestas 2.3.6, (2.70) at rest",
    "slip_inverse": "Tzafestas Example 2.2, corrected for steered wheels",
    "chained": f"Tzafestas (2.58); {CHAIN_UNICYCLE}; {CHAIN_CAR}",
    "chained_input": f"Tzafestas (2.58); {CHAIN_UNICYCLE}; {CHAIN_CAR}",
    "chained_rates": f"Tzafestas (2.58); {CHAIN_UNICYCLE}; {CHAIN_CAR}",
    "brockett": "Tzafestas (2.59), (2.64), (2.65)",
    "brockett_input": "Tzafestas (2.59), (2.64), (2.65)",
    "brockett_rates": "Tzafestas (2.59), (2.64), (2.65)",
    "desaturate": "ours; the texts have none",
    "inverse_together": "ours; the texts have none",
    "wheel_angles": "Siegwart 3.4.2, the locked bicycle; Konstantinov (6)",
    "flat": "ours; Tzafestas (2.66)-(2.69) solved for the inputs",
    "input_limits": "AA274, bounds of the simplified car; Tzafestas 2.3.4",
    "accelerations": "Kelly (4.31) in the plane; Siegwart (3.18)",
    "wheel_motion": "Kelly (4.23)-(4.31), (4.25) corrected",
    "stability": "criterion of Kelly 4.1.3; the margin is ours",
    "cg_force": "Kelly 4.1.3",
}
