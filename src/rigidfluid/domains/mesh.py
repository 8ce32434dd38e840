"""A domain whose boundary is that of a mesh in a file."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets, area_vectors, enclosed_volume, place
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.part import PartOptions
from rigidfluid.domains.boundary_of_mesh import SAME, boundary_of
from rigidfluid.domains.mesh_file import FIELD, read_mesh
from rigidfluid.domains.naming import Labels, order_surfaces, surface_names
from rigidfluid.domains.orientation import facing_the_fluid
from rigidfluid.errors import SceneError

_LEAST_VOLUME = 1e-12
"""Volume over that of the cube around the domain, below which facets are flat [1]."""


class MeshOptions(PartOptions):
    """Keys of the ``[domain]`` table with type ``mesh``: a file whose boundary facets are the walls. Its own cells are
    not used. Walls without thickness, which have fluid on both sides, are refused.

    Files of Gmsh, MED, VTU and Medit need meshio, which comes with `rigidfluid[files]`; those of Netgen and STL do not.
    """

    file: str = Field(
        description="The file, searched for in the scene's folder: .msh, .med, .vtu, .mesh, .meshb, .vol, .vol.gz or "
        ".stl"
    )
    scale: float = Field(default=1.0, gt=0, description="Factor by which lengths in the file are multiplied [1]")
    faces: dict[str, Labels] | None = Field(
        default=None,
        description="Names of surfaces, each with the names or numbers in the file that it consists of; each must be "
        "listed; the file's names if not given",
    )
    fluid: int | str | None = Field(
        default=None, description="Number or name of the cells that are fluid, if the file has several kinds"
    )


class MeshDomain(Domain):
    """The polyhedron, or in 2D the polygon, of the boundary facets of a mesh.

    A file that cannot be read, a region that is not there, facets without a name, and a surface that is open, crosses
    itself or has one side only raise SceneError.
    """

    name: ClassVar[str] = "mesh"
    Options: ClassVar[type[PartOptions]] = MeshOptions
    options: MeshOptions

    def __init__(self, options: MeshOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        file = read_mesh(Path(options.file), dimension)
        boundary = boundary_of(file, dimension, options.fluid, options.scale)
        self._doubled = boundary.doubled
        parts = boundary.parts
        names = surface_names(parts, options.faces)
        self._names = order_surfaces(names, options.faces)
        _refuse_crossing(boundary.facets)
        facets = facing_the_fluid(boundary.facets, FIELD)
        piece_of = {part.number: self._names.index(name) for part, name in zip(parts, names, strict=True)}
        markers = np.array([piece_of[number] for number in facets.markers.tolist()], dtype=np.int64)
        self._facets = Facets(facets.points, facets.vertices, markers)
        self._whole = FacetSurface(self._facets)
        self._volume = -enclosed_volume(facets.points, facets.vertices)
        if not self._volume > _LEAST_VOLUME * float(np.ptp(facets.points, axis=0).max()) ** dimension:
            found = f"facets that enclose a volume of {self._volume:.3g}"
            raise SceneError(FIELD, found, "facets around a region of some volume", "Rewrite the file.")

    @property
    def facets(self) -> Facets:
        """The facets of the file, normals into the fluid, marked by the number of their piece."""
        return self._facets

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Pieces in the order of `faces`, else of the file."""
        return tuple(self._piece(number, name) for number, name in enumerate(self._names))

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the box around all facets [length]."""
        return self._whole.bounds

    @property
    def volume(self) -> float:
        """Exact volume of the polyhedron [length^d]."""
        return self._volume

    @property
    def remarks(self) -> tuple[str, ...]:
        """Remark on the number of points that were joined, if any were."""
        joined = f"{self._doubled} points of the file were joined with others less than {SAME:g} of the domain away"
        return (joined,) if self._doubled else ()

    def contains(self, points: FloatArray) -> BoolArray:
        """Which of ``points`` (N, d) are inside, (N,)."""
        return np.asarray(self._whole.signed_distance(points) > 0.0)

    def _piece(self, number: int, name: str) -> Piece:
        facets = self._facets.part(self._facets.markers == number)
        area = np.linalg.norm(area_vectors(facets.points, facets.vertices), axis=1).sum()
        return Piece(name, self._whole.piece(number), float(area))


def _refuse_crossing(facets: Facets) -> None:
    from rigidfluid.core.geometry.crossings import first_crossing

    crossing = first_crossing(facets.points, facets.vertices)
    if crossing is not None:
        one, other = (place(facets.points[facets.vertices[facet]]) for facet in crossing)
        found = f"facets that cross each other, the first two about {one} and {other}"
        raise SceneError(FIELD, found, "a surface that does not cross itself", "Mend it there.")
