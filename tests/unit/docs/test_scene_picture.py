"""The gallery's pictures show the times and the part of a run that they are told to."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scenes import dry_tables, wet_tables
from site_tools.scene_picture import HEIGHT, WIDTH, Shown, View, scene_picture

import rigidfluid

DISK = {"name": "disk", "type": "sphere", "radius": 0.1, "density": 2.0}


@pytest.fixture(scope="module")
def fall(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fall")
    body = DISK | {"position": [0.4, 0.5], "velocity": [0.0, -2.0]}
    rigidfluid.run(rigidfluid.scene_from_dict(wet_tables(body, end=0.02, output={"every": 0.01})), folder)
    return folder


@pytest.mark.parametrize("view", ["speed", "vorticity", "pressure", "streamlines", "mesh"])
def test_a_panel_shows_a_window_about_the_body_at_its_time(view: View, fall: Path) -> None:
    figure = scene_picture(fall, Shown(view, (0.0, 0.02), window=(-0.2, -0.1, 0.3, 0.4)))
    first, second, bar = figure.axes
    bodies = rigidfluid.load_results(fall).bodies
    for axes, time, state in ((first, "time 0", 0), (second, "time 0.02", -1)):
        assert axes.get_title().split(",")[0] == time
        np.testing.assert_allclose(axes.get_xlim(), bodies["x"][state] + [-0.2, 0.3])
        np.testing.assert_allclose(axes.get_ylim(), bodies["y"][state] + [-0.1, 0.4])
        assert not [*axes.get_xticks(), *axes.get_yticks()]
    assert bar.get_ylabel().startswith(view if view in ("vorticity", "pressure") else "speed")
    assert figure.get_size_inches().tolist() == [WIDTH, HEIGHT]


def test_without_a_fluid_paths_are_seen(tmp_path: Path) -> None:
    rigidfluid.run(rigidfluid.scene_from_dict(dry_tables(DISK | {"position": [0.4, 0.5]}, end=0.02)), tmp_path)
    (axes,) = scene_picture(tmp_path, Shown("paths", (0.02,))).axes
    assert axes.get_title().startswith("paths")
    assert len(axes.lines) > 1


def test_a_slice_in_space_has_no_names_of_edges(tmp_path: Path) -> None:
    body: dict[str, Any] = DISK | {"radius": 0.2, "position": [0.5] * 3, "velocity": [0.0, 0.0, -1.0]}
    tables = wet_tables(body, end=0.01, mesh={"size": 0.4, "size_body": 0.2}, output={"every": 0.01})
    rigidfluid.run(rigidfluid.scene_from_dict(tables), tmp_path)
    axes, _ = scene_picture(tmp_path, Shown("space", (0.01,), plane="xz")).axes
    assert axes.images
    assert not axes.texts
