"""Plain calls of MMG: what it makes of a mesh whose kept facets are required to stay."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mesh.adaptation.signals import kept_signals
from rigidfluid.core.mesh.generation.same_points import rows_of
from rigidfluid.core.mesh.topology import REMEDY
from rigidfluid.core.model.types import Mesh
from rigidfluid.errors import MeshError

MESHER_MEMORY = {2: 1e7, 3: 3.6e8}
"""Memory of a call besides the mesh, of 6,000 cells as of 57,000: in 3D MMG fills its tables for a million vertices
beforehand. It was measured as the resident memory at the most over that before and after [byte]."""


class Kept(NamedTuple):
    """Tell whether MMG has to keep each of the ``facets`` (F,) and ``cells`` (M,) of a mesh."""

    facets: BoolArray
    cells: BoolArray


def keep_facets(mesh: Mesh, facets: BoolArray) -> Kept:
    """Keep these ``facets`` (F,) of a mesh and none of its cells."""
    return Kept(facets, np.zeros(len(mesh.cells), dtype=bool))


def run_mmg(mesh: Mesh, kept: Kept, bodies: int, metric: FloatArray, gradation: float) -> Mesh:
    """Re-mesh by MMG, which has to keep what is ``kept`` and the corners of the domain."""
    try:
        mmg = mmg_mesh(mesh, kept, bodies, metric)
        with kept_signals():
            mmg.remesh(verbose=-1, hgrad=gradation)
    except RuntimeError as error:
        raise MeshError("mesh", f"MMG failed ({error})", "a mesh that MMG can improve", REMEDY) from error
    return from_mmg(mmg, mesh.points.shape[1])


def mmg_mesh(mesh: Mesh, kept: Kept, bodies: int, metric: FloatArray) -> Any:
    """MMG's mesh with its wanted size ``metric`` (N,); its references are the markers and 1."""
    import mmgpy

    d = mesh.points.shape[1]
    corners = domain_corners(mesh, bodies)
    cells, facets, references = (mesh.cells.astype(np.int32), mesh.facets.astype(np.int32), mesh.markers + 1)
    mmg: Any
    if d == 2:
        mmg = mmgpy.MmgMesh2D()
        mmg.set_mesh_size(vertices=len(mesh.points), triangles=len(cells), edges=len(facets))
        put_cells, put_facets, require = mmg.set_triangles, mmg.set_edges, mmg.set_required_edges
        require_cells = mmg.set_required_triangles
    else:
        mmg = mmgpy.MmgMesh3D()
        mmg.set_mesh_size(vertices=len(mesh.points), tetrahedra=len(cells), triangles=len(facets))
        put_cells, put_facets, require = mmg.set_tetrahedra, mmg.set_triangles, mmg.set_required_triangles
        require_cells = mmg.set_required_tetrahedra
    mmg.set_vertices(mesh.points)
    put_cells(cells)
    put_facets(facets, references)
    require(np.flatnonzero(kept.facets).astype(np.int32))
    if kept.cells.any():
        require_cells(np.flatnonzero(kept.cells).astype(np.int32))
    mmg.set_corners(corners.astype(np.int32))
    mmg.set_required_vertices(corners.astype(np.int32))
    mmg["metric"] = metric[:, None]
    return mmg


def from_mmg(mmg: Any, dimension: int) -> Mesh:
    """MMG's mesh as arrays."""
    cells = mmg.get_triangles() if dimension == 2 else mmg.get_tetrahedra()
    facets, references = mmg.get_edges_with_refs() if dimension == 2 else mmg.get_triangles_with_refs()
    points = np.ascontiguousarray(mmg.get_vertices())
    marked = references > 0  # the facets of required cells come back too
    facets, references = facets[marked].astype(np.int64), references[marked].astype(np.int64)
    return without_unused(Mesh(points, cells.astype(np.int64), facets, references - 1))


def without_unused(mesh: Mesh) -> Mesh:
    """The mesh without vertices that no cell has, of which MMG leaves one now and then."""
    used = np.zeros(len(mesh.points), dtype=bool)
    used[mesh.cells] = True
    number = np.cumsum(used) - 1
    return mesh if used.all() else Mesh(mesh.points[used], number[mesh.cells], number[mesh.facets], mesh.markers)


def domain_corners(mesh: Mesh, bodies: int) -> IntArray:
    """Vertices that lie on at least d surfaces of the domain."""
    on_face = [np.unique(mesh.facets[mesh.markers == face]) for face in range(bodies, mesh.markers.max() + 1)]
    vertex, count = np.unique(np.concatenate(on_face), return_counts=True)
    corners: IntArray = vertex[count >= mesh.points.shape[1]]
    return corners


def with_kept_facets(new: Mesh, outer: BoolArray, old: Mesh, kept: Kept, given: FloatArray) -> Mesh:
    """Put the ``kept`` facets of ``old`` to the ``outer`` ones of ``new``, with exact coordinates, also in kept cells.

    MMG scales the ``given`` coordinates and back, so that they return changed by round-off; vertices are recognised by
    nearness.
    """
    old_vertices = np.union1d(old.facets[kept.facets], old.cells[kept.cells])
    place = rows_of(given[old_vertices], new.points, 1e-9 * float(np.ptp(old.points, axis=0).max()))
    if place is None:
        raise MeshError("mesh", "a vertex lost by MMG", "every vertex of bodies and curved walls kept", REMEDY)
    number = np.zeros(len(old.points), dtype=np.int64)
    number[old_vertices] = place
    points = new.points.copy()
    points[place] = old.points[old_vertices]
    facets = np.concatenate([number[old.facets[kept.facets]], new.facets[outer]])
    return Mesh(points, new.cells, facets, np.concatenate([old.markers[kept.facets], new.markers[outer]]))
