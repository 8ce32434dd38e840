"""Exact rotation in Stokes flow of two equal spheres on a rigid rod that the fluid does not feel.

The director p of the pair turns as ṗ = W·p + r (E·p - (p·E·p) p), W and E the spin and strain of the undisturbed flow:
the pair has the symmetries of a body of revolution, and r alone is its own (Bretherton, J. Fluid Mech. 14 (1962) 284,
doi:10.1017/S002211206200124X). Where the flow is u = γ y along x, the angle φ of p from the x-axis turns at

    dφ/dt = -γ (A sin²φ + B cos²φ),   A = (1 + r)/2,   B = (1 - r)/2,

once in 2π/(γ √(A B)).

r is the rate at which the pair, free of torque, turns in the strain u = (z, 0, x) with its centres on the z-axis. The
fluid's disturbance is Lamb's solution outside each sphere (Kim & Karrila, Microhydrodynamics, 1991, section 4.2):

    u = Σₙ ∇×(r χₙ) + ∇Φₙ - (n-2)/(2n(2n-1)) r² ∇pₙ + (n+1)/(n(2n-1)) r pₙ,   viscosity 1,

pₙ and Φₙ multiples of r^(-n-1) Pₙ¹(cos θ) cos φ, χₙ of the same with sin φ; the force on a sphere is -4π ∇(r³ p₁) and
the torque -8π ∇(r³ χ₁). All coefficients and r follow by least squares on one sphere; the other has the same, mirrored.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import legvander

FloatArray = np.ndarray


def rotation_in_strain(distance: float, order: int = 60) -> tuple[float, float]:
    """r of two spheres of radius 1, and the largest velocity by which the solution misses the rigid motion.

    Parameters
    ----------
    distance : float
        Of the centres, > 2 [radius].
    order : int
        Largest n; enough is some 12 over the square root of the gap.
    """
    cos = np.polynomial.legendre.leggauss(4 * order)[0]
    sin = np.sqrt(1.0 - cos**2)
    mirrored = np.array([-1.0, -1.0, 1.0])[:, None, None]
    fields = lamb(sin, cos, order) + mirrored * lamb(sin, -(cos + distance), order)
    height = cos + distance / 2
    # u_ρ and u_z go with cos φ, u_φ with sin φ: of the rotation (z, 0, -x), and of the strain (z, 0, x)
    rotation, strain = np.array([height, -height, -sin]), np.array([height, -height, sin])
    unknowns = np.concatenate([fields, -rotation[:, :, None]], axis=2).reshape(3 * len(cos), -1)
    no_torque = np.zeros(3 * order + 1)
    no_torque[[0, 2 * order]] = distance / 2, 2.0
    matrix = np.vstack([unknowns, no_torque])
    scale = np.linalg.norm(matrix, axis=0)
    sides = np.append(-strain.ravel(), 0.0)
    found = np.linalg.lstsq(matrix / scale, sides, rcond=1e-15)[0] / scale
    return float(found[-1]), float(np.abs(matrix @ found - sides).max())


def drag_across(gap: float, order: int = 60) -> float:
    """Force over 6πμrV on each of two spheres that do not turn and move with V across the line of their centres, one to
    each side: Y₁₁ᴬ - Y₁₂ᴬ of Jeffrey & Onishi, J. Fluid Mech. 139 (1984) 261, doi:10.1017/S0022112084000355.

    Parameters
    ----------
    gap : float
        Between the surfaces [radius].
    order : int
        Largest n; enough is some 12 over the square root of the gap.
    """
    cos = np.polynomial.legendre.leggauss(4 * order)[0]
    sin = np.sqrt(1.0 - cos**2)
    mirrored = np.array([-1.0, -1.0, 1.0])[:, None, None]
    matrix = (lamb(sin, cos, order) + mirrored * lamb(sin, -(cos + 2.0 + gap), order)).reshape(3 * len(cos), -1)
    scale = np.linalg.norm(matrix, axis=0)
    sides = np.array([np.ones_like(cos), -np.ones_like(cos), np.zeros_like(cos)]).ravel()
    found = np.linalg.lstsq(matrix / scale, sides, rcond=1e-15)[0] / scale
    return float(abs(found[0]) * 4.0 * np.pi / (6.0 * np.pi))


def lamb(rho: FloatArray, z: FloatArray, order: int) -> FloatArray:
    """Velocities about a sphere's centre, (3, points, 3·order): u_ρ, u_φ and u_z of all p, then all Φ, then all χ.

    Parameters
    ----------
    rho, z : (points,) array
        Distance from the axis, and height above the centre.
    order : int
        Largest n.
    """
    r = np.hypot(rho, z)
    cos, sin, n = (z / r)[:, None], (rho / r)[:, None], np.arange(1.0, order + 1)
    legendre = legvander(cos[:, 0], order)
    slope = np.zeros_like(legendre)
    slope[:, 1] = 1.0
    for m in range(2, order + 1):
        slope[:, m] = slope[:, m - 2] + (2 * m - 1) * legendre[:, m - 1]
    over_sine = slope[:, 1:]
    harmonic, tilt = sin * over_sine, n * (n + 1) * legendre[:, 1:] - cos * over_sine
    decay = r[:, None] ** -(n + 2)
    # ∇(r^(-n-1) Pₙ¹ cos φ) along r, θ and φ
    gradient = decay * np.array([-(n + 1) * harmonic, tilt, -over_sine])
    outward, r = np.array([1.0, 0.0, 0.0])[:, None, None], r[:, None]
    pressure = -(n - 2) / (2 * n * (2 * n - 1)) * r**2 * gradient
    pressure += (n + 1) / (n * (2 * n - 1)) * r**2 * decay * harmonic * outward
    curl = r * decay * np.array([np.zeros_like(harmonic), over_sine, -tilt])
    radial, along, around = np.concatenate([pressure, gradient, curl], axis=2)
    return np.array([sin * radial + cos * along, around, cos * radial - sin * along])


def axis_ratio(r: float) -> float:
    """Of the ellipsoid of revolution that turns alike, √(A/B) (Jeffery, Proc. R. Soc. Lond. A 102 (1922) 161)."""
    return float(np.sqrt((1 + r) / (1 - r)))


def period(r: float) -> float:
    """Time of a whole turn in simple shear [1/shear rate]."""
    return float(4 * np.pi / np.sqrt(1 - r**2))


def angle(r: float, time: FloatArray) -> FloatArray:
    """The angle from the x-axis at times [1/shear rate], zero at the start [rad]."""
    ratio = axis_ratio(r)
    phase = time * ratio / (ratio**2 + 1)
    # tan φ = -tan(phase)/ratio, on the branch of the phase
    return -(phase + np.arctan2((1 / ratio - 1) * np.tan(phase), 1 + np.tan(phase) ** 2 / ratio))
