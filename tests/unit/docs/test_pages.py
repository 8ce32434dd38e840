"""Examples on the pages run."""

from __future__ import annotations

import ast
import importlib
import json
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from linked_runs import body, linked_scene
from page_sections import blocks, section, text
from paths import ROOT, SCENES
from typer.testing import CliRunner

import rigidfluid
from rigidfluid.api import Fluid, OutputError, Simulation, TimeTable, model_of, scene_from_dict
from rigidfluid.cli import app
from rigidfluid.post.reports.report import report
from rigidfluid.registry import DOMAIN, FORCE_LAW, GROUP, Registry

pytestmark = pytest.mark.long

Install = Callable[..., Path]
COARSE = ["time.end=0.2", "time.step=0.004", "mesh.size_body=0.05", "output.every=0.2"]


def test_the_example_of_a_plug_in_runs(install: Install) -> None:
    page = text("docs/plugins.md")
    law = section(page, "A force law, from nothing")
    project, scene_table = (tomllib.loads(block) for block in blocks(law, "toml"))
    (name, module), *_ = project["project"]["entry-points"][GROUP].items()
    install(blocks(law, "python")[0], name=name, module=module)
    assert Registry.load().get(FORCE_LAW, "linear").__doc__
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=0.01"]).to_dict()
    scene["contact"] = scene_table["contact"]
    history = rigidfluid.run(rigidfluid.scene_from_dict(scene))
    assert history.bodies["cfx"].any()


