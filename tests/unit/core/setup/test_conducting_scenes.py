"""Scenes with bodies that conduct a scalar inside: balances through new meshes, resumed runs, shapes, and refusals."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigidfluid
from rigidfluid.api import Fluid, FluidBackend, Scalar, ScalarOnSurface, load_results, model_of
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.bodies.ellipsoid import Ellipsoid
from rigidfluid.bodies.sphere import Sphere
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.mesh.generation.inside import inside_mesh
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.output.vtu import read_pvd
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.core.setup.features import features
from rigidfluid.errors import MeshError, SceneError
from rigidfluid.taylor_hood.elements.facet_integrals import area_at_points

DISK: dict[str, Any] = {"type": "sphere", "name": "disk", "radius": 0.15, "density": 1.2, "position": [0.5, 1.4]}
CONDUCTS: dict[str, Any] = {"on": "disk", "value": "1 + 4*(x - 0.5)", "capacity": 2.0, "conductivity": 0.5}
WHOLE = 2.0 * np.pi * 0.15**2
"""Capacity of the disk."""


def scene(*bodies: dict[str, Any], **tables: Any) -> rigidfluid.Scene:
    """A warm disk that falls and turns in a closed box 1 by 2, whose walls nothing passes."""
    common: dict[str, Any] = {
        "scene": {"name": "falls", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 0.05, "gravity": [0.0, -9.81]},
        "scalar": {"diffusivity": 0.02, "initial": "0.1*x", "expansion": 0.05, "body": [*bodies] or [CONDUCTS]},
        "domain": {"lower": [0.0, 0.0], "upper": [1.0, 2.0]},
        "body": [{**DISK, "angular_velocity": 20.0}],
        "mesh": {"size": 0.25, "size_body": 0.08, "remesh_every": 0.05},
        "time": {"end": 0.12, "step": 0.01},
        "output": {"every": 0.06},
    }
    return scene_from_dict(common | tables)


def whole_content(history: Any, capacity: float = WHOLE) -> Any:
    """Content of the fluid and of the disk after each step."""
    disk = history.scalar_fluxes["surface"] == "disk"
    return history.scalar["content"] + capacity * history.scalar_fluxes["inside"][disk]


def test_disk_and_fluid_keep_their_content_through_new_meshes() -> None:
    history = rigidfluid.run(scene())
    account, fluxes = history.scalar, history.scalar_fluxes
    disk = fluxes["surface"] == "disk"
    assert history.steps["remeshes"][-1] >= 2
    assert history.bodies["angle"][-1] > 0.5
    assert np.abs(account["imbalance"]).max() < 1e-9 * account["content"].max() / 0.01
    assert np.ptp(whole_content(history)) < 1e-12
    assert np.all(fluxes["flux"][disk] > 0.0)
    assert np.all(fluxes["inside"][disk] > fluxes["value"][disk])  # it cools from its surface
    assert account["greatest"][-1] > 1.2  # inside
    walls = ~disk
    np.testing.assert_array_equal(fluxes["inside"][walls], fluxes["value"][walls])


def test_a_disk_that_conducts_well_falls_as_one_with_one_value() -> None:
    well, lumped = (
        rigidfluid.run(scene({"on": "disk", "value": 1.0, "capacity": 2.0, **more}, time={"end": 0.06, "step": 0.01}))
        for more in ({"conductivity": 1e4}, {})
    )
    for name in ("least", "greatest", "content"):
        np.testing.assert_allclose(well.scalar[name], lumped.scalar[name], rtol=2e-4, atol=1e-5)
    np.testing.assert_allclose(well.scalar_fluxes["inside"], lumped.scalar_fluxes["inside"], rtol=2e-4, atol=1e-6)
    np.testing.assert_allclose(well.bodies["vy"], lumped.bodies["vy"], rtol=1e-5, atol=1e-6)


def test_a_run_is_resumed_to_the_last_bit(tmp_path: Path) -> None:
    rigidfluid.run(scene(), tmp_path / "whole")
    rigidfluid.run(scene(time={"end": 0.06, "step": 0.01}), tmp_path / "parts")
    rigidfluid.run(scene(), tmp_path / "parts", resume=True)
    for name in ("scalar.csv", "scalar_fluxes.csv", "bodies.csv", "energy.csv"):
        assert (tmp_path / "whole" / name).read_bytes() == (tmp_path / "parts" / name).read_bytes()
    assert np.ptp(whole_content(load_results(tmp_path / "parts"))) < 1e-12


def test_what_is_inside_is_a_block_of_the_fields_that_turns_with_the_disk(tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    history = rigidfluid.run(scene(), tmp_path)
    bodies, fluxes = history.bodies, history.scalar_fluxes
    series = read_pvd(tmp_path / "fields.pvd", "insides")
    assert [time for time, _ in series] == pytest.approx([0.0, 0.06, 0.12])
    start = None
    for time, path in series:
        row = np.argmin(np.abs(bodies["time"] - time))
        read = meshio.read(path)
        centre, angle = np.array([bodies["x"][row], bodies["y"][row]]), bodies["angle"][row]
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        own = (read.points[:, :2] - centre) @ turn
        start = own if start is None else start
        np.testing.assert_allclose(own, start, rtol=0.0, atol=1e-12)
        assert np.linalg.norm(own, axis=1).max() == pytest.approx(0.15, rel=1e-9)
        assert not read.point_data["body"].any()
        cells = read.cells_dict["triangle6"]
        shapes, area = area_at_points(read.points[cells], 4)
        mean = np.average(read.point_data["scalar"][cells] @ shapes.T, weights=area[:, :, 2])
        now = (fluxes["surface"] == "disk") & np.isclose(fluxes["time"], time)
        assert mean == pytest.approx(fluxes["inside"][now][0] if time > 0.0 else 1.0, rel=1e-5)


def test_probes_read_the_inside_of_the_disk_that_is_over_them_and_the_fluid_elsewhere() -> None:
    """At the start 1 + 4 (x - .5) inside; later what a disk of all but one value has everywhere."""
    probes = [[0.45, 1.45], [0.58, 1.36], [0.5, 1.4], [0.5, 0.3], [0.8, 1.4]]
    short = {"time": {"end": 0.02, "step": 0.01}, "output": {"every": 0.02, "probes": probes}}
    seen = rigidfluid.run(scene(**short)).probes["scalar"].reshape(-1, 5)
    np.testing.assert_allclose(seen[0, :3], [0.8, 1.32, 1.0], rtol=1e-9)
    np.testing.assert_allclose(seen[0, 3:], [0.05, 0.08], atol=1e-9)
    mixed = rigidfluid.run(scene({**CONDUCTS, "conductivity": 1e4}, **short))
    inside = mixed.scalar_fluxes["inside"][mixed.scalar_fluxes["surface"] == "disk"][-1]
    np.testing.assert_allclose(mixed.probes["scalar"].reshape(-1, 5)[-1, :3], inside, rtol=1e-3)


def test_probes_find_the_image_of_a_disk_across_periodic_surfaces_and_its_own_inside_among_several() -> None:
    seam = [{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}]
    same = {"capacity": 1.0, "conductivity": 1.0}
    values = {"on": "disk", "value": "1 + y"}, {"on": "other", "value": "7 + y"}
    second = {**DISK, "name": "other", "position": [0.5, 0.6], "fixed": True}
    history = rigidfluid.run(
        scene(
            scalar={"diffusivity": 0.02, "initial": "0.1*y", "body": [{**same, **one} for one in values]},
            body=[{**DISK, "position": [1.05, 1.4], "fixed": True}, second],
            boundary=seam,
            time={"end": 0.01, "step": 0.01},
            output={"every": 0.01, "probes": [[0.02, 1.45], [0.97, 1.35], [0.5, 0.65], [0.5, 1.0]]},
        )
    )
    start = history.probes["scalar"].reshape(-1, 4)[0]
    np.testing.assert_allclose(start, [2.45, 2.35, 7.65, 0.1], atol=1e-9)


def test_a_probe_beside_the_short_axis_of_an_ellipse_is_in_the_fluid() -> None:
    """Nearer to its centre than its ends are."""
    ellipse = {"type": "ellipsoid", "name": "disk", "semi_axes": [0.2, 0.08], "density": 1.2, "position": [0.5, 1.4]}
    seen = rigidfluid.run(
        scene(
            {**CONDUCTS, "value": 5.0},
            body=[{**ellipse, "fixed": True}],
            time={"end": 0.01, "step": 0.01},
            output={"every": 0.01, "probes": [[0.5, 1.53], [0.6, 1.4]]},
        )
    ).probes["scalar"]
    assert seen[0] < 4.0
    assert seen[1] == pytest.approx(5.0, rel=1e-9)


def in_periodic_channel(start: float) -> Any:
    """Results of a disk from x = ``start`` on, which a drop of pressure takes along through a few periods."""
    x = f"2*pi*(x - {start})"
    conducts = {**CONDUCTS, "value": f"3 + 2*sin({x}) + y"}
    return rigidfluid.run(
        scene(
            scalar={"diffusivity": 0.02, "initial": f"1 + 0.5*cos({x})*y", "body": [conducts]},
            fluid={"density": 1.0, "viscosity": 0.5, "model": "stokes"},
            boundary=[{"on": "left", "type": "periodic", "pressure_drop": 6.0}, {"on": "right", "type": "periodic"}],
            body=[{**DISK, "radius": 0.12, "density": 1.0, "position": [start, 0.8]}],
            mesh={"size": 0.2, "size_body": 0.06},
            time={"end": 0.6, "step": 0.05},
            output={"every": 0.6},
        )
    )


def test_a_disk_that_crosses_periodic_surfaces_takes_its_inside_along() -> None:
    """It has the same inside as one that starts elsewhere, and so crosses them at other times."""
    histories = [in_periodic_channel(start) for start in (0.9, 0.3)]
    for history in histories:
        whole = whole_content(history, 2.0 * np.pi * 0.12**2)
        assert history.bodies["x"][-1] > 3.0
        assert np.ptp(whole) < 1e-11 * whole[0]
    for name in ("inside", "value"):
        found, other = (each.scalar_fluxes[name][each.scalar_fluxes["surface"] == "disk"] for each in histories)
        np.testing.assert_allclose(found, other, rtol=3e-3)


def test_shapes_of_every_kind_conduct() -> None:
    """A prescribed ellipse and a fixed polygon."""
    shapes = scene(
        {"on": "all", "value": "y", "capacity": 1.5, "conductivity": 3.0},
        body=[
            {
                **{"type": "ellipsoid", "name": "ellipse", "semi_axes": [0.15, 0.08], "density": 1.2, "angle": 0.5},
                **{"position": [0.5, 1.5], "prescribed": {"angular_velocity": 3.0}},
            },
            {
                **{"type": "polygon", "name": "corner", "density": 1.2, "position": [0.5, 0.5], "fixed": True},
                "points": [[0.0, 0.0], [0.3, 0.0], [0.3, 0.1], [0.1, 0.1], [0.1, 0.3], [0.0, 0.3]],
            },
        ],
        time={"end": 0.03, "step": 0.01},
    )
    system = assemble(model_of(shapes))
    assert system.fluid is not None
    assert system.fluid.scalar is not None
    for body, condition in zip(system.bodies, system.fluid.scalar.conditions, strict=False):
        assert condition.conduction is not None
        farthest = np.linalg.norm(condition.conduction.inside().points, axis=1).max()
        assert farthest == pytest.approx(body.bounding_radius)
    history = rigidfluid.run(shapes)
    fluxes = history.scalar_fluxes
    whole = history.scalar["content"].copy()
    for name, volume in (("ellipse", np.pi * 0.15 * 0.08), ("corner", 0.05)):
        inside = fluxes["inside"][fluxes["surface"] == name]
        assert np.abs(np.diff(inside)).min() > 0.0
        whole += 1.5 * volume * inside
    assert np.ptp(whole) < 1e-12


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"on": "disk", "value": 1.0, "conductivity": 2.0}, r"scalar.body.0.conductivity: found 2 without a capacity"),
    ({"on": "disk", "conductivity": 2.0}, r"scalar.body.0.conductivity: found 2 without a capacity"),
    ({**CONDUCTS, "conductivity": 0.0}, r"scalar.body.0.conductivity"),
    ({**CONDUCTS, "conductivity": -1.0}, r"scalar.body.0.conductivity"),
    ({**CONDUCTS, "value": None, "flux": 1.0}, r"scalar.body.0.flux: found a flux and a capacity"),
]


@pytest.mark.parametrize(("body", "message"), WRONG)
def test_what_is_wrong_is_told(body: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        model_of(scene({key: value for key, value in body.items() if value is not None}))


def test_a_surface_of_the_domain_does_not_conduct() -> None:
    wall = {"on": "left", "value": 1.0, "conductivity": 2.0}
    with pytest.raises(SceneError, match=r"scalar.boundary.0.conductivity"):
        model_of(scene(scalar={"diffusivity": 0.02, "boundary": [wall]}))
    made = model_of(scene())
    assert isinstance(made.fluid, Fluid)
    on = {"left": ScalarOnSurface(conductivity=2.0, field="scalar.left")}
    with pytest.raises(SceneError, match=r"scalar.left.conductivity: found 2.* one of bodies alone"):
        replace(made, fluid=replace(made.fluid, scalar=Scalar(0.02, lambda time, points: points[:, 0], on_faces=on)))


def test_other_backends_are_refused() -> None:
    with pytest.raises(SceneError, match=r"scalar: found one with backend 'dry'"):
        model_of(scene(fluid={"backend": "dry"}))


def test_a_backend_that_does_not_solve_inside_bodies_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScikitFem, "conduction", FluidBackend.conduction)
    with pytest.raises(SceneError, match=r"scalar.body.0.conductivity: found 0.5 with backend 'scikit-fem'"):
        model_of(scene())


def test_cells_inside_are_straight_for_a_backend_without_curved_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    curved = []
    for taken in (True, False):
        monkeypatch.setattr(ScikitFem, "curved_cells", taken)
        system = assemble(model_of(scene()))
        assert system.fluid is not None
        assert system.fluid.scalar is not None
        conduction = system.fluid.scalar.conditions[0].conduction
        assert conduction is not None
        curved.append(len(conduction.inside().curved))
    assert curved[0] > 0
    assert curved[1] == 0


def test_a_thin_ellipsoid_is_meshed_inside() -> None:
    """With edges of this length Netgen makes facets near the tips that cross; shorter ones are asked for then."""
    thin = Ellipsoid(Ellipsoid.Options(semi_axes=[0.2, 0.1, 0.05]), 3)
    mesh = inside_mesh(thin, Sizes(0.1, 0.04, 0.3), 60.0)
    corners = mesh.points[mesh.cells]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1]).sum() / 6.0
    assert 0.98 * thin.volume < volume < thin.volume


def test_a_shape_that_no_mesher_fills_is_refused_when_the_scene_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Sphere, "cad_shape", lambda self, unit: None)
    with pytest.raises(SceneError, match=r"scalar.body.0.conductivity: found 0.5 of a body of type 'sphere'"):
        model_of(scene())


def test_a_mesher_that_fails_inside_a_body_is_told_by_its_key(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any) -> None:
        raise MeshError("mesh", "Netgen failed", "a surface that it can fill", "")

    monkeypatch.setattr("rigidfluid.core.mesh.generation.inside.inside_mesh", fail)
    with pytest.raises(MeshError, match=r"scalar.body.0.conductivity: found Netgen failed"):
        Simulation(scene(), None)


def test_check_tells_how_many_bodies_conduct() -> None:
    told = {found.name: found.why for found in features(assemble(model_of(scene())), None)}
    assert told["scalar in the fluid"] == "with buoyancy; bodies that conduct: 1"
