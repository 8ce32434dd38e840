"""Tells when a moved mesh has become too coarse: cells are stretched, and not remade, where bodies go."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.mesh_quality import cell_sizes
from rigidfluid.core.mesh.size.size_field import Sizes, size_away_from_gaps
from rigidfluid.core.model.ranks import Ranks
from rigidfluid.core.model.types import Pose

MOST_COARSENED = 1.4
"""A cell may become this many times longer, over the wanted size, than it was when made, or than wanted."""


def has_coarsened(made: FloatArray, now: FloatArray, ranks: Ranks) -> bool:
    """Tell whether r > MOST_COARSENED · max(r₀, 1) in a cell of the whole mesh, r the cell's relative size ``now``
    (M,), r₀ when ``made`` (M,) [1].

    A mesh just made has r = r₀, so it never asks for another at once.
    """
    return bool(ranks.greatest(float((now / np.maximum(made, 1.0)).max())) > MOST_COARSENED)


def relative_sizes(points: FloatArray, cells: IntArray, fluid_domain: FluidDomain, sizes: Sizes) -> FloatArray:
    """Each cell's size over the one wanted at its centre, (M,) [1].

    Gaps are left out of the wanted size: cells in a gap are squeezed with it, and a rule of their own watches them.
    """
    centres = points[cells].mean(axis=1)
    return cell_sizes(points, cells) / size_away_from_gaps(centres, fluid_domain, sizes)


def is_due(reference: Pose, before: Pose, after: Pose, sizes: Sizes) -> bool:
    """Tell whether it is time to look: bodies have gone another size_body/growth from their ``reference`` pose.

    So far the size wanted next to a body doubles. It depends on poses alone, so that nothing need be remembered.
    """
    gone = (_farthest(reference, pose) * sizes.growth / sizes.size_body for pose in (before, after))
    first, second = map(np.floor, gone)
    return bool(first != second)


def _farthest(reference: Pose, pose: Pose) -> float:
    """Largest distance of a body from its place in another pose [length]."""
    return float(np.linalg.norm(pose.position - reference.position, axis=1).max(initial=0.0))
