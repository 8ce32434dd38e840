"""Exact resistance in Stokes flow of two spheres, or of a sphere and a plane, that slide past each other and turn.

In bispherical coordinates z = c sinh ξ/(cosh ξ - t), ρ = c sin η/(cosh ξ - t), t = cos η, the spheres are ξ = α > 0 and
ξ = β < 0, the plane is β = 0. With viscosity 1 the flow is (O'Neill & Majumdar, Z. angew. Math. Phys. 21 (1970) 164,
doi:10.1007/BF01590641; at a plane Goldman, Cox & Brenner, Chem. Eng. Sci. 22 (1967) 637,
doi:10.1016/0009-2509(67)80047-2)

    p = Q cos φ/c,  u_ρ = (ρQ/c + V + U) cos φ/2,  u_φ = (V - U) sin φ/2,  u_z = (zQ/c + 2W) cos φ/2

with √(cosh ξ - t) times Q, W = sin η Σ qₙ Pₙ'(t), U = Σ uₙ Pₙ(t), V = sin²η Σ vₙ Pₙ''(t), where each qₙ is a sum of
exp(±(n + ½)ξ). The divergence is harmonic too, which gives one recurrence for each sign. The terms of one sign are
singular in one sphere alone, so that their far field gives its force and torque.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import spsolve

FloatArray = np.ndarray
E_FOLDS = 24.0
"""Decay of the last coefficient from the first."""


@cache
def resistance(gap: float, radius_b: float) -> FloatArray:
    """Resistance A of spheres of radius 1 and ``radius_b`` to (U_a, ω_a, U_b, ω_b), (4, 4): forces and torques about
    the centres, U along x and ω about y, a above b; (2, 2) of a alone where ``radius_b`` is infinite."""
    alpha, beta, c = coordinates(gap, radius_b)
    order = int(E_FOLDS / min(alpha, -beta or np.inf)) + 10
    motions = [(0, 1.0, 0.0), (0, 0.0, 1.0), (1, 1.0, 0.0), (1, 0.0, 1.0)][: 2 if np.isinf(radius_b) else 4]
    matrix = sparse.bmat(_boundary_rows(alpha, beta, order) + _divergence_rows(alpha, beta, order)).tocsc()
    sides = [_boundary_sides((alpha, beta)[at], at, c, order, velocity, spin) for at, velocity, spin in motions]
    found = spsolve(matrix, np.column_stack(sides))
    return np.concatenate([_load(found, (alpha, beta)[at], at, c, order) for at in range(len(motions) // 2)])


@cache
def film_resistance(gap: float, radius_b: float) -> FloatArray:
    """Resistance M = (B A⁻¹ Bᵀ)⁻¹ (2, 2) of a pair that nothing else holds, to (v, w) = B (U_a, ω_a, U_b, ω_b): v the
    velocity of a relative to b half-way between the surfaces, w that of n × (ω_a - ω_b), with n from b to a."""
    relative = relative_motion(gap, radius_b)
    return np.linalg.inv(relative @ np.linalg.solve(resistance(gap, radius_b), relative.T))


def relative_motion(gap: float, radius_b: float) -> FloatArray:
    """The B of `film_resistance`, (2, 4); (2, 2) of a alone where ``radius_b`` is infinite."""
    arm_a, arm_b = 1.0 + 0.5 * gap, radius_b + 0.5 * gap
    if np.isinf(radius_b):
        return np.array([[1.0, -arm_a], [0.0, -1.0]])
    return np.array([[1.0, -arm_a, -1.0, -arm_b], [0.0, -1.0, 0.0, 1.0]])


def free_twists(resistance: FloatArray, relative: FloatArray, wanted: FloatArray) -> FloatArray:
    """Velocities (m,) of a pair with a ``wanted`` relative motion (r,) = ``relative`` (r, m) velocities, by which no
    load acts on the pair as a whole; ``resistance`` (m, m) is that of both bodies."""
    moved = np.linalg.solve(resistance, relative.T)
    return np.asarray(moved @ np.linalg.solve(relative @ moved, wanted))


@cache
def twisting(gap: float, radius_b: float) -> FloatArray:
    """Resistance of spheres of radius 1 and ``radius_b`` to angular velocities along the axis, with viscosity 1,
    (2, 2); (1, 1) of the first alone where ``radius_b`` is infinite. Sums over the images of spheres that spin
    (Jeffery, Proc. London Math. Soc. s2-14 (1915) 327)."""
    alpha, beta, c = coordinates(gap, radius_b)
    n = (alpha - beta) * np.arange(1.0, int(E_FOLDS / (alpha - beta)) + 10)

    def images(distance: FloatArray) -> float:
        return float(8.0 * np.pi * np.sum((c / np.sinh(distance)) ** 3))

    a = images(n + beta)
    if np.isinf(radius_b):
        return np.array([[a]])
    b, both = images(n - alpha), -images(n)
    return np.array([[a, both], [both, b]])


@cache
def twisting_resistance(gap: float, radius_b: float) -> float:
    """Resistance of a pair that nothing else holds to ω_a - ω_b along the axis, with viscosity 1."""
    found = twisting(gap, radius_b)
    return float(found[0, 0] if np.isinf(radius_b) else np.linalg.det(found) / found.sum())


def coordinates(gap: float, radius_b: float) -> tuple[float, float, float]:
    """Coordinates α > 0 and β of the spheres and the length c, over the radius of the first."""
    distance = 1.0 + radius_b + gap
    beyond = gap * (1.0 if np.isinf(radius_b) else (gap + 2.0 * radius_b) / (2.0 * distance))
    c = float(np.sqrt(beyond * (2.0 + beyond)))
    return float(np.arcsinh(c)), -float(np.arcsinh(c / radius_b)), c


def _times_t(order: int, m: int) -> Any:
    """t on Σ qₙ Pₙ⁽ᵐ⁾, as a matrix on coefficients 0 … order."""
    n = np.arange(order + 1.0)
    up, down = (n + 1 - m) / (2 * n + 1), (n + m) / (2 * n + 1)
    return sparse.diags([up[:-1], down[1:]], [-1, 1])


def _raised(order: int) -> Any:
    """Coefficients in Pₙ⁽ᵐ⁺¹⁾ of those in Pₙ⁽ᵐ⁾."""
    n = np.arange(order + 1.0)
    return sparse.diags([1 / (2 * n + 1)[:-1], -1 / (2 * n + 1)[1:]], [-1, 1])


def _lowered(order: int) -> Any:
    """Coefficients in Pₙ of sin²η Σ qₙ Pₙ'."""
    n = np.arange(order + 1.0)
    factor = n * (n + 1) / (2 * n + 1)
    return sparse.diags([-factor[:-1], factor[1:]], [-1, 1])


