"""Energy unaccounted for in runs whose cause is known is put to that cause, and goes where the cause goes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from falling import SCENES, falling_disk
from scenes import wet_tables
from throat import SLIPPERY, throat

import rigidfluid
from rigidfluid.core.output.energy_flows import PARTS
from rigidfluid.core.output.history import History
from rigidfluid.core.scene.scene import Scene

FREE = {"mesh": {"size": 0.4, "size_body": 0.08}, "output": {"every": 1.0}}


def shares(history: History) -> dict[str, float]:
    """Each part of the residual at the end, over the energy put in."""
    return {part.removeprefix("residual_"): history.energy[part][-1] / put_in(history) for part in PARTS}


def put_in(history: History) -> float:
    return float(history.summary["energy"]["put_in"])


def fall(step: float, **mesh: Any) -> History:
    """A disk that falls from rest, far from all walls."""
    return rigidfluid.run(
        falling_disk(mesh=FREE["mesh"] | mesh, output=FREE["output"], time={"end": 0.24, "step": step})
    )


def test_the_parts_add_up_to_the_residual() -> None:
    energy = fall(0.008, remesh_every=0.05).energy
    np.testing.assert_allclose(sum(energy[part] for part in PARTS), energy["residual"], rtol=1e-12, atol=1e-14)


def test_a_smooth_fall_is_wrong_by_its_steps_alone() -> None:
    """Of second order in the step; finer cells change nothing."""
    coarse, fine, finer_mesh = fall(0.008), fall(0.004), fall(0.008, size=0.2, size_body=0.04)
    for history in (coarse, fine, finer_mesh):
        found = shares(history)
        assert found["remeshing"] == found["contacts"] == found["mesh"] == 0.0
        assert abs(found["start"]) < 0.2 * found["steps"]
    assert 3.0 < shares(coarse)["steps"] / shares(fine)["steps"] < 5.0
    assert shares(finer_mesh)["steps"] == pytest.approx(shares(coarse)["steps"], rel=0.1)


def test_new_meshes_are_no_cause_but_in_the_two_steps_after_them() -> None:
    history = fall(0.008, remesh_every=0.05)
    grown = np.diff(history.energy["residual_remeshing"]) != 0.0
    new = np.diff(history.steps["remeshes"], prepend=0) > 0
    assert 0 < new.sum() < len(new) / 2
    assert grown.any()
    assert not (grown & ~new & ~np.concatenate([[False], new[:-1]])).any()


def test_frequent_new_meshes_are_not_blamed_for_long_steps() -> None:
    """With a new mesh every third step the disk loses what it loses without: what is more is re-meshing's."""
    alone, often = shares(fall(0.008)), shares(fall(0.008, remesh_every=0.024))
    assert often["steps"] == pytest.approx(alone["steps"], rel=0.3)
    assert abs(often["remeshing"]) < 0.3 * often["steps"]


def test_an_impact_is_wrong_in_its_own_steps() -> None:
    """A disk thrown at the floor; before and after it the steps are to blame."""
    history = rigidfluid.run(rigidfluid.load_scene(SCENES / "bounce_in_fluid.toml", ["time.step=5e-4"]))
    energy, gap = history.energy, history.bodies["gap"]
    at_contacts = np.diff(energy["residual_contacts"]) != 0.0
    touching = gap[1:] < 0.05
    soon_after = np.concatenate([[False], touching[:-1]])
    assert at_contacts.any()
    assert not (at_contacts & ~touching & ~soon_after).any()
    assert np.abs(np.diff(energy["residual_steps"]))[at_contacts].max() < 1e-12 * put_in(history)


def test_a_body_that_rests_on_a_wall_is_no_impact() -> None:
    """Its contact pushes all the time, and its box of fluid is shaken."""
    disk = {"type": "sphere", "radius": 0.2, "density": 2.0, "position": [0.5, 0.2499]}
    shaken = disk | {"position": [0.5, 0.75], "radius": 0.1, "prescribed": {"amplitude": [0.1, 0.0], "frequency": 2.0}}
    tables = wet_tables(
        disk | {"name": "resting"},
        shaken | {"name": "shaken"},
        end=0.3,
        fluid={"gravity": [0.0, -1.0]},
        contact={"law": "normal", "range": 0.1, "epsilon": 1e-3},
    )
    history = rigidfluid.run(rigidfluid.scene_from_dict(tables))
    late = history.energy["time"] > 0.05
    assert (history.bodies["cfy"].reshape(-1, 2)[1:, 0] > 0.1).all()
    assert np.ptp(history.energy["residual_contacts"][late]) == 0.0
    assert np.ptp(history.energy["residual_steps"][late]) > 0.0


def leaky(step: float, size: float) -> History:
    """Flow through a throat whose curved walls let it slip, past a small disk in a corner."""
    tables = throat(SLIPPERY, end=3.0, step=step).to_dict()
    still = {"type": "sphere", "radius": 0.05, "density": 1.5, "position": [-2.8, 1.4], "fixed": True}
    tables["body"], tables["contact"] = [still], {}
    tables["mesh"] |= {"size": size, "size_body": min(0.6, size), "order": 1}
    return rigidfluid.run(rigidfluid.scene_from_dict(tables))


@pytest.mark.long
def test_coarse_curved_slip_walls_leak_by_the_mesh_alone() -> None:
    coarse, fine, fine_mesh = (shares(leaky(step, size)) for step, size in ((0.04, 0.8), (0.02, 0.8), (0.04, 0.12)))
    assert abs(coarse["mesh"]) > 1e-5
    assert fine["mesh"] == pytest.approx(coarse["mesh"], rel=0.02)
    assert abs(fine["steps"]) < 0.4 * abs(coarse["steps"])
    assert abs(fine_mesh["mesh"]) < 0.2 * abs(coarse["mesh"])
    assert fine_mesh["steps"] == pytest.approx(coarse["steps"], rel=0.3)


def gust(step: float) -> Scene:
    """A vortex that a stream takes out of a box of coarse cells."""
    return rigidfluid.scene_from_dict(
        wet_tables(
            {"type": "sphere", "radius": 0.3, "density": 1.0, "position": [-1.0, 2.0], "fixed": True},
            end=8.0,
            step=step,
            fluid={
                "viscosity": 0.005,
                "initial": ["1.0 - 2*y*exp(-(x-1.5)**2-y**2)", "2*(x-1.5)*exp(-(x-1.5)**2-y**2)"],
            },
            domain={"lower": [-3.0, -3.0], "upper": [5.0, 3.0]},
            boundary=[
                {"on": "all", "type": "slip"},
                {"on": "left", "type": "velocity", "velocity": [1.0, 0.0]},
                {"on": "right", "type": "pressure", "pressure": 0.0},
            ],
            mesh={"size": 0.8, "size_body": 0.15},
        )
    )


@pytest.mark.long
def test_a_vortex_leaves_through_coarse_cells_with_all_its_energy() -> None:
    """Carried energy is a cubic of the velocity: counted by the facets' own rule it was .7 % off, whatever the step.

    What stabilisation takes, 1.9 %, is known to .3 % of it.
    """
    coarse, fine = (rigidfluid.run(gust(step)) for step in (0.1, 0.05))
    assert fine.summary["energy"]["created"] < 1e-4
    assert shares(fine)["steps"] < 2e-3
    assert shares(fine)["steps"] < 0.35 * shares(coarse)["steps"]


def test_only_the_first_step_of_a_fall_is_a_start() -> None:
    start = fall(0.008).energy["residual_start"]
    assert start[1] != 0.0
    assert np.ptp(start[1:]) == 0.0
