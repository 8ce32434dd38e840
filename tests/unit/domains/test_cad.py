"""Domains from CAD files: exact closest points, names, units, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import ball_in_a_box, bent_tube, drawn, plate, written
from mesh_tools import ball, upright

from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import check_mesh
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.core.setup.profiles import Disk, Rectangle, section
from rigidfluid.domains.cad import Cad, CadOptions
from rigidfluid.domains.closed_form import Flat, Offset, form_of_face
from rigidfluid.errors import SceneError

ROUND_OFF = 1e-10
BY_NUMBER = {"inflow": 5, "outflow": "outflow", "wall": (1, 2, 4)}


def to_the_tube(x: np.ndarray) -> np.ndarray:
    """1 minus the distance to the middle line of the bent tube, of points inside it."""
    straight = np.where(x[:, 2] <= 4.0, np.hypot(x[:, 0], x[:, 1]), np.hypot(x[:, 1], x[:, 2] - 7.0))
    bend = np.hypot(np.hypot(x[:, 0] - 3.0, x[:, 2] - 4.0) - 3.0, x[:, 1])
    return 1.0 - np.where((x[:, 0] < 3.0) & (x[:, 2] > 4.0), bend, straight)


@pytest.mark.long
def test_a_tube_written_and_read_back_is_exact(tmp_path: Path) -> None:
    tube = drawn(bent_tube(), tmp_path)
    assert set(tube.names) == {"wall", "inflow", "outflow"}
    assert tube.volume == pytest.approx(np.pi * (8.0 + 1.5 * np.pi), rel=1e-12)
    lower, upper = tube.extent
    points = np.random.default_rng(0).uniform(lower, upper, (3000, 3))
    inside = points[tube.contains(points)]
    assert len(inside) == pytest.approx(3000 * tube.volume / np.prod(tube.size), rel=0.05)
    where_leg_and_bend_meet = np.random.default_rng(1).uniform([-0.7, -0.7, 3.98], [0.7, 0.7, 4.02], (3000, 3))
    inside = np.concatenate([inside, where_leg_and_bend_meet])
    wall = tube.pieces[tube.names.index("wall")].shape
    distance, foot = wall.signed_distance(inside), wall.closest_point(inside)
    np.testing.assert_allclose(distance, to_the_tube(inside), rtol=0, atol=ROUND_OFF)
    np.testing.assert_allclose(np.linalg.norm(inside - foot, axis=1), distance, rtol=0, atol=ROUND_OFF)
    np.testing.assert_allclose(to_the_tube(foot), 0.0, rtol=0, atol=ROUND_OFF)
    assert wall.least_radius == pytest.approx(1.0, rel=1e-12)


def test_a_leg_ends_where_its_face_does(tmp_path: Path) -> None:
    """Its cylinder goes on through the bend."""
    tube = drawn(bent_tube(), tmp_path, faces={"leg": 4, "rest": (1, 2), "inflow": 5, "outflow": 3})
    leg = tube.pieces[0].shape
    on_the_axis = np.array([[0.0, 0.0, 2.0], [0.5, 0.0, 5.0], [1.0, 0.0, 6.0]])
    to_the_rim = [1.0, np.hypot(0.5, 1.0), 2.0]
    np.testing.assert_allclose(leg.signed_distance(on_the_axis), to_the_rim, rtol=0, atol=0.01)
    np.testing.assert_allclose(leg.closest_point(on_the_axis)[1:], [[1.0, 0.0, 4.0]] * 2, rtol=0, atol=0.1)


def test_fluid_behind_a_plate_is_not_in_it(tmp_path: Path) -> None:
    from netgen import occ

    plate = occ.Box(occ.Pnt(0.9, 0.5, 0.5), occ.Pnt(1.0, 1.5, 1.5))
    plate.faces.name = "edge"
    plate.faces.Min(occ.X).name, plate.faces.Max(occ.X).name = "front", "back"
    box = occ.Box(occ.Pnt(0, 0, 0), occ.Pnt(2, 2, 2))
    box.faces.name = "box"
    domain = drawn(box - plate, tmp_path)
    sides = {piece.name: piece.shape for piece in domain.pieces}
    points = np.array([[0.5, 1.0, 1.0], [0.93, 1.0, 1.0], [1.5, 1.0, 1.0]])
    np.testing.assert_allclose(sides["front"].signed_distance(points), [0.4, -0.03, 0.6], rtol=0, atol=1e-12)
    np.testing.assert_allclose(sides["back"].signed_distance(points), [0.5, -0.07, 0.5], rtol=0, atol=1e-12)


def test_a_wall_of_a_cylinder_and_its_caps_is_exact(tmp_path: Path) -> None:
    from netgen import occ

    can = occ.Cylinder(occ.Pnt(0, 0, 0), occ.Z, 1, 2)
    can.faces.name = "can"
    (piece,) = drawn(can, tmp_path).pieces
    points = np.random.default_rng(1).uniform([-0.7, -0.7, 0.0], [0.7, 0.7, 0.3], (4000, 3))
    exact = np.minimum(1.0 - np.hypot(points[:, 0], points[:, 1]), np.minimum(points[:, 2], 2.0 - points[:, 2]))
    found = piece.shape.signed_distance(points)
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-3)  # of facets, where two faces are as near
    assert np.mean(np.abs(found - exact) < ROUND_OFF) > 0.99


def test_points_outside_a_wall_are_at_negative_distances(tmp_path: Path) -> None:
    tube = drawn(bent_tube(), tmp_path)
    wall = tube.pieces[tube.names.index("wall")].shape
    np.testing.assert_allclose(wall.signed_distance(np.array([[0.0, 1.25, 2.0], [5.0, 0.0, 9.0]])), [-0.25, -1.0])


@pytest.mark.long
def test_round_ends_are_known_as_disks(tmp_path: Path) -> None:
    """So that they can have a Poiseuille profile; and rectangles next to curved faces as rectangles."""
    tube = drawn(bent_tube(), tmp_path)
    end = section(tube.pieces[tube.names.index("outflow")])
    assert isinstance(end, Disk)
    np.testing.assert_allclose(end.centre, [7.0, 0.0, 7.0], rtol=0, atol=1e-12)
    assert end.radius == pytest.approx(1.0, rel=1e-12)
    box = ball_in_a_box()
    for face, name in zip(sorted(box.faces, key=lambda face: face.center.x)[:1], ("left",), strict=True):
        face.name = name
    left = drawn(box, tmp_path)
    assert isinstance(section(left.pieces[left.names.index("left")]), Rectangle)


@pytest.mark.long
def test_a_body_is_meshed_in_a_tube(tmp_path: Path) -> None:
    tube, body, pose = drawn(bent_tube(), tmp_path), ball(0.4, 3), upright([0.0, 0.0, 2.0])
    mesh = initial_mesh(FluidDomain([body], pose, tube, surfaces_of(tube, 1)), Sizes(0.6, 0.3))
    check_mesh(mesh, quality=0.1)
    on_wall = mesh.points[np.unique(mesh.facets[mesh.markers == 1 + tube.names.index("wall")])]
    assert np.abs(to_the_tube(on_wall)).max() < 1e-13


def test_a_ball_is_known_as_one(tmp_path: Path) -> None:
    domain = drawn(ball_in_a_box(), tmp_path)
    shapes = {piece.name: piece.shape for piece in domain.pieces}
    assert shapes["ball"].radius == pytest.approx(0.5, rel=1e-12)
    assert shapes["box"].radius is None
    assert domain.volume == pytest.approx(8.0 - np.pi / 6.0, rel=1e-12)
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (500, 3))
    away = np.linalg.norm(points, axis=1) - 0.5
    np.testing.assert_allclose(shapes["ball"].signed_distance(points), away, rtol=0, atol=ROUND_OFF)
    np.testing.assert_array_equal(domain.contains(points), away > 0.0)
    np.testing.assert_allclose(
        np.abs(shapes["box"].signed_distance(points)), 1.0 - np.abs(points).max(axis=1), rtol=0, atol=ROUND_OFF
    )


def test_units_of_the_file_are_scaled(tmp_path: Path) -> None:
    domain = drawn(plate(), tmp_path, 2, scale=0.01)
    assert domain.volume == pytest.approx(1e-4 * (8.0 - np.pi * 0.09), rel=1e-12)
    assert domain.pieces[domain.names.index("hole")].shape.radius == pytest.approx(0.003, rel=1e-12)
    np.testing.assert_allclose(domain.extent, [[0.0, 0.0], [0.04, 0.02]], rtol=0, atol=1e-12)


def test_faces_without_names_get_them_by_number(tmp_path: Path) -> None:
    path = written(bent_tube(), tmp_path, "tube.brep")
    with pytest.raises(SceneError, match=r"domain.faces: found nothing, and no names in the file for 1 \(about"):
        Cad(CadOptions(file=path), 3)
    named = Cad(CadOptions(file=path, faces=BY_NUMBER | {"outflow": 3}), 3)
    assert named.names == ("inflow", "outflow", "wall")
    assert named.pieces[2].area == pytest.approx(np.pi * (16.0 + 3.0 * np.pi), rel=1e-10)
    assert named.pieces[0].shape.plane is not None


@pytest.mark.parametrize(
    ("faces", "message"),
    [
        ({"wall": "wall", "inflow": "inflow"}, r"domain.faces: found no surface for 3 'outflow' \(about"),
        ({"wall": "wal"}, r"domain.faces.wall: found 'wal', which is not in the file.*Did you mean 'wall'"),
        ({"wall": (1, 9)}, r"domain.faces.wall: found 9, which is not in the file; allowed is 1 'wall'"),
        (BY_NUMBER | {"wall": (1, 2, 3, 4)}, r"domain.faces.wall: found 3, which belongs to 'outflow' already"),
        ({"all": (1, 2, 3, 4, 5)}, r"domain.faces: found a surface named 'all'"),
    ],
)
def test_wrong_names_are_refused(tmp_path: Path, faces: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        drawn(bent_tube(), tmp_path, faces=faces)


def test_files_that_are_no_domain_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"domain.file: found .*nothing.step: No such file.*; allowed is a file"):
        Cad(CadOptions(file=str(tmp_path / "nothing.step")), 3)
    (tmp_path / "empty.step").touch()
    with pytest.raises(SceneError, match=r"domain.file: found .*empty.step, which Open CASCADE cannot read"):
        Cad(CadOptions(file=str(tmp_path / "empty.step")), 3)
    (tmp_path / "mesh.msh").touch()
    with pytest.raises(SceneError, match=r"domain.file: found .*mesh.msh; allowed is one of .step.*type = 'mesh'"):
        Cad(CadOptions(file=str(tmp_path / "mesh.msh")), 3)
    with pytest.raises(SceneError, match=r"with 0 solids and 1 faces; allowed is one solid in 3D"):
        drawn(plate(), tmp_path, 3)
    with pytest.raises(SceneError, match=r"with 1 solids and 5 faces; allowed is one face and no solid in 2D"):
        drawn(bent_tube(), tmp_path, 2)


def test_forms_of_other_faces_are_not_guessed() -> None:
    from netgen import occ

    egg = occ.Ellipsoid(occ.Axes(occ.Pnt(0, 0, 0), occ.X, occ.Y), 2.0, 1.0, 0.5)
    assert form_of_face(egg.faces[0].surf) is None
    ball = occ.Sphere(occ.Pnt(1, 2, 3), 2).Rotate(occ.Axis(occ.Pnt(0, 0, 0), occ.Dir(1, 1, 0)), 33)
    form = form_of_face(ball.faces[0].surf)
    assert isinstance(form, Offset)
    assert form.round
    assert isinstance(form_of_face(occ.Box(occ.Pnt(0, 0, 0), occ.Pnt(1, 2, 3)).faces[0].surf), Flat)
