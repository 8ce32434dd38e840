"""Contents of a view of a 3D run: bodies, their paths, the box around the domain, and a slice of the flow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from rigidfluid.core.model.interfaces import Body
from rigidfluid.core.model.types import FloatArray
from rigidfluid.post.reports.bodies import rotations
from rigidfluid.post.reports.curves import MOST_LINES
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.view_plane import ViewPlane

_AZIMUTH, _ELEVATION = np.radians(30.0), np.radians(20.0)
_ROOM = 0.3
"""Margin around the box, over the smaller of its width and height."""
_POINTS = 20_000
"""Number of points on all smooth bodies together."""
_FEWEST, _MOST = 60, 1000
"""Bounds of the number of points on one body."""


@dataclass(frozen=True)
class Space:
    """One moment.

    ``bodies`` (T, 3, 3): triangles of their surfaces, normals outwards; ``paths`` (n, s, 3) until then, none of many
    bodies; ``box`` (2, 3): corners around the domain; ``slice_points`` (S, 3, 3) and ``slice_colours`` (S, 3, 3):
    triangles, and the RGB of their corners; none without a fluid.
    """

    bodies: FloatArray
    paths: FloatArray
    box: FloatArray
    slice_points: FloatArray
    slice_colours: FloatArray


@dataclass(frozen=True)
class Camera:
    """Direction ``to`` (3,) of the distant observer, whose picture has ``right`` and ``up`` (3,); unit vectors."""

    to: FloatArray
    right: FloatArray
    up: FloatArray

    @classmethod
    def place(cls, plane: ViewPlane) -> Camera:
        """Place the observer to the right of the plane's normal, and above it."""
        level = np.cos(_AZIMUTH) * plane.normal + np.sin(_AZIMUTH) * plane.right
        to = np.cos(_ELEVATION) * level + np.sin(_ELEVATION) * plane.up
        right = np.cos(_AZIMUTH) * plane.right - np.sin(_AZIMUTH) * plane.normal
        return cls(to, right, np.cross(to, right))

    def seen(self, points: FloatArray, box: FloatArray) -> FloatArray:
        """Projection (…, 2) of ``points`` (…, 3) on the picture, from the middle of a box (2, 3)."""
        return ViewPlane(self.right, self.up).flat(points - box.mean(axis=0))

    def size(self, box: FloatArray) -> FloatArray:
        """Width and height (2,) of the picture of a box (2, 3), with room for what stands at its edges."""
        box_size = np.ptp(self.seen(box_edges(box).reshape(-1, 3), box), axis=0)
        return np.asarray(box_size + _ROOM * box_size.min())


def space(results: Results, state: int, slice_points: FloatArray, slice_colours: FloatArray) -> Space:
    """The bodies at a state, with a slice."""
    position = results.vectors("")
    bodies = results.system.bodies
    count = int(np.clip(_POINTS // len(bodies), _FEWEST, _MOST))
    places = zip(bodies, position[state], rotations(results, state), strict=True)
    surfaces = [surface_triangles(body, count) @ turn.T + centre for body, centre, turn in places]
    paths = position[: state + 1, : 0 if len(bodies) > MOST_LINES else len(bodies)].swapaxes(0, 1)
    box = np.array(results.system.domain.extent)
    return Space(np.concatenate(surfaces), paths, box, slice_points, slice_colours)


def surface_triangles(body: Body, count: int) -> FloatArray:
    """Triangles (T, 3, 3) of a body's surface in its frame, normals outwards: its facets, or those between about
    ``count`` points of a smooth surface, of which each direction from the centre of mass must meet one point."""
    if body.facets is not None:
        return np.asarray(body.facets.points[body.facets.vertices])
    points = body.sample_surface(count)
    directions = points / np.linalg.norm(points, axis=1)[:, None]
    hull = ConvexHull(directions)
    triangles = points[hull.simplices]
    inwards = np.linalg.det(directions[hull.simplices]) < 0.0
    triangles[inwards] = triangles[inwards, ::-1]
    return np.asarray(triangles)


def box_edges(box: FloatArray) -> FloatArray:
    """The twelve edges (12, 2, 3) of a box (2, 3)."""
    corners = np.stack(np.meshgrid(*box.T, indexing="ij"), axis=-1)
    return np.concatenate([np.moveaxis(corners, axis, 2).reshape(4, 2, 3) for axis in range(3)])
