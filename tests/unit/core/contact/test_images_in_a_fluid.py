"""Bodies in a fluid meet images of each other across a seam as they meet each other in the middle."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scenes import wet_tables

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.errors import SceneError, StepError

BALL = {"type": "sphere", "radius": 0.12, "density": 40.0}
LENGTH = 2.0
SIDES = [{"on": "left", "type": "periodic"}, {"on": "right", "type": "periodic"}]
CONTACT = {"law": "spring-dashpot", "range": 0.03, "stiffness": 3e3, "restitution": 0.8, "friction": 0.3}


def tables(*bodies: dict[str, Any], **changes: Any) -> dict[str, Any]:
    given: dict[str, Any] = {
        "domain": {"lower": [0.0, 0.0], "upper": [LENGTH, 1.0]},
        "fluid": {"viscosity": 0.05},
        "boundary": SIDES,
        "contact": CONTACT,
        "mesh": {"size": 0.15, "size_body": 0.06},
        "end": 0.45,
        "step": 0.01,
    }
    return wet_tables(*bodies, **(given | changes))


def collision(shift: float) -> tuple[FloatArray, float, float]:
    """Displacements of two bodies that hit each other at x = 1.9 + ``shift``, their least gap, and the residual over
    the energy at the start."""
    left = BALL | {"position": [(1.6 + shift) % LENGTH, 0.5], "velocity": [1.0, 0.0]}
    right = BALL | {"position": [(0.2 + shift) % LENGTH, 0.55], "velocity": [-1.0, 0.0]}
    run = Simulation(scene_from_dict(tables(left, right)))
    start, energy, least = run.state.pose.position, run.state.ledger.kinetic, np.inf
    while not run.ended:
        run.step()
        least = min(least, float(run.state.gaps.min()))
    return run.state.pose.position - start, least, run.state.ledger.residual / energy


def test_a_collision_across_the_seam_is_one_in_the_middle() -> None:
    across, gap, created = collision(0.0)
    middle, gap_there, _ = collision(1.0)
    assert gap < 0.03  # the law has acted
    assert gap == pytest.approx(gap_there, rel=0.02)
    np.testing.assert_allclose(across, middle, rtol=0, atol=2e-3)
    assert abs(created) < 5e-3


def test_a_flow_given_in_the_domain_is_the_same_where_the_mesh_goes_on_beyond_it() -> None:
    energies = []
    for place, centre in ((1.95, 0.25), (0.95, 1.25)):
        swirl = ["0", f"exp(-((x-{centre})/0.15)**2)*y*(1-y)"]
        body = BALL | {"position": [place, 0.5]}
        run = Simulation(scene_from_dict(tables(body, fluid={"viscosity": 0.05, "initial": swirl})))
        energies.append(run.state.ledger.kinetic)
    assert energies[0] == pytest.approx(energies[1], rel=0.03)


def test_a_velocity_given_on_a_surface_is_the_same_beyond_the_seam() -> None:
    works = []
    for place, centre in ((1.93, 0.35), (0.93, 1.35)):
        top = {"on": "top", "type": "velocity", "velocity": [f"exp(-((x-{centre})/0.2)**2)", "0"]}
        given = tables(BALL | {"position": [place, 0.5]}, boundary=[*SIDES, top])
        run = Simulation(scene_from_dict(given))
        run.step()
        works.append(run.state.ledger.boundary)
    assert works[0] == pytest.approx(works[1], rel=0.05)
    assert works[0] > 1e-6


def test_detectors_on_the_mesh_are_refused_beside_periodic_surfaces() -> None:
    given = tables(BALL | {"position": [1.0, 0.5]}, contact=CONTACT | {"detector": "narrow_band"})
    with pytest.raises(SceneError, match="narrow_band"):
        scene_from_dict(given)


def test_a_body_longer_than_the_period_stays_in_the_domain() -> None:
    needle = {"type": "ellipsoid", "semi_axes": [0.05, 0.7], "density": 2.0, "position": [0.5, 1.0]}
    domain, sizes = {"lower": [0.0, 0.0], "upper": [1.0, 2.0]}, {"size": 0.3, "size_body": 0.06}
    given = tables(needle, domain=domain, mesh=sizes)
    assert len(Simulation(scene_from_dict(given)).system.lattice.vectors) == 0


def test_a_body_ends_the_run_where_images_of_walls_are_not_known() -> None:
    obstacle = {"name": "post", "type": "sphere", "radius": 0.1, "position": [1.0, 0.2]}
    domain = {"type": "channel", "lower": [0.0, 0.0], "upper": [LENGTH, 1.0], "obstacle": [obstacle]}
    run = Simulation(scene_from_dict(tables(BALL | {"position": [1.7, 0.6], "velocity": [1.0, 0.0]}, domain=domain)))
    with pytest.raises(StepError, match="beyond a periodic surface"):
        run.go()
