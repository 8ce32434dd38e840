"""Integrals over boundary facets of fields that are given at the nodes."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.types import FloatArray, IntArray

# ∫ φᵢ over a straight quadratic facet of measure 1: Simpson's weights on an edge, the midpoints' on a triangle.
_WEIGHTS = {2: np.array([1.0, 1.0, 4.0]) / 6.0, 3: np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]) / 3.0}


def facet_weights(points: FloatArray, facets: IntArray) -> FloatArray:
    """∫ φᵢ over each facet for its nodes i, (F, 3 | 6), for vertices at ``points`` and ``facets`` (F, d)."""
    edges = points[facets[:, 1:]] - points[facets[:, :1]]
    gram = edges @ np.swapaxes(edges, 1, 2)
    measure = np.sqrt(np.linalg.det(gram)) / (1.0 if facets.shape[1] == 2 else 2.0)
    return np.outer(measure, _WEIGHTS[facets.shape[1]])
