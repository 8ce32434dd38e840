"""Finer cells where the fluid turns, in wakes and shear layers."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.flow import Flow
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.scene.table import Positive


class VorticityOptions(PartOptions):
    """Keys of a ``[[mesh.field]]`` table with type ``vorticity``: edges so short that the velocity changes little
    along one, in each mesh except the first."""

    size: Positive = Field(description="Shortest edge that it asks for [length]")
    threshold: Positive = Field(
        default=0.1, description="Largest vorticity times edge length, divided by the largest speed in the fluid [1]"
    )


class Vorticity(SizeField):
    """h = threshold · max|u| / |ω|, and at least ``size``, with the vorticity ω of the flow on the mesh before.

    References
    ----------
    S. Popinet, Gerris: a tree-based adaptive solver for the incompressible Euler equations in complex geometries, J.
    Comput. Phys. 190, 572 (2003), whose criterion h |ω| / max|u| this is.
    """

    name: ClassVar[str] = "vorticity"
    Options: ClassVar[type[PartOptions]] = VorticityOptions
    options: VorticityOptions

    def edge_length(self, points: FloatArray, around: FluidDomain, flow: Flow) -> FloatArray:
        """h, (m,) [length]."""
        turning: FloatArray = np.linalg.norm(flow.vorticity(points), axis=1)
        longest = np.full(len(points), around.width)
        turns = turning > 0.0
        resolved = self.options.threshold * flow.speed / turning[turns]
        longest[turns] = np.minimum(np.maximum(resolved, self.options.size), around.width)
        return longest
