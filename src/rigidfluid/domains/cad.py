"""A domain from a CAD file: the exact surfaces that were drawn."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets, area_vectors
from rigidfluid.core.geometry.mesher_unit import in_unit, mesher_unit
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.plane_of_facets import plane_around
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.mesh.generation.meshing import EdgeLengths, netgen_mesh, sides, surfaces_of
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.part import PartOptions
from rigidfluid.domains.closed_form import Flat, Form, components, form_of_edge, form_of_face
from rigidfluid.domains.formed_surface import FormedSurface
from rigidfluid.domains.naming import Labels, Part, order_surfaces, surface_names
from rigidfluid.domains.orientation import facing_the_fluid
from rigidfluid.domains.trial import require_survival
from rigidfluid.errors import MeshError, SceneError
from rigidfluid.regular_file import MOST_GEOMETRY, require_regular

_FACETS = 30
"""Facets along the longest side of the domain, at least, by which faces are found."""

_FACETS_PER_RADIUS = 8.0
"""Facets along a radius of curvature, at least."""

_GROWTH = 0.3
"""Growth of facets away from where they are small [1]."""

_SAME = 1e-9
"""Areas and distances that differ by less, relatively, are equal."""

_SUFFIXES = (".step", ".stp", ".brep", ".iges", ".igs")


class CadOptions(PartOptions):
    """Keys of the ``[domain]`` table with type ``cad``: a STEP, BREP or IGES file with one solid, or in 2D one face,
    which the fluid fills.

    Planes, cylinders, balls and tori (in 2D lines and circles) are exact; fine facets represent other faces.
    """

    file: str = Field(description="The file, searched for in the scene's folder: .step, .stp, .brep, .iges or .igs")
    scale: float = Field(default=1.0, gt=0, description="Factor by which lengths in the file are multiplied [1]")
    faces: dict[str, Labels] | None = Field(
        default=None,
        description="Names of surfaces, each with the faces (in 2D edges) that it consists of, by their names in the "
        "file or by numbers from 1; each face must be listed; the file's names if not given",
    )


class Cad(Domain):
    """The inside of a solid of a CAD file, or in 2D of a face in the plane z = 0.

    A file that cannot be read or has no such shape, and faces without a name, raise SceneError.
    """

    name: ClassVar[str] = "cad"
    Options: ClassVar[type[PartOptions]] = CadOptions
    options: CadOptions

    def __init__(self, options: CadOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        path = Path(options.file)
        _refuse_other_files(path)
        require_survival("cad", path, dimension)
        self._shape, self._unit = _read(options, dimension)
        parts = [self._part(number) for number in range(1, len(self._sides) + 1)]
        self._names = surface_names(parts, options.faces)
        self._order = order_surfaces(self._names, options.faces)
        facets = facing_the_fluid(_fine_facets(self._shape, dimension, self._unit), "domain.file")
        self._facets, self._whole = facets, FacetSurface(facets)
        self._forms = [self._form(side) for side in self._sides]

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Pieces in the order of `faces`, else of the file."""
        return tuple(self._piece(name) for name in self._order)

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the box around all faces; round ones may be a little within it [length]."""
        return self._exact.bounds

    @property
    def volume(self) -> float:
        """Volume as Open CASCADE integrates it [length^d]."""
        return float(self._shape.mass) * self._unit**self.dimension

    def contains(self, points: FloatArray) -> BoolArray:
        """Which of ``points`` (N, d) are inside, (N,)."""
        return np.asarray(self._exact.signed_distance(points) > 0.0)

    def cad_shape(self, unit: float) -> Any:
        """The solid or face of the file, its lengths over ``unit``."""
        shape = _scaled(self._shape, float(in_unit(self._unit, unit)))
        for side, name in zip(sides(shape, self.dimension), self._names, strict=True):
            side.name = name
        return shape

    @property
    def _sides(self) -> list[Any]:
        return list(sides(self._shape, self.dimension))

    @cached_property
    def _exact(self) -> FormedSurface:
        return FormedSurface(self._facets, self._forms)

    def _form(self, side: Any) -> Form | None:
        return form_of_edge(side, self._unit) if self.dimension == 2 else form_of_face(side.surf, self._unit)

    def _centre(self, number: int) -> FloatArray:
        return self._unit * components(self._sides[number].center)[: self.dimension]

    def _area(self, number: int) -> float:
        return float(self._sides[number].mass) * self._unit ** (self.dimension - 1)

    def _part(self, number: int) -> Part:
        centre = ", ".join(f"{x:.4g}" for x in self._unit * components(self._sides[number - 1].center))
        look = f"about ({centre}), of size {self._area(number - 1):.4g}"
        return Part(number, self._sides[number - 1].name, look)

    def _piece(self, name: str) -> Piece:
        numbers = [i for i, given in enumerate(self._names) if given == name]
        chosen = np.isin(self._facets.markers, numbers)
        facets = self._facets.part(chosen)
        area = sum(self._area(i) for i in numbers)
        if all(isinstance(self._forms[i], Flat) for i in numbers):
            plane = plane_around(facets, self._facets.points)
            if plane is not None:
                centre = np.sum([self._area(i) * self._centre(i) for i in numbers], axis=0) / area
                return Piece(name, _bounded(plane, facets, area, centre, self._exact.slack), area)
        return Piece(name, FormedSurface(facets, self._forms, self._whole), area)


def _bounded(plane: Plane, facets: Facets, area: float, centre: FloatArray, slack: float) -> Plane:
    """The plane, bounded as the piece of that ``area`` and ``centre`` is and not as its facets, if its edge is round.

    Whatever has an area of πr² and no point farther than r from its centre is a disk.
    """
    areas = np.linalg.norm(area_vectors(facets.points, facets.vertices), axis=1)
    if np.isclose(areas.sum(), area, rtol=_SAME, atol=0.0):
        return plane
    rim, radius = facets.points[np.unique(facets.vertices)], np.sqrt(area / np.pi)
    across = np.sqrt(1.0 - plane.unit_normal**2)
    if np.linalg.norm(rim - centre, axis=1).max() <= (1.0 + _SAME) * radius:
        return Plane(plane.point, plane.unit_normal, (centre - radius * across, centre + radius * across))
    lower, upper = plane.bounds
    return Plane(plane.point, plane.unit_normal, (lower - slack * across, upper + slack * across))


def _refuse_other_files(path: Path) -> None:
    """Raise SceneError for what is no regular file, or by its name of another kind."""
    require_regular(path, "domain.file", MOST_GEOMETRY)
    if path.suffix.lower() not in _SUFFIXES:
        remedy = "Write it in one of those; a mesh is read by type = 'mesh'."
        raise SceneError("domain.file", str(path), f"one of {', '.join(_SUFFIXES)}", remedy)


def _read(options: CadOptions, dimension: int) -> tuple[Any, float]:
    """The shape with its longest side as meshers take it, and what is 1 in it [length]."""
    from netgen import meshing, occ

    path = Path(options.file)
    try:
        shape = occ.OCCGeometry(str(path), dim=dimension).shape
    except (meshing.NgException, occ.OCCException, RuntimeError) as error:
        found = f"{path}, which Open CASCADE cannot read ({type(error).__name__})"
        raise SceneError("domain.file", found, "a whole CAD file", "Rewrite it.") from error
    solids, faces = list(shape.solids), list(shape.faces)
    whole = solids if dimension == 3 else [] if solids else faces
    if len(whole) != 1:
        found = f"{path} with {len(solids)} solids and {len(faces)} faces"
        allowed = "one solid in 3D" if dimension == 3 else "one face and no solid in 2D"
        raise SceneError("domain.file", found, allowed, "Join what the fluid fills, and leave the rest out.")
    unit = mesher_unit(_size(whole[0]))
    return _scaled(whole[0], 1.0 / unit), options.scale * unit


def probe_cad(path: Path, dimension: int) -> None:
    """Do with a file all that a domain does that may end the process: read it, look at its sides, and mesh them."""
    shape, unit = _read(CadOptions(file=str(path)), dimension)
    for side in sides(shape, dimension):
        (form_of_edge(side, unit) if dimension == 2 else form_of_face(side.surf, unit), side.mass, side.center)
    (_fine_facets(shape, dimension, unit), shape.mass)


def _scaled(shape: Any, factor: float) -> Any:
    from netgen import occ

    return shape if factor == 1.0 else shape.Scale(occ.Pnt(0, 0, 0), factor)


def _size(shape: Any) -> FloatArray:
    """Sides of the box around a shape, (3,)."""
    low, high = shape.bounding_box
    return components(high) - components(low)


def _fine_facets(shape: Any, dimension: int, unit: float) -> Facets:
    """Facets marked by the number of their face, from 0; ``unit`` is 1 in the shape [length]."""
    size = float(_size(shape).max())
    for number, side in enumerate(sides(shape, dimension)):
        side.name = str(number)
    try:
        lengths = EdgeLengths(size / _FACETS, _GROWTH, per_radius=_FACETS_PER_RADIUS)
        made = netgen_mesh(shape, dimension, lengths, surfaces_alone=True)
    except MeshError as error:
        found = f"a shape that Netgen cannot mesh ({str(error.__cause__).strip()})"
        remedy = "Repair it where it was drawn."
        raise SceneError("domain.file", found, "a closed shape without gaps", remedy) from error
    mesh = surfaces_of(made, dimension)
    used, compact = np.unique(mesh.facets, return_inverse=True)
    return Facets(unit * mesh.points[used], compact.reshape(mesh.facets.shape).astype(np.int64), mesh.markers)
