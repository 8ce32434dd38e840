"""Gaps of bodies to the bumps of a stenosis, as the mesh's facets have them and as they are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

import numpy as np
from mesh_tools import ball, ellipsoid

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.detectors.ellipsoid import EllipsoidDetector
from rigidfluid.detectors.narrow_band import NarrowBandDetector, NarrowBandOptions
from rigidfluid.domains.stenosis import Stenosis, StenosisOptions

BUMP = 3.125
PLACES = ((0.0, 0.2), (-2.0, 0.6), (-3.2, 1.6))
SHAPES = {"disk": (ball(0.5), 0.5), "ellipse": (ellipsoid(0.6, 0.3), 0.3**2 / 0.6)}
"""Each with its least radius of curvature."""


@dataclass(frozen=True)
class CurvedGap:
    """Of one ``shape`` at ``place`` with facets of ``size``: the ``exact`` gap to the nearest bump, the detector's
    ``error``, and the ``bound`` (h_w²/R + h_b²/r)/8 for the facets of wall and body that are nearest there
    [length]."""

    shape: str
    place: tuple[float, float]
    size: float
    exact: float
    error: float
    bound: float


def curved_gaps(sizes: tuple[float, ...] = (0.1, 0.05, 0.025)) -> Iterator[CurvedGap]:
    """Shapes at places next to and in the throat, with facets of some sizes."""
    domain = Stenosis(StenosisOptions(length=32.0, width=8.0, radius=BUMP), 2)
    walls = list(surfaces_of(domain, 1))
    bumps = [wall for wall in walls if wall.shape.plane is None]
    for name, (body, narrowest) in SHAPES.items():
        for place in PLACES:
            pose = Pose(np.array([place]), np.array([[pi / 5.0]]))
            exact = EllipsoidDetector(PartOptions(), [body], bumps).detect(pose, None, np.inf).gap.min()
            for size in sizes:
                mesh = initial_mesh(FluidDomain([body], pose, domain, walls), Sizes(0.5, size))
                found = NarrowBandDetector(NarrowBandOptions(), [body], bumps).detect(pose, mesh, 2.5)
                at = int(np.argmin(found.gap))
                on_body = _length(mesh, 0, found.point_a[at])
                on_wall = _length(mesh, int(found.body_b[at]), found.point_b[at])
                bound = (on_wall**2 / BUMP + on_body**2 / narrowest) / 8.0
                yield CurvedGap(name, place, size, float(exact), float(found.gap[at] - exact), bound)


def _length(mesh: Mesh, surface: int, point: FloatArray) -> float:
    """Of the longest edge of a surface that ends or passes at a point."""
    ends = mesh.points[mesh.facets[mesh.markers == surface]]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    around = np.linalg.norm(ends - point, axis=2).sum(axis=1) - length
    return float(length[around <= 1e-9].max())
