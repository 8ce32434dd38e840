"""Size fields in scenes and in runs: named, handed over, added up, checked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from falling import falling_disk

from rigidfluid.api import Fluid, PartOptions, Scene, Simulation, SizeField, run, scene_from_dict
from rigidfluid.checks import check
from rigidfluid.checks.run_size import run_size
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.case.schema import json_schema
from rigidfluid.core.case.system import build_system
from rigidfluid.core.mesh.fluid_domain import fluid_domain_at
from rigidfluid.core.mesh.size.size_field import Sizes, wanted_size
from rigidfluid.core.mesh.size.size_interface import with_fields_at_rest
from rigidfluid.errors import PluginError, SceneError

Install = Callable[..., Path]
SHORT = {"time": {"step": 0.004, "end": 0.02}, "output": {"every": 0.02}}
MESH = {"size": 0.3, "size_body": 0.05, "remesh_every": 0.008}
FAST = {"velocity": [0.0, -10.0]}

BANDS = """
    import numpy as np
    from pydantic import Field
    from rigidfluid.api import PartOptions, SizeField, hookimpl

    class BandOptions(PartOptions):
        height: float = Field(description="Height of its middle [length]")
        size: float = Field(gt=0, description="Edge length there [length]")

    class Band(SizeField):
        name = "band"
        Options = BandOptions

        def edge_length(self, points, around, flow):
            return RESULT

    @hookimpl
    def rigidfluid_size_fields():
        return [Band]
