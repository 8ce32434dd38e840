"""The fluid backends that come with rigidfluid."""

from __future__ import annotations

from rigidfluid.backends.dolfinx import Dolfinx
from rigidfluid.backends.dry import Dry
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.hookspecs import hookimpl


@hookimpl
def rigidfluid_fluid_backends() -> list[type[FluidBackend]]:
    """The built-in fluid backends."""
    return [Dolfinx, Dry, ScikitFem]
