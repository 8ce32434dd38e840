"""The stream that a scene prescribes."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.setup.boundary_samples import sample_times, sampled_inflows
from rigidfluid.post.reports.results import Results


def prescribed_stream(results: Results) -> FloatArray | None:
    """The greatest mean velocity over a surface that fluid comes in by, at any time (d,); None without any."""
    means: list[FloatArray] = []
    model = results.model
    inlets = sampled_inflows(model.conditions, model.domain)
    times = sample_times(model.conditions, model.time.end, steady=all(inlet.velocity.is_steady for inlet in inlets))
    for inlet in inlets:
        for time in times[times <= results.time[-1]]:
            if (inlet.flux(time) or 0.0) > 0.0:
                means.append(inlet.weights @ inlet.velocity(time, inlet.points) / inlet.weights.sum())
    return max(means, key=lambda mean: float(np.linalg.norm(mean)), default=None)
