"""Domains from mesh files: every kind of file, names, regions, units, and surfaces that are refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import ball_in_a_box, bent_tube, drawn, plate
from mesh_files import CUBE, FLUID, TRIANGLES, meshed, write_by_meshio, write_gmsh41, write_stl, write_vol
from mesh_tools import ball, nobody, upright
from scipy.spatial import Delaunay

from rigidfluid.core.geometry.facets import area_vectors
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import boundary_facets, check_mesh
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.errors import SceneError


@pytest.fixture(scope="module")
def tube(tmp_path_factory: pytest.TempPathFactory) -> tuple[Mesh, list[str]]:
    domain = drawn(bent_tube(), tmp_path_factory.mktemp("tube"))
    return generate_mesh(FluidDomain([], nobody(3), domain, ()), Sizes(1.0, 1.0, 0.3)), list(domain.names)


@pytest.fixture(scope="module")
def sheet(tmp_path_factory: pytest.TempPathFactory) -> tuple[Mesh, list[str]]:
    domain = drawn(plate(), tmp_path_factory.mktemp("sheet"), 2)
    return generate_mesh(FluidDomain([], nobody(2), domain, ()), Sizes(0.4, 0.4, 0.3)), list(domain.names)


def volume(mesh: Mesh) -> float:
    return float(cell_volumes(mesh.points, mesh.cells).sum())


@pytest.mark.parametrize("kind", ["gmsh22.msh", "gmsh41.msh", "tube.med", "tube.vtu", "tube.mesh"])
@pytest.mark.parametrize("which", ["tube", "sheet"])
def test_a_mesh_is_read_from_any_file(tmp_path: Path, kind: str, which: str, request: pytest.FixtureRequest) -> None:
    mesh, names = request.getfixturevalue(which)
    path, d = tmp_path / kind, mesh.points.shape[1]
    (write_gmsh41 if "41" in kind else write_by_meshio)(path, mesh, names)
    numbered = {name: i + 1 for i, name in enumerate(names)} if path.suffix in (".vtu", ".mesh") else None
    domain = meshed(path, d, faces=numbered)
    assert set(domain.names) == set(names)
    assert domain.volume == pytest.approx(volume(mesh), rel=1e-12)
    np.testing.assert_allclose(domain.extent, [mesh.points.min(axis=0), mesh.points.max(axis=0)], rtol=0, atol=1e-15)
    areas = np.linalg.norm(area_vectors(mesh.points, mesh.facets), axis=1)
    for piece in domain.pieces:
        assert piece.area == pytest.approx(areas[mesh.markers == names.index(piece.name)].sum(), rel=1e-12)
    middles = mesh.points[mesh.cells].mean(axis=1)
    assert domain.contains(middles).all()
    assert not domain.contains(middles + 100.0).any()


@pytest.mark.parametrize("name", ["tube.vol", "packed.vol.gz"])
def test_a_file_of_netgen_needs_no_other_package(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "meshio", None)
    write_vol(tmp_path / name, bent_tube(), 1.0)
    domain = meshed(tmp_path / name)
    assert set(domain.names) == {"wall", "inflow", "outflow"}
    assert domain.volume == pytest.approx(np.pi * (8.0 + 1.5 * np.pi), rel=0.2)


def test_a_plane_mesh_of_netgen(tmp_path: Path) -> None:
    from netgen import occ

    occ.OCCGeometry(occ.Rectangle(2.0, 1.0).Face(), dim=2).GenerateMesh(maxh=0.5).Save(str(tmp_path / "plane.vol"))
    assert meshed(tmp_path / "plane.vol", 2, faces={"wall": (1, 2, 3, 4)}).volume == pytest.approx(2.0, rel=1e-12)


def test_a_package_that_is_missing_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also to the process that tries the file, which looks for modules where this one does."""
    (tmp_path / "modules").mkdir()
    (tmp_path / "modules" / "meshio.py").write_text("raise ModuleNotFoundError")
    monkeypatch.syspath_prepend(tmp_path / "modules")
    (tmp_path / "tube.msh").touch()
    with pytest.raises(SceneError, match=r"pip install 'rigidfluid\[files\]'"):
        meshed(tmp_path / "tube.msh")


