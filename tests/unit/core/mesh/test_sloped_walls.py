"""Domains between sloped flat walls, each with a name of its own: all stay where they are, however often re-meshed."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import drawn, oblique_tube, polyhedron, straight, written
from mesh_files import meshed, write_gmsh41
from mesh_tools import ball, nobody, upright

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion
from rigidfluid.core.mesh.adaptation.remesh import remesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.inserter import Inserter, Way
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.generation.on_surfaces import put_on_surfaces
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import check_volume
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.run.run import run
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.errors import MeshError

TRAPEZOID = [(0.0, 0.0), (1.3, 0.0), (2.0, 1.0), (-0.4, 1.0)]
TRIANGLE = [(0.1, 0.03), (1.7, 0.2), (0.6, 1.5)]
HOPPER = [(-0.2, 0.0), (0.2, 0.0), (1.0, 1.3), (-1.0, 1.3)]
SIX_SIDES = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
BIN = [(-0.3, -0.25, 0.0), (0.3, -0.25, 0.0), (0.3, 0.25, 0.0), (-0.3, 0.25, 0.0)]
BIN += [(-0.9, -0.75, 1.2), (1.1, -0.75, 1.2), (1.1, 0.85, 1.2), (-0.9, 0.85, 1.2)]
PYRAMID = [(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0), (0.1, 0.2, 1.5)]
FIVE_SIDES = [(3, 2, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]

EPSILON = float(np.finfo(float).eps)
MISSED = 1e-12
"""Over the size of the domain: where more planes meet than there are dimensions, they miss each other by as much as
they are off the points that they were made from."""

SHAPES: dict[str, tuple[Any, tuple[float, ...]]] = {
    "trapezoid": (lambda: straight(TRAPEZOID), (0.7, 0.5)),
    "triangle": (lambda: straight(TRIANGLE), (0.8, 0.5)),
    "hopper": (lambda: straight(HOPPER), (0.0, 0.7)),
    "small trapezoid": (lambda: straight(1e-3 * np.array(TRAPEZOID)), (0.7e-3, 0.5e-3)),
    "far trapezoid": (lambda: straight(np.add(TRAPEZOID, (100.0, 50.0))), (100.7, 50.5)),
    "hopper in space": (lambda: polyhedron(BIN, SIX_SIDES), (0.1, 0.0, 0.7)),
    "pyramid": (lambda: polyhedron(PYRAMID, FIVE_SIDES), (0.0, 0.1, 0.5)),
}


def domain_of(shape: Any, dimension: int, kind: str, folder: Path) -> Domain:
    """From a CAD file, or from a file of a mesh of it."""
    cad = drawn(shape, folder, dimension)
    if kind == "cad":
        return cad
    size = 0.2 * float(cad.size.max())
    write_gmsh41(
        folder / "shape.msh",
        generate_mesh(FluidDomain([], nobody(dimension), cad, ()), Sizes(size, size, 0.3)),
        list(cad.names),
    )
    return meshed(folder / "shape.msh", dimension)


def off_its_planes(mesh: Mesh, domain: Domain) -> float:
    """How far at most a vertex is from a plane that it belongs to, over the size of the domain; body 0 is inside."""
    distances = []
    for number, piece in enumerate(domain.pieces, start=1):
        assert piece.shape.plane is not None
        distances.append(piece.shape.signed_distance(mesh.points[np.unique(mesh.facets[mesh.markers == number])]))
    return float(np.abs(np.concatenate(distances)).max() / domain.size.max())


CASES = [(name, kind) for name in SHAPES for kind in ("cad", "mesh") if (name, kind) != ("pyramid", "cad")]


@pytest.mark.long
@pytest.mark.parametrize(("name", "kind"), CASES)
def test_sloped_walls_stay_through_ten_meshes(name: str, kind: str, tmp_path: Path) -> None:
    make, centre = SHAPES[name]
    d = len(centre)
    domain = domain_of(make(), d, kind, tmp_path)
    size = float(domain.size.max())
    sizes = Sizes(0.3 * size, 0.025 * size, 0.5) if d == 2 else Sizes(0.5 * size, 0.1 * size, 0.9)
    body, walls = ball((0.05 if d == 2 else 0.1) * size, d), list(surfaces_of(domain, 1))
    poses = [upright(np.array(centre) + 0.002 * size * step) for step in range(11)]
    mesh = initial_mesh(FluidDomain([body], poses[0], domain, walls), sizes)
    before = float(cell_volumes(mesh.points, mesh.cells).sum())
    allowed = MISSED if name == "pyramid" else 4.0 * EPSILON * float(np.abs(mesh.points).max()) / size
    assert off_its_planes(mesh, domain) <= allowed
    for start, end in pairwise(poses):
        moved = Mesh(
            MeshMotion(mesh, FluidDomain([body], start, domain, ())).move(end), mesh.cells, mesh.facets, mesh.markers
        )
        mesh = remesh(moved, FluidDomain([body], end, domain, walls), sizes)
        assert off_its_planes(mesh, domain) <= allowed
    assert float(cell_volumes(mesh.points, mesh.cells).sum()) == pytest.approx(before, rel=1e-14 * max(1.0, 1.0 / size))


@pytest.mark.long
@pytest.mark.parametrize("way", ["cad", "fill"])
def test_rims_of_curved_walls_in_sloped_planes_are_on_both(way: Way, tmp_path: Path) -> None:
    """Edges there are halved as the body is near: the new vertices are on the round wall, and in the plane."""
    domain = drawn(oblique_tube(), tmp_path)
    body, pose, sizes = ball(0.25, 3), upright([0.55, 0.0, 0.2]), Sizes(0.6, 0.15, 0.8)
    walls = list(surfaces_of(domain, 1))
    mesh = initial_mesh(FluidDomain([body], pose, domain, walls), sizes, Inserter(way))
    for made in (mesh, remesh(mesh, FluidDomain([body], pose, domain, walls), sizes)):
        for number, piece in enumerate(domain.pieces, start=1):
            vertices = made.points[np.unique(made.facets[made.markers == number])]
            assert np.abs(piece.shape.signed_distance(vertices)).max() < 4.0 * EPSILON


@pytest.mark.long
def test_a_run_between_sloped_walls_goes_on_through_ten_meshes(tmp_path: Path) -> None:
    table = {
        "scene": {"name": "sloped", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 0.1, "gravity": [0.0, -10.0]},
        "domain": {"type": "cad", "file": written(straight(HOPPER), tmp_path)},
        "body": [{"type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.05, 0.7]}],
        "contact": {"law": "contact", "range": 0.05, "epsilon": "auto"},
        "mesh": {"size": 0.3, "size_body": 0.06, "remesh_every": 0.004},
        "time": {"end": 0.044, "step": 0.004},
        "output": {"every": 0.044},
    }
    history = run(scene_from_dict(table))
    assert history.summary["remeshes"] >= 10
    assert history.bodies["vy"][-1] < -0.05


def test_a_corner_comes_onto_all_its_planes_at_once() -> None:
    """Three planes, one of them across an axis, where its coordinate is exact; a point of two stays on their line."""
    rng = np.random.default_rng(3)
    normals = rng.normal(size=(3, 3))
    normals[0] = [0.0, 0.0, 1.0]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    planes = [Plane(np.array([0.1, 0.7, 0.3]), normal) for normal in normals]
    points = np.array([0.1, 0.7, 0.3]) + 1e-3 * rng.normal(size=(5, 3))
    belongs = np.array([[1, 1, 1], [1, 1, 0], [0, 1, 1], [0, 1, 0], [0, 0, 0]], dtype=bool)
    put = put_on_surfaces(points, planes, belongs)
    distances = np.stack([plane.signed_distance(put) for plane in planes], axis=1)
    assert np.abs(distances[belongs]).max() < 4.0 * EPSILON
    np.testing.assert_array_equal(put[:2, 2], 0.3)
    np.testing.assert_allclose(put[0], [0.1, 0.7, 0.3], rtol=0, atol=1e-15)
    np.testing.assert_array_equal(put[4], points[4])
    for row in (1, 2):  # the nearest point: the way there has no part along the line
        along = np.cross(*normals[belongs[row]])
        assert abs((put[row] - points[row]) @ along) < 1e-16


@pytest.mark.parametrize("angle", [0.0, 1e-15, 1e-11])
def test_a_corner_between_planes_that_are_one_stays_where_it_is_along_them(angle: float) -> None:
    """Rounding alone would say where they meet."""
    slope = 0.3 + np.array([0.0, angle])
    planes = [Plane(np.array([0.2, k * 1e-16]), np.array([-np.sin(a), np.cos(a)])) for k, a in enumerate(slope)]
    point = np.array([[1.0, 0.4]])
    put = put_on_surfaces(point, planes, np.ones((1, 2), dtype=bool))
    np.testing.assert_allclose(put, planes[0].closest_point(point), rtol=0, atol=1e-11)


def test_a_volume_is_as_exact_as_rounding_of_the_coordinates_allows() -> None:
    """A corner moved by a hundred roundings is seen; wherever the domain is, rounding itself is not."""
    for shift in (0.0, 1e3):
        points = np.array(TRIANGLE) + shift
        mesh = Mesh(points, np.array([[0, 1, 2]]), np.array([[0, 1], [1, 2], [2, 0]]), np.arange(3))
        expected = float(cell_volumes(points, mesh.cells)[0])
        check_volume(mesh, expected, "before")
        unit = EPSILON * np.abs(points).max()
        check_volume(replace(mesh, points=points + [[0.0, 0.0], [0.0, 2.0 * unit], [0.0, 0.0]]), expected, "before")
        with pytest.raises(MeshError, match=r"off the .* before; allowed is at most .*, by rounding"):
            check_volume(replace(mesh, points=points + [[0.0, -200.0 * unit], [0, 0], [0, 0]]), expected, "before")
