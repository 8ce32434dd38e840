"""Finds the curved cells that hold given points, and evaluates bases there, for transfers and probes."""

from __future__ import annotations

import numpy as np
import scipy

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.quadratic_cells import quadratic_basis
from rigidfluid.core.mesh.location import INSIDE, CellFinder, move_inside
from rigidfluid.taylor_hood.elements.numbering import Numbering

_ITERATIONS, _ENOUGH = 30, 1e-14
_BEYOND = 0.2
"""So far outside a curved cell, in its coordinates, its map is trusted."""
_REACHED = 1e-4
"""Last change of coordinates, and difference of their sum from 1, with which a map has reached its target: in cells
that are bent as much as they may be each change is 0.7 times the one before, and the last one 2e-5."""
_NEIGHBOURS = 32


def located(
    finder: CellFinder, numbering: Numbering, geometry: FloatArray, targets: FloatArray, least: float = INSIDE
) -> tuple[IntArray, FloatArray]:
    """The cell, straight or curved, of each target (N,) and its coordinates there (N, d+1), moved inside.

    ``finder`` of the straight cells, ``geometry`` (vertices + K, d) of all; ``least`` as for `locate_on_curves`.
    """
    cell, coordinates = finder.find(targets)
    at_curves = np.flatnonzero(np.isin(cell, numbering.curved_cells))
    if len(at_curves):
        guess = np.searchsorted(numbering.curved_cells, cell[at_curves])
        nodes = numbering.curved_cell_points(geometry)
        found, coordinates[at_curves] = locate_on_curves(nodes, guess, targets[at_curves], least)
        cell[at_curves] = numbering.curved_cells[found]
    return cell, coordinates


def locate_on_curves(
    nodes: FloatArray, guess: IntArray, targets: FloatArray, least: float = INSIDE
) -> tuple[IntArray, FloatArray]:
    """The curved cell of each target (N,) and its coordinates in the cell's quadratic map (N, d+1), moved inside.

    ``nodes`` (C, b, d) of all curved cells; ``guess`` (N,): the one whose straight cell holds the target. In 3D the
    faces between two curved cells are curved too, so that a target near one may be the neighbour's, which is looked for
    where a coordinate in the guessed cell is below ``least``.
    """
    cell, (found, depth) = guess.copy(), _invert_maps(nodes[guess], targets)
    astray = np.flatnonzero(depth < least)
    if len(astray):
        corners = targets.shape[1] + 1
        count = min(_NEIGHBOURS, len(nodes))
        _, near = scipy.spatial.cKDTree(nodes[:, :corners].mean(axis=1)).query(targets[astray], k=count)
        near = near.reshape(len(astray), count)
        tried, depths = _invert_maps(nodes[near.ravel()], np.repeat(targets[astray], count, axis=0))
        tried, depths = tried.reshape(*near.shape, corners), depths.reshape(near.shape)
        best = np.argmax(depths, axis=1)
        rows = np.arange(len(astray))
        better = depths[rows, best] > depth[astray]
        cell[astray[better]], found[astray[better]] = near[rows, best][better], tried[rows, best][better]
    return cell, move_inside(found)


def _invert_maps(nodes: FloatArray, targets: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Coordinates (N, d+1) where the quadratic maps of cells with ``nodes`` (N, b, d) reach ``targets`` (N, d), by
    Newton's method with the straight cells' matrices; and the least of each (N,), -inf where they do not reach it."""
    d = targets.shape[1]
    inverse = np.linalg.inv(np.swapaxes(nodes[:, 1 : d + 1] - nodes[:, :1], 1, 2))
    coordinates = np.full((len(targets), d + 1), 1.0 / (d + 1))
    for _ in range(_ITERATIONS):
        missed = targets - np.einsum("nb,nbd->nd", quadratic_basis(coordinates), nodes)
        rest = np.einsum("nij,nj->ni", inverse, missed)
        coordinates = coordinates + np.column_stack([-rest.sum(axis=1), rest])
        coordinates = np.clip(coordinates, -_BEYOND, 1.0 + _BEYOND)
        if np.abs(rest).max(initial=0.0) < _ENOUGH:
            break
    sum_is_one = np.abs(coordinates.sum(axis=1) - 1.0) < _REACHED  # which a clipped coordinate may have spoilt
    reached = sum_is_one & (np.abs(rest).max(axis=1, initial=0.0) < _REACHED)
    return coordinates, np.where(reached, coordinates.min(axis=1), -np.inf)


def barycentric(points: FloatArray, simplices: IntArray, targets: FloatArray) -> FloatArray:
    """Barycentric coordinates (…, d+1) of ``targets`` (…, d) in ``simplices`` (…, d+1)."""
    corners = points[simplices]
    edges = np.moveaxis(corners[..., 1:, :] - corners[..., :1, :], -1, -2)
    rest = np.linalg.solve(edges, (targets - corners[..., 0, :])[..., None])[..., 0]
    return np.concatenate([1.0 - rest.sum(axis=-1, keepdims=True), rest], axis=-1)
