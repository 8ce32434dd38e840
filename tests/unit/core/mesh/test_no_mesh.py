"""A scene without a fluid has a mesh without cells, and nothing is done with it."""

import json

import numpy as np
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.records import count_cells
from rigidfluid.core.output.vtu import read_pvd
from rigidfluid.core.run.run import run
from rigidfluid.core.run.simulation import Simulation

BALL = {"type": "sphere", "name": "ball", "radius": 0.1, "density": 2.0, "position": [0.5, 0.5], "velocity": [1.0, 0.0]}


def falling(**tables):
    return scene_from_dict(dry_tables(BALL, end=0.04, fluid={"gravity": [0.0, -1.0]}, **tables))


def test_the_mesh_has_no_cells_at_any_time():
    simulation = Simulation(falling())
    first = simulation.state.mesh
    simulation.go()
    assert simulation.state.mesh is first is simulation.state.reference.mesh
    assert count_cells(first) == len(first.points) == len(first.facets) == 0
    assert np.isnan(simulation.mesh_updater.quality(simulation.state))
    assert simulation.counts.remeshes == 0


def test_a_table_of_a_mesh_is_not_read():
    simulation = Simulation(falling(mesh={"size": 0.2, "size_body": 0.1}))
    assert count_cells(simulation.state.mesh) == 0


def test_no_fields_are_written_and_no_probe_is_recorded(tmp_path):
    history = run(falling(output={"probes": [[0.5, 0.9]]}), tmp_path)
    assert {path.name.split(".", 1)[1] for path in (tmp_path / "fields").iterdir()} == {"bodies.vtu", "contacts.vtu"}
    assert read_pvd(tmp_path / "fields.pvd") == ()
    assert len(history.probes["time"]) == 0
    assert json.loads((tmp_path / "summary.json").read_text())["cells"] == 0


def test_a_run_is_taken_up_where_it_was_left(tmp_path):
    whole = run(falling())
    run(falling(time={"end": 0.02}, output={"every": 0.02}), tmp_path)
    resumed = run(falling(output={"every": 0.02}), tmp_path, resume=True)
    np.testing.assert_array_equal(resumed.bodies["x"][-1:], whole.bodies["x"][-1:])
