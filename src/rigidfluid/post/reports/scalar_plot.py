"""The plot of a transported scalar over time: in bodies, through surfaces, and how far its values reach."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.reports.curves import MOST_LINES, draw_bodies
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.state_tables import table_by_state
from rigidfluid.post.reports.style import time_panels


class _Curves(NamedTuple):
    """``values`` (s, c) of so many ``names``, with the ``label`` of their axis."""

    label: str
    names: Sequence[str]
    values: FloatArray


def scalar_plot(results: Results) -> Figure:
    """Means in bodies and fluxes from them into the fluid, fluxes through faces of the domain, and the least and the
    greatest value: a panel each, where there are any."""
    fluxes = _table(results, "scalar_fluxes", len(results.system.surfaces))
    shown = [curves for curves in _curves(results, fluxes) if len(curves.names)]
    figure, panels = time_panels(len(shown))
    time = fluxes["time"][:, 0]
    for axes, curves in zip(panels, shown, strict=True):
        draw_bodies(axes, time, curves.values[: len(time)], curves.names)
        axes.set_ylabel(curves.label)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def _curves(results: Results, fluxes: dict[str, FloatArray]) -> Iterator[_Curves]:
    names, surfaces, totals = results.names, results.system.surfaces, _table(results, "scalar", 1)
    count, unit = len(names), "[scalar·area/time]" if results.system.dimension == 2 else "[scalar·area·length/time]"
    yield _Curves("mean in bodies\n[scalar]", names, fluxes["inside"][:, :count])
    yield _Curves(f"flux from bodies\n{unit}", names, fluxes["flux"][:, :count])
    through = np.abs(fluxes["flux"][:, count:]).max(axis=0)
    faces = np.sort(np.argsort(-through, kind="stable")[:MOST_LINES])
    faces = faces[through[faces] > 0.0] + count
    yield _Curves(f"flux in through faces\n{unit}", [surfaces[face] for face in faces], fluxes["flux"][:, faces])
    ends = np.column_stack([totals["least"], totals["greatest"]])
    yield _Curves("extremes [scalar]", ("least", "greatest"), ends)


def _table(results: Results, name: str, count: int) -> dict[str, FloatArray]:
    """A table by column, (states, count)."""
    return table_by_state(results.folder, name, results.system, count, complete=bool(results.summary))
