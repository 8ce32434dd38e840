"""Pictures of surfaces in space as a distant observer sees them, what is in front over what is behind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import to_rgb
from scipy.spatial import ConvexHull

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.model.body import Body
from rigidfluid.post.reports.bodies import seen_bodies
from rigidfluid.post.reports.raster import Grid, Sampling
from rigidfluid.post.reports.results import Results

_LIGHT = np.array([-0.4, 0.5, 0.77]) / np.linalg.norm([-0.4, 0.5, 0.77])
"""Direction of the light: to the observer's right, up, and to the observer."""
_AMBIENT = 0.4
"""Brightness of surfaces that are turned away from the light."""
_BAND = 0.07
"""Half the width of the stripe that shows how a body turns, over the bounding radius."""
_POINTS = 20_000
"""Number of points on all smooth bodies together."""
_FEWEST, _MOST = 60, 1000
"""Bounds of the number of points on one body."""


@dataclass(frozen=True)
class Shell:
    """Triangles (T, 3, 3) of a body's surface in its frame, and the unit normals (T, 3, 3) at their corners."""

    triangles: FloatArray
    normals: FloatArray

    @classmethod
    def cover(cls, body: Body, count: int) -> Shell:
        """The body's facets, or triangles between about ``count`` points of a smooth surface, of which each direction
        from the centre of mass must meet one point."""
        if body.facets is not None:
            triangles = np.asarray(body.facets.points[body.facets.vertices])
            normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
            return cls(triangles, np.repeat(_unit(normal)[:, None], 3, axis=1))
        points = body.sample_surface(count)
        directions = _unit(points)
        corners = ConvexHull(directions).simplices
        inwards = np.linalg.det(directions[corners]) < 0.0
        corners[inwards] = corners[inwards, ::-1]
        triangles, normals = points[corners], np.zeros_like(points)
        normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        np.add.at(normals, corners, normal[:, None])
        return cls(triangles, _unit(normals)[corners])


@dataclass(frozen=True)
class Canvas:
    """A ``picture`` (rows, columns, 3) of a ``grid``, and the ``depth`` (rows, columns) of what it shows: the height
    towards the observer [length]."""

    picture: FloatArray
    depth: FloatArray
    grid: Grid

    @classmethod
    def blank(cls, grid: Grid) -> Canvas:
        """A white picture."""
        return cls(np.ones((grid.rows, grid.columns, 3)), np.full((grid.rows, grid.columns), -np.inf), grid)

    def paint(self, triangles: FloatArray, values: FloatArray, colours: Callable[[FloatArray], FloatArray]) -> None:
        """Paint triangles (T, 3, 3) at the points where nothing is in front of them, by the ``colours`` (P, 3) of
        ``values`` (T, 3, c) at their corners, which are linear between those."""
        seen = Sampling.locate(triangles, self.grid)
        height = seen.values(triangles @ self.grid.plane.normal)
        order = np.argsort(height, kind="stable")  # of several on one point the last, which is the nearest, stays
        order = order[height[order] > self.depth.ravel()[seen.place[order]]]
        place = seen.place[order]
        self.picture.reshape(-1, 3)[place] = colours(seen.values(values)[order])
        self.depth.reshape(-1)[place] = height[order]

    def paint_bodies(self, shells: list[Shell], results: Results, state: int, colour: str, stripe: str) -> None:
        """Paint the bodies lit from the upper left, each with a ``stripe`` along its x-axis."""
        plane = self.grid.plane
        observer = np.stack([plane.right, plane.up, plane.normal])
        for body in seen_bodies(results, state):
            shell, turn = shells[body.number], body.turn
            own = shell.triangles[..., :2] / body.shape.bounding_radius
            values = np.concatenate([own, shell.normals @ (observer @ turn).T], axis=2)
            self.paint(shell.triangles @ turn.T + body.centre, values, lambda at: _lit(at, colour, stripe))

    def shows(self, points: FloatArray, slack: float) -> BoolArray:
        """Tell whether nothing that is painted hides each of ``points`` (…, 3) by more than ``slack`` [length]."""
        i, j = np.moveaxis(self.grid.coordinates(points).round().astype(int), -1, 0)
        depth = self.depth[np.clip(j, 0, self.grid.rows - 1), np.clip(i, 0, self.grid.columns - 1)]
        return np.asarray(points @ self.grid.plane.normal > depth - slack)


def body_shells(results: Results) -> list[Shell]:
    """Surfaces of the bodies, the coarser the more there are."""
    bodies = results.system.bodies
    count = int(np.clip(_POINTS // max(len(bodies), 1), _FEWEST, _MOST))
    return [Shell.cover(body, count) for body in bodies]


def _lit(values: FloatArray, colour: str, stripe: str) -> FloatArray:
    """RGB (P, 3) from x and y in the body's frame over its radius and the normal in the observer's, (P, 5)."""
    striped = (np.abs(values[:, 1]) < _BAND) & (values[:, 0] > 0.0)
    brightness = _AMBIENT + (1.0 - _AMBIENT) * np.maximum(_unit(values[:, 2:]) @ _LIGHT, 0.0)
    return np.asarray(np.where(striped[:, None], to_rgb(stripe), to_rgb(colour)) * brightness[:, None])


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), np.finfo(float).tiny))
