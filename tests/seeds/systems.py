"""The systems of the five texts and the functions that reproduce each: the table of tests/README.md.

T: Tzafestas ch. 2, K: Konstantinov, KE: Kelly ch. 4, S: Siegwart ch. 2.3 and 3, A: AA274 lecture 1.
"""

from __future__ import annotations

WHEEL = "{{name: {0}, type: {1}, x: {2}, y: {3}, heading: {4}, r: 0.1{5}}}"


def wheel(name: str, kind: str, x: str, y: str, heading: str = "0", more: str = "") -> str:
    return WHEEL.format(name, kind, x, y, heading, more and f", {more}")


def ring(*angles: str, turn: str = "+ pi/2") -> list[str]:
    """Omni wheels at polar angles, driving along the tangent."""
    return [
        f"{{name: w{k}, type: swedish, l: 0.25, alpha: {a}, heading: {a} {turn}, r: 0.06, gamma: 0}}"
        for k, a in enumerate(angles, 1)
    ]  # fmt: skip


PAIR = [wheel("right", "fixed", "0", "-0.3"), wheel("left", "fixed", "0", "0.3")]
BACK = [wheel("right", "fixed", "0.13", "-0.3"), wheel("left", "fixed", "0.13", "0.3")]
REAR = [wheel("rear_left", "fixed", "0", "0.4", more="actuated: []")]
REAR += [wheel("rear_right", "fixed", "0", "-0.4", more="actuated: []")]
FOUR = [
    wheel(name, "steered", x, y, more=f"offset_y: {o}")
    for name, x, y, o in (("w1", "0.5", "0.3", "0.07"), ("w2", "0.5", "-0.3", "-0.07"),
                          ("w3", "-0.5", "0.3", "0.07"), ("w4", "-0.5", "-0.3", "-0.07"))
]  # fmt: skip
MECANUM = [
    wheel(name, "swedish", x, y, more=f"gamma: {g} deg, r_sw: 0.02")
    for name, x, y, g in (("fr", "0.26", "-0.18", "45"), ("fl", "0.26", "0.18", "-45"),
                          ("rl", "-0.26", "0.18", "45"), ("rr", "-0.26", "-0.18", "-45"))
]  # fmt: skip
CASTORS = [
    wheel(f"c{k}", "castor", x, y, more="d: 0.06, actuated: [spin, steer]")
    for k, (x, y) in enumerate((("1", "0.4"), ("1", "-0.4"), ("-1", "0.4"), ("-1", "-0.4")), 1)
]
SYNCHRO = [
    wheel("w1", "steered", "0.3", "0"),
    wheel("w2", "steered", "-0.15", "0.26"),
    wheel("w3", "steered", "-0.15", "-0.26"),
]  # fmt: skip
BELTS = "couplings: [{equal: [w1.steer, w2.steer, w3.steer]}, {equal: [w1.spin, w2.spin, w3.spin]}]\n"

