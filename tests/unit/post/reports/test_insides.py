"""Colours inside bodies that conduct a scalar, in pictures of reports and in movies, across periodic surfaces too."""

from __future__ import annotations

from pathlib import Path
from typing import cast

import numpy as np
import pytest
from matplotlib.collections import LineCollection, TriMesh
from matplotlib.colors import to_rgb

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.model.types import Fields
from rigidfluid.core.output.history import History
from rigidfluid.post.movies import Look, movie
from rigidfluid.post.movies.picture import draw_bodies, flow_image, inside_image, paint_flow
from rigidfluid.post.movies.shot import shot_of
from rigidfluid.post.reports import report
from rigidfluid.post.reports.insides import inside_section
from rigidfluid.post.reports.moment import moment
from rigidfluid.post.reports.pictures import flow_picture, scalar_picture
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.reports.scalar_plot import scalar_plot
from rigidfluid.post.reports.shared_scale import shared_scale
from rigidfluid.post.reports.style import BODY
from rigidfluid.post.reports.view_plane import ViewPlane, view_plane

RADIUS = 0.15
HOT = "1 + 100*(0.0225 - where(x < 0.55, x - 0.05, x - 1.05)**2 - (y - 0.5)**2)"
"""1 on the disk's surface, 3.25 at its centre; points are those in the domain."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A disk that conducts across the left face, and one of one value, in a fluid at rest."""
    out = tmp_path_factory.mktemp("hot")
    disk = {"type": "sphere", "radius": RADIUS, "density": 1.0, "fixed": True}
    scene = {
        "scene": {"name": "hot", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 1.0, "model": "stokes"},
        "scalar": {
            "diffusivity": 0.02,
            "body": [
                {"on": "conducts", "value": HOT, "capacity": 2.0, "conductivity": 0.5},
                {"on": "lumped", "value": 1.0, "capacity": 2.0},
            ],
        },
        "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]},
        "boundary": [{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}],
        "body": [
            {**disk, "name": "conducts", "position": [0.05, 0.5]},
            {**disk, "name": "lumped", "position": [0.55, 0.5]},
        ],
        "mesh": {"size": 0.2, "size_body": 0.06},
        "time": {"end": 0.04, "step": 0.02},
        "output": {"every": 0.02},
    }
    rigidfluid.run(scene_from_dict(scene), out)
    return out


@pytest.fixture(scope="module")
def results(folder: Path) -> Results:
    return read_results(folder)


def test_pictures_have_the_values_inside_in_all_images_and_nothing_in_other_bodies(results: Results) -> None:
    path, grid = results.series[0][1], shot_of(results, None, None).grid(0, 200)
    inside = inside_image(results, path, "scalar", grid)
    known = np.isfinite(inside)
    assert known.sum() * grid.right[0] * grid.up[1] == pytest.approx(np.pi * RADIUS**2, rel=0.02)
    x, y = np.moveaxis(grid.points(), -1, 0)
    from_centre = (x - 0.05 - np.rint(x - 0.05)) ** 2 + (y - 0.5) ** 2
    np.testing.assert_allclose(inside[known], (1.0 + 100.0 * (RADIUS**2 - from_centre))[known], atol=0.06)
    assert known[:, -1].any()
    assert not np.isfinite(inside_image(results, path, "speed", grid)).any()


def test_a_movie_is_grey_in_bodies_that_do_not_conduct_alone(results: Results) -> None:
    path, grid = results.series[-1][1], shot_of(results, None, None).grid(-1, 200)
    scale = shared_scale(results, "scalar", view_plane(results), None)
    inside = inside_image(results, path, "scalar", grid)
    known = np.isfinite(inside)
    picture = paint_flow(np.where(known, inside, flow_image(results.fields(path), "scalar", grid)), scale)
    draw_bodies(picture, grid, results, -1, known)
    grey = np.all(picture == to_rgb(BODY), axis=2)
    columns = np.flatnonzero(grey.any(axis=0))
    assert grid.origin[0] + grid.right[0] * columns[0] > 0.38
    assert grid.origin[0] + grid.right[0] * columns[-1] < 0.72
    coloured = np.all(picture == scale.colours(np.nan_to_num(inside)), axis=2) & known
    assert coloured.sum() > 0.8 * known.sum()  # all but its outline and its mark
    assert np.all(picture[known] == 0.0, axis=1).sum() > 50  # which is black


