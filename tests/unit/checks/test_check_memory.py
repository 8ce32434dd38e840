"""What `check` says of the memory and the time that a run takes."""

from __future__ import annotations

import numpy as np
import pytest
from falling import SCENES

from rigidfluid.backends.dry import Dry
from rigidfluid.checks import Finding, check, run_time
from rigidfluid.checks import memory as asked
from rigidfluid.checks.machine_speed import machine_speed
from rigidfluid.checks.run_size import RunSize
from rigidfluid.core.case.load import load_scene
from rigidfluid.core.case.system import build_system
from rigidfluid.core.mesh.generation.cell_count import Count
from rigidfluid.core.model.types import SolverCost
from rigidfluid.core.scene.scene import Scene

FINE_SPHERE = ["mesh.size=1.0", "mesh.size_body=0.1", "mesh.growth=0.2"]
LYING = "body.0.orientation=[0.7547,0.0,0.0,0.6561]"
COARSE_SPHERE = ["mesh.size=3.0", "mesh.size_body=0.6"]


def findings(scene: Scene) -> list[Finding]:
    return [one for one in check(scene).findings if one.question == "memory"]


MEASURED = [  # scene, settings, unknowns at the start, most and memory [MiB] of the whole run
    ("falling_sphere", [], 66_923, 72_163, 1049),
    ("falling_sphere", ["mesh.size_body=0.4"], 18_005, 25_713, 903),
    ("falling_ellipsoid", [], 61_521, 63_666, 1074),
    ("falling_ellipsoid", ["body.0.position=[0.5,0.4,0.2]", LYING, "time.end=0.2"], 60_283, 63_666, 961),
    ("drafting_kissing_tumbling", ["time.step=0.0005", "time.end=0.31"], 32_441, 35_615, 444),
    ("ten_cate_e3", ["contact.epsilon=7.576e-8"], 356_442, 465_534, 2956),
    ("two_disks", ["mesh.size_body=0.04", "time.step=0.004"], 8_738, 9_542, 350),
]


@pytest.mark.parametrize(("name", "settings", "first", "most", "memory"), MEASURED, ids=str)
def test_the_worst_moment_is_that_of_whole_runs(
    name: str, settings: list[str], first: int, most: int, memory: int
) -> None:
    (finding,) = findings(load_scene(SCENES / f"{name}.toml", settings))
    assert finding.found["unknowns"] == pytest.approx(first, rel=0.1)
    assert finding.found["most_unknowns"] == pytest.approx(most, rel=0.15)
    assert finding.found["memory"] == pytest.approx(memory * 2**20, rel=0.15)


def test_it_tells_unknowns_memory_and_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(asked, "available_memory", lambda: np.inf)
    (finding,) = findings(load_scene(SCENES / "falling_sphere.toml", ["fluid.solver=lu", *FINE_SPHERE]))
    found = finding.found
    assert finding.grade == "note"
    assert found["method"] == "lu"
    assert found["unknowns"] == pytest.approx(248_705, rel=0.3)
    assert found["seconds"] == pytest.approx(88.0, rel=0.5)
    assert "GiB of memory" in finding.text
    assert f"{found['seconds']:.3g} s" in finding.text


@pytest.mark.parametrize(("solver", "grade"), [("lu", "warning"), ("schur", "note"), ("auto", "note")])
def test_more_than_is_available_is_a_warning(solver: str, grade: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(asked, "available_memory", lambda: 3e9)
    (finding,) = findings(load_scene(SCENES / "falling_sphere.toml", [f"fluid.solver={solver}", *FINE_SPHERE]))
    assert finding.grade == grade
    assert ('fluid.solver = "schur"' in finding.remedy) == (grade == "warning")
    assert finding.enough == ({"memory": 3e9} if grade == "warning" else {})


def test_without_a_mesh_nothing_is_asked() -> None:
    scene = load_scene(SCENES / "dry_bounce.toml")
    assert findings(scene) == []
    assert Dry.solver_cost(Dry.__new__(Dry), 1.0, 1.0) is None


def test_cells_that_no_machine_holds_are_counted_all_the_same() -> None:
    scene = load_scene(SCENES / "falling_sphere.toml", ["mesh.size=0.01", "mesh.size_body=0.001", "mesh.growth=0.2"])
    (finding,) = findings(scene)
    assert finding.grade == "warning"
    assert float(finding.found["cells"] or 0.0) == pytest.approx(11.1 * 960.0 / 0.01**3, rel=0.2)
    assert np.isfinite(float(finding.found["memory"] or np.inf))


def in_time(scene: Scene) -> Finding:
    (finding,) = [one for one in check(scene).findings if one.question == "time"]
    return finding


def test_the_time_is_that_of_all_steps_and_meshes_on_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_time, "machine_speed", lambda: 2.0)
    fast = in_time(load_scene(SCENES / "falling_disk.toml", ["time.end=0.9", "time.step=0.004"]))
    assert fast.found["steps"] == 225
    assert 9 <= fast.found["meshes"] <= 20  # whole runs made 10 to 13
    assert f"{fast.found['steps']} steps" in fast.text
    monkeypatch.setattr(run_time, "machine_speed", lambda: 1.0)
    slow = in_time(load_scene(SCENES / "falling_disk.toml", ["time.end=1.8", "time.step=0.004"]))
    assert slow.found["steps"] == 450
    for share in ("least", "most"):
        assert 3.0 < slow.found[share] / fast.found[share] < 4.0
    assert slow.found["most"] / slow.found["least"] < 10.0


def test_the_parts_of_a_run_add_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_time, "machine_speed", lambda: 1.0)
    count, cost = Count(1000.0, 100.0), SolverCost("lu", 4000.0, 1e9, seconds=0.02, step_seconds=0.01)
    size = RunSize(count, count, None, cost, cost, meshes=3, memory=1e9)
    smooth = 100 * 0.01 + 3 * (1000 * 3e-5 + 0.02)
    for name, contact in (("falling_disk", 0.005), ("ellipse_xia", 0.1), ("dfg_cylinder", 0.0)):
        scene = load_scene(SCENES / f"{name}.toml", ["time.end=1.0", "time.step=0.01"])
        (finding,) = run_time.run_time_findings(size, build_system(scene), scene.time)
        assert finding.found["least"] == pytest.approx(0.6 * smooth)
        assert finding.found["most"] == pytest.approx(4.5 * smooth + 100 * contact)


@pytest.mark.parametrize(("name", "least"), [("dfg_cylinder", 1), ("hundred_disks", 10), ("vortex_induced", 2)])
def test_what_moves_has_more_than_one_mesh(name: str, least: int) -> None:
    found = in_time(load_scene(SCENES / f"{name}.toml")).found
    meshes = found["meshes"]
    assert isinstance(meshes, int)
    assert meshes == 1 if least == 1 else meshes >= least


def test_the_speed_of_the_machine_is_measured() -> None:
    assert 0.02 < machine_speed() < 50.0
