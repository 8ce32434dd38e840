"""How easily bodies give way at their surface, against closed forms, and what that means for substeps."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from dry_scenes import ball, dry_scene

from rigidfluid.bodies.ellipsoid import Ellipsoid
from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.mechanics.added_mass import added_mass
from rigidfluid.core.mechanics.rotational_factor import ELLIPSOIDS, largest_rotational_factor
from rigidfluid.core.run.simulation import Simulation


def shape(dimension: int, points: Any, unit_inertia: Any) -> Any:
    """A shape that is no ellipsoid, of these surface points."""
    farthest = float(np.linalg.norm(points, axis=1).max())
    known = {"dimension": dimension, "radius": None, "semi_axes": None, "facets": None, "volume": 1.0}
    return SimpleNamespace(
        **known,
        unit_inertia=np.asarray(unit_inertia),
        bounding_radius=farthest,
        sample_surface=lambda _: np.asarray(points),
    )


def test_a_disk_with_a_thin_arm_has_far_more_than_an_ellipse() -> None:
    """A disk of radius 1 has r²/2; its arm weighs next to nothing and reaches to 3.3."""
    assert largest_rotational_factor(shape(2, [[1.0, 0.0], [0.0, 3.3]], [[0.5]])) == pytest.approx(2 * 3.3**2)


def test_a_rod_has_that_of_the_text_book() -> None:
    """Of length l and no width: (l/2)² over l²/12."""
    rod = shape(3, [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], np.diag([1e-9, 1 / 3, 1 / 3]))
    assert largest_rotational_factor(rod) == pytest.approx(3.0)


@pytest.mark.parametrize("axes", [(1.0, 1.0, 0.99), (1.0, 0.3, 0.2), (1.0, 0.01, 0.01), (1.0, 1.0, 0.01)])
def test_ellipsoids_have_no_more_than_is_said(axes: tuple[float, ...]) -> None:
    body = Ellipsoid(Ellipsoid.Options(semi_axes=list(axes)), 3)
    hidden = shape(3, body.sample_surface(2000), body.unit_inertia)
    assert largest_rotational_factor(hidden) <= 1.001 * ELLIPSOIDS
    assert largest_rotational_factor(body) == ELLIPSOIDS


def test_substeps_are_as_short_as_the_rotational_factor_asks(monkeypatch: pytest.MonkeyPatch) -> None:
    law = {"law": "centre", "range": 0.05, "epsilon": 1e-6, "epsilon_wall": 1e-6}
    disk = ball([0.5, 0.13], [0.0, -1.0], type="ellipsoid", semi_axes=[0.1, 0.09])
    del disk["radius"]
    simulation = Simulation(dry_scene({**law, "law": "normal"}, disk, end=0.1, step=0.01), None, False)
    counts = []
    for factor in (5.0, 22.0):
        system = replace(simulation.system, rotational_factor=np.array([factor]))
        counts.append(scheme_of(system).follow(simulation.state, 0.0, 0.01, None).substeps)
    assert counts[1] > 1.5 * counts[0]


def test_a_point_that_gives_way_easily_may_hit_with_more_speed() -> None:
    """A contact is then met with more energy, in which `barrier` is exponentially stiff."""
    counts = []
    law = {"law": "barrier", "range": 0.05, "epsilon": 3e-2}
    disk = ball([0.5, 0.13], [0.0, -1.0], type="ellipsoid", semi_axes=[0.1, 0.09])
    del disk["radius"]
    simulation = Simulation(dry_scene(law, disk, end=0.1, step=0.01), None, False)
    for factor in (5.0, 22.0):
        system = replace(simulation.system, rotational_factor=np.array([factor]))
        counts.append(scheme_of(system).follow(simulation.state, 0.0, 0.01, None).substeps)
    assert counts[1] > 8 * counts[0]


@pytest.mark.parametrize("dimension", [2, 3])
def test_other_shapes_drag_along_at_least_what_a_ball_of_their_volume_does(dimension: int) -> None:
    points = np.eye(dimension)
    other = shape(dimension, points, np.eye(1 if dimension == 2 else 3))
    np.testing.assert_allclose(added_mass(other), np.eye(dimension) / (dimension - 1.0))
