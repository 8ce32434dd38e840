"""A fluid backend whose integrals are NGSolve's."""

from __future__ import annotations

from rigidfluid.core.model.interfaces import FluidBackend
from rigidfluid.hookspecs import hookimpl
from rigidfluid_ngsolve.backend import NGSolve


@hookimpl
def rigidfluid_fluid_backends() -> list[type[FluidBackend]]:
    """The backend "ngsolve"."""
    return [NGSolve]
