"""The second opinion: the same dry scene in LAMMPS."""

from __future__ import annotations

from rigidfluid.crosscheck.comparison import Comparison, Means, Row
from rigidfluid.crosscheck.crosscheck import crosscheck

__all__ = ["Comparison", "Means", "Row", "crosscheck"]
