"""Cells next to bodies come through a re-meshing as they were."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mesh_tools import ball, box, box_walls, upright

from rigidfluid.core.mesh.adaptation import remesh as module
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.adaptation.kept_cells import LAYERS, kept_cells
from rigidfluid.core.mesh.adaptation.remesh import remesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_field import Sizes, wanted_size


def meshed(dimension, height):
    """A ball in a box, meshed for where it is, and what goes with it."""
    lower, upper = np.zeros(dimension), np.full(dimension, 2.0)
    place = np.full(dimension, 1.0)
    place[-1] = height
    body, pose = ball(0.25, dimension), upright(place)
    sizes = Sizes(0.4, 0.08 if dimension == 2 else 0.15)
    around = FluidDomain([body], pose, box(lower, upper), box_walls(lower, upper, 1))
    return initial_mesh(around, sizes), around, sizes


def cells_at(mesh, chosen):
    """The chosen cells as sorted sets of the coordinates of their corners."""
    return {tuple(sorted(map(tuple, corners))) for corners in mesh.points[mesh.cells[chosen]].tolist()}


@pytest.mark.parametrize("dimension", [2, 3])
def test_good_cells_near_a_body_are_kept_to_the_last_bit(dimension):
    mesh, around, sizes = meshed(dimension, 1.0)

    def size_at(points):
        return wanted_size(points, around, sizes)

    squeezed = mesh.points + 0.02 * np.sin(9.0 * mesh.points[:, ::-1]) * ~_near(mesh)[:, None]
    inside = np.setdiff1d(np.arange(len(mesh.points)), np.unique(mesh.facets))
    points = mesh.points.copy()
    points[inside] = squeezed[inside]
    moved = type(mesh)(points, mesh.cells, mesh.facets, mesh.markers)
    kept = kept_cells(moved, 1, size_at, LAYERS)
    assert kept.sum() > 20
    made = remesh(moved, around, sizes, LAYERS)
    assert cells_at(moved, kept) <= cells_at(made, slice(None))
    assert len(made.cells) != len(moved.cells), "MMG has done something elsewhere"


def test_cells_around_a_bad_one_are_given_up_before_the_others(monkeypatch):
    """The first mesh has a flat cell next to the body; the second keeps all cells but those there."""
    mesh, around, sizes = meshed(2, 1.0)
    kept, made = [], module.remeshed_once

    def one_flat_cell(given_mesh, fluid_domain, given, cells, gradation):
        kept.append(cells)
        new = made(given_mesh, fluid_domain, given, cells, gradation)
        if len(kept) > 1:
            return new
        flat = new.cells[np.isin(new.cells, new.facets[new.markers == 0]).sum(axis=1) == 2][0]
        apex, ends = np.setdiff1d(flat, new.facets), np.intersect1d(flat, new.facets)
        points = new.points.copy()
        points[apex] = 0.01 * points[apex] + 0.99 * points[ends].mean(axis=0)
        bad.append(points[ends].mean(axis=0))
        return replace(new, points=points)

    bad = []
    monkeypatch.setattr(module, "remeshed_once", one_flat_cell)
    module.best_remeshed(mesh, around, lambda points: wanted_size(points, around, sizes), LAYERS)
    first, second = kept
    given_up = first & ~second
    distance = np.linalg.norm(mesh.points[mesh.cells].mean(axis=1) - bad[0], axis=1)
    assert 0 < given_up.sum() < 0.3 * first.sum()
    assert distance[given_up].max() < 4.0 * sizes.size_body
    assert not second[distance < sizes.size_body].any()


def test_no_mesh_is_asked_for_twice_where_bad_cells_are_around_all_kept_ones(monkeypatch):
    mesh, around, sizes = meshed(2, 1.0)
    asked = []

    def all_bad(given_mesh, fluid_domain, given, cells, gradation):
        asked.append((int(cells.sum()), gradation))
        return given_mesh

    monkeypatch.setattr(module, "remeshed_once", all_bad)
    monkeypatch.setattr(module, "_bad_outside_films", lambda new, fluid_domain: np.arange(len(new.cells)))
    module.best_remeshed(mesh, around, lambda points: wanted_size(points, around, sizes), LAYERS)
    (first, _), *rest = asked
    assert first > 0
    assert rest == [(0, gradation) for gradation in module.GRADATIONS]


@pytest.mark.parametrize("wanted", [0.02, 0.4])
def test_cells_of_another_size_than_wanted_are_not_kept(wanted):
    """Gaps ask for shorter edges; where a gap has opened longer ones do."""
    mesh, _, _ = meshed(2, 1.0)
    assert kept_cells(mesh, 1, lambda points: np.full(len(points), 0.09), LAYERS).any()
    assert not kept_cells(mesh, 1, lambda points: np.full(len(points), wanted), LAYERS).any()


def _near(mesh):
    return np.linalg.norm(mesh.points - 1.0, axis=1) < 0.6
