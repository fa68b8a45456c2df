"""Robots larger than any in the gallery."""

from __future__ import annotations

from math import cos, pi, sin


def robot(name: str, count: int, types: tuple[str, ...]) -> str:
    """Return a robot file with ``count`` wheels of alternating types on an ellipse."""
    lines = ["wmrgen: 1", f"name: {name}", "wheels:"]
    for k in range(count):
        turn = 2 * pi * k / count
        place = f"x: {1.5 * cos(turn):.4f}, y: {sin(turn):.4f}"
        lines.append(f"  - {{name: w{k}, type: {_kind(types[k % len(types)], place, k)}}}")
    return "\n".join(lines) + "\n"


def _kind(kind: str, place: str, k: int) -> str:
    if kind == "spherical":
        return f"spherical, {place}, r: 0.1"
    extra = {"castor": ", d: 0.03", "swedish": f", gamma: {'-' if k % 3 else ''}pi/4"}.get(kind, "")
    return f"{kind}, {place}, heading: 0, r: 0.1{extra}"


def train(name: str, count: int, hitch: float, functions: str) -> str:
    """Return a robot file of a car with rear drive and ``count`` trailers."""
    trailers = ", ".join(f"{{length: {0.5 + 0.1 * k:.1f}, hitch: {hitch}}}" for k in range(count))
    rear = "  - {name: rear, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}\n"
    front = "  - {name: front, type: steered, x: 1.4, y: 0, heading: 0, r: 0.1}\n"
    return (
        f"wmrgen: 1\nname: {name}\nwheels:\n{rear}{front}trailers: [{trailers}]\nfunctions: [{functions}]\n"
    )


LARGE = {
    "swerve8": robot("swerve8", 8, ("steered",)),
    "swerve64": robot("swerve64", 64, ("steered",)),
    "mixed64": robot("mixed64", 64, ("steered", "castor", "swedish", "spherical")),
    "train8": train("train8", 8, 0, "trailer, chained, chained_input, chained_rates"),
    "train8_off_axle": train("train8_off_axle", 8, 0.15, "trailer, steady_circle"),
}