def refuse_failed_contract(folder: Path, code: str, test: Path) -> None:
    """Fail if a contract on a page does not hold for the modules in a ``folder``."""
    test.write_text(code)
    path = os.pathsep.join([str(folder), *filter(None, sys.path)])
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(test)]
    done = subprocess.run(command, env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert "passed" in done.stdout


def test_the_contract_of_the_example_law_holds(install: Install, tmp_path: Path) -> None:
    page = text("docs/plugins.md")
    folder = install(blocks(section(page, "A force law, from nothing"), "python")[0], module="rigidfluid_linear")
    (contract,) = blocks(section(page, "Its test"), "python")
    refuse_failed_contract(folder, contract, tmp_path / "test_linear.py")


def test_the_example_of_a_body_runs(install: Install, tmp_path: Path) -> None:
    """It falls onto the floor of a box, dry, comes back, and keeps its energy; its contract holds."""
    example = section(text("docs/plugins.md"), "A body, from nothing")
    code, contract = blocks(example, "python")
    (table,) = (tomllib.loads(block)["body"] for block in blocks(example, "toml"))
    folder = install(code, name="capsule", module="rigidfluid_capsule")
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=0.06", "time.step=2e-4"]).to_dict()
    scene["contact"] = {"law": "normal", "range": 0.02, "epsilon": "auto"}
    history = rigidfluid.run(rigidfluid.scene_from_dict(scene | {"body": [table[0] | {"velocity": [0.0, -3.0]}]}))
    assert history.bodies["vy"].max() > 0.0
    assert abs(history.summary["energy"]["relative_residual"]) < 1e-3
    refuse_failed_contract(folder, contract, tmp_path / "test_capsule.py")


def test_the_example_of_a_model_runs(install: Install, tmp_path: Path) -> None:
    """Nothing in it is registered but the shape; it goes on from a checkpoint, and its report is made in Python."""
    (code,) = blocks(text("docs/models.md"), "python")
    install(blocks(section(text("docs/plugins.md"), "A domain, from nothing"), "python")[0], module="rigidfluid_dish")
    names: dict[str, Any] = {}
    exec(code, names)
    model, whole = names["model"], names["history"]
    assert whole.bodies["y"][-1] < 0.0
    assert abs(whole.summary["energy"]["relative_residual"]) < 0.01
    rigidfluid.run(replace(model, time=TimeTable(end=0.1, step=0.02)), tmp_path)
    resumed = rigidfluid.run(model, tmp_path, resume=True)
    np.testing.assert_array_equal(resumed.bodies["y"], whole.bodies["y"])
    assert report(tmp_path, model=model)[-1].exists()
    with pytest.raises(OutputError, match="results of the model 'model', made in Python"):
        report(tmp_path)


def test_the_example_of_a_domain_runs(install: Install, tmp_path: Path) -> None:
    """A disk falls in the round container, stays inside, and all energy is accounted for; its contract holds."""
    example = section(text("docs/plugins.md"), "A domain, from nothing")
    code, contract = blocks(example, "python")
    (domain,) = (tomllib.loads(block) for block in blocks(example, "toml"))
    folder = install(code, name="dish", module="rigidfluid_dish")
    assert Registry.load().get(DOMAIN, "dish").__doc__
    scene = rigidfluid.load_scene(SCENES / "falling_disk.toml", COARSE).to_dict()
    scene |= domain | {"body": [{"type": "sphere", "radius": 0.125, "density": 1.25, "position": [0.3, -0.6]}]}
    history = rigidfluid.run(rigidfluid.scene_from_dict(scene))
    assert np.all(np.hypot(history.bodies["x"], history.bodies["y"]) + 0.125 < 1.0)
    assert history.bodies["y"][-1] < -0.7
    energy = history.summary["energy"]
    assert max(energy["created"], energy["lost"]) < 0.01
    refuse_failed_contract(folder, contract, tmp_path / "test_dish.py")


def test_the_example_of_a_mechanism_runs(install: Install, tmp_path: Path) -> None:
    page = section(text("docs/plugins.md"), "A mechanism, from nothing")
    code, contract, driven = blocks(page, "python")
    (table,) = (tomllib.loads(block)["mechanism"] for block in blocks(page, "toml"))
    code = code.replace("@hookimpl", f"{driven}\n\n@hookimpl").replace("return [Dumbbell]", "return [Dumbbell, Stroke]")
    folder = install(code, name="dumbbell", module="rigidfluid_dumbbell")
    base = rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=0.01"]).to_dict()
    for kind in ("dumbbell", "stroke"):
        scene = rigidfluid.scene_from_dict(base | {"body": [], "mechanism": [table[0] | {"type": kind}]})
        names = rigidfluid.run(scene).bodies["body"]
        assert set(names) == {"dumbbell", "dumbbell.left", "dumbbell.right"}
    both = "params=[(Dumbbell, 2), (Dumbbell, 3), (Stroke, 2), (Stroke, 3)]"
    of_both = (
        contract.replace("import Dumbbell,", "import Dumbbell, Stroke,")
        .replace("params=[2, 3]", both)
        .replace("return Dumbbell(", "return request.param[0](")
        .replace("request.param)", "request.param[1])")
    )
    refuse_failed_contract(folder, of_both, tmp_path / "test_dumbbell.py")


def imports_the_public_face_alone(code: str) -> bool:
    """Whether a module takes from the library what `rigidfluid.api` and `rigidfluid.testing` offer."""
    homes = {node.module for node in ast.walk(ast.parse(code)) if isinstance(node, ast.ImportFrom) and node.module}
    return {home for home in homes if home.split(".")[0] == "rigidfluid"} <= {"rigidfluid.api", "rigidfluid.testing"}


def test_the_example_of_a_domain_with_obstacles_runs(install: Install, tmp_path: Path) -> None:
    """A ball that falls onto a post, dry, comes to rest nowhere in it; its contract holds."""
    page = text("docs/plugins.md")
    install(blocks(section(page, "A domain, from nothing"), "python")[0], name="dish", module="rigidfluid_dish")
    example = section(page, "A domain with obstacles")
    code, contract = blocks(example, "python")
    assert imports_the_public_face_alone(code + contract)
    (domain,) = (tomllib.loads(block) for block in blocks(example, "toml"))
    folder = install(code, name="posts", module="rigidfluid_posts")
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=0.5", "time.step=1e-3"]).to_dict()
    scene["contact"] = {"law": "normal", "range": 0.02, "epsilon": "auto"}
    ball = {"type": "sphere", "radius": 0.1, "density": 1.5, "position": [0.5, 0.5]}
    history = rigidfluid.run(rigidfluid.scene_from_dict(scene | domain | {"body": [ball], "boundary": []}))
    distance = np.hypot(history.bodies["x"] - 0.5, history.bodies["y"] - 0.1)
    assert 0.3 < distance.min() < 0.32
    assert history.bodies["vy"].max() > 0.0
    refuse_failed_contract(folder, contract, tmp_path / "test_posts.py")


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"name": "rim"}, "domain.post.0.name"),
        ({"position": [0.9, 0.1]}, "domain.post.0.position"),
        ({"position": [2.0, 0.1]}, "domain.post.0.position"),
        ({"radios": 0.2}, "domain.post.0.radios"),
        ({"position": [0.5]}, "domain.post.0.position"),
    ],
)
def test_the_obstacles_of_a_strangers_domain_are_checked_as_our_own(
    install: Install, change: dict[str, object], field: str
) -> None:
    page = text("docs/plugins.md")
    install(blocks(section(page, "A domain, from nothing"), "python")[0], name="dish", module="rigidfluid_dish")
    example = section(page, "A domain with obstacles")
    install(blocks(example, "python")[0], name="posts", module="rigidfluid_posts")
    (domain,) = (tomllib.loads(block)["domain"] for block in blocks(example, "toml"))
    domain["post"][0] |= change
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml").to_dict() | {"domain": domain, "boundary": []}
    with pytest.raises(rigidfluid.errors.SceneError) as caught:
        rigidfluid.scene_from_dict(scene)
    assert caught.value.subject == field


