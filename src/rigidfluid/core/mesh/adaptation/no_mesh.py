"""Mesh of a run without a fluid: there are no cells, and nothing is to be done."""

from __future__ import annotations

import math

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.replaceable import Replaceable
from rigidfluid.core.model.state import Reference, State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh, Pose


class NoMesh:
    """`Updater` of a mesh without cells."""

    needs_remesh = Replaceable()

    def __init__(self, system: System) -> None:
        self.system = system
        self.needs_remesh = lambda state, pose: False

    def first_mesh(self) -> Mesh:
        return Mesh.empty(self.system.dimension)

    def first_reference(self, mesh: Mesh, gaps: FloatArray) -> Reference:
        return Reference(mesh, self.system.pose, gaps, math.nan, 0)

    def deform(self, state: State, pose: Pose) -> Mesh:
        return state.mesh

    def remesh_if_needed(self, state: State, pose: Pose) -> State:
        return state

    def quality(self, state: State) -> float:
        return math.nan
