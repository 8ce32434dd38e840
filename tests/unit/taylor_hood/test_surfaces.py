"""Velocities prescribed on the faces of one mesh."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from rigidfluid.core.fluid.conditions import PrescribedVelocity
from rigidfluid.core.nested.expressions import VectorExpression
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.surfaces import Surfaces, pressure_pin_vertex
from rigidfluid.testing.fluid.boxes import box, box_with_balls
from rigidfluid.testing.fluid.exact import problem


def test_inflow_and_outflow_of_an_enclosed_flow_are_made_equal_on_the_mesh() -> None:
    """A hundredth more comes in than goes out, and both become their mean."""
    given = [VectorExpression.parse([source, 0.0], "u") for source in ("1.01*y*(1 - y)", "0.99*y*(1 - y)")]
    left, right = (partial(PrescribedVelocity, value=value) for value in given)
    mesh = box(2, 2)
    numbering = Numbering(mesh.cells, len(mesh.points))
    surfaces = Surfaces(numbering, mesh, problem(2, {"x0": left, "x1": right}).conditions, ())
    points, nobody = numbering.node_points(mesh.points), np.zeros((0, 3))
    found = surfaces.prescribed_velocity(0.0, points, nobody[:, :2], nobody, np.zeros(0, dtype=bool))
    ends = np.isin(points[:, 0], (0.0, 1.0))
    profile = np.column_stack([points[:, 1] * (1.0 - points[:, 1]), np.zeros(len(points))])
    np.testing.assert_allclose(found[ends], profile[ends], rtol=2e-4)


@pytest.mark.parametrize("most_pairs", [10**6, 0])
def test_the_pressure_pin_is_the_inner_vertex_farthest_from_bodies(
    most_pairs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Among all pairs of vertices, and by a tree."""
    monkeypatch.setattr("rigidfluid.taylor_hood.elements.surfaces._FEW", most_pairs)
    mesh = box_with_balls(2)
    surfaces = Surfaces(Numbering(mesh.cells, len(mesh.points)), mesh, problem(2, bodies=2).conditions, (0, 1))
    inner = np.setdiff1d(np.arange(len(mesh.points)), mesh.facets)
    on_bodies = mesh.points[np.unique(mesh.facets[mesh.markers < 2])]
    apart = np.linalg.norm(mesh.points[inner, None] - on_bodies, axis=2).min(axis=1)
    assert pressure_pin_vertex(surfaces, mesh) == inner[np.argmax(apart)]