def test_a_surface_alone_is_a_domain_however_its_triangles_are_turned(tmp_path: Path) -> None:
    write_stl(tmp_path / "cube.stl", CUBE, TRIANGLES)
    domain = meshed(tmp_path / "cube.stl", faces={"wall": 1}, scale=2.0)
    assert domain.volume == pytest.approx(8.0, rel=1e-15)
    assert domain.pieces[0].area == pytest.approx(24.0, rel=1e-15)
    np.testing.assert_array_equal(domain.contains(np.array([[1.0, 1.0, 1.9], [1.0, 1.0, 2.1]])), [True, False])
    assert domain.pieces[0].shape.plane is None


def test_a_hollow_in_a_surface_is_outside(tmp_path: Path) -> None:
    inner = 0.25 + 0.5 * CUBE
    write_stl(tmp_path / "shell.stl", np.vstack([CUBE, inner]), np.vstack([TRIANGLES, TRIANGLES + 8]))
    domain = meshed(tmp_path / "shell.stl", faces={"wall": 1})
    assert domain.volume == pytest.approx(1.0 - 0.125, rel=1e-15)
    np.testing.assert_array_equal(domain.contains(np.array([[0.1, 0.1, 0.1], [0.5, 0.5, 0.5]])), [True, False])


def test_points_that_are_there_twice_are_joined(tmp_path: Path) -> None:
    loose = CUBE[TRIANGLES].reshape(-1, 3) * (1.0 + 1e-12 * np.arange(36)[:, None])
    write_stl(tmp_path / "loose.stl", loose, np.arange(36).reshape(12, 3))
    domain = meshed(tmp_path / "loose.stl", faces={"wall": 1})
    assert domain.volume == pytest.approx(1.0, rel=1e-10)
    joined = len(np.unique(loose, axis=0)) - len(CUBE)
    assert domain.remarks == (
        f"{joined} points of the file were joined with others less than 1e-09 of the domain away",
    )


def test_only_the_region_that_is_fluid_counts(tmp_path: Path, tube: tuple[Mesh, list[str]]) -> None:
    """Of a tube with its cells in two groups the boundary of one alone, whose cut must have a name."""
    mesh, names = tube
    below = mesh.points[mesh.cells].mean(axis=1)[:, 2] < 2.0
    halves = replace(mesh, cells=mesh.cells[np.argsort(~below, kind="stable")])
    path = tmp_path / "halves.vtu"
    write_by_meshio(path, halves, names)
    import meshio

    made = meshio.read(path)
    made.cell_data["part"][-1][np.count_nonzero(below) :] = FLUID + 1
    meshio.write(path, made)
    faces = {name: i + 1 for i, name in enumerate(names)}
    with pytest.raises(SceneError, match=r"domain.fluid: found nothing, and several regions: 7 \(\d+ cells\); 8 "):
        meshed(path, faces=faces)
    with pytest.raises(SceneError, match=r"domain.fluid: found 'lumen', which is no region of the file"):
        meshed(path, faces=faces, fluid="lumen")
    with pytest.raises(SceneError, match=r"\d+ facets of the fluid's boundary without a number, the first about \("):
        meshed(path, faces=faces, fluid=FLUID)


def test_bodies_are_meshed_in_a_file_and_keep_its_facets(tmp_path: Path, tube: tuple[Mesh, list[str]]) -> None:
    mesh, names = tube
    write_gmsh41(tmp_path / "tube.msh", mesh, names)
    domain, body, pose = meshed(tmp_path / "tube.msh"), ball(0.3, 3), upright([0.0, 0.0, 2.0])
    made = initial_mesh(FluidDomain([body], pose, domain, surfaces_of(domain, 1)), Sizes(1.0, 0.3))
    check_mesh(made, quality=0.1)
    body_volume = volume(mesh) - volume(made)
    assert body_volume == pytest.approx(4.0 / 3.0 * np.pi * 0.027, rel=0.2)
    for number, piece in enumerate(domain.pieces, start=1):
        vertices = made.points[np.unique(made.facets[made.markers == number])]
        assert np.abs(piece.shape.signed_distance(vertices)).max() < 1e-14


