"""Domains made of facets: an irregular outline, and a bent tube."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facet_moments import facet_moments
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets, area_vectors
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.mesh.generation.meshing import EdgeLengths, netgen_mesh
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.part import PartOptions

TUBE_RADIUS, BEND, LEG = 1.0, 3.0, 4.0


class FacetDomain(Domain):
    """The inside of closed facets whose markers are the numbers of ``names``."""

    name = "facets"
    Options = PartOptions

    def __init__(self, facets: Facets, names: tuple[str, ...]) -> None:
        super().__init__(PartOptions(), facets.points.shape[1])
        self._surface = FacetSurface(facets)
        areas = np.linalg.norm(area_vectors(facets.points, facets.vertices), axis=1)
        self._pieces = tuple(
            Piece(name, self._surface.piece(k), float(areas[facets.markers == k].sum())) for k, name in enumerate(names)
        )

    @property
    def facets(self) -> Facets:
        return self._surface.facets

    @property
    def pieces(self) -> tuple[Piece, ...]:
        return self._pieces

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        return self._surface.bounds

    @property
    def volume(self) -> float:
        return -float(facet_moments(self.facets).volume)

    def contains(self, points: FloatArray) -> BoolArray:
        return np.asarray(self._surface.signed_distance(points) > 0.0)


def irregular_outline(seed: int = 1, count: int = 65) -> FacetDomain:
    """A channel of length 32 about 8 wide, its walls waves with random bumps, edges about half a unit long."""
    rng = np.random.default_rng(seed)
    x = np.linspace(-16.0, 16.0, count)
    bumps = [np.interp(x, np.linspace(-16.0, 16.0, 20), 0.3 * rng.standard_normal(20)) for _ in range(2)]
    lower = np.stack([x, -4.0 + 0.8 * np.sin(0.9 * x) + bumps[0]], axis=1)
    upper = np.stack([x, 4.0 + 0.7 * np.sin(0.7 * x + 1.0) + bumps[1]], axis=1)
    sides = [lower, _between(lower[-1], upper[-1]), upper[::-1], _between(upper[0], lower[0])]
    points = np.concatenate([side[:-1] for side in sides])
    markers = np.repeat(np.arange(4), [len(side) - 1 for side in sides])
    numbers = np.arange(len(points))
    edges = np.stack([np.roll(numbers, -1), numbers], axis=1)  # clockwise, so that normals point into the fluid
    return FacetDomain(Facets(points, edges, markers), ("lower", "outlet", "upper", "inlet"))


def room(corners: Sequence[tuple[float, float]]) -> FacetDomain:
    """The inside of a polygon, its corners in order to the left, each side with a name of its own."""
    numbers = np.arange(len(corners))
    edges = np.stack([np.roll(numbers, -1), numbers], axis=1)  # clockwise, so that normals point into the fluid
    return FacetDomain(Facets(np.array(corners), edges, numbers), tuple(f"side {number}" for number in numbers))


def bent_tube(size: float = 0.4) -> FacetDomain:
    """Facets of a tube of radius 1: a leg along x, a quarter bend of radius 3, a leg along y, each leg 4 long."""
    from netgen import occ

    first = occ.Cylinder(occ.Pnt(-LEG, 0, 0), occ.X, r=TUBE_RADIUS, h=LEG)
    circle = occ.WorkPlane(occ.Axes((0, 0, 0), n=occ.X, h=occ.Y)).Circle(TUBE_RADIUS).Face()
    bend = circle.Revolve(occ.Axis(occ.Pnt(0, BEND, 0), occ.Z), 90)
    shape = first + bend + occ.Cylinder(occ.Pnt(BEND, BEND, 0), occ.Y, r=TUBE_RADIUS, h=LEG)
    for side in shape.faces:
        middle = side.center
        side.name = "inlet" if middle.x < 1e-3 - LEG else "outlet" if middle.y > BEND + LEG - 1e-3 else "wall"
    netgen = netgen_mesh(shape, 3, EdgeLengths(size, 0.3), surfaces_alone=True)
    return _of_netgen(netgen, ("wall", "inlet", "outlet"))


def along_the_tube(rng: np.random.Generator) -> FloatArray:
    """A random place about the tube's axis, (3,)."""
    s, radius, angle = rng.uniform(-3.2, 1.5 * np.pi + 3.2), rng.uniform(0.0, 0.5), rng.uniform(0.0, 2.0 * np.pi)
    across, up = radius * np.cos(angle), radius * np.sin(angle)
    if s < 0.0:
        return np.array([s, across, up])
    turn = min(s / BEND, 0.5 * np.pi)
    beyond = max(s - 0.5 * np.pi * BEND, 0.0)
    axis = np.array([BEND * np.sin(turn), BEND * (1.0 - np.cos(turn)) + beyond, 0.0])
    return axis + across * np.array([-np.sin(turn), np.cos(turn), 0.0]) + np.array([0.0, 0.0, up])


def _between(start: FloatArray, end: FloatArray) -> FloatArray:
    steps = int(np.ceil(2.0 * np.linalg.norm(end - start)))
    return np.linspace(start, end, steps + 1)


def _of_netgen(netgen: Any, names: tuple[str, ...]) -> FacetDomain:
    table = netgen.Elements2D().NumPy()
    vertices: IntArray = table["nodes"][:, :3].astype(np.int64) - 1
    regions = table["index"].astype(np.int64) - 1
    markers = np.array([names.index(netgen.GetBCName(int(region))) for region in range(regions.max() + 1)])[regions]
    used, compact = np.unique(vertices, return_inverse=True)
    inward = compact.reshape(-1, 3)[:, ::-1]
    return FacetDomain(Facets(netgen.Coordinates()[used].copy(), np.ascontiguousarray(inward), markers), names)
