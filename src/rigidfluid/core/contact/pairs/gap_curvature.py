"""Curvature of the gap between two smooth surfaces: its effective radius, on which alone the resistance to squeezing
depends, and the curvature tensors of both, on which all others do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.wall import Wall, wall_radii
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.types import Contacts, Pose

if TYPE_CHECKING:
    from rigidfluid.core.model.system import System


def with_gap_curvatures(contacts: Contacts, system: System, pose: Pose) -> Contacts:
    """Contacts with what the laws of films of a system read: R, and where one is ``curved`` both surfaces' tensors."""
    if not any(interaction.law.film for interaction in system.interactions):
        return contacts
    if not system.has_curved_films:
        return with_effective_radii(contacts, system.bodies, system.walls, pose)
    tensors, radius = _curvatures(contacts, system.bodies, system.walls, pose), contacts.effective_radius
    radius = np.where(np.isnan(radius), _effective_radius(tensors.sum(axis=1)), radius)
    return replace(contacts, effective_radius=radius, curvatures=tensors)


def with_effective_radii(contacts: Contacts, bodies: Sequence[Body], walls: Sequence[Wall], pose: Pose) -> Contacts:
    """Contacts with R of ellipses and ellipsoids added: with H, the sum of both surfaces' curvature tensors,

        R = √(2/(tr H √(det H))) in 3D, 1/tr H in 2D.

    The pressure 6μV/(tr H h²) solves Reynolds' equation in the gap h + xᵀHx/2 squeezed at the speed V, and has the
    resultant 12πμV/(tr H √(det H) h): that of a ball of radius R at a flat wall, 6πμR²V/h (Cox, Int. J. Multiphase Flow
    1 (1974) 343, doi:10.1016/0301-9322(74)90019-6). R is set wherever both surfaces have semi-axes or are round, and
    the gap widens to all sides; other contacts are unchanged [length].
    """
    unknown = np.flatnonzero(np.isnan(contacts.effective_radius))
    if len(unknown) == 0:
        return contacts
    radius = contacts.effective_radius.copy()
    radius[unknown] = _effective_radius(_curvatures(select(contacts, unknown), bodies, walls, pose).sum(axis=1))
    return replace(contacts, effective_radius=radius)


def _curvatures(contacts: Contacts, bodies: Sequence[Body], walls: Sequence[Wall], pose: Pose) -> FloatArray:
    """Curvature tensors of a and of b, (m, 2, d, d) [1/length]."""
    normal, at_wall, body_b = contacts.normal, contacts.at_wall, contacts.body_b
    tensors = np.empty((len(contacts), 2, *2 * normal.shape[1:]))
    tensors[:, 0] = _body_curvatures(contacts.body_a, normal, bodies, pose)
    tensors[at_wall, 1] = _across(normal[at_wall]) / wall_radii(walls, body_b[at_wall])[:, None, None]
    tensors[~at_wall, 1] = _body_curvatures(body_b[~at_wall], normal[~at_wall], bodies, pose)
    return tensors


def _body_curvatures(body: IntArray, normal: FloatArray, bodies: Sequence[Body], pose: Pose) -> FloatArray:
    """Curvature tensor P √(nᵀMn) M⁻¹ P with M = R diag(a²) Rᵀ of each ellipsoid where its normal is ±n, P across n, (m,
    d, d) [1/length]; NaN without semi-axes."""
    dimension = normal.shape[1]
    missing = np.full(dimension, np.nan)
    axes = [missing if bodies[one].semi_axes is None else bodies[one].semi_axes for one in body.tolist()]
    squares = np.reshape(np.array(axes, dtype=float), (-1, dimension)) ** 2
    rotation = rotation_matrices(pose.orientation[body])
    along = np.einsum("mij,mi->mj", rotation, normal)
    height = np.sqrt(np.sum(squares * along**2, axis=1))
    inverse = np.einsum("mij,mj,mkj->mik", rotation, height[:, None] / squares, rotation)
    across = _across(normal)
    return np.asarray(across @ inverse @ across)


def _across(normal: FloatArray) -> FloatArray:
    """Projector 1 - nnᵀ, (m, d, d)."""
    return np.asarray(np.eye(normal.shape[1]) - normal[:, :, None] * normal[:, None, :])


def _effective_radius(curvature: FloatArray) -> FloatArray:
    """Effective radius R (m,) of H (m, d, d), which is zero along the normal; NaN where H is not positive across it
    [length]."""
    trace = np.trace(curvature, axis1=1, axis2=2)
    if curvature.shape[1] == 2:
        return 1.0 / np.where(trace > 0.0, trace, np.nan)
    determinant = 0.5 * (trace**2 - np.sum(curvature**2, axis=(1, 2)))
    wide = (trace > 0.0) & (determinant > 0.0)
    return np.sqrt(2.0 / (np.where(wide, trace, np.nan) * np.sqrt(np.where(wide, determinant, np.nan))))
