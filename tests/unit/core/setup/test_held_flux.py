"""A flux that is held through periodic surfaces: the drop of pressure that it takes, its work, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigidfluid
from rigidfluid.api import FluidBackend, model_of
from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.fluid.conditions import Periodic
from rigidfluid.core.model.types import Pose
from rigidfluid.core.output.history import History
from rigidfluid.core.setup.impact import fastest_flow
from rigidfluid.errors import SceneError
from rigidfluid.testing.fluid import exact
from rigidfluid.testing.fluid.boxes import box
from rigidfluid.testing.fluid.exact import problem
from rigidfluid.testing.fluid.flow import Flow

VISCOSITY, FLUX = 0.5, 0.8
HELD = {"type": "sphere", "radius": 0.12, "density": 1.0, "position": [0.7, 0.45], "fixed": True}


def scene(drive: dict[str, Any] | None = None, **tables: Any) -> rigidfluid.Scene:
    """A channel 2 by 1 in Stokes flow round a fixed disk, if nothing else is given."""
    boundary = [{"on": "left", "type": "periodic"} | (drive or {"flux": FLUX}), {"on": "right", "type": "periodic"}]
    common: dict[str, Any] = {
        "scene": {"name": "held", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": VISCOSITY, "model": "stokes"},
        "domain": {"lower": [0.0, 0.0], "upper": [2.0, 1.0]},
        "body": [HELD],
        "boundary": boundary,
        "mesh": {"size": 0.3, "size_body": 0.1},
        "time": {"end": 0.2, "step": 0.05},
        "output": {"every": 0.1},
    }
    return scene_from_dict(common | tables | {"fluid": common["fluid"] | tables.pop("fluid", {})})


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_drop_of_plane_poiseuille_flow_is_exact(dimension: int) -> None:
    """Δp = 12 μ U L/h² between plates, with L = h = 1 and the mean velocity U = Q."""
    posed = problem(dimension, inertia=False)
    faces = list(posed.conditions)
    for axis in (0, 2)[: dimension - 1]:
        one, two = faces[2 * axis : 2 * axis + 2]
        flux = (lambda _: FLUX) if axis == 0 else None
        faces[2 * axis] = Periodic(one.surface, one.name, one.normal, two.surface, held_flux=flux)
        faces[2 * axis + 1] = Periodic(two.surface, two.name, two.normal)
    backend = ScikitFem(ScikitFem.Options(tolerance=1e-12), replace(posed, conditions=tuple(faces)))
    nobody = Pose(np.zeros((0, dimension)), np.zeros((0, 1 if dimension == 2 else 4)))
    flow = Flow.start(backend, box(dimension, 3), nobody).after(None)
    flux, drop = backend.driving(flow.fluid, flow.mesh)[0]
    assert flux == pytest.approx(FLUX, rel=1e-12)
    assert drop == pytest.approx(12.0 * exact.VISCOSITY * FLUX, rel=1e-10)


def test_a_flux_that_starts_at_once_is_met_in_every_state() -> None:
    """In Navier–Stokes flow past a free body: from the impulse of the start on, to rounding."""
    history = rigidfluid.run(scene(body=[HELD | {"fixed": False}], fluid={"model": "navier-stokes"}))
    np.testing.assert_allclose(history.driving["flux"], FLUX, rtol=1e-12)
    assert abs(history.energy["residual"][-1]) < 0.02 * history.energy["boundary"][-1]


def steady(drive: dict[str, Any]) -> History:
    """The steady Navier–Stokes flow past a fixed body."""
    fluid = {"model": "navier-stokes", "initial": "steady"}
    return rigidfluid.run(scene(drive=drive, fluid=fluid, time={"end": 0.05, "step": 0.05}))


def test_flux_and_drop_of_pressure_drive_the_same_flow_past_a_body() -> None:
    """The work of the drop is what viscosity takes."""
    held = steady({"flux": FLUX})
    dropped = steady({"pressure_drop": float(held.driving["pressure_drop"][0])})
    assert dropped.driving["flux"][-1] == pytest.approx(FLUX, rel=1e-8)
    assert dropped.bodies["fx"][-1] == pytest.approx(held.bodies["fx"][-1], rel=1e-8)
    for history in (held, dropped):
        assert history.energy["boundary"][-1] == pytest.approx(history.energy["dissipation"][-1], rel=1e-6)


def test_a_flux_that_swings_keeps_the_balance_of_energy() -> None:
    """Second order: what the balance leaves falls to a quarter at half the step."""
    left = []
    for step in (0.02, 0.01):
        drive = {"flux": "sin(5*t)**2"}
        fluid, time = {"model": "navier-stokes"}, {"end": 0.4, "step": step}
        history = rigidfluid.run(scene(drive=drive, fluid=fluid, time=time))
        np.testing.assert_allclose(history.driving["flux"], np.sin(5 * history.driving["time"]) ** 2, atol=1e-12)
        left.append(abs(history.energy["residual"][-1]) / history.energy["boundary"].max())
    assert left[1] < 0.35 * left[0]
    assert left[0] < 0.02


def test_a_drop_that_swings_drives_a_flux_in_step_without_inertia() -> None:
    """Stokes flow past a fixed body: the flux is that of a unit drop times the drop, at each time."""
    one, swings = (rigidfluid.run(scene(drive={"pressure_drop": drop})).driving for drop in (1.0, "3*cos(5*t)"))
    drop = 3.0 * np.cos(5.0 * swings["time"][1:])
    np.testing.assert_allclose(swings["pressure_drop"][1:], drop, rtol=1e-9)
    np.testing.assert_allclose(swings["flux"][1:], one["flux"][-1] * drop, rtol=1e-6)


def test_a_drop_that_swings_keeps_the_balance_of_energy() -> None:
    """Its work is that of the drop at each time: second order."""
    left = []
    for step in (0.02, 0.01):
        fluid, time = {"model": "navier-stokes"}, {"end": 0.4, "step": step}
        energy = rigidfluid.run(scene(drive={"pressure_drop": "20*sin(5*t)**2"}, fluid=fluid, time=time)).energy
        left.append(abs(energy["residual"][-1]) / energy["boundary"].max())
    assert left[1] < 0.35 * left[0]
    assert left[0] < 0.02


def test_a_run_is_resumed_to_the_last_bit(tmp_path: Path) -> None:
    def case(end: float) -> rigidfluid.Scene:
        body = [HELD | {"fixed": False}]
        return scene(body=body, fluid={"model": "navier-stokes"}, time={"end": end, "step": 0.05})

    rigidfluid.run(case(0.2), tmp_path / "whole")
    rigidfluid.run(case(0.1), tmp_path / "parts")
    rigidfluid.run(case(0.2), tmp_path / "parts", resume=True)
    for name in ("bodies.csv", "energy.csv", "driving.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_bodies_are_expected_at_the_speed_of_the_flux() -> None:
    assert fastest_flow(model_of(scene(drive={"flux": "3 - t"}))) == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        ({"flux": 1.0, "pressure_drop": 1.0}, r"boundary.0.flux: flux takes the place of pressure_drop, and both"),
        ({"flux": "x"}, r"boundary.0.flux: found an unknown name"),
        ({"pressure_drop": "y"}, r"boundary.0.pressure_drop: found an unknown name"),
        ({"pressure_drop": "1/t"}, r"boundary.0.pressure_drop on 'left': found inf from '1/t' at time 0 and point"),
        ({"flux": "1/t"}, r"boundary.0.flux on 'left': found inf from '1/t' at time 0; allowed"),
    ],
    ids=["both", "place", "place-of-a-drop", "infinite", "infinite-drop"],
)
def test_a_flux_that_cannot_be_is_refused(drive: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        model_of(scene(drive=drive))


def test_only_one_of_a_pair_has_a_flux() -> None:
    both = [{"on": name, "type": "periodic", "flux": 1.0} for name in ("left", "right")]
    with pytest.raises(SceneError, match=r"boundary.0.flux: only one of 'left' and 'right' can have the drop .* flux"):
        scene(boundary=both)


def test_a_backend_that_holds_no_flux_refuses_it_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScikitFem, "held_fluxes", FluidBackend.held_fluxes)
    with pytest.raises(SceneError, match=r"boundary.0.flux: found a flux through a periodic surface with backend"):
        model_of(scene())
