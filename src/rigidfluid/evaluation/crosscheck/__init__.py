"""The second opinion: the same dry scene in LAMMPS."""

from __future__ import annotations

from rigidfluid.evaluation.crosscheck.comparison import Comparison, Means, Row
from rigidfluid.evaluation.crosscheck.crosscheck import crosscheck

__all__ = ["Comparison", "Means", "Row", "crosscheck"]
