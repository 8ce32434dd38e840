"""Fields of the fluid at one time, in memory or from the disk, also as a grid of PyVista."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Fields
from rigidfluid.core.output.cell_gradients import nodal_shear_rate
from rigidfluid.core.output.optional_package import optional_package
from rigidfluid.core.output.vtu import QUADRATIC, in_space, nodal_arrays
from rigidfluid.described import Described


@dataclass(frozen=True, repr=False)
class FluidFields(Described, Fields):
    """Fields of the fluid at the nodes of its mesh at one time.

    Parameters
    ----------
    points : FloatArray
        (N, d) nodes, at the corners of cells and on the middle of their edges [length].
    cells : IntArray
        (M, 6) triangles or (M, 10) tetrahedra: numbers of their nodes in VTK's order.
    velocity : FloatArray
        (N, d) [length/time].
    pressure : FloatArray
        (N,) [force/length^(d-1)].
    scalar : FloatArray or None
        (N,) of a scene with a table ``[scalar]`` [scalar].
    viscosity : FloatArray or None
        (N,) of a fluid whose viscosity varies, at the ``shear_rate`` of each node [mass·length^(2-d)/time].
    cell_errors : FloatArray or None
        (M,) squared errors of the cells in the norm of dissipation, with ``mesh.estimate`` [energy/time].
    time : float
        Time of the state [time].
    """

    time: float = field(kw_only=True)

    @classmethod
    def from_fields(cls, found: Fields, time: float) -> FluidFields:
        """The same arrays with their time."""
        return cls(**found.nodal_values, cells=found.cells, cell_errors=found.cell_errors, time=time)

    @property
    def vorticity(self) -> FloatArray:
        """Vorticity ∇ × u at the nodes, the mean over the cells around each: (N,) in 2D, (N, 3) in 3D [1/time]."""
        return nodal_arrays(self)["vorticity"]

    @property
    def shear_rate(self) -> FloatArray:
        """Shear rate √(½|∇u + ∇uᵀ|²) at the nodes, of the mean gradient over the cells around each, (N,) [1/time]."""
        return nodal_shear_rate(self)

    def grid(self) -> Any:
        """Grid of PyVista with the arrays of `fields/` on disk at its points, ``velocity`` of three components.

        Returns
        -------
        pyvista.UnstructuredGrid
            N points and M quadratic cells.

        Raises
        ------
        OutputError
            If PyVista is not installed.
        """
        pyvista = optional_package("pyvista", "vtk")
        grid = pyvista.UnstructuredGrid({QUADRATIC[self.cells.shape[1]]: self.cells}, in_space(self.points))
        grid.point_data.update(nodal_arrays(self))
        return grid

    def _facts(self) -> Mapping[str, object]:
        return {
            "time": self.time,
            "cells": len(self.cells),
            "nodes": len(self.points),
            "dimension": self.points.shape[1],
            "highest speed": float(np.linalg.norm(self.velocity, axis=1).max()),
            "pressure": f"{self.pressure.min():.4g} to {self.pressure.max():.4g}",
        }
