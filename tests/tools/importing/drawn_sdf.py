"""SDF files of one robot, each with frames of its own.

The wheels are placed first; frames are drawn, and every pose is written relative to one of them, by matrices of numpy.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

Matrix = Any  # 4 by 4, or its rotation


def sdf(*parts: str, version: str = "1.9") -> str:
    return f'<sdf version="{version}"><model name="probe">{"".join(parts)}</model></sdf>'


def angles(rotation: Matrix) -> tuple[float, float, float]:
    """Roll, pitch and yaw of Rz Ry Rx."""
    pitch = math.asin(-rotation[2, 0])
    return (
        math.atan2(rotation[2, 1], rotation[2, 2]),
        pitch,
        math.atan2(rotation[1, 0], rotation[0, 0]),
    )


def drawn(random: np.random.Generator) -> Matrix:
    """A frame anywhere, turned in any way: the factor Q of a random matrix."""
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    frame = np.eye(4)
    frame[:3, :3] = turn * np.linalg.det(turn)
    frame[:3, 3] = random.uniform(-1, 1, 3)
    return frame


class Writer:
    """Frames by name, and poses in them; an angle that would be snapped makes ValueError."""

    def __init__(self, seed: int) -> None:
        self.random = np.random.default_rng(seed)
        self.frames: dict[str, Matrix] = {"": np.eye(4), "__model__": np.eye(4)}

    def some(self) -> str:
        return str(self.random.choice(sorted(set(self.frames) - {""})))

    def pose(self, where: Matrix, default: str = "") -> str:
        """The pose of a frame relative to one of those that there are, at times in degrees or as a quaternion."""
        name = self.some() if self.random.random() < 0.8 else default
        seen = np.linalg.inv(self.frames[name]) @ where
        said = f' relative_to="{name}"' if name != default else ""
        roll, pitch, yaw = angles(seen[:3, :3])
        if min(abs(math.remainder(a, math.pi / 12)) for a in (roll, pitch, yaw)) < 3e-3:
            raise ValueError("would be snapped")
        xyz = " ".join(f"{v:.15g}" for v in seen[:3, 3])
        match self.random.integers(3):
            case 0:
                a, b, c = (v / 2 for v in (roll, pitch, yaw))
                x = math.sin(a) * math.cos(b) * math.cos(c) - math.cos(a) * math.sin(b) * math.sin(c)
                y = math.cos(a) * math.sin(b) * math.cos(c) + math.sin(a) * math.cos(b) * math.sin(c)
                z = math.cos(a) * math.cos(b) * math.sin(c) - math.sin(a) * math.sin(b) * math.cos(c)
                w = math.cos(a) * math.cos(b) * math.cos(c) + math.sin(a) * math.sin(b) * math.sin(c)
                return f'<pose rotation_format="quat_xyzw"{said}>{xyz} {x:.17g} {y:.17g} {z:.17g} {w:.17g}</pose>'
            case 1:
                turn = " ".join(f"{math.degrees(v):.17g}" for v in (roll, pitch, yaw))
                return f'<pose degrees="true"{said}>{xyz} {turn}</pose>'
        return f"<pose{said}>{xyz} {roll:.17g} {pitch:.17g} {yaw:.17g}</pose>"

    def axis(self, along: Matrix, joint: Matrix, key: str = "axis") -> str:
        name = self.some() if self.random.random() < 0.7 else ""
        within = (self.frames[name] if name else joint)[:3, :3]
        xyz = " ".join(f"{v:.17g}" for v in within.T @ along)
        said = f' expressed_in="{name}"' if name else ""
        return f"<{key}><xyz{said}>{xyz}</xyz></{key}>"

    def link(self, name: str, axle: Matrix | None = None, centre: Matrix | None = None) -> str:
        """A link anywhere; with ``axle`` a wheel, whose cylinder of radius 0.1 stands about the axle at ``centre``."""
        frame = self.frames[name] = drawn(self.random)
        shape = ""
        if axle is not None:
            across = np.cross(axle, [0.0, 0.0, 1.0])
            tube = np.eye(4)
            tube[:3, :3] = np.column_stack([np.cross(across, axle), across, axle])
            tube[:3, 3] = centre
            tube = tube @ _about_z(self.random.uniform(0, 6))
            geometry = "<cylinder><radius>0.1</radius><length>0.04</length></cylinder>"
            shape = f'<collision name="c">{self.pose(tube, name)}<geometry>{geometry}</geometry></collision>'
        others = {k: v for k, v in self.frames.items() if k != name}
        self.frames, held = others, self.frames
        text = f'<link name="{name}">{self.pose(frame)}{shape}</link>'
        self.frames = held
        return text


def _about_z(angle: float) -> Matrix:
    frame = np.eye(4)
    frame[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    return frame


def drawn_robot(writer: Writer) -> tuple[str, dict[str, tuple[float, ...]]]:
    """A robot with two fixed wheels, a castor and a wheel on a universal joint, in any frames, and what it is: of each
    joint x, y, heading, d and offset_y of its wheel."""
    random = writer.random
    parts = [writer.link("chassis")]
    for name in ("f", "g"):
        frame = drawn(random)
        parts.append(f'<frame name="{name}" attached_to="chassis">{writer.pose(frame, "chassis")}</frame>')
        writer.frames[name] = frame
    truth: dict[str, tuple[float, ...]] = {}
    up = np.array([0.0, 0.0, 1.0])
    for name, (x, y) in {
        "left": (0.0, 0.3),
        "right": (0.0, -0.3),
        "tail": (-0.4, 0.1),
        "front": (0.5, 0.2),
    }.items():
        heading = random.uniform(-3, 3) if name in ("tail", "front") else random.choice([0.0, math.pi])
        e = np.array([math.cos(heading), math.sin(heading), 0.0])
        axle = np.cross(up, e)  # a x z = e
        d = 0.07 if name == "tail" else 0.0
        offset = 0.0 if name in ("left", "right") else random.uniform(-0.03, 0.03)
        pivot = np.array([x, y, 0.1])
        centre = pivot + d * e + offset * axle
        parent = "chassis"
        joint = drawn(random)
        joint[:3, 3] = centre + random.uniform(-0.05, 0.05) * axle if d or not offset else pivot
        if name == "tail":
            parts.append(writer.link("fork"))
            swivel = drawn(random)
            swivel[:3, 3] = pivot + random.uniform(-0.2, 0.2) * up
            parent = "fork"
            parts.append(_joint(writer, "swivel", "continuous", "chassis", "fork", swivel, [("axis", up)]))
        parts.append(writer.link(name, axle, centre))
        axes = [("axis", up), ("axis2", axle)] if name == "front" else [("axis", axle)]
        kind = "universal" if name == "front" else "revolute"
        parts.append(_joint(writer, f"{name}_joint", kind, parent, name, joint, axes))
        truth[f"{name}_joint"] = (x, y, heading, d, offset)
    random.shuffle(parts)
    return sdf(*parts), truth


def _joint(writer: Writer, name: str, kind: str, parent: str, child: str, where: Matrix, axes: Any) -> str:
    writer.frames, held = {**writer.frames, "": writer.frames[child]}, writer.frames
    text = writer.pose(where)
    writer.frames = held
    text += "".join(writer.axis(along, where, key) for key, along in axes)
    return f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>{text}</joint>'


def unsnapped(seed: int) -> tuple[str, dict[str, tuple[float, ...]]]:
    for attempt in range(100):
        try:
            return drawn_robot(Writer(1000 * seed + attempt))
        except ValueError:
            continue
    raise AssertionError("no robot without angles near a multiple of pi/12")
