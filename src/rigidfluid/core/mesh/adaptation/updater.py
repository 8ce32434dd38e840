"""Interface by which the loop keeps the mesh of a run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.state import Reference, State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh, Pose


class FirstMesh(Protocol):
    """Maker of a run's first mesh."""

    def first_mesh(self) -> Mesh:
        """The mesh around the bodies' initial pose."""

    def first_reference(self, mesh: Mesh, gaps: FloatArray) -> Reference:
        """The first ``mesh`` as what later ones are moved from and compared with; nearest ``gaps`` (n,) there
        [length]."""


class Updater(FirstMesh, Protocol):
    """Keeper of a run's mesh: it moves the mesh with the bodies, and re-makes it when ``needs_remesh`` says so."""

    system: System
    """The present system; another one may be put in its place between steps."""
    needs_remesh: Callable[[State, Pose], bool]

    def deform(self, state: State, pose: Pose) -> Mesh:
        """The mesh when the bodies are at ``pose``; raises StepRejected where a cell is tangled."""

    def remesh_if_needed(self, state: State, pose: Pose) -> State:
        """The same state, on a new mesh if a step to ``pose`` asks for one; with a mark where none can be made."""

    def quality(self, state: State) -> float:
        """Quality of the worst cell of the mesh where it is now, curved cells included; nan without cells [1]."""
