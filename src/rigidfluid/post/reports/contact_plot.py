"""The plot of contacts over time: how many, how strong, how near."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.style import BLUE, time_panels


def contact_plot(results: Results) -> Figure:
    """The number of contacts within the range of the laws, the largest contact force on a body, over its submerged
    weight where it has one, and the least gap."""
    figure, (count, force, gap) = time_panels(3)
    count.step(results.time, results.contact_counts, where="post", color=BLUE)
    count.set_ylabel("contacts")
    count.yaxis.set_major_locator(MaxNLocator(integer=True))
    values, label = _largest_force(results)
    force.plot(results.time, values, color=BLUE)
    force.set_ylabel(label)
    least = results.bodies["gap"].min(axis=1)
    gap.plot(results.time, np.where(np.isfinite(least) & (least > 0.0), least, np.nan), color=BLUE)
    gap.set_yscale("log")
    gap.set_ylabel("least gap [length]")
    return figure


def _largest_force(results: Results) -> tuple[FloatArray, str]:
    """Largest contact force on a body at each time (s,), over its weight if all have one, and its label."""
    force = np.linalg.norm(results.quantity("contact_force"), axis=2)
    weight = np.linalg.norm(results.system.weight, axis=1)
    if not weight.all():
        return np.asarray(np.nanmax(force, axis=1)), "largest\ncontact force [force]"
    return np.asarray(np.nanmax(force / weight, axis=1)), "largest contact force\nover the weight"