# Robot -> wheels and the keys beside them.
ROBOTS: dict[str, tuple[list[str], str]] = {
    "disk": ([wheel("w", "fixed", "0", "0")], ""),
    "differential": (PAIR, "cg: {x: -0.1, y: 0, z: 0.2}\n"),
    "offset": (BACK, "slip: true\n"),
    "tricycle": ([*REAR, wheel("front", "steered", "1.4", "0")], ""),
    "bicycle": (
        [wheel("rear", "fixed", "0", "0"), wheel("front", "steered", "1.4", "0", more="actuated: [steer]")],
        "limits: {vx: 1.7, steer: 0.6, spin: 17}\n",
    ),
    "front_driven": (
        [wheel("rear", "fixed", "0", "0", more="actuated: []"), wheel("front", "steered", "1.4", "0")],
        "",
    ),
    "car": (
        [wheel("rear_left", "fixed", "0", "0.4"), wheel("rear_right", "fixed", "0", "-0.4"),
         wheel("front_left", "steered", "1.4", "0.4", more="actuated: [steer]"),
         wheel("front_right", "steered", "1.4", "-0.4", more="actuated: [steer]")],
        "virtual: [{name: front, steers: [front_left, front_right]}, {name: rear, drives: [rear_left, rear_right]}]\n"
        "trailers: [{length: 1.1}, {length: 0.9}]\ncg: {x: 0.7, y: 0, z: 0.5}\n",
    ),
    "omni3": (ring("-pi/2", "pi/6", "5*pi/6"), ""),
    "omni3_k": (ring("0", "2*pi/3", "4*pi/3", turn="- pi/2"), ""),
    "omni3_s": (ring("pi/3", "pi", "-pi/3", turn="- pi/2"), ""),
    "omni4": (ring("pi/4", "3*pi/4", "5*pi/4", "7*pi/4"), ""),
    "omni5": (ring("0.1", "1.3566", "2.6133", "3.8699", "5.1265"), ""),
    "mecanum": (MECANUM, ""),
    "ball": (["{name: b, type: spherical, x: 0.4, y: 0.5, r: 0.12}", wheel("w", "fixed", "0", "0")], ""),
    "two_steer": ([wheel("w1", "steered", "0.9", "0.2"), wheel("w2", "steered", "-0.7", "-0.1")], ""),
    "four_steer": (FOUR, ""),
    "castors": (CASTORS, ""),
    "synchro": (SYNCHRO, BELTS),
    "locked": ([wheel("w1", "fixed", "0.6", "0"), wheel("w2", "fixed", "-0.6", "0", "pi")], ""),
}  # fmt: skip

TEXTBOOK = "textbook"

