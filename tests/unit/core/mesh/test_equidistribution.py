"""Cells by accuracy: fewest for an error that is known, when another mesh is worth it, and in runs."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mesh_tools import ball, box, upright

import rigidfluid
from rigidfluid.api import (
    AtRest,
    FloatArray,
    Flow,
    PartOptions,
    Scene,
    Simulation,
    SizeField,
    model_of,
    scene_from_dict,
)
from rigidfluid.core.mesh.flow import FlowOnMesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.equidistribution import Equidistribution
from rigidfluid.core.mesh.size.size_field import LONGEST
from rigidfluid.core.model.mesh_error import EstimatedError
from rigidfluid.core.model.types import Mesh
from rigidfluid.errors import SceneError
from rigidfluid.testing.fluid.boxes import box as box_mesh


def around(dimension: int) -> FluidDomain:
    return FluidDomain([ball(0.1, dimension)], upright([0.5] * dimension), box([0] * dimension, [1] * dimension), ())


def apart(dimension: int) -> FloatArray:
    """Points off the ball."""
    return np.array(list(product((0.0, 0.5, 1.0), repeat=dimension)))[:3]


def wanted(mesh: Mesh, error: EstimatedError | None, field: Equidistribution, points: FloatArray) -> FloatArray:
    """Edges at the points, after a mesh with an error."""
    d, nothing = mesh.points.shape[1], np.zeros_like(mesh.points)
    flow = FlowOnMesh(mesh, nothing, nothing[:, 0], AtRest(1, d).twist, error)
    return field.edge_length(points, around(d), flow)


@pytest.mark.parametrize("dimension", [2, 3])
def test_equal_errors_keep_equal_cells_that_meet_the_target(dimension: int) -> None:
    """h falls with the root of the relative error; the edge of a regular simplex of the cells' volume is known."""
    mesh = box_mesh(dimension, 4)
    error = EstimatedError(np.full(len(mesh.cells), 0.09 / len(mesh.cells)), 1.0)
    found = wanted(mesh, error, Equidistribution(0.3 / 0.7, 10**6, dimension), apart(dimension))
    edge = {2: np.sqrt(4.0 / np.sqrt(3.0) / 32.0), 3: np.cbrt(6.0 * np.sqrt(2.0) / 384.0)}[dimension]
    assert found == pytest.approx(edge, rel=1e-12)
    finer = wanted(mesh, error, Equidistribution(0.2 / 0.7, 10**6, dimension), apart(dimension))
    assert finer == pytest.approx(edge * np.sqrt(0.2 / 0.3), rel=1e-12)


def test_edges_that_stay_on_a_body_are_as_long_as_the_accuracy_allows() -> None:
    """They are bisected where they are LONGEST times longer than wanted, and √0.7 is left between aim and accuracy."""
    mesh, error = box_mesh(2, 4), EstimatedError(np.full(32, 0.01), 32.0)
    points = np.array([[0.5, 0.595], [0.5, 0.605], [0.5, 0.65]])
    on, just_off, off = wanted(mesh, error, Equidistribution(0.1, 10**6, 2), points)
    allowed = wanted(mesh, error, Equidistribution(0.1 / 0.7, 10**6, 2), points)[2]
    assert LONGEST * on == pytest.approx(allowed, rel=1e-12)
    assert on == just_off < off == pytest.approx(np.sqrt(0.7) * allowed, rel=1e-12)


def test_edges_change_by_a_factor_of_two_at_most() -> None:
    mesh = box_mesh(2, 4)
    error = EstimatedError(np.full(32, 1.0 / 32), 1.0)
    now = wanted(mesh, error, Equidistribution(1.0 / 0.7, 10**6, 2), mesh.points)
    assert wanted(mesh, error, Equidistribution(1e-4, 10**9, 2), mesh.points) == pytest.approx(0.5 * now)
    coarser = EstimatedError(1e-9 * error.cells, 1.0)
    assert wanted(mesh, coarser, Equidistribution(0.5, 10**6, 2), mesh.points) == pytest.approx(2.0 * now)


