"""Scenes made wrong on purpose end in a warning, each by its cause; their right twins end in none."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from scenes import dry_tables
from starts import DISK, INFLOW, disk_in_box

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Contacts
from rigidfluid.core.output.energy_account import NOTICEABLE, STABILISED
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import PluginError, RunWarning
from rigidfluid.forces.normal import NormalLaw
from rigidfluid.taylor_hood.backend import TaylorHoodBackend

SWAYING = {"prescribed": {"amplitude": [0.1, 0.0], "frequency": 1.0}}
FALLING = {"density": 2.0, "position": [0.7, 0.7]}
HEAVY = {"gravity": [0.0, -10.0]}


class Pair(NamedTuple):
    """A scene, by a value that makes it wrong and by one that makes it right, and what the warning names."""

    scene: Callable[[Any], Scene]
    wrong: Any
    right: Any
    told: str


def thrown(contact: dict[str, Any], **tables: Any) -> Scene:
    """A disk between walls, without a fluid."""
    tables = (
        dry_tables(
            DISK | {"radius": 0.1, "position": [0.5, 0.4], "velocity": [1.0, 0.3]},
            contact={"law": "normal", "range": 0.05, "epsilon": 1e-5} | contact,
        )
        | tables
    )
    return scene_from_dict(tables)


def pulsating(step: float, shape: str) -> Scene:
    inflow = [INFLOW[0] | {"velocity": [f"4*y*(1 - y)*{shape}", 0.0]}, INFLOW[1]]
    return disk_in_box(step, 1.0, boundary=inflow)


def stirred(size: float) -> Scene:
    """Thin layers on a disk that sways, carried to new meshes all the time, which keep the cells at the disk."""
    mesh = {"size": size, "size_body": 0.5 * size, "remesh_every": 0.02}
    body = {"prescribed": {"amplitude": [0.1, 0.0], "frequency": 2.0}}
    return disk_in_box(0.01, 0.3, body, {"viscosity": 2e-3}, mesh=mesh)


def at_once(step: float) -> Scene:
    """A disk that is moved from the first moment on, with cells that show its layer."""
    return disk_in_box(step, 0.4, {"prescribed": {"velocity": [0.5, 0.0]}}, mesh={"size": 0.15, "size_body": 0.03})


PAIRS = {
    "a stroke in five steps": Pair(lambda step: disk_in_box(step, 0.8, SWAYING), 0.1, 0.0125, "time.step too long"),
    "pulses in five steps": Pair(lambda step: pulsating(step, "(1 - cos(6.28*t))"), 0.2, 0.02, "time.step too long"),
    "pulses after a start at once": Pair(lambda step: pulsating(step, "(1 + sin(12*t))"), 0.1, 0.01, "time.step"),
    "a fall in four steps": Pair(lambda step: disk_in_box(step, 0.24, FALLING, HEAVY), 0.06, 0.01, "time.step"),
    "a start at once in two steps": Pair(at_once, 0.2, 0.0125, "in first steps"),
    "a time.tolerance too loose": Pair(
        lambda tolerance: disk_in_box(0.2, 0.6, SWAYING, time={"end": 0.6, "step": 0.2, "tolerance": tolerance}),
        *(0.1, 0.01, "time.step too long"),
    ),
    "a fluid.tolerance too loose": Pair(
        lambda tolerance: disk_in_box(0.01, 0.2, FALLING, HEAVY | {"tolerance": tolerance}), 0.3, 1e-9, "vanished"
    ),
    "a law too stiff for its substeps": Pair(
        lambda substeps: thrown({} if substeps is None else {"substeps": substeps}), 1, None, "at impacts"
    ),
    "meshes too coarse": Pair(stirred, 0.5, 0.1, "taken by stabilisation"),
    "an impact in one step": Pair(
        lambda step: disk_in_box(
            step,
            0.4,
            {"density": 2.0, "position": [0.7, 0.4], "velocity": [0.0, -2.0]},
            contact={"law": "normal", "range": 0.05, "epsilon": 1e-3},
        ),
        *(0.3, 0.02, "vanished"),
    ),
}


def account(scene: Scene) -> tuple[float, list[str]]:
    """The most energy that was created, lost or taken by stabilisation, over what is told of each, and what is said."""
    energy = rigidfluid.run(scene).summary["energy"]
    worst = max(
        *(energy[f"largest_{flow}"] / NOTICEABLE for flow in ("creation", "loss")), energy["grad_div"] / STABILISED
    )
    return worst, [warning["text"] for warning in energy["warnings"]]


@pytest.mark.long
@pytest.mark.parametrize("case", PAIRS)
def test_a_wrong_scene_is_told_and_its_right_twin_is_not(case: str) -> None:
    pair = PAIRS[case]
    error, told = account(pair.scene(pair.wrong))
    assert error > 1.0
    assert any(pair.told in text for text in told), told
    error, told = account(pair.scene(pair.right))
    assert told == []
    assert error < 1.0


@pytest.mark.parametrize("honest", [True, False])
def test_a_lossy_transfer_is_told(monkeypatch: pytest.MonkeyPatch, honest: bool) -> None:
    """A tenth of the velocity is lost with each new mesh, whether the backend says so or not."""
    transfer = TaylorHoodBackend.transfer

    def lossy(self: TaylorHoodBackend, fluid: Any, old: Any, new: Any) -> Any:
        moved, lost = transfer(self, fluid, old, new)
        before = self.prediction_error(moved, moved, new, np.zeros(2))  # ½ρ∫|u|²
        slower = moved | {name: 0.9 * moved[name] for name in ("velocity", "velocity_previous")}
        return slower, lost + (0.19 * before if honest else 0.0)

    scene = disk_in_box(0.01, 0.2, FALLING, HEAVY, mesh={"size": 0.25, "size_body": 0.1, "remesh_every": 0.05})
    assert account(scene)[1] == []
    monkeypatch.setattr(TaylorHoodBackend, "transfer", lossy)
    error, told = account(scene)
    assert error > 1.0
    assert "by re-meshing" in told[0]


def test_a_law_whose_energy_is_not_its_forces_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """In an impact what is stored seems to vanish, and to come back; where it is looked at before, it is refused."""
    assert account(thrown({}))[1] == []
    energy = NormalLaw.energy
    monkeypatch.setattr(NormalLaw, "energy", lambda self, contacts: 0.9 * energy(self, contacts))
    with pytest.raises(PluginError, match=r"force law 'normal', force: .* minus the slope of the energy"):
        account(thrown({}))

    def less(self: NormalLaw, contacts: Contacts) -> FloatArray:
        return np.where(contacts.gap > 0.84 * self.range, 0.9, 1.0) * energy(self, contacts)

    monkeypatch.setattr(NormalLaw, "energy", less)
    error, told = account(thrown({}))
    assert error > 1.0
    assert "at impacts" in told[0]


def test_a_run_in_python_warns_as_the_command_does() -> None:
    """Once for each text of the summary; a right scene is silent."""
    pair = PAIRS[next(iter(PAIRS))]
    with pytest.warns(RunWarning) as seen:
        history = rigidfluid.run(pair.scene(pair.wrong))
    texts = [str(warning.message) for warning in seen if warning.category is RunWarning]
    assert len(texts) == len(history.summary["energy"]["warnings"]) + sum(
        remark["grade"] == "warning" for remark in history.summary["remarks"]
    )
    assert any(pair.told in text for text in texts)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rigidfluid.run(thrown({}))