def test_the_example_of_a_mechanism_from_tables_runs(install: Install, tmp_path: Path) -> None:
    """Its components go apart as the rows say, about the common centre of mass; its contract holds."""
    example = section(text("docs/plugins.md"), "A mechanism from tables")
    code, contract = blocks(example, "python")
    assert imports_the_public_face_alone(code + contract)
    (table,) = (tomllib.loads(block) for block in blocks(example, "toml"))
    folder = install(code, name="breathing", module="rigidfluid_breathing")
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=0.4", "time.step=0.01"]).to_dict()
    history = rigidfluid.run(
        rigidfluid.scene_from_dict(scene | {"body": [], "contact": {}, "fluid": {"backend": "dry"}} | table)
    )
    left, right = (history.bodies["x"][history.bodies["body"] == f"lung.{name}"] for name in ("left", "right"))
    assert right[0] - left[0] == pytest.approx(0.2)
    assert right[-1] - left[-1] == pytest.approx(0.4)
    refuse_failed_contract(folder, contract, tmp_path / "test_breathing.py")


def test_a_file_of_rows_drives_a_strangers_mechanism(install: Install, tmp_path: Path) -> None:
    example = section(text("docs/plugins.md"), "A mechanism from tables")
    install(blocks(example, "python")[0], name="breathing", module="rigidfluid_breathing")
    (table,) = (tomllib.loads(block) for block in blocks(example, "toml"))
    rows = tmp_path / "rows.csv"
    rows.write_text("0.0, 0.0\n0.2, 0.05\n0.4, 0.0\n")
    table["mechanism"][0]["stroke"] = {"piecewise": {"file": str(rows)}}
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=0.2", "time.step=0.01"]).to_dict()
    history = rigidfluid.run(
        rigidfluid.scene_from_dict(scene | {"body": [], "contact": {}, "fluid": {"backend": "dry"}} | table)
    )
    left, right = (history.bodies["x"][history.bodies["body"] == f"lung.{name}"] for name in ("left", "right"))
    assert right[-1] - left[-1] == pytest.approx(0.3)


