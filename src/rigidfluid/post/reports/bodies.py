"""Bodies at a moment of the run: where they are, and what a plane cuts out of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from contourpy import contour_generator

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.body import Body
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.view_plane import ViewPlane

_GRID = 80
"""Points to each side of the grid about a body in which its outline is found."""


@dataclass(frozen=True, eq=False)
class PlacedBody:
    """Body of a run by its ``number``: ``shape``, ``centre`` (d,), and ``turn`` (d, d) from its frame to space."""

    number: int
    shape: Body
    centre: FloatArray
    turn: FloatArray


def placed_bodies(results: Results, state: int) -> list[PlacedBody]:
    """The bodies that are there at a state."""
    there = np.flatnonzero(results.present[state])
    centres = results.quantity("position")[state, there]
    turns = rotation_matrices(results.quantity("orientation")[state, there])
    bodies = results.system.bodies
    return [PlacedBody(int(i), bodies[i], *place) for i, *place in zip(there, centres, turns, strict=True)]


def seen_bodies(results: Results, state: int) -> list[PlacedBody]:
    """The bodies that are there at a state and, along periods, their images in the domain and around it."""
    bodies, lattice = placed_bodies(results, state), results.system.domain.cells
    if not len(lattice.vectors):
        return bodies
    around = lattice.displacement(np.array(list(product((-1, 0, 1), repeat=len(lattice.vectors)))))
    return [
        replace(body, centre=lattice.wrapped(body.centre[None])[0] + displacement)
        for body in bodies
        for displacement in around
    ]


def cuts(results: Results, state: int, plane: ViewPlane, through: FloatArray) -> list[FloatArray]:
    """The curves (K, 2) in which the plane through a point (d,) cuts bodies, to the right and up."""
    return [curve for body in seen_bodies(results, state) for curve in cut(body, plane, through)]


def cut(placed: PlacedBody, plane: ViewPlane, through: FloatArray) -> list[FloatArray]:
    """The curves (K, 2) in which the plane through a point (d,) cuts one body."""
    body, centre = placed.shape, placed.centre
    off = through - centre
    foot = off - plane.right * (plane.right @ off) - plane.up * (plane.up @ off)
    if np.linalg.norm(foot) >= body.bounding_radius:
        return []
    line = np.linspace(-1.02, 1.02, _GRID) * body.bounding_radius
    points = foot + line[None, :, None] * plane.right + line[:, None, None] * plane.up
    distance = body.signed_distance((points @ placed.turn).reshape(-1, len(centre))).reshape(_GRID, _GRID)
    lines = contour_generator(line, line, distance).lines(0.0)
    return [np.asarray(curve) + plane.flat(centre) for curve in lines]