"""
RIGHT = "self.options.size + 0.3 * np.abs(points[:, 1] - self.options.height)"


def fall(*fields: dict[str, object], **mesh: object) -> Scene:
    return falling_disk(**SHORT, body=FAST, mesh=MESH | mesh | {"field": list(fields)})


def cells_near(simulation: Simulation, point: tuple[float, float], radius: float = 0.2) -> int:
    mesh = simulation.state.mesh
    assert mesh is not None
    return int(np.sum(np.linalg.norm(mesh.points[mesh.cells].mean(axis=1) - point, axis=1) < radius))


class AboutThePoint(SizeField):
    """Nobody registers it."""

    name = "about the point"

    def edge_length(self, points, around, flow):  # type: ignore[no-untyped-def]
        return 0.02 + 0.2 * np.linalg.norm(points - (1.0, 1.0), axis=1)


@pytest.mark.long
def test_later_meshes_are_fine_where_the_fluid_turns_and_the_first_is_as_without() -> None:
    plain, followed = (Simulation(fall(*fields)) for fields in ((), ({"type": "vorticity", "size": 0.01},)))
    np.testing.assert_array_equal(plain.state.mesh.points, followed.state.mesh.points)
    for simulation in (plain, followed):
        simulation.go()
    disk = tuple(followed.bodies["disk"].position)
    assert cells_near(followed, disk) > 4 * cells_near(plain, disk)
    assert cells_near(followed, (1.0, 1.0), 0.5) < 1.5 * cells_near(plain, (1.0, 1.0), 0.5)


@pytest.mark.long
def test_a_higher_threshold_asks_for_fewer_cells() -> None:
    runs = [Simulation(fall({"type": "vorticity", "size": 0.01, "threshold": bound})) for bound in (0.1, 0.4)]
    for simulation in runs:
        simulation.go()
    strict, lax = (len(simulation.state.mesh.cells) for simulation in runs)
    assert strict > 1.5 * lax


def test_of_several_fields_the_least_size_counts(install: Install) -> None:
    install(BANDS.replace("RESULT", RIGHT), name="bands", module="bands")
    scene = fall(*({"type": "band", "height": height, "size": 0.04} for height in (1.0, 5.0)))
    system, points = build_system(scene), np.random.default_rng(0).uniform((0.0, 0.0), (2.0, 6.0), (500, 2))
    around, plain = fluid_domain_at(system, system.pose), Sizes(0.3, 0.05)
    low, high = (0.04 + 0.3 * np.abs(points[:, 1] - height) for height in (1.0, 5.0))
    expected = np.minimum(wanted_size(points, around, plain), np.minimum(low, high))
    found = wanted_size(points, around, with_fields_at_rest(plain, model_of(scene).fluid.size_fields, around))
    np.testing.assert_array_equal(found, expected)
    assert (low == found).any()
    assert (high == found).any()
    assert cells_near(Simulation(scene), (1.0, 1.0)) > 4 * cells_near(Simulation(fall()), (1.0, 1.0))


def test_an_object_that_nobody_registered_makes_cells() -> None:
    plain = model_of(fall())
    assert isinstance(plain.fluid, Fluid)
    fluid = replace(plain.fluid, size_fields=[AboutThePoint(PartOptions(), 2)])
    plain, handed = Simulation(plain), Simulation(replace(plain, fluid=fluid))
    assert cells_near(handed, (1.0, 1.0)) > 10 * cells_near(plain, (1.0, 1.0))


def test_the_check_counts_the_cells_that_a_field_asks_for_at_the_start(install: Install) -> None:
    install(BANDS.replace("RESULT", RIGHT), name="bands", module="bands")
    scene = fall({"type": "band", "height": 1.0, "size": 0.02})
    assert scene.mesh is not None
    size = run_size(model_of(scene), build_system(scene), scene.mesh)
    assert size is not None
    assert size.start.cells == pytest.approx(len(Simulation(scene).state.mesh.cells), rel=0.2)


def test_the_check_says_whether_a_scene_has_size_fields() -> None:
    for fields, on, named in (((), False, "none"), (({"type": "vorticity", "size": 0.1},), True, "'vorticity'")):
        told = {feature.name: feature for feature in check(fall(*fields)).features}["cells by size fields"]
        assert (told.on, told.why) == (on, f"[[mesh.field]] names {named}")


@pytest.mark.parametrize(
    ("table", "field"),
    [
        ({"type": "vortisity", "size": 0.1}, "mesh.field.0.type"),
        ({"type": "vorticity", "size": 0.1, "treshold": 1.0}, "mesh.field.0.treshold"),
        ({"type": "vorticity", "size": 0.0}, "mesh.field.0.size"),
        ({"type": "vorticity"}, "mesh.field.0.size"),
    ],
)
def test_a_table_that_cannot_be_is_refused_by_its_key(table: dict[str, object], field: str) -> None:
    with pytest.raises((SceneError, PluginError)) as caught:
        fall(table)
    assert caught.value.subject == field


@pytest.mark.parametrize(
    ("result", "told"),
    [
        ("-(" + RIGHT + ")", "found -0.*; allowed is numbers above 0"),
        ("np.nan * points[:, 0]", "found nan; allowed is finite numbers"),
        ("np.inf + points[:, 0]", "found inf; allowed is finite numbers"),
        ("points", r"found an array of float64 of shape \(18, 2\); allowed is .* of real numbers of shape \(18,\)"),
    ],
)
def test_lengths_that_are_none_are_refused_by_name(install: Install, result: str, told: str) -> None:
    install(BANDS.replace("RESULT", result), name="bands", module="bands")
    with pytest.raises(PluginError, match=f"size field 'band', edge_length: {told}"):
        Simulation(fall({"type": "band", "height": 1.0, "size": 0.04}))


def test_a_scene_without_fields_is_written_as_before_there_were_any() -> None:
    assert "field" not in fall().to_dict()["mesh"]
    assert fall({"type": "vorticity", "size": 0.1}).to_dict()["mesh"]["field"] == [{"type": "vorticity", "size": 0.1}]


@pytest.mark.long
def test_a_resumed_run_makes_the_same_meshes(tmp_path: Path) -> None:
    scene = fall({"type": "vorticity", "size": 0.02}).to_dict() | {"output": {"every": 0.012}}
    whole = run(scene_from_dict(scene), tmp_path / "whole")
    run(scene_from_dict(scene | {"time": scene["time"] | {"end": 0.012}}), tmp_path / "parts")
    resumed = run(scene_from_dict(scene), tmp_path / "parts", resume=True)
    assert resumed.summary["remeshes"] == whole.summary["remeshes"] == 2
    for name, column in whole.bodies.items():
        np.testing.assert_array_equal(resumed.bodies[name], column)


def test_the_schema_knows_the_keys_of_each_field() -> None:
    conditions = json_schema()["$defs"]["SizeFieldTable"]["allOf"]
    (vorticity,) = [
        one["then"] for one in conditions if one["if"].get("properties") == {"type": {"const": "vorticity"}}
    ]
    assert set(vorticity["properties"]) == {"size", "threshold"}
