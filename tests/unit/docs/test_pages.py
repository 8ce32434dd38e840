"""The pages are complete, their links lead somewhere, and their examples run."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from falling import SCENES
from linked_runs import body, linked_scene

import rigidfluid
from rigidfluid.core.output.records import columns
from rigidfluid.registry import DOMAIN, FORCE_LAW, GROUP, KINDS, Registry

ROOT = SCENES.parent
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
Install = Callable[..., Path]
COARSE = ["time.end=0.2", "time.step=0.004", "mesh.size_body=0.05", "output.every=0.2"]


def text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def section(page: str, title: str) -> str:
    return page.partition(f"\n## {title}\n")[2].partition("\n## ")[0]


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", page, flags=re.DOTALL)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("table", columns(2))
def test_every_column_is_explained(table: str, dimension: int) -> None:
    named = section(text("docs/results.md"), f"{table}.csv")
    assert [name for name in columns(dimension)[table] if f"`{name}`" not in named] == []


def test_every_figure_of_the_summary_is_explained() -> None:
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=2e-5"])
    named = section(text("docs/results.md"), "summary.json")
    assert [key for key in rigidfluid.run(scene).summary if f"`{key}`" not in named] == []


def test_every_hook_is_explained() -> None:
    page = text("docs/plugins.md")
    for kind in KINDS:
        for word in (kind.hook, kind.interface.__name__, kind.field):
            assert f"`{word}`" in page


def test_every_built_in_part_is_in_the_readme() -> None:
    page = text("README.md")
    built_in = [entry.name for entry in Registry.load().entries if entry.origin.startswith("rigidfluid ")]
    assert [name for name in built_in if f"`{name}`" not in page] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_to_files(page: Path) -> None:
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    assert [link for link in links if not (page.parent / link).exists()] == []


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


def test_the_picture_is_small() -> None:
    assert (ROOT / "docs" / "falling_disk.png").stat().st_size < 300 * 1024
