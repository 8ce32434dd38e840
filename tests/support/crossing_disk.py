"""A disk that crosses the middle of a round wall in slow flow: its drag, in closed form and between bounds."""

from __future__ import annotations

import numpy as np
from curved_channels import INNER, OUTER
from sheared_materials import moved_flow

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.materials.power_law import PowerLaw, PowerLawOptions

LEAST = 1e-3
"""Shear rate below which the power law is made Newtonian [1/time]."""

_RINGS, _AROUND = 60, 400


def drag_in_power_law(exponent: float, layers: int) -> float:
    """Drag at velocity 1 in τ = γ̇ⁿ of that ``exponent`` n, computed on so many ``layers`` of curved cells."""
    options = PowerLawOptions(viscosity=1.0, shear_rate=1.0, exponent=exponent, least_shear_rate=LEAST)
    flow = moved_flow(PowerLaw(options, 2), layers, [1.0, 0.0, 0.0])
    return -float(flow.advance.hydrodynamic_wrench.force[0, 0])


def newtonian_drag() -> float:
    """Drag at velocity 1 and viscosity 1: -4πb of the stream function (a r³ + b r ln r + c r + d/r) sin θ."""
    return float(-4.0 * np.pi * _coefficients()[1])


def slope_of_drag() -> float:
    """d drag/dn at n = 1: ∫ γ̇² ln γ̇ dA of the Newtonian flow, by the reciprocal theorem."""
    rate, area = _newtonian_rates()
    return float(np.sum(rate**2 * np.log(rate) * area))


def bounds_of_drag(exponent: float) -> tuple[float, float]:
    """Drags that the power law's is between, of extremum principles with the Newtonian flow and its stress.

    R. Hill and G. Power, Q. J. Mech. Appl. Math. 9 (1956) 313, doi:10.1093/qjmam/9.3.313: of all velocities that fit
    the boundary the flow has the least ∫ τ dγ̇, and of all stresses in equilibrium the least ∫ γ̇ dτ less the drag.
    """
    rate, area = _newtonian_rates()
    above = np.sum(rate ** (exponent + 1.0) * area)
    below = newtonian_drag() ** (exponent + 1.0) / np.sum(rate ** (1.0 + 1.0 / exponent) * area) ** exponent
    return float(below), float(above)


def _coefficients() -> FloatArray:
    """a, b, c, d of the stream function: velocity 1 along x on the disk, 0 on the wall."""
    rows = [
        row
        for r in (INNER, OUTER)
        for row in ([r**2, np.log(r), 1.0, r**-2], [3.0 * r**2, np.log(r) + 1.0, 1.0, -(r**-2)])
    ]
    return np.linalg.solve(rows, [1.0, 1.0, 0.0, 0.0])


def _newtonian_rates() -> tuple[FloatArray, FloatArray]:
    """γ̇ of the Newtonian flow at points of the gap (n,), and the area that each stands for (n,)."""
    root, weight = np.polynomial.legendre.leggauss(_RINGS)
    ring = INNER + 0.5 * (OUTER - INNER) * (1.0 + root)
    r, angle = (
        each.ravel() for each in np.meshgrid(ring, 2.0 * np.pi * (np.arange(_AROUND) + 0.5) / _AROUND, indexing="ij")
    )
    a, b, c, d = _coefficients()
    f = a * r**3 + b * r * np.log(r) + c * r + d / r
    slope = 3.0 * a * r**2 + b * (np.log(r) + 1.0) + c - d / r**2
    bend = 6.0 * a * r + b / r + 2.0 * d / r**3
    stretch, shear = 2.0 * (slope - f / r) / r * np.cos(angle), (slope / r - f / r**2 - bend) * np.sin(angle)
    area = np.repeat(0.5 * (OUTER - INNER) * weight * ring, _AROUND) * 2.0 * np.pi / _AROUND
    return np.hypot(stretch, shear), area
