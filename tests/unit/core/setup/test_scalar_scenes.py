"""Scenes with a table [scalar]: their results, runs that are resumed, and what is refused by name."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigidfluid
from rigidfluid.api import FloatArray, Fluid, FluidBackend, Model, Scalar, ScalarOnSurface, load_results, model_of
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import SceneError

TABLE: dict[str, Any] = {
    "diffusivity": 0.02,
    "initial": "0.1*x",
    "expansion": 0.05,
    "boundary": [{"on": "all", "value": 0.0}, {"on": "left", "flux": 0.01}],
    "body": [{"on": "disk", "value": 1.0, "capacity": 2.0}],
}


def scene(scalar: dict[str, Any] | None = None, **tables: Any) -> rigidfluid.Scene:
    """A hot disk that rises in a closed box 1 by 2."""
    common: dict[str, Any] = {
        "scene": {"name": "hot", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 0.05, "gravity": [0.0, -9.81]},
        "scalar": TABLE | (scalar or {}),
        "domain": {"lower": [0.0, 0.0], "upper": [1.0, 2.0]},
        "body": [{"type": "sphere", "name": "disk", "radius": 0.15, "density": 0.95, "position": [0.5, 0.6]}],
        "mesh": {"size": 0.25, "size_body": 0.08, "remesh_every": 0.05},
        "time": {"end": 0.12, "step": 0.01},
        "output": {"every": 0.06},
    }
    return scene_from_dict(common | tables)


def test_the_content_of_disk_and_fluid_changes_by_the_walls_across_new_meshes(tmp_path: Path) -> None:
    """Each step's balance closes to rounding, new meshes between them too: BDF2 weighs contents of earlier times."""
    history = rigidfluid.run(scene(), tmp_path)
    totals, fluxes = history.scalar, history.scalar_fluxes
    assert history.steps["remeshes"][-1] >= 1
    assert np.abs(totals["imbalance"]).max() < 1e-11 * np.abs(fluxes["flux"]).max()
    disk, left = (fluxes["surface"] == name for name in ("disk", "left"))
    np.testing.assert_allclose(fluxes["flux"][left], 0.01 * 2.0, rtol=1e-12)
    assert np.all(fluxes["flux"][disk] > 0.0)
    assert np.all(np.diff(fluxes["value"][disk]) < 0.0)
    assert history.bodies["vy"][-1] > 0.0
    step, content, capacity = 0.01, totals["content"], 2.0 * np.pi * 0.15**2
    whole = content + capacity * fluxes["value"][disk]
    outside = np.array([fluxes["flux"][fluxes["step"] == n][1:].sum() for n in totals["step"]])
    rate = (1.5 * whole[2:] - 2.0 * whole[1:-1] + 0.5 * whole[:-2]) / step
    same = np.diff(history.steps["remeshes"])  # content of T, where polygons of the disk are the same
    regular = (history.steps["size"][2:] == step) & (same[1:] == 0) & (same[:-1] == 0)
    assert regular.any()
    np.testing.assert_allclose(rate[regular], outside[2:][regular], atol=1e-10)


def test_fields_and_probes_have_the_scalar(tmp_path: Path) -> None:
    probes = [[0.5, 0.6], [0.2, 1.4], [0.8, 0.3]]
    rigidfluid.run(scene(output={"every": 0.06, "probes": probes}), tmp_path)
    fields = load_results(tmp_path).fields(0.12)
    near = [np.argmin(np.linalg.norm(fields.points - point, axis=1)) for point in probes]
    seen = load_results(tmp_path).probes["scalar"].reshape(-1, 3)
    assert fields.scalar is not None
    np.testing.assert_allclose(seen[-1], fields.scalar[near], atol=0.02)
    assert seen[-1].max() > 0.7 > 0.1 > seen[-1].min()
    assert fields.scalar is not None
    assert fields.scalar.max() == pytest.approx(load_results(tmp_path).scalar["greatest"][-1], rel=1e-6)


def test_probes_have_no_scalar_of_a_backend_that_does_not_tell_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScikitFem, "probe_scalar", FluidBackend.probe_scalar)
    short = {"time": {"end": 0.01, "step": 0.01}, "output": {"every": 0.01, "probes": [[0.2, 1.4]]}}
    found = rigidfluid.run(scene(**short)).probes
    assert np.isnan(found["scalar"]).all()
    assert np.isfinite(found["pressure"]).all()