def _boundary_rows(alpha: float, beta: float, order: int) -> list[list[Any]]:
    """W, U and V on both spheres by the coefficients Q±, W±, U±, V±, each scaled to 1 on its own sphere."""
    n, rows = np.arange(order + 1.0), []
    across = sparse.diags([np.exp(-(n + 0.5) * (alpha - beta))], [0])
    for m, by_pressure, first in ((1, None, 1), (0, _lowered(order), 0), (2, _raised(order), 2)):
        for at, xi in enumerate((alpha, beta)):
            own = [sparse.identity(order + 1), across] if at == 0 else [across, sparse.identity(order + 1)]
            apart = np.cosh(xi) * sparse.identity(order + 1) - _times_t(order, m)
            pressure = 0.5 * (np.sinh(xi) * sparse.identity(order + 1) if by_pressure is None else by_pressure)
            row = [None] * 8
            for sign in range(2):
                row[sign] = (pressure @ own[sign]).tocsr()[first:, 1:]
                row[{1: 2, 0: 4, 2: 6}[m] + sign] = (apart @ own[sign]).tocsr()[first:, first:]
            rows.append(row)
    return rows


def _divergence_rows(alpha: float, beta: float, order: int) -> list[list[Any]]:
    """Both recurrences, from n = 1 on."""
    n, rows = np.arange(order + 1.0), []
    for side, (sign, at) in enumerate(((1.0, alpha), (-1.0, -beta))):
        terms = {
            0: (-(n - 1), 5.0 + 0 * n, n + 2, 1),
            2: (-2 * sign * (n - 1), 2 * sign * (2 * n + 1), -2 * sign * (n + 2), 1),
            4: (-1.0 + 0 * n, 2.0 + 0 * n, -1.0 + 0 * n, 0),
            6: ((n - 2) * (n - 1), -2 * (n - 1) * (n + 2), (n + 2) * (n + 3), 2),
        }
        row = [None] * 8
        for kind, (below, same, above, first) in terms.items():
            bands = [np.exp(at) * below[1:], same, np.exp(-at) * above[:-1]]
            row[kind + side] = sparse.diags(bands, [-1, 0, 1]).tocsr()[1:, first:]
        rows.append(row)
    return rows


def _boundary_sides(xi: float, at: int, c: float, order: int, velocity: float, spin: float) -> FloatArray:
    """Right sides where sphere ``at`` moves and turns, with its centre at z = c coth ξ."""
    n = np.arange(order + 2.0)
    root = np.sqrt(2.0) * np.exp(-(n + 0.5) * abs(xi))  # 1/√(cosh ξ - t) in Pₙ
    along, across = -spin * c * (_raised(order + 1) @ root), np.zeros(order + 2)
    height = 0.0 if xi == 0.0 else c / np.tanh(xi)
    across += 2.0 * (velocity - spin * height) * (np.cosh(xi) * root - _times_t(order + 1, 0) @ root)
    across += 2.0 * spin * c * np.sinh(xi) * root
    none = np.zeros(order - 1), np.zeros(2 * order)
    both = [(0.0 * along[1:-1], 0.0 * across[:-1]), (along[1:-1], across[:-1])]
    w, u = zip(both[1 - at], both[at], strict=True)
    return np.concatenate([*w, *u, none[0], none[0], none[1]])


def _load(found: FloatArray, xi: float, at: int, c: float, order: int) -> FloatArray:
    """Force and torque (2, motions) that sphere ``at`` exerts on the fluid, by the coefficients that are ``found``."""
    n, sign = np.arange(order + 1.0), 1.0 if at == 0 else -1.0
    starts = np.cumsum([0, order, order, order, order, order + 1])
    scale = np.exp(-(n + 0.5) * abs(xi))[:, None]
    q = found[starts[at] : starts[at] + order] * scale[1:]
    w = found[starts[2 + at] : starts[2 + at] + order] * scale[1:]
    u = found[starts[4 + at] : starts[4 + at] + order + 1] * scale
    twice = (n * (n + 1))[1:, None]
    force = 4.0 * np.sqrt(2.0) * np.pi * c * np.sum(twice * q, axis=0)
    about_origin = sign * np.sum((n + 0.5)[:, None] * u, axis=0) - np.sum(twice * w, axis=0)
    torque = 4.0 * np.sqrt(2.0) * np.pi * c**2 * about_origin - c / np.tanh(xi) * force
    return np.array([force, torque])
