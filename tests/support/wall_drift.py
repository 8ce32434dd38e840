"""Many re-meshings of a stenosis while a disk goes through its throat: do the walls stay where they are?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from mesh_tools import ball, upright

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion
from rigidfluid.core.mesh.adaptation.remesh import remesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.domains.stenosis import Stenosis, StenosisOptions

RADIUS = 3.125


@dataclass(frozen=True)
class Drift:
    """After so many ``remeshings``, with the disk at ``x``: area between the walls minus the exact one, how far the
    farthest vertex of a bump is off its circle, quality of the worst cell, and facets on the bumps."""

    remeshings: int
    x: float
    area_error: float
    off_wall: float
    quality: float
    curved_facets: int


def wall_drift(remeshings: int = 50) -> Iterator[Drift]:
    """A disk of diameter 1 goes through a throat of 1.75 on a wavy path from x = -8 to 8, and the mesh is regenerated
    at each stop; stops are closer where the gap is small, as a mesh must not tangle on the way to the next.

    Parameters
    ----------
    remeshings : int
        How many stops on the way.

    Yields
    ------
    Drift
        Of the first mesh, and after each re-meshing.
    """
    domain = Stenosis(StenosisOptions(length=32.0, width=8.0, radius=RADIUS), 2)
    body, x = ball(0.5), np.linspace(-1.0, 1.0, remeshings + 1)
    x = 8.0 * np.sign(x) * np.abs(x) ** 1.5
    poses = [upright([at, 0.3 * np.cos(0.4 * at)]) for at in x]
    walls, sizes = surfaces_of(domain, 1), Sizes(0.5, 0.08)
    mesh = initial_mesh(FluidDomain([body], poses[0], domain, walls), sizes)
    yield _seen(0, mesh, poses[0], domain)
    for number, (before, after) in enumerate(pairwise(poses), start=1):
        moved = replace(mesh, points=MeshMotion(mesh, FluidDomain([body], before, domain, ())).move(after))
        mesh = remesh(moved, FluidDomain([body], after, domain, walls), sizes)
        yield _seen(number, mesh, after, domain)


def _seen(number: int, mesh: Mesh, pose: Pose, domain: Stenosis) -> Drift:
    centre = pose.position[0]
    inside = cell_volumes(mesh.points, mesh.cells).sum() + _fan(mesh.points[mesh.facets[mesh.markers == 0]] - centre)
    curved = [number for number, piece in enumerate(domain.pieces, start=1) if piece.shape.plane is None]
    on_bumps = mesh.points[np.unique(mesh.facets[np.isin(mesh.markers, curved)])]
    off = np.abs(np.hypot(on_bumps[:, 0], 4.0 - np.abs(on_bumps[:, 1])) - RADIUS).max()
    return Drift(
        remeshings=number,
        x=float(centre[0]),
        area_error=float(inside) - domain.volume,
        off_wall=float(off),
        quality=float(cell_quality(mesh.points, mesh.cells).min()),
        curved_facets=int(np.isin(mesh.markers, curved).sum()),
    )


def _fan(edges: FloatArray) -> float:
    """Area of the triangles between edges (F, 2, 2) of a convex outline and the origin in it."""
    return 0.5 * float(np.abs(np.linalg.det(edges)).sum())
