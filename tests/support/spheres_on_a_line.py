"""Exact Stokes flow of unit spheres that move along the line of their centres in an unbounded fluid.

Each sphere's share of the flow is the series of Stokes' stream function in its own coordinates r and ζ = cos θ,

    ψ = Σₙ (Bₙ r^(1-n) + Dₙ r^(3-n)) Iₙ(ζ),   Iₙ = (Pₙ₋₂ - Pₙ)/(2n - 1),   n = 2, 3, …

and the sum of all shares is the spheres' velocity at Gauss points on each of them, in least squares (Gluckman, Pfeffer
and Weinbaum 1971, doi:10.1017/S0022112071002854). The fluid's force on a sphere is 4πμD₂.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from rigidfluid.core.geometry.arrays import FloatArray

DEGREES = 12
"""Terms of each series: ten digits where surfaces are a radius apart."""

STROKES = (((1.0, 1.0), (-1.0, 0.0)), ((0.0, 1.0), (0.0, -1.0)), ((0.0, 0.0), (1.0, 0.0)), ((1.0, 0.0), (0.0, 1.0)))
"""How far out both outer spheres of the swimmer are when a stroke begins, and how that changes: left in, right in, left
out, right out."""


def velocities(centres: FloatArray, given: FloatArray) -> FloatArray:
    """Velocities (m,) of spheres at ``centres`` (m,): those ``given`` (m,) and a common one, with which the forces on
    all of them add up to zero."""
    rows, along, first = _collocation(centres)
    system = np.block([[rows, -along[:, None]], [first, np.zeros((1, 1))]])
    load = np.append(along * np.repeat(given, len(along) // len(given)), 0.0)
    return np.asarray(given + np.linalg.lstsq(system, load)[0][-1])


def drag(centres: FloatArray, given: FloatArray) -> FloatArray:
    """Drag (m,) of spheres at ``centres`` (m,) that move with the velocities ``given`` (m,), over 6πμ."""
    rows, along, first = _collocation(centres)
    load = along * np.repeat(given, len(along) // len(given))
    coefficients = np.linalg.lstsq(rows, load)[0]
    return np.asarray(-2.0 / 3.0 * coefficients[first[0] == 1.0])


def cycle(arm: float, stroke: float, points: int = 6) -> FloatArray:
    """Displacement (4,) of the middle sphere in each stroke of the three-sphere swimmer with arms ``arm``."""
    nodes, weights = leggauss(points)
    moved = np.zeros(4)
    for number, ((left, right), (left_rate, right_rate)) in enumerate(STROKES):
        for s, weight in zip((nodes + 1.0) / 2.0, weights / 2.0, strict=True):
            arms = arm - stroke * (1.0 - np.array([left + s * left_rate, right + s * right_rate]))
            given = stroke * np.array([-left_rate, 0.0, right_rate])
            moved[number] += weight * velocities(np.array([-arms[0], 0.0, arms[1]]), given)[1]
    return moved


def _collocation(centres: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Velocity at all points, along the line and across it, by all coefficients; which rows are along the line; which
    coefficients are D₂."""
    zeta = leggauss(2 * DEGREES)[0]
    along = np.concatenate([np.column_stack([zeta, np.sqrt(1.0 - zeta**2)])] * len(centres))
    along[:, 0] += np.repeat(centres, len(zeta))
    shares = [_share(along - [centre, 0.0]) for centre in centres]
    matrix = np.concatenate(shares, axis=2)
    rows = np.stack([matrix[0], matrix[1]], axis=1).reshape(-1, matrix.shape[2])
    first = np.zeros((1, matrix.shape[2]))
    first[0, DEGREES :: 2 * DEGREES] = 1.0
    return rows, np.tile([1.0, 0.0], len(along)), first


def _share(points: FloatArray) -> FloatArray:
    """Velocity (2, p, 2 DEGREES) along the line and across it at ``points`` (p, 2) by the coefficients B and D of one
    sphere at the origin."""
    r = np.hypot(*points.T)[:, None]
    zeta, sine = points[:, :1] / r, points[:, 1:] / r
    n = np.arange(2, DEGREES + 2)
    legendre = legvander(zeta[:, 0], DEGREES + 1)
    gegenbauer = (legendre[:, :-2] - legendre[:, 2:]) / (2 * n - 1)
    outward, polar = [], []
    for power in (1 - n, 3 - n):
        radial = r ** (power - 2)
        outward.append(-radial * legendre[:, 1:-1])
        polar.append(power * radial * gegenbauer / sine)
    out, turn = np.concatenate(outward, axis=1), np.concatenate(polar, axis=1)
    return np.stack([zeta * out - sine * turn, sine * out + zeta * turn])
