"""Errors by the mesh of flow and motions, as estimates know them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import FluidState, Mesh, Twist, Wrench


class RefinedFlow(NamedTuple):
    """A backend's state of a ``fluid`` on its ``mesh``, and the ``finer`` one of halved edges."""

    fluid: FluidState
    mesh: Mesh
    finer: Mesh


class Refinement(NamedTuple):
    """Change by a finer mesh of the motions' ``twist``, the ``wrench`` on the bodies, and the ``velocity`` (nodes, d)
    of the fluid at its nodes."""

    twist: Twist
    wrench: Wrench
    velocity: FloatArray


class ErrorRate(NamedTuple):
    """Part of ∂e/∂t that earlier errors e are: of the fluid's ``velocity`` (nodes, d) on the mesh of halved edges
    [length/time²], and as ``load`` (N, d+k) on the motions, their mass times it with the opposite sign
    [force | force·length]."""

    velocity: FloatArray
    load: FloatArray


MeshVelocity = Callable[[FloatArray], FloatArray]
"""Velocity (vertices + K, d) of a mesh's geometry whose motions have a twist (N, d+k) [length/time]."""


@dataclass(frozen=True, slots=True)
class FlowError:
    """Errors at the latest ``times`` (o,) of an estimate, newest first: of the fluid's ``velocity`` (o, nodes, d) at
    the nodes of the mesh of halved edges, and of the motions' ``twist`` (o, N, d+k)."""

    times: FloatArray
    velocity: FloatArray
    twist: FloatArray

    def after(self, earlier: FlowError | None) -> FlowError:
        """The latest two of these and ``earlier`` ones."""
        if earlier is None:
            return self
        pairs = [(getattr(self, each.name), getattr(earlier, each.name)) for each in fields(self)]
        return FlowError(*(np.concatenate(pair)[:2] for pair in pairs))
