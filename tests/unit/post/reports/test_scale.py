"""Colours of speed, vorticity and pressure: one scale for report and movie, and weak values are seen beside strong."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from falling import falling_disk
from matplotlib.axes import Axes

import rigidfluid
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.vtu import read_vtu
from rigidfluid.post.movies import Look, movie
from rigidfluid.post.reports import report
from rigidfluid.post.reports.results import read_results
from rigidfluid.post.reports.scale import QUANTITIES, Quantity, Scale
from rigidfluid.post.reports.section import Section
from rigidfluid.post.reports.shared_scale import shared_scale
from rigidfluid.post.reports.style import new_figure
from rigidfluid.post.reports.view_plane import view_plane

WAKE = np.concatenate([np.full(900, 0.01), np.full(80, 3.0), np.full(20, -100.0)])
"""Values of a still fluid, of a wake in it and of a boundary layer, each on the same area."""


def paleness(scale: Scale, value: float) -> float:
    """How near a colour is to white, from 0 to 1."""
    return float(scale.colours(np.array(value)).min())


def bar(scale: Scale) -> tuple[Axes, FloatArray]:
    figure = new_figure(4.0, 4.0)
    panel = figure.subplots()
    scale.draw_bar(figure, [panel], 2)
    figure.canvas.draw()
    return figure.axes[-1], figure.axes[-1].get_yticks()


@pytest.mark.parametrize("quantity", ["vorticity", "pressure"])
def test_a_wake_is_seen_beside_a_boundary_layer(quantity: Quantity) -> None:
    scale = Scale.fit(quantity, [WAKE], [np.ones(1000)])
    assert (scale.lowest, scale.highest) == (-100.0, 100.0)
    assert paleness(scale, 3.0) < 0.8 < 0.9 < paleness(scale, 0.01)
    assert paleness(Scale(quantity, -100.0, 100.0, 100.0), 3.0) > 0.9


def test_values_spread_evenly_have_even_steps() -> None:
    scale = Scale.fit("vorticity", [np.linspace(-1.0, 1.0, 2001)], [np.ones(2001)])
    share = scale.norm(np.array([0.0, 0.25, 0.5]))
    assert share[0] == pytest.approx(0.5)
    assert share[2] - share[1] == pytest.approx(share[1] - share[0], rel=0.1)


def test_the_scale_goes_by_area_and_not_by_how_fine_cells_are() -> None:
    few = Scale.fit("pressure", [np.array([1.0, 5.0])], [np.array([0.9, 0.1])])
    many = Scale.fit("pressure", [np.array([1.0]), np.full(50, 5.0)], [np.array([0.9]), np.full(50, 0.002)])
    assert few == many == Scale("pressure", -5.0, 5.0, 1.0)
    corner = Scale.fit("pressure", [np.array([1.0, 1e9])], [np.array([1.0, 1e-5])])
    assert corner.highest == 1.0


def test_speeds_have_even_steps_from_zero_to_the_highest() -> None:
    scale = Scale.fit("speed", [np.array([0.0, 1.0, 100.0])], [np.array([1.0, 1.0, 1e-6])])
    assert (scale.lowest, scale.highest) == (0.0, 100.0)
    assert scale.norm(np.array([25.0, 50.0])).tolist() == [0.25, 0.5]


@pytest.mark.parametrize("factor", [1.0, 1e-6, 1.9, 1e9])
def test_numbers_at_the_bar_are_apart_and_within_it(factor: float) -> None:
    axes, ticks = bar(Scale.fit("vorticity", [factor * WAKE], [np.ones(1000)]))
    labels = [label.get_window_extent() for label in axes.get_yticklabels()]
    assert len(ticks) == 5
    assert np.abs(ticks).max() <= factor * 100.0
    assert all(one.y1 < other.y0 for one, other in pairwise(labels))


def test_a_fluid_at_rest_has_a_scale() -> None:
    for quantity in QUANTITIES:
        scale = Scale.fit(quantity, [np.zeros(3)], [np.ones(3)])
        assert np.isfinite(scale.colours(np.zeros(2))).all()
        bar(scale)


@pytest.mark.long
def test_report_and_movie_have_one_scale(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mesh, time = {"size": 0.4, "size_body": 0.1}, {"step": 0.004, "end": 0.012}
    rigidfluid.run(falling_disk(mesh=mesh, time=time, output={"every": 0.004}), tmp_path)
    results = read_results(tmp_path)
    plane = view_plane(results)
    everything = [Section.cut(read_vtu(path), plane, np.zeros(2)).spread("vorticity") for _, path in results.series]
    values, areas = zip(*everything, strict=True)
    scale = shared_scale(results, "vorticity", plane, None)
    assert scale == Scale.fit("vorticity", values, areas)
    drawn: list[Scale] = []

    def record(self: Scale, *_: object) -> None:
        drawn.append(self)

    monkeypatch.setattr(Scale, "draw_bar", record)
    report(tmp_path)
    assert scale in drawn
    of_report = len(drawn)
    look = Look(show="vorticity", longer=60, window=(0.0, 0.0, 0.5, 0.5))
    movie(tmp_path, tmp_path / "a.gif", look)
    assert drawn[of_report:] == [scale]
