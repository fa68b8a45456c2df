"""URDF texts in the spirit of real ones, for the tests of import."""

from __future__ import annotations

FORWARD = "0 1 0"


def link(
    name: str, geometry: str = "", role: str = "collision", rpy: str = "1.57 0 0", xyz: str = "0 0 0"
) -> str:
    shape = (
        f'<{role}><origin xyz="{xyz}" rpy="{rpy}"/><geometry>{geometry}</geometry></{role}>'
        if geometry
        else ""
    )
    return f'<link name="{name}">{shape}</link>'


def cylinder(radius: str) -> str:
    return f'<cylinder radius="{radius}" length="0.05"/>'


def joint(
    name: str, parent: str, child: str, xyz: str, kind: str = "continuous", axis: str = FORWARD, rpy: str = "0 0 0",
    more: str = "",
) -> str:  # fmt: skip
    said = f'<axis xyz="{axis}"/>' if axis else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/>{said}{more}</joint>'
    )


def wheel(name: str, xyz: str, geometry: str = "", parent: str = "base_link", **of_joint: str) -> str:
    """A wheel and its joint; a cylinder of radius 0.1 unless said otherwise."""
    body = link(f"{name}_link", geometry or cylinder("0.1"))
    return body + joint(f"{name}_joint", parent, f"{name}_link", xyz, **of_joint)


def robot(*parts: str, name: str = "probe") -> str:
    return f'<?xml version="1.0"?><robot name="{name}">{link("base_link")}{"".join(parts)}</robot>'


def pair(**of_joint: str) -> str:
    return wheel("left", "0.05 0.25 0.1", **of_joint) + wheel("right", "0.05 -0.25 0.1", **of_joint)
