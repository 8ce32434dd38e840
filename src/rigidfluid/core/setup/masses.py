"""Masses and weights of a scene's bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.mechanics.added_mass import added_mass
from rigidfluid.core.model.types import FloatArray

if TYPE_CHECKING:
    from rigidfluid.core.setup.parts import Parts


@dataclass(frozen=True)
class Masses:
    """``mass`` (n,) of the bodies, their ``inertia`` (n, k, k), the ``added`` mass (n, d, d) of the fluid around them,
    and their submerged ``weight`` (n, d) [force]."""

    mass: FloatArray
    inertia: FloatArray
    added: FloatArray
    weight: FloatArray


def masses_of(parts: Parts) -> Masses:
    """Masses of all bodies, the components of mechanisms included."""
    bodies, tables = parts.bodies, parts.scene.body
    mass = np.array([table.density * body.volume for table, body in zip(tables, bodies, strict=True)])
    inertia = mass[:, None, None] * np.array([body.unit_inertia for body in bodies])
    added = _inert_density(parts) * np.array([added_mass(body) for body in bodies])
    return Masses(mass, inertia, added, _submerged_weight(parts, mass))


def _submerged_weight(parts: Parts, mass: FloatArray) -> FloatArray:
    """(m - ρV)g with the exact volume, (n, d) [force]; the fluid carries no gravity, so buoyancy belongs here."""
    fluid, dimension = parts.scene.fluid, parts.scene.dimension
    volume = np.array([body.volume for body in parts.bodies])
    return np.outer(mass - (fluid.density or 0.0) * volume, np.array(fluid.gravity or [0.0] * dimension))


def _inert_density(parts: Parts) -> float:
    """Density of the fluid that bodies have to move with them; none without a fluid, or without its inertia."""
    fluid = parts.scene.fluid
    return (fluid.density or 0.0) if parts.wet and fluid.model == "navier-stokes" else 0.0
