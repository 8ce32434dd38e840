"""Bodies at random in curved and irregular domains, a few of the arrangements of docs/validation/insertion.md."""

from __future__ import annotations

import numpy as np
import pytest
from facet_domain import bent_tube
from insertion_cases import CASES, Outcome, outcome, peanut, peanut_in_a_tube

from rigidfluid.core.geometry.facet_moments import facet_moments
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.fill import fill_mesh
from rigidfluid.core.mesh.generation.inserter import Way
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes

pytestmark = pytest.mark.long


def assert_fits(found: Outcome, quality: float) -> None:
    """Good cells, vertices on the shapes, and walls that are as they were."""
    assert found.quality > quality
    assert found.vertices_off < 1e-14
    assert found.middles_off < 1.2
    assert found.all_surfaces
    assert found.kept == 1.0
    assert found.area_change < 1e-12


@pytest.mark.parametrize("seed", [0, 7])
@pytest.mark.parametrize("name", ["stenosis, 20 bodies", "irregular outline, 20 bodies"])
def test_twenty_bodies_in_the_plane(name: str, seed: int) -> None:
    found = outcome(CASES[name](), seed, "fill")
    assert_fits(found, quality=0.3)
    assert found.cells < 10000


@pytest.mark.parametrize("way", ["fill", "level_set"])
def test_a_body_in_a_bent_tube(way: Way) -> None:
    assert_fits(outcome(CASES["bent tube, 1 body"](), 0, way), quality=0.4)


def test_a_body_with_sharp_edges_keeps_its_facets_to_the_last_bit() -> None:
    body, pose, domain = peanut(), *peanut_in_a_tube()
    mesh = fill_mesh(FluidDomain([body], pose, domain, ()), Sizes(0.4, 0.2, 0.3))
    assert body.facets is not None
    given = body.facets.points + pose.position[0]
    number = {tuple(point): k for k, point in enumerate(given.tolist())}
    facets = mesh.points[mesh.facets[mesh.markers == 0]].tolist()
    kept = {tuple(sorted(number[tuple(corner)] for corner in corners)) for corners in facets}
    assert kept == set(map(tuple, np.sort(body.facets.vertices, axis=1).tolist()))
    volume = cell_volumes(mesh.points, mesh.cells).sum()
    assert volume == pytest.approx(domain.volume - facet_moments(body.facets).volume, rel=1e-13)
    assert cell_quality(mesh.points, mesh.cells).min() > 0.2


def test_the_tube_is_closed() -> None:
    assert bent_tube(0.6).volume == pytest.approx(np.pi * (8.0 + 0.5 * np.pi * 3.0), rel=0.1)
