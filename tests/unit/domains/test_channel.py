"""Channels with obstacles, and with a throat: what is refused, and distances known in closed form."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from channels import CHANNEL, PIN, THROAT, scene
from mesh_files import CUBE, TRIANGLES, write_stl
from mesh_tools import nobody, upright

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.case.schema import json_schema
from rigidfluid.core.case.system import build_system
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.nested.bodies import NestedBodyTable
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.domains.channel import Channel, ChannelOptions
from rigidfluid.domains.orientation import facing_the_fluid
from rigidfluid.domains.stenosis import Stenosis, StenosisOptions
from rigidfluid.errors import RigidfluidError


def channel(*obstacles: dict[str, Any]) -> dict[str, Any]:
    return CHANNEL | {"obstacle": list(obstacles)}


@pytest.mark.parametrize(
    ("domain", "message"),
    [
        (channel(PIN, PIN), r"domain.obstacle.1.name: found 'pin' for the second time"),
        (channel(PIN | {"name": "left"}), r"domain.obstacle.0.name: found 'left'; allowed is a name other than all, l"),
        (channel(PIN | {"name": "all"}), r"domain.obstacle.0.name: found 'all'"),
        (channel(PIN | {"name": "a\nb"}), r"domain.obstacle.0.name: found 'a\\nb'"),
        (channel(PIN | {"position": [2.0, 0.1], "radius": 0.1}), r"obstacle.0.position: .*overlaps 'bottom' by 0;"),
        (channel(PIN | {"position": [2.0, 0.15]}), r"obstacle.0.position: .*'pin' overlaps 'bottom' by 0.05;"),
        (channel(PIN | {"position": [2.0, 9.0]}), r"obstacle.0.position: found \[2.0, 9.0\]; allowed is inside"),
        (
            channel(PIN, PIN | {"name": "b", "position": [2.3, 0.4]}),
            r"obstacle.0.position: .*'pin' overlaps 'b' by 0.1",
        ),
        (channel(PIN | {"position": [2.0]}), r"obstacle.0.position: found \[2.0\], 1 of them; allowed is 2 numbers"),
        (channel(PIN | {"raduis": 0.2}), r"domain.obstacle.0.raduis: found a key that nothing reads.*'radius'"),
        (channel(PIN | {"radius": -1.0}), r"domain.obstacle.0.radius: found -1"),
        (channel(PIN | {"type": "spere"}), r"domain.obstacle.0.type: found 'spere'.*Did you mean 'sphere'"),
        (channel(PIN | {"orientation": [1.0, 0.0, 0.0, 0.0]}), r"domain.obstacle.0.orientation: .*no quaternion in 2D"),
        (channel({"type": "sphere", "radius": 0.1}), r"domain.obstacle.0.position: this key is missing"),
        (
            channel(PIN | {"type": "ellipsoid", "semi_axes": [0.1]}),
            r"obstacle.0.radius: found a key that nothing reads",
        ),
        (
            channel({"type": "ellipsoid", "semi_axes": [0.1, 0.1, 0.1], "position": [1.0, 0.5]}),
            r"domain.obstacle.0.semi_axes: found .*a list of 2 lengths",
        ),
        (THROAT | {"radius": 4.0}, r"domain.radius: found 4.0; allowed is less than half of domain.width = 8"),
        (THROAT | {"throat": 8.0}, r"domain.throat: found 8.0; allowed is less than domain.width = 8"),
        (THROAT | {"radius": 1.0, "throat": 2.0}, r"domain.radius: found 1.0; allowed is more than 1.5"),
        (THROAT | {"length": 6.2}, r"domain.length: found 6.2; allowed is more than 6.25"),
        (THROAT | {"radius": 3.0, "throat": 1.0, "length": 6.0}, r"domain.length: .*more than 6, the width"),
    ],
)
def test_what_cannot_be_is_refused(domain: dict[str, Any], message: str) -> None:
    with pytest.raises(RigidfluidError, match=message):
        scene_from_dict(scene(domain))


def test_a_stenosis_in_space_is_refused() -> None:
    body = [{"type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.0, 0.0, 0.0]}]
    with pytest.raises(RigidfluidError, match=r"domain.type: found 'stenosis' in 3D"):
        scene_from_dict(scene(THROAT, scene={"name": "x", "dimension": 3}, body=body))


def test_keys_of_an_obstacle_are_in_the_schema() -> None:
    schema = jsonschema.Draft7Validator(json_schema())
    assert not list(schema.iter_errors(scene(channel(PIN))))
    assert list(schema.iter_errors(scene(channel({"type": "sphere", "radius": 0.1}))))


def test_a_polygon_is_an_obstacle_with_sharp_corners() -> None:
    star = {"type": "polygon", "points": [[0.0, 0.0], [0.3, 0.1], [0.0, 0.2], [0.1, 0.1]], "position": [2.0, 0.5]}
    parts = model_of(scene_from_dict(scene(channel(star | {"name": "star", "angle": 0.4}))))
    domain, piece = parts.domain, parts.domain.pieces[4]
    assert domain.volume == pytest.approx(4.0 - 0.02, rel=1e-14)
    assert piece.area == pytest.approx(2.0 * np.hypot(0.3, 0.1) + 2.0 * np.hypot(0.1, 0.1), rel=1e-14)
    body, pose = parts.shapes[0], upright([1.0, 0.5])
    mesh = initial_mesh(FluidDomain([body], pose, domain, surfaces_of(domain, 1)), Sizes(0.2, 0.05))
    on_star = mesh.points[np.unique(mesh.facets[mesh.markers == 5])]
    assert np.abs(piece.shape.signed_distance(on_star)).max() < 1e-14
    disk = 0.5 * np.abs(np.linalg.det(mesh.points[mesh.facets[mesh.markers == 0]] - pose.position[0])).sum()
    assert cell_volumes(mesh.points, mesh.cells).sum() + disk == pytest.approx(domain.volume, rel=1e-12)


def test_a_polyhedron_is_an_obstacle(tmp_path: Path) -> None:
    write_stl(tmp_path / "cube.stl", CUBE, facing_the_fluid(Facets(CUBE, TRIANGLES, TRIANGLES[:, 0]), "x").vertices)
    tables = (NestedBodyTable(type="stl", file=str(tmp_path / "cube.stl"), scale=0.5, position=(1.0, 1.0, 1.0)),)
    domain = Channel(ChannelOptions(lower=(0.0, 0.0, 0.0), upper=(2.0, 2.0, 2.0), obstacle=tables), 3)
    assert domain.volume == pytest.approx(8.0 - 0.125, rel=1e-12)
    mesh = generate_mesh(FluidDomain([], nobody(3), domain, ()), Sizes(0.5, 0.5, 0.3))
    assert cell_volumes(mesh.points, mesh.cells).sum() == pytest.approx(domain.volume, rel=1e-12)


def test_a_body_in_an_obstacle_is_refused() -> None:
    body = {"type": "sphere", "radius": 0.1, "density": 2.0, "position": [1.8, 0.55]}
    with pytest.raises(RigidfluidError, match=r"body 'body0' overlaps surface 'pin' of the domain by 0.05"):
        build_system(scene_from_dict(scene(channel(PIN), body=[body])))


def test_conditions_hold_on_obstacles_by_name() -> None:
    parts = model_of(scene_from_dict(scene(channel(PIN), boundary=[{"on": "pin", "type": "wall"}])))
    assert parts.domain.names == ("left", "right", "bottom", "top", "pin")


def test_gaps_to_obstacles_and_bumps_are_exact() -> None:
    """|c - c'| - r - R, to round-off."""
    system = build_system(scene_from_dict(scene(channel(PIN))))
    assert isinstance(system.detector, SphereDetector)
    found = system.detector.detect(system.pose, None, np.inf)
    assert found.gap[found.body_b == 5][0] == pytest.approx(np.hypot(1.0, 0.1) - 0.3, abs=1e-15)
    body = {"type": "sphere", "radius": 0.5, "density": 2.0, "position": [-2.0, 0.6]}
    system = build_system(scene_from_dict(scene(THROAT, body=[body])))
    found = system.detector.detect(system.pose, None, np.inf)
    np.testing.assert_array_equal(found.body_b, [1, 2, 3, 4, 5, 6])
    np.testing.assert_allclose(found.gap[4:], np.hypot(2.0, [4.6, 3.4]) - 3.625, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(found.radius_b[4:], 3.125)


@pytest.mark.parametrize("throat", [None, 5.0, 1.0])
def test_bumps_leave_the_throat(throat: float | None) -> None:
    domain = Stenosis(StenosisOptions(length=32.0, width=8.0, radius=3.125, throat=throat), 2)
    bottom, top = domain.pieces[4:]
    crest = np.zeros((1, 2))
    gap = bottom.shape.signed_distance(crest) + top.shape.signed_distance(crest)
    assert gap[0] == pytest.approx(throat or 1.75, abs=1e-14)
    assert bottom.shape.bounds[1][1] == pytest.approx(-0.5 * (throat or 1.75), abs=1e-14)


def test_the_area_of_the_stenosis_of_the_paper() -> None:
    domain = Stenosis(StenosisOptions(length=32.0, width=8.0, radius=3.125), 2)
    assert domain.volume == pytest.approx(256.0 - np.pi * 3.125**2, rel=1e-15)


def test_beside_a_flat_bump_its_end_is_nearest() -> None:
    """Not the part of its circle that is below the wall."""
    domain = Stenosis(StenosisOptions(length=32.0, width=8.0, radius=3.125, throat=6.0), 2)
    arc = domain.pieces[4].shape
    far = np.array([[10.0, -3.5]])
    end = np.sqrt(1.0 * (2 * 3.125 - 1.0))
    np.testing.assert_allclose(arc.closest_point(far), [[end, -4.0]], rtol=0, atol=1e-14)
    assert arc.signed_distance(far)[0] == pytest.approx(np.hypot(10.0 - end, 0.5), abs=1e-14)


def test_a_channel_without_obstacles_is_a_box() -> None:
    assert model_of(scene_from_dict(scene(CHANNEL))).domain.names == ("left", "right", "bottom", "top")
