"""Masses and weights of a model's bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.added_mass import added_mass

if TYPE_CHECKING:
    from rigidfluid.core.setup.model import Model


@dataclass(frozen=True)
class Masses:
    """``mass`` (n,) of the bodies, their ``inertia`` (n, k, k), the ``added`` mass (n, d, d) of the fluid around them,
    and their submerged ``weight`` (n, d) [force]."""

    mass: FloatArray
    inertia: FloatArray
    added: FloatArray
    weight: FloatArray


def masses_of(model: Model) -> Masses:
    """Masses of all bodies, the components of mechanisms included."""
    mass = np.array([body.density * body.shape.volume for body in model.all_bodies])
    d, k = model.dimension, 1 if model.dimension == 2 else 3
    unit_inertia = np.array([shape.unit_inertia for shape in model.shapes]).reshape(-1, k, k)
    added = np.array([added_mass(shape) for shape in model.shapes]).reshape(-1, d, d)
    inertia = mass[:, None, None] * unit_inertia
    return Masses(mass, inertia, model.fluid.inert_density * added, _submerged_weight(model, mass))


def _submerged_weight(model: Model, mass: FloatArray) -> FloatArray:
    """(m - ρV)g with the exact volume, (n, d) [force]; the fluid carries no gravity, so buoyancy belongs here."""
    volume = np.array([shape.volume for shape in model.shapes])
    gravity = np.zeros(model.dimension) if model.gravity is None else np.array(model.gravity)
    return np.outer(mass - model.fluid.density * volume, gravity)
