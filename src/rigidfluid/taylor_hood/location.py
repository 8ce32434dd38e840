"""Finds the cells that hold given points, for transfer between meshes and for probes."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from rigidfluid.core.model.types import FloatArray, IntArray
from rigidfluid.taylor_hood.numbering import EDGES

_CANDIDATES = (8, 64, 512)
_INSIDE = -1e-10
_ITERATIONS, _ENOUGH = 30, 1e-14
_BEYOND = 0.2
"""So far outside a curved cell, in its coordinates, its map is trusted."""


def locate(points: FloatArray, cells: IntArray, targets: FloatArray) -> tuple[IntArray, FloatArray]:
    """The cell of each target (N,) and its barycentric coordinates there (N, d+1).

    A target outside the mesh takes the cell that it is least outside of, with its coordinates moved inside.
    The cells tried are those with the nearest centres, more of them for the targets that are not found yet.
    """
    centres = cKDTree(points[cells].mean(axis=1))
    cell = np.zeros(len(targets), dtype=np.int64)
    coordinates = np.full((len(targets), cells.shape[1]), -np.inf)
    missing = np.arange(len(targets))
    for count in _CANDIDATES:
        _, near = centres.query(targets[missing], k=min(count, len(cells)))
        near = near.reshape(len(missing), min(count, len(cells)))
        found = barycentric(points, cells[near], targets[missing, None])
        best = np.argmax(found.min(axis=2), axis=1)
        rows = np.arange(len(missing))
        cell[missing], coordinates[missing] = near[rows, best], found[rows, best]
        missing = missing[coordinates[missing].min(axis=1) < _INSIDE]
        if len(missing) == 0:
            break
    inside = np.maximum(coordinates, 0.0)
    return cell, inside / inside.sum(axis=1, keepdims=True)


def on_curved_cells(nodes: FloatArray, coordinates: FloatArray, targets: FloatArray) -> FloatArray:
    """Coordinates (N, d+1) where the quadratic maps of cells with ``nodes`` (N, b, d) reach ``targets`` (N, d).

    From ``coordinates`` (N, d+1) in the straight cells on, by Newton's method with the straight cells' matrices; moved
    inside.
    """
    corners = np.swapaxes(nodes[:, 1 : coordinates.shape[1]] - nodes[:, :1], 1, 2)
    for _ in range(_ITERATIONS):
        missed = targets - np.einsum("nb,nbd->nd", quadratic_basis(coordinates), nodes)
        rest = np.linalg.solve(corners, missed[..., None])[..., 0]
        coordinates = coordinates + np.column_stack([-rest.sum(axis=1), rest])
        coordinates = np.clip(coordinates, -_BEYOND, 1.0 + _BEYOND)
        if np.abs(rest).max(initial=0.0) < _ENOUGH:
            break
    inside = np.maximum(coordinates, 0.0)
    return np.asarray(inside / inside.sum(axis=1, keepdims=True))


def barycentric(points: FloatArray, simplices: IntArray, targets: FloatArray) -> FloatArray:
    """Barycentric coordinates (…, d+1) of ``targets`` (…, d) in ``simplices`` (…, d+1)."""
    corners = points[simplices]
    edges = np.moveaxis(corners[..., 1:, :] - corners[..., :1, :], -1, -2)
    rest = np.linalg.solve(edges, (targets - corners[..., 0, :])[..., None])[..., 0]
    return np.concatenate([1.0 - rest.sum(axis=-1, keepdims=True), rest], axis=-1)


def quadratic_basis(coordinates: FloatArray) -> FloatArray:
    """The P2 basis (N, b) at barycentric ``coordinates`` (N, d+1): vertices, then edges in the order of `EDGES`."""
    edges = EDGES[coordinates.shape[1] - 1]
    vertices = coordinates * (2.0 * coordinates - 1.0)
    middles = [4.0 * coordinates[:, i] * coordinates[:, j] for i, j in edges]
    return np.column_stack([vertices, *middles])
