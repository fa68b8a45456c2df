"""The keys of a robot file: one table that the checks, the messages and the JSON Schema share."""

from __future__ import annotations

from wmrgen.spec.numbers import Kind

# Key -> (what it measures, meaning). Order is the order of messages and of the schema.
QUANTITIES: dict[str, tuple[Kind, str]] = {
    "l": (Kind.LENGTH, "distance from the robot's origin to the wheel's pivot; with alpha"),
    "alpha": (Kind.ANGLE, "direction of the pivot seen from the origin, 0 is forward, pi/2 left; with l"),
    "x": (Kind.LENGTH, "pivot position forward of the origin; with y"),
    "y": (Kind.LENGTH, "pivot position left of the origin; with x"),
    "beta": (Kind.ANGLE, "angle of the axle from the line origin-pivot, for steering wheels at zero steer"),
    "heading": (Kind.ANGLE, "rolling direction in the robot frame, alpha + beta - pi/2; instead of beta"),
    "r": (Kind.LENGTH, "wheel radius, not diameter"),
    "gamma": (
        Kind.ANGLE,
        "from the wheel plane to the roller axis at the ground: 0 omni, 45 or -45 deg mecanum",
    ),
    "d": (Kind.LENGTH, "castor offset: steering axis to contact point, along the rolling direction"),
    "offset_y": (Kind.LENGTH, "contact point left of the steering axis, along the axle"),
    "r_sw": (Kind.LENGTH, "roller radius"),
}
COMMON_KEYS = ("name", "type", "l", "alpha", "x", "y", "beta", "heading", "r", "actuated", "sensed", "limits")
WHEEL_KEYS = ("name", "type", *QUANTITIES, "actuated", "sensed", "limits")
ROBOT_KEYS = (
    "wmrgen", "name", "description", "source", "angles", "snap",
    "parameters", "wheels", "couplings", "limits",
    "virtual", "trailers", "slip", "cg", "gains", "functions",
)  # fmt: skip
ROBOT_REQUIRED = ("wmrgen", "name", "wheels")

# Gain -> meaning.
GAINS: dict[str, str] = {
    "k_rho": "speed per distance to the goal [1/s]; goto_pose",
    "k_alpha": "yaw rate per bearing of the goal [1/s]; goto_pose",
    "k_beta": "yaw rate per heading left over at the goal [1/s]; goto_pose",
}

# Limit -> what it measures.
LIMITS: dict[str, Kind] = {
    "vx": Kind.SPEED,
    "vy": Kind.SPEED,
    "omega": Kind.RATE,
    "spin": Kind.RATE,
    "steer": Kind.ANGLE,
    "steer_rate": Kind.RATE,
}
LIMITS_OF_JOINT = {"spin": ("spin",), "steer": ("steer", "steer_rate")}

KEY_ALIASES = {
    **dict.fromkeys(("radius", "wheel_radius"), "Did you mean r?"),
    **dict.fromkeys(("diameter", "dia"), "Did you mean r? It is the radius: half the diameter."),
    **dict.fromkeys(("theta", "yaw", "orientation", "angle", "direction"), "Did you mean heading?"),
    **dict.fromkeys(("trail", "offset", "offset_x", "castor_offset"), "Did you mean d?"),
    **dict.fromkeys(("lateral_offset", "scrub", "axle_offset"), "Did you mean offset_y?"),
    **dict.fromkeys(("roller_radius", "r_roller"), "Did you mean r_sw?"),
    **dict.fromkeys(("roller_angle", "rollers"), "Did you mean gamma?"),
    **dict.fromkeys(("pos", "position", "pose", "xy"), "Write x: and y:."),
    **dict.fromkeys(("powered", "driven", "drive"), "Write actuated: [spin], or actuated: []."),
    "version": "Write wmrgen: 1.",
    "distance": "Did you mean l?",
}

# Key -> why it does not fit a wheel type that lacks it, and what to write; a type's own words come first.
MISFITS: dict[str, tuple[str, str]] = {
    "d": (
        "d is the castor offset from the steering axis, and this wheel has none.",
        "Put the contact point itself in l, alpha or x, y.",
    ),
    "offset_y": (
        "offset_y is the lateral offset from the steering axis, and this wheel has none.",
        "Put the contact point itself in l, alpha or x, y.",
    ),
    "gamma": (
        "gamma is the roller axis at the ground against the wheel plane; only swedish wheels have rollers.",
        "Write type: swedish for an omni or mecanum wheel, or delete gamma.",
    ),
    "r_sw": (
        "r_sw is the roller radius; only swedish wheels have rollers.",
        "Write type: swedish for an omni or mecanum wheel, or delete r_sw.",
    ),
}

# Why each required key matters.
MISSING: dict[str, tuple[str, str]] = {
    "wmrgen": ("It tells the format version.", "Begin the file with wmrgen: 1."),
    "name": ("Names become identifiers in the generated code.", "Write name: and a word such as front_left."),
    "wheels": ("A robot without wheels has no kinematics.", "Write wheels: and a list of wheels."),
    "r": ("The radius turns spin [rad/s] into speed [m/s].", "Write r: and the radius, such as r: 50 mm."),
    "d": (
        "d is how far the contact point trails the steering axis; with d = 0 it is a steered wheel.",
        "Write d: and the trail, such as d: 40 mm, or type: steered.",
    ),
    "l": ("A place is l with alpha.", "Write l: and the distance from the origin to the pivot."),
    "alpha": ("A place is l with alpha.", "Write alpha: and the direction of the pivot from the origin."),
    "x": ("A place is x with y.", "Write x: and the distance forward of the origin."),
    "y": ("A place is x with y.", "Write y: and the distance left of the origin."),
}