def test_cells_are_no_more_than_the_most() -> None:
    """32 cells of equal errors stay as they are, however large the error is."""
    mesh = box_mesh(2, 4)
    error = EstimatedError(np.full(32, 1.0 / 32), 1.0)
    kept = wanted(mesh, error, Equidistribution(1e-4, 32, 2), mesh.points)
    assert kept == pytest.approx(wanted(mesh, error, Equidistribution(1.0 / 0.7, 10**6, 2), mesh.points))
    assert not Equidistribution(1e-4, 32, 2).is_due(error, 100.0)


def test_no_cells_of_other_sizes_are_fewer() -> None:
    """Σ η² (h'/h)⁴ at fixed Σ (h'/h)⁻²: any other change of a cell raises one of them."""
    random = np.random.default_rng(3)
    error = EstimatedError(np.exp(random.uniform(-1.0, 1.0, 40)), 40.0)
    change = Equidistribution(error.relative, 10**6, 2)._changes(error)
    slopes = 4.0 * error.cells * change**3 / (-2.0 * change**-3.0)
    assert slopes == pytest.approx(slopes[0], rel=1e-12)
    assert error.cells @ change**4 == pytest.approx((0.7 * error.relative) ** 2 * 40.0, rel=1e-12)


def test_nothing_is_asked_for_without_an_error() -> None:
    mesh, field = box_mesh(2, 4), Equidistribution(0.1, 1000, 2)
    unknown = [None, EstimatedError(np.zeros(32), 1.0), EstimatedError(np.ones(32), 0.0)]
    for error in unknown:
        assert wanted(mesh, error, field, mesh.points).tolist() == [around(2).width] * len(mesh.points)
        assert error is None or not field.is_due(error, 100.0)
    assert field.edge_length(mesh.points, around(2), AtRest(1, 2)).tolist() == [around(2).width] * len(mesh.points)


def test_another_mesh_is_made_where_it_is_worth_it() -> None:
    """With equal errors, of 10 %: for half of it soon, for a little less and for four times it later, but not for what
    is nearly there, for edges that the mesher would leave, and where cells may not grow."""
    error = EstimatedError(np.full(100, 0.01), 100.0)
    fields = {accuracy: Equidistribution(accuracy, 10**6, 2) for accuracy in (0.05, 0.0999, 0.12, 0.2, 0.4)}
    due = {accuracy: field.is_due(error, 100.0) for accuracy, field in fields.items()}
    assert due == {0.05: True, 0.0999: True, 0.12: False, 0.2: False, 0.4: True}
    assert not fields[0.4].is_due(error, 100.0, np.ones(100))
    new = {accuracy: [field.is_due(error, age) for age in (3.0, 4.0, 19.0, 20.0)] for accuracy, field in fields.items()}
    assert new == {
        0.05: [False, True, True, True],
        0.0999: [False, False, False, True],
        0.12: [False, False, False, False],
        0.2: [False, False, False, False],
        0.4: [False, False, False, True],
    }


@pytest.mark.parametrize("dimension", [2, 3])
def test_cells_without_any_error_grow_as_far_as_others_do(dimension: int) -> None:
    """One whose fluid is at rest, far below the accuracy."""
    cells = np.full(1000, 1e-7)
    cells[0] = 0.0
    error, field = EstimatedError(cells, 1.0), Equidistribution(0.9, 10**6, dimension)
    assert field.is_due(error, 100.0)
    mesh = box_mesh(dimension, 4)
    alike = np.full(len(mesh.cells), 1e-7)
    partly = np.where(np.arange(len(alike)) == 0, 0.0, alike)
    found, expected = (wanted(mesh, EstimatedError(each, 1.0), field, apart(dimension)) for each in (partly, alike))
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def channel(**mesh: Any) -> Scene:
    """A disk that is held in a channel."""
    return scene_from_dict({
        "scene": {"name": "held", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 0.1, "initial": "steady"},
        "domain": {"lower": [0.0, 0.0], "upper": [2.0, 1.0]},
        "boundary": [
            {"on": "left", "type": "velocity", "profile": "parabolic", "velocity": [1.0, 0.0]},
            {"on": "right", "type": "pressure", "pressure": 0.0},
        ],
        "body": [{
            **{"name": "disk", "type": "sphere", "radius": 0.15, "density": 1.0, "position": [0.7, 0.5]}, "fixed": True,
        }],
        "mesh": {"size": "auto", "accuracy": 0.02} | mesh,
        "time": {"end": 1.0, "step": 0.1},
        "output": {"every": 0.5},
    })  # fmt: skip


