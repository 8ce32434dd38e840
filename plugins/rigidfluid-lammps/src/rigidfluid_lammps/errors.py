"""The error that a comparison ends with."""

from __future__ import annotations

from rigidfluid.api import RigidfluidError


class CrosscheckError(RigidfluidError):
    """LAMMPS is missing, cannot run the scene as rigidfluid does, or fails."""
