"""Quality of the insertion of bodies into a mesh: facets and corners kept, distances, areas, volumes, cells."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from math import factorial
from typing import Any, NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.facets import area_vectors
from rigidfluid.core.mechanics.frames import distance_to_body, to_world
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh

BINS = 20
"""Number of classes of the histogram of cell quality, from 0 to 1."""


@dataclass(frozen=True, slots=True)
class SurfaceFigures:
    """Figures of one surface of the mesh.

    ``kind``: "smooth", or "facets", or "flat" for a flat piece of the domain, whose facets may be re-meshed in their
    plane. ``given_facets``, ``given_corners``: number in a shape made of facets; ``kept_facets``, ``kept_corners``: how
    many of them are in the mesh to the last bit (a facet that is not has been halved); else None. ``facets`` in the
    mesh; ``vertices_off``, ``middles_off``: farthest vertex, and middle of a facet, from the shape [length].
    ``area`` of the facets, ``exact_area`` of the shape where it is known [length^(d-1)]; ``volume`` that a body's
    facets enclose, ``exact_volume`` of the body [length^d].
    """

    name: str
    kind: str
    facets: int
    given_facets: int | None
    kept_facets: int | None
    given_corners: int | None
    kept_corners: int | None
    vertices_off: float
    middles_off: float
    area: float
    exact_area: float | None
    volume: float | None
    exact_volume: float | None


@dataclass(frozen=True, slots=True)
class Figures:
    """Figures of a mesh: counts, the worst cell's quality [1], cells in each of BINS classes of quality, volume of the
    mesh and of the domain less the bodies [length^d], seconds of each phase, and its surfaces."""

    name: str
    dimension: int
    inserter: str
    cells: int
    vertices: int
    worst_quality: float
    quality_histogram: tuple[int, ...]
    volume: float
    exact_volume: float
    seconds: dict[str, float]
    surfaces: tuple[SurfaceFigures, ...]

    def to_dict(self) -> dict[str, Any]:
        """Dictionary for JSON, surfaces included."""
        return asdict(self)


def measured(name: str, inserter: str, mesh: Mesh, system: System, seconds: dict[str, float]) -> Figures:
    """The figures of a straight mesh around a system's bodies where they start."""
    quality = cell_quality(mesh.points, mesh.cells)
    return Figures(
        name=name,
        dimension=system.dimension,
        inserter=inserter,
        cells=len(mesh.cells),
        vertices=len(mesh.points),
        worst_quality=float(quality.min()),
        quality_histogram=tuple(np.histogram(quality, BINS, (0.0, 1.0))[0].tolist()),
        volume=float(cell_volumes(mesh.points, mesh.cells).sum()),
        exact_volume=system.meshed(system.pose).volume - sum(body.volume for body in system.bodies),
        seconds=seconds,
        surfaces=tuple(_surfaces(mesh, system)),
    )


class _Given(NamedTuple):
    """Facets that a shape is made of, where they lie: ``points`` (N, d) [length] and ``vertices`` (F, d)."""

    points: FloatArray
    vertices: IntArray


_Counts = tuple[int | None, int | None, int | None, int | None]


def _surfaces(mesh: Mesh, system: System) -> Iterator[SurfaceFigures]:
    sides = _sides(mesh)
    for number in range(len(system.bodies)):
        yield _body_figures(mesh, system, number, sides)
    domain = system.meshed(system.pose)
    for number in range(len(domain.pieces)):
        if number not in domain.periodic_pieces:  # the mesh may be cut open anywhere
            yield _piece_figures(mesh, system, number)