def test_a_flat_piece_is_all_of_its_plane_only_where_the_domain_is_beside_it(tmp_path: Path) -> None:
    """Of an L the two sides at the corner that points inwards end there."""
    corners = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]])
    edges = np.stack([np.arange(6), np.roll(np.arange(6), -1)], axis=1)
    cells = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]])
    mesh = Mesh(corners, cells, edges, np.arange(6))
    write_gmsh41(tmp_path / "l.msh", mesh, list("abcdef"))
    domain = meshed(tmp_path / "l.msh", 2)
    flat = [piece.shape.plane is not None for piece in domain.pieces]
    assert flat == [True, True, False, False, True, True]
    wall = domain.pieces[2].shape
    np.testing.assert_allclose(wall.signed_distance(np.array([[1.5, 0.75], [0.7, 0.6]])), [0.25, 0.5], atol=1e-15)


@pytest.mark.parametrize("faces", [None, {"wall": 1}])
def test_triangles_without_area_are_refused(tmp_path: Path, faces: dict[str, Any] | None) -> None:
    write_stl(tmp_path / "points.stl", CUBE, np.array([[0, 0, 0], [1, 1, 2]]))
    with pytest.raises(SceneError, match=r"domain.file: found 2 facets, all without an area"):
        meshed(tmp_path / "points.stl", faces=faces)


