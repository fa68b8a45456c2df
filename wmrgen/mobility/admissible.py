"""The admissible twists: those for which steering exists that lets every wheel roll.

Without couplings these are the null space of the constant rows: any twist in it tells each steered wheel
where to point. Wheels that must steer alike, or turn alike, each add a quadratic equation in the twist;
their common zeros are planes, cones or lines through the origin. The component kept is the one that leaves
most freedom of steering.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.coupled import geared
from wmrgen.mobility.ranks import null_basis
from wmrgen.mobility.records import Array

SMALL = 1e-9
_SAMPLES = ((0.83, -0.41, 0.57), (0.29, 0.71, -0.47), (-0.61, 0.37, 0.89))


@dataclass(frozen=True, slots=True)
class Component:
    """One component of the admissible twists: ``basis`` rows span it; ``sample`` is a generic twist in it.

    ``tangent`` spans the tangent space at the sample.
    """

    dimension: int
    basis: Array
    sample: Array
    linear: bool
    tangent: Array


def _pivot(w: Wheel, turned: bool) -> Array:
    """2x3: twist to pivot velocity, in the joint frame at zero steering when ``turned``."""
    g = w.nominal
    p = np.array([[1.0, 0.0, -float(g.y)], [0.0, 1.0, float(g.x)]])
    c, s = float(g.ch), float(g.sh)
    return np.array([[c, s], [-s, c]]) @ p if turned else p


def quadrics(robot: Robot) -> list[Array]:
    """Symmetric 3x3 forms that vanish on twists allowed by the couplings of steered wheels."""
    forms: list[Array] = []
    for i, leader in enumerate(robot.steer_group):
        a, b = robot.wheels[leader], robot.wheels[i]
        if i != leader and a.kind.steers and b.kind.steers:
            p, q = _pivot(a, True), _pivot(b, True)
            forms.append(np.outer(p[0], q[1]) - np.outer(p[1], q[0]))
    for i, k in geared(robot):
        a, b = robot.wheels[i], robot.wheels[k]
        if robot.steer_group[i] == robot.steer_group[k]:
            # One angle for both: not only the sizes of the velocities are in proportion, seen from the wheels.
            both = _pivot(a, True) - _pivot(b, True) * float(a.nominal.r / b.nominal.r)
            forms += [np.outer(row, row) / (row @ row) for row in both if np.abs(row).max() > SMALL]
        else:
            ratio = float(a.nominal.rolling_radius / b.nominal.rolling_radius)
            forms.append((_speed(a) - _speed(b) * ratio**2) / max(1.0, ratio**2))
    forms = [(f + f.T) / 2 for f in forms]
    return [f for f in forms if np.abs(f).max() > SMALL]


def _speed(w: Wheel) -> Array:
    """The form of the squared rim speed."""
    p = _pivot(w, True)
    if w.kind.steers:
        return p.T @ p
    along = float(w.nominal.cg) * p[0] + float(w.nominal.sg) * p[1]
    return np.outer(along, along)


def components(constant_null: Array, forms: list[Array]) -> list[Component]:
    """Components of {xi in span(rows of constant_null): every form vanishes}."""
    size = len(constant_null)
    if not size:
        return []
    reduced = [constant_null @ f @ constant_null.T for f in forms]
    reduced = [f for f in reduced if np.abs(f).max() > SMALL]

    def linear(rows: Array) -> Component:
        rows = rows @ constant_null
        weights = np.array(_SAMPLES[0][: len(rows)])
        return Component(len(rows), rows, weights @ rows, True, rows)

    if not reduced:
        return [linear(np.eye(size))]
    if size == 2:
        return [linear(v[None, :]) for v in _binary_roots(reduced)]
    if size == 3:
        return _ternary(reduced, linear, constant_null)
    return []


def _binary_roots(forms: list[Array]) -> list[Array]:
    """Common real zeros (unit vectors) of binary quadratic forms."""
    f = forms[0]
    a, b, c = f[0, 0], 2 * f[0, 1], f[1, 1]
    disc = b * b - 4 * a * c
    scale = np.abs(f).max() ** 2
    if disc < -SMALL * scale:
        return []
    root = np.sqrt(max(disc, 0.0))
    if abs(disc) <= SMALL * scale:
        root = 0.0
    found: list[Array] = []
    for sign in (1.0, -1.0):
        v = np.array([-b + sign * root, 2 * a]) if abs(a) > SMALL * np.sqrt(scale) else np.array([1.0, 0.0])
        if abs(a) <= SMALL * np.sqrt(scale) and sign < 0:
            v = np.array([-c, b])
        if np.abs(v).max() < SMALL:
            continue
        v = v / np.linalg.norm(v)
        new = all(abs(v[0] * w[1] - v[1] * w[0]) > 1e-6 for w in found)
        if new and all(abs(v @ g @ v) < 1e-7 * np.abs(g).max() for g in forms):
            found.append(v)
    return found


def _spaces(form: Array) -> list[Array]:
    """Bases of the real planes, or of the line, on which a degenerate ternary form is zero; [] of another form."""
    values, vectors = np.linalg.eigh(form)
    live = np.abs(values) > 1e-9 * np.abs(values).max()
    axes = vectors[:, live].T
    if len(axes) == 1:
        return [null_basis(_oriented(axes[0])[None, :])]
    if len(axes) == 2:
        first, second = values[live]
        if first * second > 0:
            return [_oriented(vectors[:, ~live][:, 0])[None, :]]
        p, q = np.sqrt(np.abs([[first], [second]])) * axes
        return [null_basis(_oriented(n / np.linalg.norm(n))[None, :]) for n in (p + q, p - q)]
    return []


def _proportional(f: Array, g: Array) -> bool:
    """Whether one is a multiple of the other."""
    f, g = f / np.linalg.norm(f), g / np.linalg.norm(g)
    return bool(min(np.abs(f - g).max(), np.abs(f + g).max()) < 1e-9)


def _oriented(v: Array) -> Array:
    """The vector or its opposite: the first clearly non-zero entry is positive."""
    lead = next(float(c) for c in v if abs(c) > 1e-6)
    return v if lead > 0 else -v


def _ternary(forms: list[Array], linear: Callable[[Array], Component], null: Array) -> list[Component]:
    first = forms[0]
    spaces = _spaces(first)
    if not spaces:
        other = next((f for f in forms if not _proportional(f, first)), None)
        if other is None:
            return _conic(first, null)
        roots = np.roots(np.poly(np.linalg.solve(first, other)))
        spaces = [s for r in roots if abs(r.imag) < 1e-9 for s in _spaces(other - r.real * first)]
    found: list[Component] = []
    for space in spaces:
        rest = [f for f in (space @ g @ space.T for g in forms) if np.abs(f).max() > 1e-8]
        if not rest:
            found.append(linear(space))
        elif len(space) == 2:
            found += [linear((v @ space)[None, :]) for v in _binary_roots(rest)]
    return found


def _conic(form: Array, null: Array) -> list[Component]:
    """A real, non-degenerate cone of twists: dimension 2, not linear."""
    values, vectors = np.linalg.eigh(form)
    if (values > 0).all() or (values < 0).all():
        return []
    odd = 0 if values[0] * values[1] < 0 else 2
    others = [k for k in range(3) if k != odd]
    u = np.array([0.6, 0.8])
    z = np.zeros(3)
    z[others] = u
    z[odd] = np.sqrt(-sum(values[k] * z[k] ** 2 for k in others) / values[odd])
    point = _oriented(vectors @ z)
    tangent = null_basis((form @ point)[None, :])
    return [Component(2, null, point @ null, False, tangent @ null)]
