"""The scheme of a system, by whether there is a fluid and whether that has inertia."""

from __future__ import annotations

from rigidfluid.core.coupling.dry_scheme import DryScheme
from rigidfluid.core.coupling.navier_stokes_scheme import NavierStokesScheme
from rigidfluid.core.coupling.scheme import Scheme
from rigidfluid.core.coupling.stokes_scheme import StokesScheme
from rigidfluid.core.model.system import System


def scheme_of(system: System) -> Scheme:
    """Scheme of a system's steps."""
    if not system.has_fluid:
        return DryScheme(system)
    return StokesScheme(system) if system.quasi_steady else NavierStokesScheme(system)