def test_a_run_is_resumed_to_the_last_bit(tmp_path: Path) -> None:
    rigidfluid.run(scene(), tmp_path / "whole")
    rigidfluid.run(scene(time={"end": 0.06, "step": 0.01}), tmp_path / "parts")
    rigidfluid.run(scene(), tmp_path / "parts", resume=True)
    for name in ("scalar.csv", "scalar_fluxes.csv", "bodies.csv", "energy.csv"):
        assert (tmp_path / "whole" / name).read_bytes() == (tmp_path / "parts" / name).read_bytes()


def test_a_scene_without_one_has_no_rows() -> None:
    history = rigidfluid.run(
        scene_from_dict(
            {
                **scene(output={"every": 0.01, "probes": [[0.2, 0.3]]}).to_dict(),
                **{"scalar": None, "time": {"end": 0.01, "step": 0.01}},
            }
        )
    )
    assert len(history.scalar["content"]) == len(history.scalar_fluxes["flux"]) == 0
    assert np.isnan(history.probes["scalar"]).all()
    assert len(history.probes["scalar"]) == 2


def test_without_expansion_the_flow_does_not_feel_it() -> None:
    short = {"end": 0.02, "step": 0.01}
    felt, unfelt = (Simulation(scene({"expansion": value}, time=short), None) for value in (0.05, None))
    for simulation in (felt, unfelt):
        simulation.go()
    bare = Simulation(scene_from_dict({**scene(time=short).to_dict(), "scalar": None}), None)
    bare.go()
    np.testing.assert_array_equal(unfelt.state.fluid["velocity"], bare.state.fluid["velocity"])
    assert not np.array_equal(felt.state.fluid["velocity"], bare.state.fluid["velocity"])


WRONG: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    ({"diffusivity": 0.0}, {}, r"scalar.diffusivity"),
    ({"boundary": [{"on": "lefft", "value": 1.0}]}, {}, r"scalar.boundary.0.on.*'lefft'.*left"),
    ({"body": [{"on": "dsk", "value": 1.0}]}, {}, r"scalar.body.0.on.*'dsk'.*disk"),
    ({"body": [{"on": "disk"}]}, {}, r"scalar.body.0.value: found nothing"),
    ({"body": [{"on": "disk", "value": 1.0, "flux": 1.0}]}, {}, r"scalar.body.0.flux: found a flux and a value"),
    ({"body": [{"on": "disk", "capacity": 1.0, "flux": 1.0}]}, {}, r"scalar.body.0.flux: found a flux and a capacity"),
    ({"initial": "z"}, {}, r"scalar.initial"),
    ({"source": "1/x"}, {}, r"scalar.source"),
    ({"expansion": None, "reference": 1.0}, {}, r"scalar.reference"),
    ({}, {"fluid": {"density": 1.0, "viscosity": 0.05}}, r"scalar.expansion.*gravity"),
    ({}, {"fluid": {"backend": "dry"}}, r"scalar: found one with backend 'dry'"),
    ({"boundary": []}, {"boundary": [{"on": "left", "type": "velocity", "velocity": [1.0, 0.0]}]}, r"scalar.boundary"),
]


