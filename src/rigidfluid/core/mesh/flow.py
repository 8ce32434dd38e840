"""Fluid and bodies at the moment at which a mesh is made: what a size field may ask for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.curl import curl
from rigidfluid.core.mesh.distribution import whole
from rigidfluid.core.mesh.location import CellFinder
from rigidfluid.core.mesh.mesh_quality import cell_volumes, regular_edges
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.mesh_error import EstimatedError
from rigidfluid.core.model.types import FluidState, Mesh, Twist


class Flow(ABC):
    """Flow around bodies of a ``twist``, at any points of the domain.

    Parameters
    ----------
    twist : Twist
        That of the bodies, in the scene's order.
    """

    def __init__(self, twist: Twist) -> None:
        self.twist = twist

    @property
    @abstractmethod
    def speed(self) -> float:
        """Greatest speed in the fluid [length/time]."""

    @abstractmethod
    def velocity(self, points: FloatArray) -> FloatArray:
        """Velocity (m, d) at ``points`` (m, d) [length/time]."""

    @abstractmethod
    def pressure(self, points: FloatArray) -> FloatArray:
        """Pressure (m,) at ``points`` (m, d) [force/length^(d-1)]."""

    @abstractmethod
    def gradient(self, points: FloatArray) -> FloatArray:
        """Slopes ∂u_i/∂x_j of the velocity, (m, d, d), at ``points`` (m, d) [1/time]."""

    @property
    def error(self) -> EstimatedError | None:
        """Error that the mesh before made in its latest step; None where it was not estimated."""
        return None

    @property
    def cell_edges(self) -> FloatArray:
        """Edges of regular cells as large as those of the mesh before, (M,) [length]; of none before the first."""
        return np.zeros(0)

    def from_cells(self, values: FloatArray, points: FloatArray) -> FloatArray:
        """Values (m,) at ``points`` (m, d), of ``values`` (M,) of the cells before."""
        return np.full(len(points), np.nan)

    def vorticity(self, points: FloatArray) -> FloatArray:
        """Vorticity ∇ × u, (m, k), in 2D its one component, at ``points`` (m, d) [1/time]."""
        return curl(self.gradient(points))


class AtRest(Flow):
    """Fluid and bodies before the first mesh: all at rest.

    Parameters
    ----------
    bodies : int
        Number of bodies.
    dimension : int
        2 or 3.
    """

    def __init__(self, bodies: int, dimension: int) -> None:
        super().__init__(Twist(np.zeros((bodies, dimension)), np.zeros((bodies, 1 if dimension == 2 else 3))))

    @property
    def speed(self) -> float:
        """Zero."""
        return 0.0

    def velocity(self, points: FloatArray) -> FloatArray:
        """Zeros (m, d)."""
        return np.zeros_like(points)

    def pressure(self, points: FloatArray) -> FloatArray:
        """Zeros (m,)."""
        return np.zeros(len(points))

    def gradient(self, points: FloatArray) -> FloatArray:
        """Zeros (m, d, d)."""
        return np.zeros((*points.shape, points.shape[1]))


class FlowOnMesh(Flow):
    """Flow by the values at a ``mesh``'s vertices, ``velocity`` (N, d) and ``pressure`` (N,), linear in its cells.

    Slopes at a vertex are the mean of those in the cells around it, by volume. Points outside the mesh take the values
    of the nearest cell, or where the flow is periodic those of their image. ``error``: that of the mesh, None where it
    is not known.
    """

    def __init__(
        self,
        mesh: Mesh,
        velocity: FloatArray,
        pressure: FloatArray,
        twist: Twist,
        error: EstimatedError | None = None,
    ) -> None:
        super().__init__(twist)
        self._mesh, self._velocity, self._pressure, self._error = mesh, velocity, pressure, error

    @property
    def speed(self) -> float:
        """Greatest speed at a vertex [length/time]."""
        return float(np.linalg.norm(self._velocity, axis=1).max())

    def velocity(self, points: FloatArray) -> FloatArray:
        """Velocity (m, d), linear between the vertices [length/time]."""
        return self._between(self._velocity, points)

    def pressure(self, points: FloatArray) -> FloatArray:
        """Pressure (m,), linear between the vertices [force/length^(d-1)]."""
        return self._between(self._pressure, points)

    def gradient(self, points: FloatArray) -> FloatArray:
        """Slopes (m, d, d), linear between those at the vertices [1/time]."""
        return self._between(self._gradient, points)

    @property
    def error(self) -> EstimatedError | None:
        """Error that the mesh made in its latest step."""
        return self._error

    @property
    def cell_edges(self) -> FloatArray:
        """Edges of regular cells of the same volumes, (M,) [length]."""
        return regular_edges(self._mesh.points, self._mesh.cells)

    def from_cells(self, values: FloatArray, points: FloatArray) -> FloatArray:
        """Values (m,) linear between means (N,) of ``values`` (M,) at the vertices, by volume."""
        return self._between(vertex_means(self._mesh, values), points)

    @cached_property
    def _gradient(self) -> FloatArray:
        """Slopes at the vertices (N, d, d)."""
        return vertex_gradient(self._mesh, self._velocity)

    @cached_property
    def _finder(self) -> CellFinder:
        """Finder of cells, which most fields ask many times and some never."""
        return CellFinder(self._mesh.points, self._mesh.cells)

    def _between(self, values: FloatArray, points: FloatArray) -> FloatArray:
        if self._mesh.periods is not None:
            ways = self._mesh.periods.ways
            points = points + self._finder.periods_ahead(points, ways) @ ways
        cell, coordinates = self._finder.find(points)
        return np.asarray(np.einsum("nb,nb...->n...", coordinates, values[self._mesh.cells[cell]]))


def flow_on(
    backend: FluidBackend, fluid: FluidState, mesh: Mesh, twist: Twist, error: EstimatedError | None = None
) -> Flow | None:
    """Flow of a backend's state on a ``mesh``, and its ``error``, on the root; None for the other ranks, all of which
    call this together."""
    present = whole(mesh)
    vertices = mesh.ranks.bcast(mesh.points if present is None else present.points)
    velocity, pressure = backend.probe(fluid, mesh, vertices)
    return None if present is None else FlowOnMesh(present, velocity, pressure, twist, error)


def vertex_gradient(mesh: Mesh, values: FloatArray) -> FloatArray:
    """Slopes ∂v_i/∂x_j at the vertices (N, c, d), of linear ``values`` (N, c): means over cells, by volume."""
    corners, given = mesh.points[mesh.cells], values[mesh.cells]
    slopes = np.linalg.solve(corners[:, 1:] - corners[:, :1], given[:, 1:] - given[:, :1])
    return np.swapaxes(vertex_means(mesh, np.asarray(slopes)), 1, 2)


def vertex_means(mesh: Mesh, values: FloatArray) -> FloatArray:
    """Means (N, …) of ``values`` (M, …) over the cells around each vertex, by volume."""
    volume = cell_volumes(mesh.points, mesh.cells).reshape(-1, *np.ones(values.ndim - 1, dtype=int))
    total, weight = np.zeros((len(mesh.points), *values.shape[1:])), np.zeros((len(mesh.points), *volume.shape[1:]))
    for corner in mesh.cells.T:
        np.add.at(total, corner, volume * values)
        np.add.at(weight, corner, volume)
    return np.asarray(total / weight)