# System -> robot (or the textbook) -> functions.
SYSTEMS: dict[str, dict[str, str]] = {
    "T-PINV": {TEXTBOOK: "inverse_2x2 inverse_3x2 inverse_4x3 inverse_2x4", "mecanum": "forward"},
    "T-HOM": {TEXTBOOK: "rotation_x rotation_y rotation_z transform_apply transform_compose transform_inverse rotate"},
    "T-HOLO": {TEXTBOOK: "disk_constraint", "differential": "dynamics chained"},
    "T-DISK": {TEXTBOOK: "rolling_disk disk_constraint", "disk": "dynamics"},
    "T-UNI": {TEXTBOOK: "unicycle", "disk": "dynamics odometry"},
    "T-DD": {"differential": "posture forward_world inverse_world circle motion"},
    "T-DDB": {"offset": "forward inverse inverse_world"},
    "T-SLIP": {"offset": "slip_inverse"},
    "T-TRI": {"tricycle": "posture inverse circle"},
    "T-CAR": {"bicycle": "posture inverse forward", "car": "posture virtual_steering virtual_angle"},
    "T-CAR-RWD": {"bicycle": "posture"},
    "T-CAR-FWD": {"front_driven": "posture"},
    "T-CAR-ZETA": {"front_driven": "zeta"},
    "T-RS-DUBINS": {"bicycle": "input_limits"},
    "T-PURSUIT": {TEXTBOOK: "pursuit", "bicycle": "pursuit"},
    "T-CHAIN": {TEXTBOOK: "chain_3 chain_5"},
    "T-BROCKETT": {TEXTBOOK: "brockett chain_to_brockett", "disk": "brockett brockett_input brockett_rates"},
    "T-BROCKETT2": {TEXTBOOK: "brockett_double"},
    "T-CHAIN-UNI": {TEXTBOOK: "unicycle_to_chain", "disk": "chained chained_input chained_rates"},
    "T-CHAIN-CAR": {"bicycle": "chained chained_input chained_rates flat"},
    "T-TRAILER": {"car": "trailer trailer_positions steady_circle chained chained_input"},
    "T-OMNI3": {"omni3": "inverse forward"},
    "T-OMNIN": {"omni5": "inverse"},
    "T-VAF": {TEXTBOOK: "omni_wheel", "omni3": "vaf", "omni4": "vaf"},
    "T-OMNI4": {"omni4": "inverse_world"},
    "T-MEC-WHEEL": {TEXTBOOK: "mecanum_wheel mecanum_wheel_inverse", "mecanum": "contacts"},
    "T-MEC4": {"mecanum": "inverse forward compatibility inverse_world forward_world"},
    "T-ROLLER": {TEXTBOOK: "mecanum_roller"},
    "K-PROJ": {"omni3_k": "projections"},
    "K-IK": {"omni3_k": "inverse_world"},
    "K-FK": {"omni3_k": "forward_world heading"},
    "K-TRAJ": {"omni3_k": "motion circle"},
    "KE-MOVING": {TEXTBOOK: "galilean transport_theorem moving_frame_velocity moving_frame_acceleration skew_matrix"},
    "KE-STAB": {TEXTBOOK: "specific_force", "car": "stability cg_force"},
    "KE-RECUR": {TEXTBOOK: "h_matrix omega_matrix two_step_velocity two_step_acceleration"},
    "KE-ARTWHEEL": {
        TEXTBOOK: "articulated_wheel_velocity articulated_wheel_acceleration", "four_steer": "wheel_motion",
    },
    "KE-ICR": {"four_steer": "icr axles steer_to"},
    "KE-DISK": {TEXTBOOK: "disk_constraint"},
    "KE-CTRL": {TEXTBOOK: "steer_sense", "two_steer": "inverse forward"},
    "KE-OFFSET": {TEXTBOOK: "offset_wheel_velocity", "four_steer": "contact_velocity accelerations"},
    "KE-DD": {"differential": "inverse forward"},
    "KE-ACK": {"bicycle": "inverse forward icr"},
    "KE-GENBIKE": {"two_steer": "contact_velocity inverse forward"},
    "KE-4WS": {"four_steer": "contact_velocity inverse forward"},
    "KE-3D": {TEXTBOOK: "wheel_velocity"},
    "S-FRAME": {TEXTBOOK: "rotation_world_to_robot world_to_robot robot_to_world"},
    "S-FIXED": {"disk": "inverse"},
    "S-STEER": {"two_steer": "inverse"},
    "S-CASTOR": {TEXTBOOK: "castor_swivel castor_alignment", "castors": "inverse"},
    "S-CASTOR4": {"castors": "inverse forward accelerations"},
    "S-SWEDISH": {TEXTBOOK: "swedish_wheel", "mecanum": "inverse contacts"},
    "S-SPHERE": {"ball": "contacts"},
    "S-DD": {TEXTBOOK: "wheel_contributions", "differential": "forward inverse"},
    "S-ROBOT": {"mecanum": "inverse", "tricycle": "inverse", "castors": "inverse"},
    "S-OMNI3": {"omni3_s": "inverse forward forward_world"},
    "S-LOCKBIKE": {"locked": "wheel_angles forward"},
    "S-DELTA": {"synchro": "dynamics", "two_steer": "dynamics", "tricycle": "configuration"},
    "S-SYNCHRO": {"synchro": "forward inverse"},
    "S-POLAR": {TEXTBOOK: "polar_coordinates polar_rates polar_rates_reverse"},
    "S-POLAR-CL": {TEXTBOOK: "polar_closed_loop polar_linearisation polar_gains", "differential": "goto_pose"},
    "S-TRAJ": {"omni3_s": "motion reach", "two_steer": "motion reach"},
    "S-PROB": {"differential": "forward", "omni3_s": "inverse"},
    "A-DISK": {TEXTBOOK: "disk_constraint"},
    "A-HOLO": {"differential": "dynamics"},
    "A-UNI": {"differential": "dynamics posture"},
    "A-TRI": {"front_driven": "posture"},
    "A-CAR": {TEXTBOOK: "car_reduction car_bounds", "bicycle": "input_limits"},
}  # fmt: skip


def asked(robot: str) -> list[str]:
    """Every function that some system asks of a robot, in order, each once."""
    return list(dict.fromkeys(name for rows in SYSTEMS.values() for name in rows.get(robot, "").split()))


def robot_file(robot: str, optional: frozenset[str]) -> str:
    """The robot's file, asking for those of its functions that are not standard."""
    wheels, keys = ROBOTS[robot]
    functions = [name for name in asked(robot) if name in optional]
    lines = ["wmrgen: 1", f"name: {robot}", "wheels:", *(f"  - {w}" for w in wheels)]
    lines += [f"functions: [{', '.join(functions)}]"] if functions else []
    return "\n".join(lines) + "\n" + keys
