"""Edge lengths that a scene leaves to the domain, or to the speeds that are expected: `mesh.size = "auto"` and
`mesh.size_body = "auto"`."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.mechanics.boundary_layer import CELLS_WANTED, boundary_layers
from rigidfluid.core.mechanics.shapes import equal_volume_radius
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.system import System
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.assemble import assemble

_EDGES_PER_DIAMETER = 10.0
_EDGES_PER_WIDTH = 4.0
_DIGITS = 3


def auto_size(domain: Domain) -> float:
    """Edge length far from bodies [length]: a quarter of the ``domain``'s least width."""
    lower, upper = domain.extent
    return _rounded(float(np.min(upper - lower)) / _EDGES_PER_WIDTH)


def auto_size_body(scene: Scene) -> float:
    """Edge length on bodies [length]: half of the thinnest boundary layer d/√Re at the expected speeds, at most a tenth
    of the diameter d of the smallest ball of equal volume, and at most the mesh's ``size``; just that with an
    ``accuracy``, by which layers are resolved.

    The scene needs a mesh; its ``size_body`` is not read.
    """
    assert scene.mesh is not None
    smallest = min((equal_volume_radius(shape) for shape in model_of(scene).shapes), default=np.inf)
    size = min(scene.mesh.size, 2.0 * smallest / _EDGES_PER_DIAMETER)
    if scene.mesh.accuracy is not None:
        return _rounded(size)
    fine = scene.model_copy(update={"mesh": scene.mesh.model_copy(update={"size_body": size})})
    return _rounded(min(size, _half_layer(assemble(model_of(fine)))))


def _half_layer(system: System) -> float:
    """The thickness of the thinnest layer over the cells wanted, infinite where there is none [length]."""
    problem, speeds = system.fluid, system.loads.travel_speed
    if problem is None or not problem.inertia or speeds is None:
        return np.inf
    layers = boundary_layers(system.bodies, speeds, problem.kinematic_viscosity)
    return float(layers.min(initial=np.inf)) / CELLS_WANTED


def _rounded(size: float) -> float:
    """Round down to three digits."""
    unit = 10.0 ** (np.floor(np.log10(size)) - _DIGITS + 1)
    return float(f"{np.floor(size / unit * (1.0 + 1e-12)) * unit:.{_DIGITS}g}")
