"""A fluid backend whose integrals are NGSolve's."""

from __future__ import annotations

from rigidfluid.api import FluidBackend, hookimpl
from rigidfluid_ngsolve.backend import NGSolve


@hookimpl
def rigidfluid_fluid_backends() -> list[type[FluidBackend]]:
    """The backend "ngsolve"."""
    return [NGSolve]
