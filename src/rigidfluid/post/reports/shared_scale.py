"""Colours of a quantity that are the same in all pictures of a run, in its report and in its movie."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.reports.insides import inside_section
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.scale import Quantity, Scale
from rigidfluid.post.reports.section import Section
from rigidfluid.post.reports.view_plane import ViewPlane

_SAMPLED = 12
"""Number of output times that fix the range of the colours."""


def shared_scale(results: Results, quantity: Quantity, plane: ViewPlane, follow: int | None) -> Scale:
    """Fit the scale of one quantity, as `shared_scales` does."""
    (scale,) = shared_scales(results, (quantity,), plane, follow)
    return scale


def shared_scales(
    results: Results, quantities: Sequence[Quantity], plane: ViewPlane, follow: int | None
) -> list[Scale]:
    """Fit a scale for each quantity to output times spread over the run, each read once: in 3D to slices through the
    body to ``follow`` by number, or the first one."""
    there = [(time, path) for time, path in results.series if path.exists()]
    chosen = np.unique(np.linspace(0, len(there) - 1, _SAMPLED).round().astype(int))
    found: list[list[tuple[FloatArray, FloatArray]]] = [[] for _ in quantities]
    for time, path in (there[i] for i in chosen):
        through = results.path(follow or 0)[results.state_at(time)]
        section = Section.cut(results.fields(path), plane, through)
        insides = inside_section(results, path, plane, through) if "scalar" in quantities else None
        for quantity, spreads in zip(quantities, found, strict=True):
            spreads.append(section.spread(quantity))
            if quantity == "scalar" and insides is not None:
                spreads.append(insides.spread(quantity))
    return [
        Scale.fit(quantity, *zip(*spreads, strict=True)) for quantity, spreads in zip(quantities, found, strict=True)
    ]
