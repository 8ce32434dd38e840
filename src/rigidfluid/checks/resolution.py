"""Are there cells in the gap where a body comes to rest?"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, log2

import numpy as np

from rigidfluid.checks.design_contacts import DesignContacts
from rigidfluid.checks.finding import Finding, figure, round_down
from rigidfluid.checks.response import rest_gap
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.scene.mesh_tables import MeshTable

QUESTION = "cells"
_MOST_REFINEMENTS = 20
_ROUNDING = 1e-9


def resolution_findings(design: DesignContacts, mesh: MeshTable) -> Iterator[Finding]:
    """Compare the finest cells, size_body/2^refinements, with the gap at rest under a stack, or where an impact ends; a
    warning where fewer than cells_per_gap cells fit."""
    gaps, finest = narrowest_gaps(design), mesh.size_body / 2**mesh.refinements
    for row in design.worst(-np.nan_to_num(gaps, nan=np.inf)):
        if np.isfinite(gaps[row]):
            yield _finding(design, row, float(gaps[row]), finest, mesh)


def narrowest_gaps(design: DesignContacts) -> FloatArray:
    """Gaps at rest under a stack, or where impacts end without weight, NaN where the law holds none (m,) [length]."""
    resting = design.stacked_weight > 0.0
    gaps = np.where(resting, rest_gap(design.law, design.contacts, design.stacked_weight, 0.0), design.turning_gaps())
    return np.where(gaps > _ROUNDING * design.law.range, gaps, np.nan)


def _finding(design: DesignContacts, row: int, gap: float, finest: float, mesh: MeshTable) -> Finding:
    cells = gap / float(np.clip(gap / mesh.cells_per_gap, finest, mesh.size_body))
    found = {"gap": gap, "cells": cells, "finest_cell": finest}
    where = "gap at rest" if design.stacked_weight[row] > 0.0 else "gap at the impact"
    text = f"{' and '.join(design.names(row))}: {figure(cells)} cells across the {where} of {figure(gap)}"
    if cells >= mesh.cells_per_gap * (1.0 - _ROUNDING):
        return Finding("note", QUESTION, design.names(row), text, found=found)
    text += f", and {mesh.cells_per_gap} are wanted"
    refinements = ceil(log2(mesh.size_body * mesh.cells_per_gap / gap) - _ROUNDING)
    if refinements <= _MOST_REFINEMENTS:
        remedy = f"Set mesh.refinements to {refinements} or more."
        return Finding("warning", QUESTION, design.names(row), text, remedy, found, {"refinements": refinements})
    size = gap * 2**mesh.refinements / mesh.cells_per_gap
    remedy = f"Set mesh.size_body to {round_down(size)} or less, or stiffen the law."
    return Finding("warning", QUESTION, design.names(row), text, remedy, found, {"size_body": size})
