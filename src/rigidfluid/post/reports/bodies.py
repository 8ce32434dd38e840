"""Bodies at a moment of the run: where they are, and what a plane cuts out of them."""

from __future__ import annotations

import numpy as np
from contourpy import contour_generator

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.body import Body
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.view_plane import ViewPlane

_GRID = 80
"""Points to each side of the grid about a body in which its outline is found."""


def rotations(results: Results, state: int) -> FloatArray:
    """From the bodies' frames to space, (n, d, d)."""
    return rotation_matrices(results.quantity("orientation")[state])


def cuts(results: Results, state: int, plane: ViewPlane, through: FloatArray) -> list[FloatArray]:
    """The curves (K, 2) in which the plane through a point (d,) cuts bodies, to the right and up."""
    turns = rotations(results, state)
    places = zip(results.system.bodies, results.quantity("position")[state], turns, strict=True)
    return [curve for body, centre, turn in places for curve in cut(body, centre, turn, plane, through)]


def cut(body: Body, centre: FloatArray, turn: FloatArray, plane: ViewPlane, through: FloatArray) -> list[FloatArray]:
    """The curves (K, 2) in which the plane through a point (d,) cuts one body."""
    off = through - centre
    foot = off - plane.right * (plane.right @ off) - plane.up * (plane.up @ off)
    if np.linalg.norm(foot) >= body.bounding_radius:
        return []
    line = np.linspace(-1.02, 1.02, _GRID) * body.bounding_radius
    points = foot + line[None, :, None] * plane.right + line[:, None, None] * plane.up
    distance = body.signed_distance((points @ turn).reshape(-1, len(centre))).reshape(_GRID, _GRID)
    lines = contour_generator(line, line, distance).lines(0.0)
    return [np.asarray(curve) + plane.flat(centre) for curve in lines]