def test_a_run_gets_to_its_accuracy_and_goes_on_from_there(tmp_path: Path) -> None:
    simulation = Simulation(channel(), tmp_path)
    simulation.go(until=0.5)
    simulation.close()
    resumed = rigidfluid.run(channel(), out=tmp_path, resume=True)
    whole = rigidfluid.run(channel())
    for name in ("mesh_error", "bodies"):
        for column, values in whole.table(name).items():
            np.testing.assert_array_equal(resumed.table(name)[column], values)
    errors, cells = whole.mesh_error["relative"], whole.steps["cells"]
    assert errors[0] > 0.04 > 0.021 > errors[-1]
    assert whole.summary["remeshes"] >= 1
    assert cells[0] < cells[-1] < 3000


def test_a_run_settles_where_edges_of_its_body_are_a_little_too_long() -> None:
    """Those on the disk are 1.3 times too long, which is within what the mesher leaves."""
    scene = channel(size_body=0.05, accuracy=0.05)
    whole = rigidfluid.run(scene.model_copy(update={"time": scene.time.model_copy(update={"end": 3.0})}))
    assert whole.mesh_error["relative"][-1] <= 0.05
    assert whole.summary["remeshes"] == 1


def test_no_mesh_is_made_for_cells_that_others_keep_small() -> None:
    """Not for 20 times the error either, as the disk and its gap to a wall ask for all cells that there are."""
    scene = channel(size=0.06, size_body=0.03, accuracy=0.5)
    disk = scene.body[0].model_copy(update={"position": (0.7, 0.17)})
    time = scene.time.model_copy(update={"end": 2.5})
    whole = rigidfluid.run(scene.model_copy(update={"body": (disk,), "time": time}))
    assert whole.mesh_error["relative"].max() < 0.1
    assert whole.summary["remeshes"] == 0


class Everywhere(SizeField):
    """Edges of .06 in all of the fluid."""

    name = "everywhere"

    def edge_length(self, points: FloatArray, around: FluidDomain, flow: Flow) -> FloatArray:
        return np.full(len(points), 0.06)


def test_no_mesh_is_made_for_cells_that_a_size_field_keeps_small() -> None:
    scene = channel(accuracy=0.3)
    model = model_of(scene.model_copy(update={"time": scene.time.model_copy(update={"end": 2.5})}))
    fluid = replace(model.fluid, size_fields=(Everywhere(PartOptions(), 2),))
    whole = rigidfluid.run(replace(model, fluid=fluid))
    assert whole.mesh_error["relative"].max() < 0.05
    assert whole.summary["remeshes"] == 0


def test_auto_sizes_become_numbers() -> None:
    mesh = channel().mesh
    assert mesh is not None
    assert (mesh.size, mesh.size_body) == (0.25, 0.03)
    given = channel(size_body=0.05).mesh
    assert given is not None
    assert given.size_body == 0.05


def test_auto_needs_an_accuracy() -> None:
    refused = r"mesh.size: found 'auto'; allowed is a number above 0 without `accuracy`"
    for given in ({}, {"accuracy": None}):
        with pytest.raises(SceneError, match=refused):
            scene_from_dict({"scene": {"name": "held", "dimension": 2}, "mesh": {"size": "auto"} | given})


def test_a_number_of_cells_needs_an_accuracy() -> None:
    with pytest.raises(SceneError, match=r"mesh.most_cells: found 200; allowed is one beside mesh.accuracy"):
        model_of(channel(size=0.25, size_body=0.05, accuracy=None, most_cells=200))
