"""What `check` says of the memory that a run takes, and how well it expects the cells of a mesh."""

from __future__ import annotations

import numpy as np
import pytest
from falling import SCENES, falling_disk

from rigidfluid.backends.dry import Dry
from rigidfluid.checks import Finding, check
from rigidfluid.checks import memory as asked
from rigidfluid.core.mesh.cell_count import expected_cells
from rigidfluid.core.run.mesh_keys import sizes_of
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.load import load_scene

FINE_SPHERE = ["mesh.size=1.0", "mesh.size_body=0.1", "mesh.growth=0.2"]
COARSE_SPHERE = ["mesh.size=3.0", "mesh.size_body=0.6"]


def findings(scene: Scene) -> list[Finding]:
    return [one for one in check(scene).findings if one.question == "memory"]


@pytest.mark.parametrize(
    "scene",
    [
        falling_disk(),
        falling_disk(body={"position": [1.0, 0.14]}, mesh={"cells_per_gap": 4}),
        load_scene(SCENES / "falling_disk_window.toml"),
        load_scene(SCENES / "dfg_2d3.toml"),
        load_scene(SCENES / "wavy_channel.toml"),
        load_scene(SCENES / "falling_sphere.toml", COARSE_SPHERE),
    ],
    ids=["disk", "narrow gap", "window", "boxes of finer cells", "curved domain", "sphere"],
)
def test_cells_are_expected_within_a_fifth(scene: Scene) -> None:
    simulation = Simulation(scene)
    system, mesh = simulation.system, simulation.state.mesh
    assert mesh is not None
    assert scene.mesh is not None
    given = system.meshed(system.pose), system.bodies, system.pose, system.walls, sizes_of(scene.mesh, system.domain)
    assert expected_cells(*given) == pytest.approx(len(mesh.cells), rel=0.2)


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
    assert Dry.solver_cost(Dry.__new__(Dry), 1.0) is None


def test_cells_that_no_machine_holds_are_counted_all_the_same() -> None:
    scene = load_scene(SCENES / "falling_sphere.toml", ["mesh.size=0.01", "mesh.size_body=0.001", "mesh.growth=0.2"])
    (finding,) = findings(scene)
    assert finding.grade == "warning"
    assert float(finding.found["cells"] or 0.0) == pytest.approx(11.2 * 960.0 / 0.01**3, rel=0.2)
    assert np.isfinite(float(finding.found["memory"] or np.inf))
