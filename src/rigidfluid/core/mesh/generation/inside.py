"""Mesh of a body's inside, in the body's own frame."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.mesher_unit import in_unit
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.curved_edges import with_curved_edges
from rigidfluid.core.mesh.generation.fill import fill_mesh
from rigidfluid.core.mesh.generation.meshing import generate_mesh, sides
from rigidfluid.core.mesh.size.regions import CurvedWall
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.errors import MeshError

_FINER = (1.0, 0.7, 0.5)
"""Sizes over the wanted one that a mesher is asked for, one after the other where it fails: around thin bodies edges
are kept to their size, inside they are not, and long ones near a tip make facets that cross."""


def can_be_filled(body: Body) -> bool:
    """Tell whether a mesher knows the shape, by facets or by CAD."""
    return body.facets is not None or body.cad_shape(1.0) is not None


def inside_mesh(body: Body, sizes: Sizes, timeout: float) -> Mesh:
    """Mesh of all inside a body, with the sizes of the fluid around it; a mesher that fills is stopped after
    ``timeout`` [s]; raises MeshError where there is none."""
    failures = []
    for finer in _FINER if body.facets is None else _FINER[:1]:
        try:
            return _inside_mesh(body, replace(sizes, size_body=finer * sizes.size_body), timeout)
        except MeshError as error:
            failures.append(error)
    raise failures[0]


def _inside_mesh(body: Body, sizes: Sizes, timeout: float) -> Mesh:
    d, size_body = body.dimension, sizes.size_body
    domain = InsideOfBody(body, size_body)
    sizes = replace(sizes, regions=(CurvedWall(domain.pieces[0].shape, size_body),), asked=())
    nobody = Pose(np.zeros((0, d)), np.zeros((0, 1 if d == 2 else 4)))
    whole = FluidDomain([], nobody, domain, ())
    mesh = generate_mesh(whole, sizes) if body.facets is None else fill_mesh(whole, sizes, timeout)
    return with_curved_edges(mesh, whole) if sizes.order == 2 else mesh


class _Hollow(Surface):
    """A body's surface as seen from its inside."""

    def __init__(self, body: Body) -> None:
        self.body = body

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        return self.body.bounds

    def closest_point(self, points: FloatArray) -> FloatArray:
        return self.body.closest_point(points)

    def signed_distance(self, points: FloatArray) -> FloatArray:
        return -self.body.signed_distance(points)

    def normal(self, points: FloatArray) -> FloatArray:
        return -self.body.normal(points)


class InsideOfBody(Domain):
    """The inside of a body as a domain of one piece, whose edges are at most ``size`` long there [length]."""

    name: ClassVar[str] = "inside of a body"

    def __init__(self, body: Body, size: float) -> None:
        super().__init__(PartOptions(), body.dimension)
        self._body, self._size = body, size
        self._pieces = (Piece("surface", _Hollow(body), 1.0),)

    @property
    def pieces(self) -> tuple[Piece, ...]:
        return self._pieces

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        return self._body.bounds

    @property
    def volume(self) -> float:
        return self._body.volume

    def contains(self, points: FloatArray) -> BoolArray:
        return np.asarray(self._body.signed_distance(points) < 0.0)

    def cad_shape(self, unit: float) -> Any:
        shape = self._body.cad_shape(unit)
        for side in sides(shape, self.dimension):
            side.name, side.maxh = "surface", float(in_unit(self._size, unit))
        return shape

    @property
    def facets(self) -> Facets | None:
        found = self._body.facets
        return None if found is None else Facets(found.points, found.vertices[:, ::-1], found.markers)
