"""Axes of its own for each node where a velocity is free along some directions that lie along no axis.

On slip faces the velocity across the face is held, on pressure faces the velocity along it. On an oblique or curved
face these are no components, and the unknowns of its nodes are taken along axes Q of the node's own: u = Q û.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.taylor_hood.elements.face import Face

_EDGE = 0.08
"""Facets at one node have two normals where the mean of n nᵀ has a second eigenvalue above this, at edges sharper than
33° between two facets, and one mean normal else."""

_ROUNDING = 1e-12
"""Relative size of a flux through a face by rounding alone."""

_SQUARE = 0.94
"""Fluid passes a node of both slip and pressure faces where these meet at a right angle, give or take 20°."""


@dataclass(frozen=True)
class Frames:
    """``axes`` (T, d, d), the columns of Q, at ``nodes`` (T,); along which of them the velocity is ``free`` (T, d).

    ``taken`` by nodes from others: rows, unknowns and values (e,) each, what is added to the velocity ``rows`` per free
    velocity ``unknowns``, both numbered d · node + component.
    """

    nodes: IntArray
    axes: FloatArray
    free: BoolArray
    taken: tuple[IntArray, IntArray, FloatArray]

    @classmethod
    def empty(cls, dimension: int) -> Frames:
        """No frames: no face is oblique or curved."""
        d, nothing = dimension, np.empty(0, np.int64)
        return cls(nothing, np.empty((0, d, d)), np.empty((0, d), bool), (nothing, nothing, np.empty(0)))

    def local_components(self, velocity: FloatArray) -> FloatArray:
        """û of a ``velocity`` u (nodes, d): its components along each node's own axes."""
        if not len(self.nodes):
            return velocity
        found = velocity.copy()
        found[self.nodes] = np.einsum("tia,ti->ta", self.axes, velocity[self.nodes])
        return found

    def spread(self, unknowns: IntArray) -> tuple[IntArray, IntArray, FloatArray]:
        """Entries of u = Q û in the columns of the free ``unknowns`` (u,), ascending.

        Returns
        -------
        rows, which, values : (e,) arrays
            The row of each entry, the place of its column in ``unknowns``, and the entry.
        """
        d, place = self.axes.shape[1], np.arange(len(unknowns))
        own = np.isin(unknowns // d, self.nodes)
        turned = np.searchsorted(self.nodes, unknowns[own] // d)
        rows = self.nodes[turned][:, None] * d + np.arange(d)
        takers, givers, shares = self.taken
        return (
            np.concatenate([unknowns[~own], rows.ravel(), takers]),
            np.concatenate([place[~own], np.repeat(place[own], d), np.searchsorted(unknowns, givers)]),
            np.concatenate([np.ones(np.count_nonzero(~own)), self.axes[turned, :, unknowns[own] % d].ravel(), shares]),
        )


def local_frames(faces: Sequence[Face], node_points: FloatArray, vertices: int, held: BoolArray) -> Frames:
    """The axes of the nodes on slip and pressure faces that lie across no axis.

    Parameters
    ----------
    faces : sequence of Face
        All faces.
    node_points : (nodes, d) array
        Coordinates of the nodes, the ``vertices`` first [length].
    vertices : int
        Number of vertices.
    held : (nodes,) bool
        Nodes whose velocity is given, which need none.

    Returns
    -------
    Frames
        Nodes ascending. Each of several faces that meet holds its own directions; nearly equal normals count as one.
    """
    d = node_points.shape[1]
    slip = [face for face in faces if face.condition.slips]
    pressure = [face for face in faces if face.condition.holds_part and not face.condition.slips]
    oblique = [face.nodes for face in [*slip, *pressure] if face.axis is None]
    nodes = np.unique(np.concatenate([*oblique, np.empty(0, np.int64)]))
    nodes = nodes[~held[nodes]]
    if not len(nodes):
        return Frames.empty(d)
    across = _normal_spaces(slip, node_points, vertices)[nodes]
    through = _normal_spaces(pressure, node_points, vertices)[nodes]
    values, axes = np.linalg.eigh(through)
    opens, way = values[:, -1] > 0.5, axes[:, :, -1]
    way = way - np.einsum("tij,tj->ti", across, way)
    size = np.linalg.norm(way, axis=1)
    passes = opens & (values[:, -2] < 0.5) & (size > _SQUARE)
    way[passes] /= size[passes, None]
    across[opens] = np.eye(d)
    across[passes] -= np.einsum("ti,tj->tij", way[passes], way[passes])
    values, axes = np.linalg.eigh(across)
    free = values < 0.5
    frames = replace(Frames.empty(d), nodes=nodes, axes=axes, free=free)
    return replace(frames, taken=_flux_corrections(frames, slip, node_points, vertices))


def _normal_spaces(faces: Sequence[Face], node_points: FloatArray, vertices: int) -> FloatArray:
    """Projectors (nodes, d, d) onto the normals of all ``faces`` together at each node; zero away from them.

    The normal is along Σ ∫ φᵢ n where the facets at a node are nearly one surface: a velocity orthogonal to it takes no
    fluid through the faces (consistent normals: Engelman, Sani and Gresho 1982, doi:10.1002/fld.1650020302). Triangles
    have next to no flux by their vertices, whose normals are means of the facets'.
    """
    count, d = node_points.shape
    total, squares, facets = np.zeros((count, d)), np.zeros((count, d, d)), np.zeros(count)
    for face in faces:
        vectors, normals = face.area_vectors(node_points), face.normals(node_points)
        if d == 3:
            area = np.linalg.norm(vectors.sum(axis=1), axis=1)
            vectors = np.where((face.facet_nodes < vertices)[..., None], area[:, None, None] * normals, vectors)
        np.add.at(total, face.facet_nodes, vectors)
        np.add.at(squares, face.facet_nodes, normals[..., :, None] * normals[..., None, :])
        np.add.at(facets, face.facet_nodes, 1.0)
    on = np.flatnonzero(facets)
    mean = total[on] / np.linalg.norm(total[on], axis=1, keepdims=True)
    found = np.zeros((count, d, d))
    values, vectors = np.linalg.eigh(squares[on] / facets[on, None, None])
    sharp = values > _EDGE
    edges = np.einsum("tia,ta,tja->tij", vectors, sharp, vectors)
    found[on] = np.where((sharp.sum(axis=1) > 1)[:, None, None], edges, mean[:, :, None] * mean[:, None, :])
    return found


def _flux_corrections(
    frames: Frames, slip: Sequence[Face], node_points: FloatArray, vertices: int
) -> tuple[IntArray, IntArray, FloatArray]:
    """Rows, unknowns and values (e,) by which midpoints of edges cancel the flux through ``slip`` faces of nodes that
    move along them; none of the ``frames`` has taken any yet.

    The vector ∫ φᵢ n at a vertex of curved triangles is small, and has another direction than the normal. Each edge's
    midpoint in the same triangles takes an equal part by a velocity along its own normal: so no free velocity takes
    fluid through the faces, and an even pressure moves nothing.
    """
    (count, d), nodes, axes, free = node_points.shape, frames.nodes, frames.axes, frames.free
    flux = np.zeros((count, d))
    for face in slip:
        np.add.at(flux, face.facet_nodes, face.area_vectors(node_points))
    through = np.einsum("ti,tia->ta", flux[nodes], axes)
    size = np.linalg.norm(flux[nodes], axis=1)
    leaks = (np.abs(np.where(free, through, 0.0)) > _ROUNDING * np.max(size, initial=0.0)).any(axis=1)
    takes = (nodes >= vertices) & (free.sum(axis=1) == d - 1) & (size > 0.0) & ~leaks
    place = np.full(count, -1)
    place[nodes] = np.arange(len(nodes))
    at = place[np.concatenate([face.facet_nodes for face in slip])] if slip else np.empty((0, 3), np.int64)
    giver, taker = (each.ravel() for each in np.broadcast_arrays(at[:, :, None], at[:, None, :]))
    chosen = (giver >= 0) & (taker >= 0) & leaks[giver] & takes[taker]
    giver, taker = np.unique(np.column_stack([giver[chosen], taker[chosen]]), axis=0).T
    way = axes[taker, :, -1] / through[taker, -1:]  # the one held comes last
    shared = through[giver] / np.bincount(giver, minlength=len(nodes))[giver, None]
    values = np.where(free[giver][:, None, :], -way[:, :, None] * shared[:, None, :], 0.0)
    rows = np.broadcast_to((nodes[taker][:, None] * d + np.arange(d))[:, :, None], values.shape)
    unknowns = np.broadcast_to((nodes[giver][:, None] * d + np.arange(d))[:, None, :], values.shape)
    moving = np.broadcast_to(free[giver][:, None, :], values.shape)
    return rows[moving], unknowns[moving], values[moving]