@pytest.mark.parametrize(("scalar", "tables", "message"), WRONG)
def test_what_is_wrong_is_told(scalar: dict[str, Any], tables: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        model_of(scene(scalar, **tables))


HOT = [{"on": "disk", "value": 3.0, "capacity": 2.0}]


def test_a_window_is_refused_by_name() -> None:
    window = {"follow": "disk", "direction": "y", "ahead": 1.0, "behind": 0.5}
    domain = {"lower": [0.0, 0.0], "upper": [1.0, 9.0], "window": window}
    with pytest.raises(SceneError, match=r"scalar: one with a window"):
        model_of(scene({"boundary": [], "expansion": None}, domain=domain))


def test_a_disk_that_crosses_periodic_surfaces_takes_its_content_along() -> None:
    """Of the disk and the fluid together nothing is lost, where nothing goes through the walls."""
    crossing = scene(
        {"boundary": [], "expansion": None, "initial": "1 + 0.5*cos(2*pi*x)*y", "body": HOT},
        fluid={"density": 1.0, "viscosity": 0.5},
        boundary=[{"on": "left", "type": "periodic", "pressure_drop": 6.0}, {"on": "right", "type": "periodic"}],
        body=[{"type": "sphere", "name": "disk", "radius": 0.12, "density": 1.0, "position": [0.9, 0.8]}],
        mesh={"size": 0.2, "size_body": 0.06},
        time={"end": 1.0, "step": 0.05},
        output={"every": 1.0},
    )
    history = rigidfluid.run(crossing)
    assert history.bodies["x"][-1] > 1.12
    disk = history.scalar_fluxes["surface"] == "disk"
    whole = history.scalar["content"] + 2.0 * np.pi * 0.12**2 * history.scalar_fluxes["value"][disk]
    assert np.ptp(whole) < 1e-11 * whole[0]
    assert history.scalar_fluxes["value"][disk][-1] < 2.0


PERIODIC = [{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}]


def test_nothing_is_held_where_the_domain_is_periodic() -> None:
    """By a table on all surfaces: a scalar that differs in y alone does not see the seam."""
    held = [{"on": "all", "value": 1.0}]
    posed = scene({"boundary": held, "initial": "1 + y", "body": []}, boundary=PERIODIC)
    fluid = model_of(posed).fluid
    assert fluid.scalar is not None
    assert sorted(fluid.scalar.on_faces) == ["bottom", "top"]
    with pytest.raises(SceneError, match=r"scalar.boundary.0.on: found 'right', which is periodic"):
        model_of(scene({"boundary": [{"on": "right", "flux": 1.0}]}, boundary=PERIODIC))


def test_bodies_do_not_enter_or_leave_a_fluid_with_a_scalar() -> None:
    with pytest.raises(SceneError, match=r"scalar: found together with bodies that enter or leave"):
        model_of(scene(sink=[{"on": "top"}]))


def test_a_model_of_objects_has_one_too(tmp_path: Path) -> None:
    """And a run of it is resumed."""
    made = model_of(scene(time={"end": 0.02, "step": 0.01}))
    assert isinstance(made.fluid, Fluid)

    def hot(time: float, points: FloatArray) -> FloatArray:
        return np.full(len(points), 1.0)

    scalar = Scalar(0.02, hot, expansion=0.05, on_bodies={"disk": ScalarOnSurface(value=hot)})
    model = replace(made, fluid=replace(made.fluid, scalar=scalar))
    history = rigidfluid.run(model, tmp_path)
    assert history.scalar["greatest"][-1] == pytest.approx(1.0)
    with pytest.raises(SceneError, match=r"scalar.on: found 'dsk'"):
        replace(made, fluid=replace(made.fluid, scalar=Scalar(0.02, hot, on_bodies={"dsk": ScalarOnSurface(hot)})))
    with pytest.raises(SceneError, match=r"scalar.initial: found values of shape \(2, 2\)"):
        replace(made, fluid=replace(made.fluid, scalar=Scalar(0.02, lambda time, points: points)))


@pytest.mark.parametrize("key", ["value", "flux"])
@pytest.mark.parametrize("on", ["on_faces", "on_bodies"])
@pytest.mark.parametrize("wrong", [lambda time, points: points, lambda time, points: np.full(len(points), np.nan)])
def test_a_function_with_no_numbers_on_a_surface_is_told_by_name(key: str, on: str, wrong: Any) -> None:
    made, name = model_of(scene(time={"end": 0.01, "step": 0.01})), {"on_faces": "left", "on_bodies": "disk"}[on]
    assert isinstance(made.fluid, Fluid)
    surface = ScalarOnSurface(**{key: wrong, "field": f"scalar.{on}.{name}"})
    scalar = Scalar(0.02, lambda time, points: np.ones(len(points)), **{on: {name: surface}})
    with pytest.raises(SceneError, match=rf"scalar.{on}.{name}.{key}: found values of shape"):
        rigidfluid.run(replace(made, fluid=replace(made.fluid, scalar=scalar)))


def test_a_backend_without_scalars_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScikitFem, "scalars", FluidBackend.scalars)
    with pytest.raises(SceneError, match=r"scalar: found one with backend 'scikit-fem'"):
        model_of(scene())


def test_a_steady_start_with_buoyancy_is_refused() -> None:
    fluid = {"density": 1.0, "viscosity": 0.05, "gravity": [0.0, -9.81], "initial": "steady"}
    with pytest.raises(SceneError, match=r"fluid.initial"):
        model_of(scene(fluid=fluid))
    assert isinstance(model_of(scene({"expansion": None}, fluid=fluid)), Model)
