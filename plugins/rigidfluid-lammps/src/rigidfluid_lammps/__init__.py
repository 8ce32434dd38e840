"""A second opinion on dry scenes: the same bodies in LAMMPS."""

from __future__ import annotations

from rigidfluid_lammps.comparison import Comparison, Means, Row
from rigidfluid_lammps.crosscheck import crosscheck
from rigidfluid_lammps.errors import CrosscheckError

__all__ = ["Comparison", "CrosscheckError", "Means", "Row", "crosscheck"]
