"""The DOLFINx fluid backend; heavy imports wait until a backend is made."""

from rigidfluid.backends.dolfinx.backend import Dolfinx

__all__ = ["Dolfinx"]
