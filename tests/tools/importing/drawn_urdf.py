"""URDF files of robots that are drawn: wheels of every kind first, then a tree of links that carries them.

Links between the base and a wheel stand anywhere, turned in any way; all matrices are numpy's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.tools.importing.drawn_sdf import angles, drawn

Matrix = Any
UP = np.array([0.0, 0.0, 1.0])
R = 0.1


@dataclass(frozen=True)
class Truth:
    """What import must say of the wheel at a joint."""

    type: str
    x: float
    y: float
    heading: float
    d: float
    offset_y: float
    gamma: float | None
    r: float


class Tree:
    """The text of a tree, and where its links are; an angle that would be snapped makes ValueError."""

    def __init__(self, seed: int) -> None:
        self.random = np.random.default_rng(seed)
        self.text = '<link name="base_link"/>'
        self.poses: dict[str, Matrix] = {"base_link": np.eye(4)}
        self.count = 0

    def link(
        self, parent: str, where: Matrix, kind: str, name: str, axis: Matrix | None, more: str = ""
    ) -> str:
        """A link at ``where`` in the base, on a joint of its name whose ``axis`` is given in the base, too."""
        self.count += 1
        child = f"{name}/body {self.count}"
        self.poses[child] = where
        said = "" if axis is None else f'<axis xyz="{_words(3 * where[:3, :3].T @ axis)}"/>'
        self.text += f'<link name="{child}">{more}</link><joint name="{name}" type="{kind}">'
        self.text += f'<parent link="{parent}"/><child link="{child}"/>'
        self.text += f"{_origin(np.linalg.inv(self.poses[parent]) @ where)}{said}</joint>"
        return child

    def plate(self, parent: str, place: Matrix | None = None) -> str:
        """One to three links on fixed joints, and at times a spring, from a link to anywhere."""
        for k in range(self.random.integers(1, 4)):
            kind = "prismatic" if k and self.random.random() < 0.4 else "fixed"
            axis = UP if kind == "prismatic" else None
            parent = self.link(parent, drawn(self.random), kind, f"part-{self.count}", axis)
        if place is not None:
            where = drawn(self.random)
            where[:3, 3] = place
            parent = self.link(parent, where, "fixed", f"part-{self.count}", None)
        return parent


def _words(values: Matrix) -> str:
    return " ".join(f"{v:.17g}" for v in values)


def _origin(seen: Matrix) -> str:
    turn = angles(seen[:3, :3])
    if min(abs(math.remainder(a, math.pi / 12)) for a in turn) < 3e-3:
        raise ValueError("would be snapped")
    return f'<origin xyz="{_words(seen[:3, 3])}" rpy="{_words(np.array(turn))}"/>'


def _cylinder(frame: Matrix, centre: Matrix, axle: Matrix, r: float) -> str:
    """A coaxial cylinder and a smaller one beside it, in a link at ``frame``."""
    across = np.cross(axle, UP)
    tube = np.eye(4)
    tube[:3, :3] = np.column_stack([across, np.cross(axle, across), axle])
    texts = []
    for radius, shift in ((r, 0.0), (r / 2, 0.07)):
        tube[:3, 3] = centre + shift * axle
        shape = f'<geometry><cylinder radius="{radius:.17g}" length="0.04"/></geometry>'
        texts.append(f"<collision>{_origin(np.linalg.inv(frame) @ tube)}{shape}</collision>")
    return "".join(texts)


def robot(seed: int) -> tuple[str, dict[str, Truth]]:
    """Two to five wheels: all with rollers, or plain ones among which some steer or trail."""
    tree = Tree(seed)
    random = tree.random
    some = ["swedish"] if random.random() < 0.3 else ["fixed", "castor", "steered"]
    kinds = ["swedish"] * 3 if some == ["swedish"] else ["fixed", *random.choice(some, random.integers(1, 5))]
    truth: dict[str, Truth] = {}
    for k, kind in enumerate(kinds):
        name = f"{random.choice(['Rad-', 'drivewhl_', 'ST32-v1 Revolute-', 'arm_roll_', 'm'])}{k}"
        r = random.uniform(0.9, 1.1) * R
        heading = random.choice([0.0, math.pi]) if kind == "fixed" else random.uniform(-3, 3)
        e = np.array([math.cos(heading), math.sin(heading), 0.0])
        axle = np.cross(UP, e)
        d = random.choice([-1, 1]) * random.uniform(0.03, 0.1) if kind == "castor" else 0.0
        offset = random.uniform(-0.05, 0.05) if kind in ("castor", "steered") else 0.0
        pivot = np.array([*random.uniform(-1, 1, 2), r])
        centre = pivot + d * e + offset * axle
        parent = tree.plate("base_link")
        if kind in ("castor", "steered"):
            where = drawn(random)
            where[:3, 3] = pivot + random.uniform(-0.3, 0.3) * UP
            parent = tree.link(parent, where, "continuous", f"{name} turn", random.choice([-1, 1]) * UP)
            parent = tree.plate(parent, None)
        frame = drawn(random)
        frame[:3, 3] = centre + random.uniform(-0.03, 0.03) * axle
        body = tree.link(parent, frame, "continuous", name, axle, _cylinder(frame, centre, axle, r))
        gamma = None
        if kind == "swedish":
            gamma = random.uniform(-1.2, 1.2)
            _rollers(tree, body, centre, e, axle, gamma, r)
        truth[name] = Truth(kind, pivot[0], pivot[1], heading, d, offset, gamma, r)
    return f'<robot name="drawn-{seed}">{tree.text}</robot>', truth


def _rollers(tree: Tree, body: str, centre: Matrix, e: Matrix, axle: Matrix, gamma: float, r: float) -> None:
    """Six rollers about the wheel, stopped anywhere: each has its axis at gamma from the heading when it is at the
    ground."""
    stopped = tree.random.uniform(0, math.pi / 3)
    for k in range(6):
        turn = stopped + k * math.pi / 3
        out, along = math.cos(turn) * -UP + math.sin(turn) * e, math.cos(turn) * e + math.sin(turn) * UP
        where = drawn(tree.random)
        where[:3, 3] = centre + 0.9 * r * out
        axis = math.cos(gamma) * along + math.sin(gamma) * axle
        tree.link(body, where, "continuous", f"roller {tree.count}", axis)


def unsnapped(seed: int) -> tuple[str, dict[str, Truth]]:
    for attempt in range(1000):
        try:
            return robot(10_000 * seed + attempt)
        except ValueError:
            continue
    raise AssertionError("no robot without angles near a multiple of pi/12")
