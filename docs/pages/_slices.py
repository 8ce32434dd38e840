"""Slices of a 3D run's flow in the plane of its motion, at some moments."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from page_tools import Run

from rigidfluid.post.reports.moment import Moment
from rigidfluid.post.reports.moment import moment as seen_at
from rigidfluid.post.reports.results import read_results
from rigidfluid.post.reports.scale import Quantity, Scale
from rigidfluid.post.reports.shared_scale import shared_scale
from rigidfluid.post.reports.view_plane import view_plane


def slices(run: Run, moments: Sequence[float]) -> list[Moment]:
    """What is seen through the first body's centre at the output times nearest to ``moments``."""
    results = read_results(run.folder)
    plane = view_plane(results)
    times = np.array([time for time, _ in results.series])
    return [seen_at(results, int(np.argmin(np.abs(times - moment))), plane, 0) for moment in moments]


def colours(run: Run, quantity: Quantity) -> Scale:
    """Colours of a quantity in all pictures of a run."""
    results = read_results(run.folder)
    return shared_scale(results, quantity, view_plane(results), None)