def test_colours_of_the_scalar_are_fitted_to_the_insides_too(results: Results) -> None:
    plane = view_plane(results)
    assert shared_scale(results, "scalar", plane, None).highest == pytest.approx(3.25, abs=0.05)
    assert shared_scale(results, "speed", plane, None).highest == 0.0


def test_a_picture_of_the_scalar_shows_the_insides_and_others_do_not(results: Results) -> None:
    plane = view_plane(results)
    shown = [moment(results, 0, plane, 0)]
    figures = {
        "scalar": scalar_picture(shown, shared_scale(results, "scalar", plane, None)),
        "speed": flow_picture(shown, shared_scale(results, "speed", plane, None)),
    }
    meshes = {
        name: [one for one in figure.axes[0].collections if isinstance(one, TriMesh)]
        for name, figure in figures.items()
    }
    assert [len(found) for found in meshes.values()] == [2, 1]
    assert meshes["scalar"][1].get_array().max() == pytest.approx(3.25, abs=0.05)
    (outlines,) = (one for one in figures["scalar"].axes[0].collections if isinstance(one, LineCollection))
    assert len(outlines.get_segments()) == len(shown[0].outlines)


def test_a_plot_over_time_has_means_fluxes_and_extremes_of_what_there_is(results: Results) -> None:
    """No panel of faces, through which nothing goes here."""
    history = History(2, folder=results.folder)
    figure = scalar_plot(results)
    lines = {axes.get_ylabel(): {str(one.get_label()): one for one in axes.lines} for axes in figure.axes}
    mean, flux = "mean in bodies\n[scalar]", "flux from bodies\n[scalar·area/time]"
    assert list(lines) == [mean, flux, "extremes [scalar]"]
    assert set(lines[mean]) == set(lines[flux]) == {"conducts", "lumped"}
    for name in ("conducts", "lumped"):
        mine = history.scalar_fluxes["surface"] == name
        for label, column in ((mean, "inside"), (flux, "flux")):
            np.testing.assert_array_equal(lines[label][name].get_ydata(), history.scalar_fluxes[column][mine])
    np.testing.assert_array_equal(lines["extremes [scalar]"]["greatest"].get_ydata(), history.scalar["greatest"])
    np.testing.assert_array_equal(lines[mean]["lumped"].get_xdata(), history.scalar["time"])


def test_report_and_movie_of_such_a_run_are_made(folder: Path, tmp_path: Path) -> None:
    page = report(folder)[-1].read_text(encoding="utf-8")
    assert "Bodies that conduct it have its colours inside." in page
    assert (folder / "report" / "scalar_over_time.svg").exists()
    assert movie(folder, tmp_path / "a.gif", Look(show="scalar", longer=60)).exists()


def test_a_slice_beside_all_bodies_that_conduct_has_no_insides() -> None:
    corners = np.vstack([np.zeros(3), np.eye(3)])
    nodes = np.vstack(
        [corners, [0.5 * (corners[a] + corners[b]) for a, b in ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))]]
    )

    class Inside:
        def insides(self, path: Path) -> Fields:
            return Fields(nodes, np.arange(10)[None], np.zeros((10, 3)), np.zeros(10), nodes[:, 0])

    plane, run = ViewPlane.coordinate_plane(0, 2, 3), cast("Results", Inside())
    through = inside_section(run, Path(), plane, np.array([0.0, 0.3, 0.0]))
    assert through is not None
    assert through.spread("scalar")[0].max() == pytest.approx(0.7)
    assert inside_section(run, Path(), plane, np.array([0.0, 2.0, 0.0])) is None
