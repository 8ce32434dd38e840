"""Part of a field that a picture shows: in 2D all of it, in 3D a slice."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.tri import Triangulation

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Fields
from rigidfluid.core.output.cell_gradients import nodal_shear_rate, vorticity
from rigidfluid.errors import OutputError
from rigidfluid.post.reports.plane import cell_by_cell, corner_triangles, fine_triangles
from rigidfluid.post.reports.raster import Grid, Sampling
from rigidfluid.post.reports.scale import Quantity
from rigidfluid.post.reports.slice import EIGHTHS, Slice, cut_cells, cut_faces
from rigidfluid.post.reports.view_plane import ViewPlane


@dataclass(frozen=True)
class Section:
    """The ``fields`` of those cells that the ``plane`` through a point ``through`` (d,) cuts, in 2D of all."""

    fields: Fields
    plane: ViewPlane
    through: FloatArray

    @classmethod
    def cut(cls, fields: Fields, plane: ViewPlane, through: FloatArray) -> Section:
        """Cut the fields by a plane: in 3D cells off the plane are left out."""
        if fields.points.shape[1] == 3:
            fields = cut_cells(fields, plane.normal, through)
        return cls(fields, plane, through)

    @property
    def is_slice(self) -> bool:
        """Tell whether the fields are in 3D."""
        return bool(self.fields.points.shape[1] == 3)

    @cached_property
    def flat_points(self) -> FloatArray:
        """The nodes' places to the right and up, (N, 2)."""
        return self.plane.flat(self.fields.points)

    @cached_property
    def speed(self) -> FloatArray:
        """|u| at the nodes, (N,) [length/time]."""
        return np.asarray(np.linalg.norm(self.fields.velocity, axis=1))

    @cached_property
    def vorticity(self) -> FloatArray:
        """ω at the nodes of each cell, in 3D its component to the observer, (M, b) [1/time]."""
        return np.asarray(vorticity(self.fields) @ (self.plane.normal if self.is_slice else np.ones(1)))

    def values(self, quantity: Quantity) -> FloatArray:
        """A quantity at the nodes (N,), or at those of each cell (M, b)."""
        match quantity:
            case "speed":
                return self.speed
            case "vorticity":
                return self.vorticity
            case "pressure":
                return self.fields.pressure
            case "scalar":
                return self._found("scalar", self.fields.scalar, "[scalar]")
            case "viscosity":
                return self._found("viscosity", self.fields.viscosity, "[fluid.material]")

    @property
    def stress(self) -> FloatArray:
        """Viscous stress |τ| = μ γ̇ at the nodes, (N,) [force/length^(d-1)]."""
        return self.values("viscosity") * nodal_shear_rate(self.fields)

    def _found(self, name: str, values: FloatArray | None, table: str) -> FloatArray:
        """Values (N,) that scenes with a ``table`` have; raises OutputError where there are none."""
        if values is None:
            raise OutputError(name, "none in these fields", f"the fields of a scene with {table}", "Show another.")
        return values

    def triangles(self, values: FloatArray) -> tuple[Triangulation, FloatArray]:
        """Triangles in the plane and values at their corners, of ``values`` (N,) at the nodes, or (M, b) at those of
        each cell, which jump from cell to cell."""
        if self.is_slice:
            of_cells = values if values.ndim == 2 else values[self.fields.cells]
            return self._triangulation, self._slice.values(of_cells).ravel()
        if values.ndim == 2:
            return cell_by_cell(self.fields), values.ravel()
        return fine_triangles(self.fields), values

    def spread(self, quantity: Quantity) -> tuple[FloatArray, FloatArray]:
        """A quantity at the corners of all triangles (K,), and the area that each stands for (K,)."""
        triangulation, at_nodes = self.triangles(self.values(quantity))
        corners = triangulation.triangles
        first, second = (np.diff(axis[corners], axis=1).T for axis in (triangulation.x, triangulation.y))
        return at_nodes[corners].ravel(), np.repeat(np.abs(first[0] * second[1] - first[1] * second[0]) / 6.0, 3)

    def image(self, values: FloatArray, grid: Grid) -> FloatArray:
        """Values, as `triangles` takes them, at the points of a ``grid`` in the plane, (rows, columns), nan outside
        the mesh."""
        triangulation, at_nodes = self.triangles(values)
        flat = np.stack([triangulation.x, triangulation.y], axis=1)[triangulation.triangles]
        sampling = Sampling.locate(self.plane.lifted(flat, self.through), grid)
        return sampling.image(at_nodes[triangulation.triangles])

    @property
    def edges(self) -> FloatArray:
        """Edges of the cells as the plane shows them, (S, 2, 2), straight between corners."""
        if self.is_slice:
            return self.plane.flat(cut_faces(self.fields.points, self.fields.cells, self.plane.normal, self.through))
        return np.asarray(self.fields.points[corner_triangles(self.fields).edges])

    @cached_property
    def slice_points(self) -> FloatArray:
        """Corners of the triangles in space, (T, 3, 3), in 3D [length]."""
        return self._slice.values(self.fields.points[self.fields.cells])

    @cached_property
    def _slice(self) -> Slice:
        height = (self.fields.points - self.through) @ self.plane.normal
        return Slice.cut(height[self.fields.cells], EIGHTHS)

    @cached_property
    def _triangulation(self) -> Triangulation:
        x, y = self.plane.flat(self.slice_points).reshape(-1, 2).T
        return Triangulation(x, y, np.arange(len(x)).reshape(-1, 3))
