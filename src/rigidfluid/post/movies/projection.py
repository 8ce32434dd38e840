"""All bodies of a 3D run as somebody far away sees them, lit from the upper left, those in front over those behind."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.colors import to_rgb

from rigidfluid.core.model.interfaces import Body
from rigidfluid.core.model.types import BoolArray, FloatArray
from rigidfluid.post.reports.bodies import rotations
from rigidfluid.post.reports.raster import Grid
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.style import SKY, VERMILLION

_STEPS = 40
"""Most steps along a ray, each as long as the distance to the body (sphere tracing: Hart 1996,
doi:10.1007/s003710050084)."""
_NEAR = 5e-3
"""Distance at which a ray has met the body, over its bounding radius."""
_DIFFERENCE = 1e-3
"""Step of the central differences for the surface's normal, over the bounding radius."""
_BAND = 0.07
"""Half the width of the stripe that shows how a body turns, over the bounding radius."""
_LIGHT = np.array([-0.4, 0.5, 0.77])
"""Direction of the light: to the right, up, and to the observer."""
_AMBIENT = 0.35
"""Brightness of surfaces that are turned away from the light."""


def draw_projected(picture: FloatArray, grid: Grid, results: Results, state: int) -> None:
    """Paint the bodies, as seen along the normal of the grid, into a picture (rows, columns, 3)."""
    canvas = _Canvas(picture, np.full(picture.shape[:2], -np.inf), grid)
    places = zip(results.system.bodies, results.vectors("")[state], rotations(results, state), strict=True)
    for body, centre, turn in places:
        _draw(canvas, body, centre, turn)


class _Canvas(NamedTuple):
    """A ``picture`` (rows, columns, 3) of a ``grid``, and the ``depth`` (rows, columns) of what it shows: the height
    towards the observer [length]."""

    picture: FloatArray
    depth: FloatArray
    grid: Grid


def _draw(canvas: _Canvas, body: Body, centre: FloatArray, turn: FloatArray) -> None:
    """Paint one body at the points where nothing is in front of it."""
    picture, depth, grid = canvas
    part = grid.about(centre, body.bounding_radius)
    if part is None:
        return
    plane, (columns, rows) = grid.plane, part
    axes = np.stack([plane.right, plane.up, plane.normal]) @ turn  # the observer's, in the body's frame
    foot = (grid.points(columns, rows) - centre) @ turn
    start = foot + (body.bounding_radius - foot @ axes[2])[..., None] * axes[2]
    met, points = _met(body, start.reshape(-1, 3), axes[2])
    height = (points @ axes[2]).reshape(foot.shape[:2]) + plane.normal @ centre
    seen = met.reshape(foot.shape[:2]) & (height > depth[rows, columns])
    points = points[seen.ravel()]
    striped = (np.abs(points[:, 1]) < _BAND * body.bounding_radius) & (points[:, 0] > 0.0)
    colour = np.where(striped[:, None], to_rgb(VERMILLION), to_rgb(SKY))
    picture[rows, columns][seen] = colour * _brightness(body, points, axes)[:, None]
    depth[rows, columns][seen] = height[seen]


def _met(body: Body, start: FloatArray, back: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Rays (P,) from ``start`` (P, 3) against ``back`` (3,) that meet the body, and their ends (P, 3)."""
    points = start.copy()
    on_the_way, met = np.ones(len(points), dtype=bool), np.zeros(len(points), dtype=bool)
    for _ in range(_STEPS):
        distance = body.signed_distance(points[on_the_way])
        rays = np.flatnonzero(on_the_way)
        met[rays] = distance < _NEAR * body.bounding_radius
        points[rays] -= np.maximum(distance, 0.0)[:, None] * back
        passed = points[rays] @ back < -body.bounding_radius
        on_the_way[rays] = ~(met[rays] | passed)
        if not on_the_way.any():
            break
    return met, points


def _brightness(body: Body, points: FloatArray, axes: FloatArray) -> FloatArray:
    """Brightness of surface points (P, 3), from 0 to 1."""
    step = _DIFFERENCE * body.bounding_radius
    slopes = [body.signed_distance(points + step * axis) - body.signed_distance(points - step * axis) for axis in axes]
    normal = np.stack(slopes, axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None]
    return np.asarray(_AMBIENT + (1.0 - _AMBIENT) * np.maximum(normal @ _LIGHT / np.linalg.norm(_LIGHT), 0.0))
