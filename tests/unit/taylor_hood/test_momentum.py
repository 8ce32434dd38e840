"""Momentum of fluid and bodies where nothing outside takes any."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import wet_tables

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.backends.scikit_fem.backend import ScikitFem
from rigidfluid.core.fluid.conditions import Periodic, TimeValue
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Links
from rigidfluid.taylor_hood.stepping.momentum import Moving
from rigidfluid.testing.fluid.boxes import box, nobody
from rigidfluid.testing.fluid.exact import problem
from rigidfluid.testing.fluid.flow import Flow

SIDES = [{"on": side, "type": "periodic"} for side in ("left", "right", "bottom", "top")]
BALL = {"type": "sphere", "radius": 0.12, "density": 2.0}


def torus() -> FluidProblem:
    """The unit square, periodic in both directions, with a fluid that hardly damps a flow."""
    posed = replace(problem(2), material=Newtonian(0.01))
    conditions = [
        Periodic(each.surface, each.name, each.normal, each.surface + 1 if each.surface % 2 == 0 else None)
        for each in posed.conditions
    ]
    return replace(posed, conditions=tuple(conditions))


def held(posed: FluidProblem, flux: TimeValue) -> FluidProblem:
    first, *others = posed.conditions
    assert isinstance(first, Periodic)
    return replace(posed, conditions=(replace(first, held_flux=flux), *others))


def started(posed: FluidProblem) -> Flow:
    return Flow.start(ScikitFem(ScikitFem.Options(tolerance=1e-12), posed), box(2, 4), nobody(2))


def vortices(_time: float, at: FloatArray) -> FloatArray:
    """A flow (N, d) without divergence that has no mean."""
    x, y = 2.0 * np.pi * at.T
    return np.stack([np.cos(x) * np.sin(y) + 0.5 * np.sin(2.0 * y), -np.sin(x) * np.cos(y)], axis=1)


def momentum(run: Simulation) -> FloatArray:
    """Momentum of a fluid of density 1 in straight cells, by the middles of their edges, and of its bodies."""
    fields = run.fields()
    corners = fields.points[fields.cells[:, :3]]
    area = 0.5 * np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1]))
    return np.asarray(
        area @ fields.velocity[fields.cells[:, 3:]].mean(axis=1) + run.system.mass @ run.state.twist.velocity
    )


def test_bodies_that_collide_on_several_meshes_keep_the_momentum_of_all() -> None:
    left = BALL | {"position": [0.36, 0.53], "velocity": [1.0, 0.0]}
    right = BALL | {"position": [0.64, 0.47], "velocity": [-1.0, 0.3]}
    law = {"law": "normal", "range": 0.04, "epsilon": 1e-3}
    given = {"domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]}, "fluid": {"viscosity": 0.01}, "contact": law}
    given |= {"mesh": {"size": 0.2, "size_body": 0.08, "order": 1}, "boundary": SIDES, "end": 0.12, "step": 0.01}
    run = Simulation(scene_from_dict(wet_tables(left, right, **given)))
    start, thrown = momentum(run), float(np.abs(run.system.mass @ np.abs(run.state.twist.velocity)).sum())
    least = np.inf
    while not run.ended:
        run.step()
        least = min(least, float(run.state.gaps.min()))
    assert least < 0.04  # the law has acted
    assert run.counts.remeshes > 0
    np.testing.assert_allclose(momentum(run), start, rtol=0, atol=1e-13 * thrown)


def test_a_flow_that_drifts_with_its_mesh_is_the_same_flow() -> None:
    drift = np.array([0.7, -0.4])
    still = started(replace(torus(), initial=vortices))
    drifting = started(replace(torus(), initial=lambda time, at: vortices(time, at) + drift))
    for _ in range(4):
        still = still.after(0.05)
        drifting = drifting.after(0.05, points=drifting.mesh.points + 0.05 * drift)
    here, there = (flow.backend.fields(flow.fluid, flow.mesh).velocity for flow in (still, drifting))
    assert np.abs(here).max() > 0.1
    np.testing.assert_allclose(there - drift, here, rtol=0, atol=1e-9)


def test_a_flux_that_is_held_takes_momentum() -> None:
    flow = started(held(replace(torus(), initial=vortices), lambda time: np.sin(5.0 * time)))
    for _ in range(3):
        flow = flow.after(0.1)
        flux, _ = flow.backend.driving(flow.fluid, flow.mesh)[0]
        assert flux == pytest.approx(np.sin(5.0 * flow.time), abs=1e-12)


@pytest.mark.parametrize(("row", "free"), [([1.0, -1.0], True), ([1.0, 0.0], False)], ids=["pair", "ground"])
def test_links_of_pairs_leave_all_free_and_links_to_the_ground_do_not(row: list[float], free: bool) -> None:
    flow = started(torus())
    links = Links(np.array(row)[None, :, None] * np.array([1.0, 0.0, 0.0]), np.zeros(1), np.zeros(1))
    step = replace(flow.step_after(0.1), links=links, prescribed=np.zeros(2, dtype=bool))
    discretisation = flow.backend._any_discretisation(flow.mesh)  # type: ignore[attr-defined]
    assert Moving(discretisation, step, flow.mesh.points).free is free
    held_fast = replace(step, prescribed=np.array([True, False]))
    assert not Moving(discretisation, held_fast, flow.mesh.points).free


def test_the_momentum_is_among_the_shapes_of_a_state() -> None:
    flow = started(torus()).after(0.1)
    shapes = flow.backend.state_shapes(flow.mesh, flow.pose)
    assert shapes == {name: each.shape for name, each in flow.fluid.items()}
