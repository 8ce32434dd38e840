"""The first mesh from surfaces: Netgen fills between the facets of the domain and of each body, which all stay."""

from __future__ import annotations

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.facets import enclosed_volume
from rigidfluid.core.geometry.mesher_unit import in_unit, mesher_unit
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.inserter import MESHER_TIMEOUT
from rigidfluid.core.mesh.generation.same_points import rows_of
from rigidfluid.core.mesh.generation.surface_checks import refuse_unfillable
from rigidfluid.core.mesh.generation.surface_mesh import surface_mesh
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import REMEDY, check_mesh, check_volume, orient
from rigidfluid.core.model.types import Mesh
from rigidfluid.errors import MeshError
from rigidfluid.python_process import environment, python

MESHER = python("-m", "rigidfluid.core.mesh.generation.netgen_fill")
"""The command that fills what one file holds and writes the cells to another."""


def fill_mesh(
    fluid_domain: FluidDomain,
    sizes: Sizes,
    timeout: float = MESHER_TIMEOUT,
) -> Mesh:
    """Mesh of the domain minus the bodies, Ω \\ ∪ B_i, between the facets of `surface_mesh`, which stay to the last
    bit.

    Markers are surface numbers: bodies 0 … n-1, then the domain's pieces. Raises MeshError where a surface is open, two
    cross, a body is outside, or Netgen makes no valid mesh within ``timeout`` [s].
    """
    surface = surface_mesh(fluid_domain, sizes)
    refuse_unfillable(surface, fluid_domain)
    return fill_between(surface, sizes, timeout)


def fill_between(surface: Mesh, sizes: Sizes, timeout: float) -> Mesh:
    """The mesh inside a closed surface, whose facets and vertices stay to the last bit."""
    points, cells = filled(surface, sizes.size, sizes.growth, timeout)
    mesh = orient(_with_facets(points, cells, surface))
    check_mesh(mesh, quality=0.0)
    check_volume(mesh, -enclosed_volume(surface.points, surface.facets), "between the surfaces")
    return mesh


def filled(surface: Mesh, size: float, growth: float, timeout: float) -> tuple[FloatArray, IntArray]:
    """Vertices (M, d) and cells (C, d+1) between closed facets, made by Netgen in a process of its own."""
    unit = mesher_unit(np.ptp(surface.points, axis=0))
    points, longest = in_unit(surface.points, unit), in_unit(size, unit)
    with TemporaryDirectory() as folder:
        given, made = Path(folder, "given.npz"), Path(folder, "made.npz")
        np.savez(given, points=points, facets=surface.facets, size=longest, growth=growth)
        try:
            # What Netgen prints is dropped, as it may print without end.
            ended = subprocess.run(
                [*MESHER, str(given), str(made)],
                timeout=timeout,
                check=False,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env=environment(),
            )
        except subprocess.TimeoutExpired as error:
            remedy = f"Raise mesh.mesher_timeout if the mesh is large. {REMEDY}"
            found = "a mesher that had not ended"
            raise MeshError("mesh", found, f"an end within {timeout:g} seconds", remedy) from error
        if ended.returncode != 0 or not made.exists():
            found = f"Netgen failed (its process ended with code {ended.returncode})"
            raise MeshError("mesh", found, "surfaces that it can fill between", REMEDY)
        with np.load(made) as arrays:
            return unit * arrays["points"], arrays["cells"]


def _with_facets(points: FloatArray, cells: IntArray, surface: Mesh) -> Mesh:
    """A mesh of the cells, with the surface's facets and its vertices to the last bit."""
    used, compact = np.unique(cells, return_inverse=True)
    points, cells = points[used], compact.reshape(cells.shape)
    place = rows_of(surface.points, points, 1e-9 * float(np.ptp(surface.points, axis=0).max()))
    if place is None:
        raise MeshError("mesh", "a vertex lost by Netgen", "every vertex of the surfaces kept", REMEDY)
    points[place] = surface.points
    return Mesh(points, cells, place[surface.facets], surface.markers)
