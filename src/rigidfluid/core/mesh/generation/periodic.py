"""Meshes whose facets on periodic surfaces are the same but for a displacement."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.images import originals
from rigidfluid.core.geometry.mesher_unit import in_space, in_unit
from rigidfluid.core.mesh.distribution import surface_vertices
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import Mesh
from rigidfluid.errors import MeshError

_APART = 1e-6
"""Netgen's images are so near to where they belong, over the distance of the surfaces."""


@dataclass(frozen=True)
class Seams:
    """Periodic surfaces of a mesh: of k pairs the ``first`` and the ``second`` marker (k,), and the ``ways`` (k, d)
    from the first to the second [length]."""

    first: IntArray
    second: IntArray
    ways: FloatArray

    @classmethod
    def from_domain(cls, bodies: int, domain: Domain) -> Seams:
        """The periodic surfaces of a ``domain`` with so many ``bodies`` in it."""
        pairs = np.array(domain.periodic, dtype=np.int64).reshape(-1, 2) + bodies
        return cls(pairs[:, 0], pairs[:, 1], domain.lattice)

    @property
    def surfaces(self) -> IntArray:
        """All markers, (2k,)."""
        return np.concatenate([self.first, self.second])

    def originals(self, mesh: Mesh) -> tuple[IntArray, IntArray]:
        """The vertex that each one of a ``mesh`` is an image of, (N,), and by how many periods, (N, k), as for
        `originals`."""
        vertices = [
            (surface_vertices(mesh, first), surface_vertices(mesh, second))
            for first, second in zip(self.first.tolist(), self.second.tolist(), strict=True)
        ]
        return originals(mesh.points, vertices, self.ways)


def identify(sides: Any, first: int, domain: Domain, unit: float) -> None:
    """Let Netgen mesh periodic ``sides`` of a shape alike, whose lengths are over ``unit``; they are named by surface
    number, the domain's from ``first`` on."""
    from netgen import occ

    for pair, way in zip(domain.periodic, in_unit(domain.lattice, unit), strict=True):
        one, two = (occ.ListOfShapes([side for side in sides if side.name == str(first + piece)]) for piece in pair)
        moved = occ.gp_Trsf.Translation(occ.Vec(*in_space(way)))
        one.Identify(two, f"{pair[0]}", occ.IdentificationType.PERIODIC, moved)


def with_exact_images(mesh: Mesh, bodies: int, domain: Domain) -> Mesh:
    """Put the vertices of the second surface of each periodic pair exactly where those of the first are displaced to;
    raises MeshError if they are not near there."""
    for pair, way in zip(domain.periodic, domain.lattice, strict=True):
        points = mesh.points.copy()
        one, two = (surface_vertices(mesh, bodies + piece) for piece in pair)
        distance, place = scipy.spatial.cKDTree(points[one] + way).query(points[two])
        if len(one) != len(two) or np.max(distance) > _APART * np.linalg.norm(way):
            names = " and ".join(repr(domain.names[piece]) for piece in pair)
            found = f"{len(one)} and {len(two)} vertices on the periodic surfaces {names}"
            raise MeshError("mesh", found, "the same facets on both", "Choose another mesh.size.")
        points[two] = points[one[place]] + way
        mesh = replace(mesh, points=points)
    return mesh


def on_periodic_surfaces(mesh: Mesh, bodies: int, domain: Domain) -> BoolArray:
    """Tell whether each facet is on a periodic surface, whose mesh stays that of its image, (F,)."""
    return np.isin(mesh.markers - bodies, list(domain.periodic_pieces))