@pytest.mark.parametrize("corner", [[0.5, 0.0, 0.0], [0.3, 0.3, 0.0]])
def test_surfaces_that_enclose_no_volume_are_refused(tmp_path: Path, corner: list[float]) -> None:
    """A tetrahedron pressed into a plane."""
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], corner])
    write_stl(tmp_path / "flat.stl", points, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
    with pytest.raises(SceneError, match=r"domain.file: found facets that enclose a volume of -?0"):
        meshed(tmp_path / "flat.stl", faces={"wall": 1})


def with_baffle(dimension: int, cracked: bool) -> tuple[Mesh, list[str]]:
    """A square or cube, its sides one group, and a plate that stands in its middle, `cracked`: with points of its own
    on either side."""
    steps = np.arange(5) / 4.0
    points = np.stack(np.meshgrid(*[steps] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    cells = Delaunay(points).simplices.astype(np.int64)
    outer = boundary_facets(cells)
    sides = np.concatenate([np.delete(cells, k, axis=1) for k in range(dimension + 1)])
    in_plate = np.all((points[sides][..., 0] == 0.5) & (points[sides][..., 1] <= 0.5), axis=1)
    plate = np.unique(np.sort(sides[in_plate], axis=1), axis=0)
    facets, count = [outer, plate], len(points)
    if cracked:
        inside = [corner for corner in np.unique(plate) if not np.isin(corner, outer) and points[corner, 1] < 0.5]
        twin = np.arange(count)
        twin[inside] = count + np.arange(len(inside))
        beyond = points[cells].mean(axis=1)[:, 0] > 0.5
        cells[beyond] = twin[cells[beyond]]
        points, facets = np.concatenate([points, points[inside]]), [outer, plate, twin[plate]]
    markers = np.repeat([0, 1, 1], [len(outer), len(plate), len(plate) * cracked])
    return Mesh(points, cells, np.concatenate(facets), markers), ["side", "plate"]


@pytest.mark.parametrize("cracked", [False, True])
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_wall_without_thickness_is_refused_by_its_name(tmp_path: Path, dimension: int, cracked: bool) -> None:
    mesh, names = with_baffle(dimension, cracked)
    write_gmsh41(tmp_path / "baffle.msh", mesh, names)
    found = r"domain.file: found \d+ facets of 2 'plate' with fluid on both sides, the first about \(0.5, "
    with pytest.raises(SceneError, match=found):
        meshed(tmp_path / "baffle.msh", dimension)
    alone = mesh.markers == 0
    whole = replace(with_baffle(dimension, False)[0], facets=mesh.facets[alone], markers=mesh.markers[alone])
    write_gmsh41(tmp_path / "whole.msh", whole, names[:1])
    assert meshed(tmp_path / "whole.msh", dimension).volume == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize(
    ("points", "facets", "message"),
    [
        (CUBE, TRIANGLES[1:], r"domain.file: found an open surface: 3 free edges, the first at \[\["),
        (CUBE, np.vstack([TRIANGLES, [[0, 1, 7]]]), r"domain.file: found (an open surface|surfaces that branch)"),
        (
            np.vstack([CUBE, CUBE * [0.5, 0.5, 3.0] + [0.2, 0.3, -1.0]]),
            np.vstack([TRIANGLES, TRIANGLES + 8]),
            r"domain.file: found facets that cross each other, the first two about \(.*\) and \(",
        ),
        (
            np.vstack([CUBE, CUBE + [2.0, 0.0, 0.0]]),
            np.vstack([TRIANGLES, TRIANGLES + 8]),
            r"domain.file: found fluid in 2 regions .* about \[0.5, 0.5, 0.5\] and \[2.5, 0.5, 0.5\]; allowed is one",
        ),
    ],
)
def test_surfaces_that_enclose_nothing_sound_are_refused(
    tmp_path: Path, points: np.ndarray, facets: np.ndarray, message: str
) -> None:
    write_stl(tmp_path / "bad.stl", points, facets)
    with pytest.raises(SceneError, match=message):
        meshed(tmp_path / "bad.stl", faces={"wall": 1})


@pytest.mark.parametrize(
    ("faces", "message"),
    [
        (None, r"domain.faces: found nothing, and no names in the file for 1 \(12 facets about \(0.5, 0.5, 0.5\)\)"),
        ({"wall": 2}, r"domain.faces.wall: found 2, which is not in the file; allowed is 1 \(12 facets"),
        ({}, r"domain.faces: found no surface for 1"),
        ({"a\nb": 1}, r"domain.faces: found a surface named 'a\\nb'; allowed is a name without control characters"),
    ],
)
def test_facets_without_a_surface_are_refused(tmp_path: Path, faces: dict[str, Any] | None, message: str) -> None:
    write_stl(tmp_path / "cube.stl", CUBE, TRIANGLES)
    with pytest.raises(SceneError, match=message):
        meshed(tmp_path / "cube.stl", faces=faces)


@pytest.mark.parametrize("name", ["empty.msh", "empty.vtu", "empty.mesh", "empty.med", "empty.vol", "empty.stl"])
def test_unreadable_files_are_refused(tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SceneError, match=r"domain.file: found .*allowed is a file that is there"):
        meshed(tmp_path / name)
    (tmp_path / name).touch()
    with pytest.raises(SceneError, match=r"domain.file: found "):
        meshed(tmp_path / name)
    (tmp_path / name).write_text("nonsense\n1 2 3\n")
    with pytest.raises(SceneError, match=r"domain.file: found "):
        meshed(tmp_path / name)
    assert capsys.readouterr() == ("", "")


def test_files_of_another_dimension_or_kind_are_refused(tmp_path: Path, tube: tuple[Mesh, list[str]]) -> None:
    write_gmsh41(tmp_path / "tube.msh", *tube)
    with pytest.raises(SceneError, match=r"points off the plane z = 0, by up to 8"):
        meshed(tmp_path / "tube.msh", 2)
    (tmp_path / "tube.step").touch()
    with pytest.raises(SceneError, match=r"allowed is one of .msh.*type = 'cad'"):
        meshed(tmp_path / "tube.step")
    write_vol(tmp_path / "tube.vol", ball_in_a_box(), 1.0)
    with pytest.raises(SceneError, match=r"points in 3 dimensions; allowed is a mesh in 2 dimensions"):
        meshed(tmp_path / "tube.vol", 2)
