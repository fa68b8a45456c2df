"""Small modules, built by hand: tests of every backend that need no robot."""

from __future__ import annotations

from fractions import Fraction

from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Module, Port, Role

VX = Port("vx", Role.COMMAND, "m/s", "velocity of P forward")
VY = Port("vy", Role.COMMAND, "m/s", "velocity of P to the left")
OMEGA = Port("omega", Role.COMMAND, "rad/s", "yaw rate")
TWIST = (VX, VY, OMEGA)
RADIUS = Port("radius", Role.GEOMETRY, "m", "wheel radius", Exact(Fraction(39, 400)))


def spin(wheel: str) -> Port:
    return Port(f"{wheel}.spin", Role.COMMAND, "rad/s", "wheel speed")


def steer(wheel: str) -> Port:
    return Port(f"{wheel}.steer", Role.STATE, "rad", "steering angle")


def differential() -> Module:
    """Unused input (vy), a constant output (slip)."""
    b = Builder()
    vx, turn = b.input("vx"), b.mul(b.const(Fraction(331, 2000)), b.input("omega"))
    scale = b.const(Fraction(400, 39))
    results = (b.mul(scale, b.sub(vx, turn)), b.mul(scale, b.add(vx, turn)), b.const(0))
    outputs = (spin("left"), spin("right"), Port("slip", Role.STATE, "m/s"))
    return Module("pair", (b.function("inverse", TWIST, outputs, results, "twist to wheel speeds"),))


def mecanum() -> Module:
    b = Builder()
    vx, vy = b.input("vx"), b.input("vy")
    turn = b.mul(b.const(Fraction(1189, 2000)), b.input("omega"))
    k = b.const(Fraction(10000, 759))
    terms = (b.sub(vx, vy), b.add(vx, vy), b.add(vx, vy), b.sub(vx, vy))
    turned = (b.sub, b.add, b.sub, b.add)
    results = [b.mul(k, combine(term, turn)) for combine, term in zip(turned, terms, strict=True)]
    outputs = tuple(spin(w) for w in ("front_left", "front_right", "rear_left", "rear_right"))
    return Module("mecanum", (b.function("inverse", TWIST, outputs, results),))


def _swerve(b: Builder, wheel: str, x: Fraction, y: Fraction) -> tuple[int, int]:
    """(steer, spin): direction and speed of the pivot; the present angle if the pivot does not move."""
    vx, vy, omega = b.input("vx"), b.input("vy"), b.input("omega")
    px = b.sub(vx, b.mul(b.const(y), omega))
    py = b.add(vy, b.mul(b.const(x), omega))
    speed = b.sqrt(b.add(b.square(px), b.square(py)))
    moving = b.select(b.const(Fraction(1, 10**6)), speed, b.atan2(py, px), b.input(f"{wheel}.steer"))
    return moving, b.mul(b.const(20), speed)


def swerve() -> Module:
    """A function with sqrt, atan2 and select, whose derivatives are all undefined at standstill."""
    b = Builder()
    a = _swerve(b, "a", Fraction(1, 4), Fraction(1, 5))
    c = _swerve(b, "c", Fraction(-1, 4), Fraction(-1, 5))
    outputs = (steer("a"), spin("a"), steer("c"), spin("c"))
    return Module("swerve", (b.function("inverse", (*TWIST, steer("a"), steer("c")), outputs, (*a, *c)),))


def tunable() -> Module:
    """A function that reads a prepared number, the radius, sin, cos, min, max and abs."""
    p = Builder()
    prepare = p.function(
        "prepare", (RADIUS,), (Port("k0", Role.PREPARED, "1/m"),), (p.div(p.const(1), p.input("radius")),)
    )
    b = Builder()
    vx, angle, k0, radius = b.input("vx"), b.input("a.steer"), b.input("k0"), b.input("radius")
    along = b.mul(vx, b.cos(angle))
    results = (b.mul(along, k0), b.mul(radius, b.sin(angle)), b.max(b.abs(vx), b.min(angle, radius)))
    inputs = (VX, steer("a"), Port("k0", Role.PREPARED, "1/m"), RADIUS)
    outputs = (spin("a"), Port("lift", Role.STATE, "m"), Port("peak", Role.STATE, ""))
    constant = Builder()
    still = constant.function(
        "still", (), (Port("slip", Role.STATE, "m/s"),), (constant.const(Fraction(-1, 3)),)
    )
    return Module("tuned", (b.function("inverse", inputs, outputs, results), still), prepare)


def empty() -> Function:
    """A function without outputs, which C does not print."""
    return Function("forward", TWIST, (), (), ())


MODULES = (differential(), mecanum(), swerve(), tunable())
