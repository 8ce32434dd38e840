"""Forces of the fluid on the domain's boundary."""

from __future__ import annotations

from dataclasses import dataclass

from rigidfluid.core.geometry.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class BoundaryForces:
    """Force of the fluid on each of b pieces of the domain's boundary, and how large they are.

    ``force`` (b, d): ∫ σ·n with n into the fluid, for a pressure of zero mean in an enclosed flow; zero on periodic
    pieces [force]. ``area`` (b,): of each piece on the mesh, a length in 2D; zero of periodic pieces [length^(d-1)].
    """

    force: FloatArray
    area: FloatArray
