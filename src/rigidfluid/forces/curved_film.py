"""Resistances of the thin film between two surfaces of any curvatures: their leading terms.

With the curvature tensors A and B of both surfaces across the normal, H = A + B, D = A - B, t = tr H, Δ = det H there
and G = [H (H + 2t)]⁻¹, the film h + xᵀHx/2 that is moved by c·x has the pressure -12μ c·(H + 2t)⁻¹x/(h + xᵀHx/2)², with
c = n × w - D v_t/2. Its resultants and those of the shear make the resistances over the viscosity in 3D

    sliding, coupling, rolling  2π [1 + 3 D G D, -6 D G, 12 G] ln(1/h)/√Δ
    twisting  -π [2t/Δ + (9b²/Δ² + 4d²/Δ - 2b²/(t²Δ))/t] h ln(R/h)/√Δ + what it is in contact,

d² the square of D without its trace, and b the component along the normal of the product of D and H. In 2D they are
those of circles of the same curvatures. Squeezing is that of the effective radius R.

The squeezed film also slides and turns the bodies, by terms in ln(1/h) that depend on the third derivatives of the
surfaces, and twists them by d and b. They vanish beside the square root of both resistances, and are left out.

Notes
-----
Cox, Int. J. Multiphase Flow 1 (1974) 343, doi:10.1016/0301-9322(74)90019-6.
"""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Contacts
from rigidfluid.forces.film_resistance import FilmResistance, leading_squeezing


def plane_radii(contacts: Contacts) -> tuple[FloatArray, FloatArray]:
    """Radii of curvature of a and of b in 2D, (m,) each [length]."""
    if contacts.curvatures is None:
        return contacts.radius_a, contacts.radius_b
    with np.errstate(divide="ignore"):  # a flat wall
        radius_a, radius_b = (1.0 / np.trace(contacts.curvatures, axis1=2, axis2=3)).T
    return _known(contacts.radius_a, radius_a), _known(contacts.radius_b, radius_b)


def _known(radius: FloatArray, local: FloatArray) -> FloatArray:
    """Radii (m,), the ``local`` ones where the surface has no other."""
    return np.where(np.isnan(radius), local, radius)


def curved_resistance(gap: FloatArray, end: FloatArray, curvatures: FloatArray, radius: FloatArray) -> FilmResistance:
    """Resistances in 3D of films as thick as ``gap`` beyond those as thick as ``end``, between surfaces of
    ``curvatures`` (m, 2, 3, 3), with the effective ``radius`` (m,)."""
    whole, unlike = curvatures[:, 0] + curvatures[:, 1], curvatures[:, 0] - curvatures[:, 1]
    trace, determinant = _invariants(whole)
    log = (np.log(end / gap) / np.sqrt(determinant))[:, None, None]
    inverse = (3.0 * trace**2 - determinant)[:, None, None] * np.eye(3) - 3.0 * trace[:, None, None] * whole
    inverse /= (determinant * (6.0 * trace**2 + determinant))[:, None, None]
    coupling = unlike @ inverse
    return FilmResistance(
        leading_squeezing(gap, radius, 3) - leading_squeezing(end, radius, 3),
        2.0 * np.pi * log * (np.eye(3) + 3.0 * coupling @ unlike),
        -12.0 * np.pi * log * coupling,
        24.0 * np.pi * log * inverse,
        _twisting(whole, unlike) * np.maximum(end * np.log(radius / end) - gap * np.log(radius / gap), 0.0),
    )


def _invariants(tensor: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Trace and determinant (m,) in two dimensions of tensors (m, 3, 3) that are zero along a third."""
    trace = np.trace(tensor, axis1=1, axis2=2)
    return trace, 0.5 * (trace**2 - np.sum(tensor**2, axis=(1, 2)))


def _twisting(whole: FloatArray, unlike: FloatArray) -> FloatArray:
    """Factor (m,) of h ln(h/R) in the resistance to twisting."""
    (trace, determinant), (trace_unlike, determinant_unlike) = _invariants(whole), _invariants(unlike)
    deviator, deviator_unlike = 0.5 * trace**2 - 2.0 * determinant, 0.5 * trace_unlike**2 - 2.0 * determinant_unlike
    along = np.sum(whole * unlike, axis=(1, 2)) - 0.5 * trace * trace_unlike
    crossed = deviator * deviator_unlike - along**2
    pressure = 9.0 * crossed / determinant + 4.0 * deviator_unlike - 2.0 * crossed / trace**2
    return np.asarray(np.pi * (2.0 * trace + pressure / trace) / determinant**1.5)
