"""The models of the examples typed by hand, as one does without wmrgen: tests drive them, benchmarks time them."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from examples.model import Model


def car(of: Model) -> Model:
    """Wheelbase 2.5 m, half track 0.75 m, wheel radius 0.3 m; the left rear wheel and the left front angle command."""
    x, u, p = _vectors(of)
    turn = ca.tan(x[3]) / (2.5 + 0.75 * ca.tan(x[3]))  # 1/radius of the rear axle's middle
    speed = 0.3 * u[0] / (1 - 0.75 * turn)
    return _typed(of, x, u, p, (speed * ca.cos(x[2]), speed * ca.sin(x[2]), speed * turn, u[1]))


def swerve(of: Model) -> Model:
    """Modules 0.381 m ahead, behind, left and right."""
    x, u, p = _vectors(of)
    slide = []
    for k, (ahead, left) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        vx, vy = u[0] - 0.381 * left * u[2], u[1] + 0.381 * ahead * u[2]
        slide.append(vy * ca.cos(x[3 + k]) - vx * ca.sin(x[3 + k]))
    c, s = ca.cos(x[2]), ca.sin(x[2])
    typed = _typed(of, x, u, p, (c * u[0] - s * u[1], s * u[0] + c * u[1], *ca.vertsplit(u[2:])))
    return replace(typed, rolling=ca.Function("rolling", [x, u, p], [ca.vertcat(*slide)]))


def skid_steer(of: Model) -> Model:
    """As it is commanded, whatever slips."""
    x, u, p = _vectors(of)
    return _typed(of, x, u, p, (u[0] * ca.cos(x[2]), u[0] * ca.sin(x[2]), u[1]))


def trailers(of: Model) -> Model:
    """Wheelbase 1.4 m, trailers of 1.1 m and 0.9 m, each coupled on the axle in front."""
    x, u, p = _vectors(of)
    v, (theta, steer, first, second) = u[0], ca.vertsplit(x[2:])
    rates = (
        v * ca.cos(theta), v * ca.sin(theta), v * ca.tan(steer) / 1.4, u[1],
        v * ca.sin(theta - first) / 1.1, v * ca.cos(theta - first) * ca.sin(first - second) / 0.9,
    )  # fmt: skip
    return _typed(of, x, u, p, rates)


def _vectors(of: Model) -> tuple[ca.SX, ca.SX, ca.SX]:
    return ca.SX.sym("x", len(of.state)), ca.SX.sym("u", len(of.inputs)), ca.SX.sym("p", len(of.p))


def _typed(of: Model, x: ca.SX, u: ca.SX, p: ca.SX, rates: tuple[ca.SX, ...]) -> Model:
    return replace(of, ode=ca.Function("by_hand", [x, u, p], [ca.vertcat(*rates)], ["x", "u", "p"], ["xdot"]))