def _body_figures(mesh: Mesh, system: System, number: int, sides: FloatArray) -> SurfaceFigures:
    """Figures of a body's surface; ``sides`` (F,) as in `_sides`."""
    body, pose, own = system.bodies[number], mesh.images_of(system.pose), mesh.markers == number
    facets, given = mesh.facets[own], None
    if body.facets is not None:
        given = _Given(to_world(pose, number, body.facets.points), body.facets.vertices)
    parts = _vertices_and_middles(mesh, facets)
    vertices_off, middles_off = (float(np.abs(distance_to_body(pose, number, body, at)).max()) for at in parts)
    return SurfaceFigures(
        system.surfaces[number],
        "smooth" if given is None else "facets",
        len(facets),
        *_kept(mesh, facets, given),
        vertices_off,
        middles_off,
        _area(mesh.points, facets),
        None if given is None else _area(*given),
        _enclosed(mesh.points[facets] - pose.position[number], sides[own]),
        body.volume,
    )


def _piece_figures(mesh: Mesh, system: System, number: int) -> SurfaceFigures:
    """Figures of a piece of the domain's boundary, by its number among the pieces."""
    domain = system.meshed(system.pose)
    piece, facets, given = domain.pieces[number], mesh.facets[mesh.markers == len(system.bodies) + number], None
    if domain.facets is not None:
        given = _Given(domain.facets.points, domain.facets.vertices[domain.facets.markers == number])
    parts = _vertices_and_middles(mesh, facets)
    vertices_off, middles_off = (
        float(np.linalg.norm(at - piece.shape.closest_point(at), axis=1).max()) for at in parts
    )
    return SurfaceFigures(
        piece.name,
        "flat" if piece.shape.plane is not None else "smooth" if given is None else "facets",
        len(facets),
        *_kept(mesh, facets, given),
        vertices_off,
        middles_off,
        _area(mesh.points, facets),
        piece.area if given is None else _area(*given),
        None,
        None,
    )


def _kept(mesh: Mesh, facets: IntArray, given: _Given | None) -> _Counts:
    """Number of facets given and kept, and of corners given and kept; None for shapes that are not made of facets."""
    if given is None:
        return None, None, None, None
    points, vertices = given
    corners = points[np.unique(vertices)]
    kept = _rows(points[vertices]) & _rows(mesh.points[facets])
    return len(vertices), len(kept), len(corners), len(_rows(corners) & _rows(mesh.points[np.unique(facets)]))


def _area(points: FloatArray, vertices: IntArray) -> float:
    return float(np.linalg.norm(area_vectors(points, vertices), axis=1).sum())


def _vertices_and_middles(mesh: Mesh, facets: IntArray) -> tuple[FloatArray, FloatArray]:
    return mesh.points[np.unique(facets)], mesh.points[facets].mean(axis=1)


def _rows(points: FloatArray) -> set[tuple[Any, ...]]:
    """Points (N, d) or facets' corners (F, d, d), to the last bit, a facet's in any order."""
    if points.ndim == 2:
        return set(map(tuple, points.tolist()))
    return {tuple(sorted(map(tuple, corners))) for corners in points.tolist()}


def _sides(mesh: Mesh) -> FloatArray:
    """1 for each facet (F,) whose normal, by the order of its vertices, points into its cell, else -1."""
    d = mesh.points.shape[1]
    picks = np.array([np.delete(np.arange(d + 1), k) for k in range(d + 1)])
    of_cells = np.sort(mesh.cells[:, picks].reshape(-1, d), axis=1)
    number = np.unique(np.concatenate([of_cells, np.sort(mesh.facets, axis=1)]), axis=0, return_inverse=True)[1]
    opposite = np.empty(number.max() + 1, dtype=np.int64)
    opposite[number[: len(of_cells)]] = mesh.cells.ravel()
    inner = mesh.points[opposite[number[len(of_cells) :]]]
    return np.asarray(-np.sign(np.linalg.det(mesh.points[mesh.facets] - inner[:, None])))


def _enclosed(corners: FloatArray, sides: FloatArray) -> float:
    """Volume enclosed by facets, ``corners`` (F, d, d) about a point of the body, ``sides`` (F,) as in `_sides`."""
    return float(sides @ np.linalg.det(corners)) / factorial(corners.shape[1])