def test_the_example_of_a_joint_runs(install: Install, tmp_path: Path) -> None:
    """A ball on the sleeve swings along its axis, and goes on turning about it; its contract holds."""
    page = section(text("docs/plugins.md"), "A joint, from nothing")
    code, contract = blocks(page, "python")
    (table,) = (tomllib.loads(block)["joint"] for block in blocks(page, "toml"))
    folder = install(code, name="sleeve", module="rigidfluid_sleeve")
    piston = body(2.0, 2.0, 2.0, name="piston", velocity=[0.0, 0.0, 1.0], angular_velocity=[0.0, 0.0, 3.0])
    history = rigidfluid.run(linked_scene([piston], table, step=5e-4, end=0.2))
    frequency = np.sqrt(2.0 / (4.0 / 3.0 * np.pi * 1e-3))
    expected = np.sin(frequency * history.joints["time"]) / frequency
    np.testing.assert_allclose(history.joints["displacement"], expected, atol=1e-4)
    np.testing.assert_allclose(history.bodies["wz"], 3.0)
    refuse_failed_contract(folder, contract, tmp_path / "test_sleeve.py")


def test_the_example_of_a_size_field_runs(install: Install, tmp_path: Path) -> None:
    """Cells next to a fast disk are finer in the second mesh, named in the scene or handed over; its contract holds."""
    example = section(text("docs/plugins.md"), "A size field, from nothing")
    code, contract = blocks(example, "python")
    assert imports_the_public_face_alone(code + contract)
    (table,) = (tomllib.loads(block)["mesh"]["field"] for block in blocks(example, "toml"))
    folder = install(code, name="fast", module="rigidfluid_fast")
    scene = rigidfluid.load_scene(SCENES / "falling_disk.toml", [*COARSE, "mesh.remesh_every=0.004"]).to_dict()
    scene["body"][0]["velocity"] = [0.0, -10.0]
    plain, named = scene_from_dict(scene), scene_from_dict(scene | {"mesh": scene["mesh"] | {"field": table}})
    module = importlib.import_module("rigidfluid_fast")
    model = model_of(plain)
    assert isinstance(model.fluid, Fluid)
    fluid = replace(model.fluid, size_fields=[module.Fast(module.FastOptions(size=0.03), 2)])
    simulations = [Simulation(each) for each in (plain, named, replace(model, fluid=fluid))]
    for simulation in simulations:
        simulation.go(0.012)
    without, *with_it = (len(simulation.state.mesh.cells) for simulation in simulations)
    assert with_it[0] == with_it[1] > 1.2 * without
    refuse_failed_contract(folder, contract, tmp_path / "test_fast.py")


def test_the_example_of_a_command_runs(install: Install, tmp_path: Path) -> None:
    page = section(text("docs/plugins.md"), "A command, from nothing")
    (code,), (points,) = blocks(page, "python"), blocks(page, "toml")
    points = points.replace("project.entry-points.", "").replace('"', "")
    install(code, name="weigh", module="rigidfluid_weigh", entry_points=points)
    file = tmp_path / "masses.json"
    arguments = ["weigh", str(SCENES / "dry_bounce.toml"), "--set", "body.0.density=2", "--json", str(file)]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.splitlines() == ["left_disk 0.06283", "right_disk 0.03142"]
    assert json.loads(file.read_text()) == pytest.approx({"left_disk": 0.02 * np.pi, "right_disk": 0.01 * np.pi})


def test_the_example_of_control_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    example, _ = blocks(text("docs/control.md"), "python")
    coarse = '["time.end=2", "mesh.size=0.1", "mesh.size_body=0.05"]'
    exec(example.replace('["time.end=2"]', coarse), {})
    printed = capsys.readouterr().out
    assert printed.startswith("1.0 [")
    assert len(printed.splitlines()) == 2


def test_the_example_of_a_closed_loop_holds_the_disk(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    example = blocks(section(text("docs/control.md"), "A closed loop"), "python")[0]
    assert "mesh.size_body=0.04" in example
    exec(example.replace('"mesh.size_body=0.04"', '"mesh.size_body=0.1", "mesh.size=0.5"'), {})
    height, work, residual = map(float, re.findall(r"-?\d+\.\d+(?:e-\d+)?", capsys.readouterr().out)[1:])
    assert height == pytest.approx(4.2, abs=5e-3)
    assert work == pytest.approx(2.607, rel=0.02)
    assert abs(residual) < 1e-3 * work
