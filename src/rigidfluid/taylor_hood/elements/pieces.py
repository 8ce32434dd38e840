"""The state on a whole mesh from those on its parts, and back: values are copied, not a bit of them changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.types import FluidState, Mesh
from rigidfluid.taylor_hood.elements.numbering import Numbering

_AT_NODES = ("velocity", "velocity_previous")
_AT_VERTICES = ("pressure", "pressure_previous")
_GEOMETRY = "points_previous"
"""Names of the state's arrays on the mesh; the others are of bodies, and the same on all ranks."""


def joined(states: Sequence[FluidState], parts: Sequence[Mesh], mesh: Mesh) -> FluidState:
    """The state on ``mesh``, the whole, from those on all its ``parts``."""
    whole, found = Numbering.from_mesh(mesh), dict(states[0])
    pieces = [_Piece.from_part(part, whole) for part in parts]
    nodes, vertices = [piece.nodes for piece in pieces], [piece.vertices for piece in pieces]
    for name in _AT_NODES:
        found[name] = _put(whole.nodes, nodes, [state[name] for state in states])
    for name in _AT_VERTICES:
        found[name] = _put(whole.vertices, vertices, [state[name] for state in states])
    points = [piece.own.node_points(state[_GEOMETRY]) for piece, state in zip(pieces, states, strict=True)]
    found[_GEOMETRY] = whole.geometry_of(_put(whole.nodes, nodes, points))
    return found


def cut(fluid: FluidState, mesh: Mesh, parts: Sequence[Mesh]) -> list[FluidState]:
    """The states on all ``parts`` of ``mesh``, the whole, from the one there."""
    whole = Numbering.from_mesh(mesh)
    points = whole.node_points(fluid[_GEOMETRY])
    found: list[FluidState] = []
    for part in parts:
        piece = _Piece.from_part(part, whole)
        at_nodes = {name: fluid[name][piece.nodes] for name in _AT_NODES}
        at_vertices = {name: fluid[name][piece.vertices] for name in _AT_VERTICES}
        geometry = {_GEOMETRY: piece.own.geometry_of(points[piece.nodes])}
        found.append({**fluid, **at_nodes, **at_vertices, **geometry})
    return found


@dataclass(frozen=True)
class _Piece:
    """A part's ``own`` numbering, and the numbers of its ``nodes`` and ``vertices`` in the whole."""

    own: Numbering
    nodes: IntArray
    vertices: IntArray

    @classmethod
    def from_part(cls, part: Mesh, whole: Numbering) -> _Piece:
        own = Numbering.from_mesh(part)
        vertices = np.arange(own.vertices) if part.part is None else part.part.vertices
        return cls(own, np.concatenate([vertices, whole.edge_nodes(vertices[own.edges])]), vertices)


def _put(count: int, places: Sequence[IntArray], values: Sequence[FloatArray]) -> FloatArray:
    made = np.empty((count, *values[0].shape[1:]))
    for place, value in zip(places, values, strict=True):
        made[place] = value
    return made
