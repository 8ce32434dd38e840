"""Bodies in the round container of docs/plugins.md: detectors, the mesh, checks and whole runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import factorial
from typing import Any

import jsonschema
import numpy as np
import pytest
from dish import CODE, dish, in_a_dish, inside, rim
from mesh_tools import ball, ellipsoid, upright
from wedge import wedge

from rigidfluid.checks.report import check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.schema import json_schema
from rigidfluid.core.case.system import build_system
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion, held_components
from rigidfluid.core.mesh.adaptation.remesh import remesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import check_mesh
from rigidfluid.core.model.contact_results import refuse_odd
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Motion, Pose
from rigidfluid.core.run.run import run
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.detectors.brute_force import BruteForceDetector, BruteForceOptions
from rigidfluid.detectors.ellipsoid import EllipsoidDetector
from rigidfluid.detectors.narrow_band import NarrowBandDetector, NarrowBandOptions
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.errors import PluginError, SceneError
from rigidfluid.forces.contact import ContactPointLaw
from rigidfluid.registry import DOMAIN, Registry

DISK = {"type": "sphere", "radius": 0.15, "density": 3.0, "position": [0.35, 0.3]}
ELLIPSE = {"type": "ellipsoid", "semi_axes": [0.2, 0.1], "angle": 0.4, "density": 3.0, "position": [0.35, 0.3]}
ACROSS = r"boundary.0.velocity: found .* across the wall 'rim'"
DRY = {"backend": "dry", "gravity": [0.0, -10.0]}


@pytest.fixture(autouse=True)
def _plug_in(install: Any) -> None:
    install(CODE, name="dish", module="rigidfluid_dish")


def built(*bodies: dict[str, Any], **tables: Any) -> Scene:
    return scene_from_dict(in_a_dish(*bodies, **tables))


def balls_near_the_rim(dimension: int) -> tuple[list[Any], Pose]:
    centres = np.array([[0.5, 0.4, 0.1], [-0.6, 0.2, 0.0], [0.0, -0.1, 0.2], [0.1, -0.75, 0.1]])[:, :dimension]
    return [ball(0.2, dimension), ball(0.3, dimension), ball(0.1, dimension), ball(0.22, dimension)], upright(*centres)


def at_walls(detector: Detector, pose: Pose, reach: float = np.inf) -> Contacts:
    found = detector.detect(pose, None, reach)
    assert np.array_equal(found.at_wall, found.body_b == len(detector.bodies))
    return select(found, found.at_wall)


def enclosed_by_the_rim(mesh: Mesh) -> float:
    """Volume of the polyhedron of the rim's facets, which all see the origin."""
    corners = mesh.points[mesh.facets[mesh.markers == 1]]
    return float(np.abs(np.linalg.det(corners)).sum()) / factorial(corners.shape[1])


@pytest.mark.parametrize("dimension", [2, 3])
def test_gaps_of_balls_are_exact_by_the_walls_distance(dimension: int) -> None:
    bodies, pose = balls_near_the_rim(dimension)
    found = at_walls(SphereDetector(PartOptions(), bodies, [rim(4, dimension=dimension)]), pose)
    away = np.linalg.norm(pose.position, axis=1)
    radii = np.array([body.radius for body in bodies])
    np.testing.assert_allclose(found.gap, 1.0 - away - radii, rtol=0, atol=1e-15)
    np.testing.assert_allclose(found.normal, -pose.position / away[:, None], atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(found.point_b, axis=1), 1.0, rtol=1e-9)
    np.testing.assert_allclose(found.point_a, found.point_b + found.gap[:, None] * found.normal, atol=1e-12)
    np.testing.assert_array_equal(found.radius_b, -1.0)
    few = SphereDetector(PartOptions(), bodies, [rim(4, dimension=dimension)]).detect(pose, None, 0.1)
    assert np.all(few.gap <= 0.1)
    assert np.all(np.diff(few.body_a * 5 + few.body_b) > 0)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_search_finds_the_same_gaps(dimension: int) -> None:
    bodies, pose = balls_near_the_rim(dimension)
    wall = rim(4, dimension=dimension)
    exact = at_walls(SphereDetector(PartOptions(), bodies, [wall]), pose)
    searched = at_walls(BruteForceDetector(BruteForceOptions(samples=200), bodies, [wall]), pose)
    np.testing.assert_allclose(searched.gap, exact.gap, rtol=0, atol=1e-8)
    np.testing.assert_allclose(searched.point_b, exact.point_b, rtol=0, atol=1e-3)


def test_an_ellipse_meets_the_rim_with_its_tip() -> None:
    bodies, pose = [ellipsoid(0.2, 0.1)], upright([0.7, 0.0])
    found = at_walls(BruteForceDetector(BruteForceOptions(), bodies, [rim(1)]), pose)
    assert found.gap[0] == pytest.approx(0.1, abs=1e-9)


def test_a_detector_on_the_mesh_sees_the_facets() -> None:
    bodies, pose = balls_near_the_rim(2)
    wall, sizes = rim(4), Sizes(0.1, 0.02)
    mesh = initial_mesh(FluidDomain(bodies, pose, dish(), [wall]), sizes)
    exact = at_walls(SphereDetector(PartOptions(), bodies, [wall]), pose, 0.3)
    marched = NarrowBandDetector(NarrowBandOptions(), bodies, [wall]).detect(pose, mesh, 0.3)
    gaps = marched.gap[marched.at_wall]
    assert len(gaps) == len(exact.gap)
    np.testing.assert_allclose(gaps, exact.gap, rtol=0, atol=0.1**2 / 8 + 0.02**2 / 0.8)
    np.testing.assert_array_equal(marched.radius_b[marched.at_wall], -1.0)


def test_the_detector_of_ellipsoids_refuses_a_wall_that_is_neither_flat_nor_round_by_name() -> None:
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    facets = Facets(corners, np.array([[1, 0], [2, 1], [0, 2]]), np.zeros(3, dtype=np.int64))
    with pytest.raises(
        SceneError, match=r"contact.detector: found .ellipsoid. with the wall 'corner'; .* flat or round"
    ):
        EllipsoidDetector(PartOptions(), [ellipsoid(0.2, 0.1)], [Wall(1, "corner", FacetSurface(facets))])


def test_auto_takes_what_can() -> None:
    assert build_system(built(DISK)).detector.name == "sphere"
    assert build_system(built(ELLIPSE)).detector.name == "ellipsoid"
    square = {"type": "polygon", "points": [[0.0, 0.0], [0.2, 0.0], [0.2, 0.2], [0.0, 0.2]], "density": 3.0}
    assert (
        build_system(built(DISK | {"position": [0.0, -0.5]}, square | {"position": [0, 0]})).detector.name == "facets"
    )


def random_ellipsoids_in_the_dish(dimension: int, elongated: bool) -> tuple[list[Any], Pose]:
    """Long and flat ones in all directions, near the rim of radius 1."""
    rng, bodies, positions, turns = np.random.default_rng(dimension), [], [], []
    for _ in range(20):
        axes = rng.uniform(0.05, 0.4, dimension) if elongated else np.full(dimension, rng.uniform(0.1, 0.3))
        bodies.append(ellipsoid(*axes))
        away = rng.normal(size=dimension)
        positions.append((1.02 - axes.max()) * rng.uniform(0.5, 1.0) * away / np.linalg.norm(away))
        turn = rng.normal(size=4)
        turns.append(turn / np.linalg.norm(turn) if dimension == 3 else rng.uniform(0, 7, 1))
    return bodies, Pose(np.array(positions), np.array(turns))


@pytest.mark.parametrize("elongated", [True, False])
@pytest.mark.parametrize("dimension", [2, 3])
def test_ellipsoids_meet_the_rim_as_a_search_says(dimension: int, elongated: bool) -> None:
    bodies, pose = random_ellipsoids_in_the_dish(dimension, elongated)
    for i in range(len(bodies)):
        one, wall = Pose(pose.position[i : i + 1], pose.orientation[i : i + 1]), rim(1, dimension=dimension)
        exact = at_walls(EllipsoidDetector(PartOptions(), bodies[i : i + 1], [wall]), one)
        searched = at_walls(BruteForceDetector(BruteForceOptions(), bodies[i : i + 1], [wall]), one)
        assert exact.gap[0] == pytest.approx(searched.gap[0], abs=1e-12)
        assert exact.gap[0] == exact.gap.min()
        np.testing.assert_allclose(np.linalg.norm(exact.point_b, axis=1), 1.0, rtol=1e-14)
        np.testing.assert_allclose(exact.point_a, exact.point_b + exact.gap[:, None] * exact.normal, atol=1e-14)


def test_an_ellipse_that_lies_in_the_dish_touches_it_with_both_ends() -> None:
    """At (0, -y), longer than the rim is round there: the ends are where |x| is largest, equally or nearly so."""
    bodies = [ellipsoid(0.4, 0.05)]
    detector = EllipsoidDetector(PartOptions(), bodies, [rim(1)])
    for tilt in (0.0, 0.01, -0.01):
        found = at_walls(detector, Pose(np.array([[0.0, -0.9]]), np.array([[tilt]])))
        angle = np.linspace(0, 2 * np.pi, 200_001)
        ellipse = np.stack([0.4 * np.cos(angle), 0.05 * np.sin(angle)])
        turn = np.array([[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]])
        x, y = turn @ ellipse + np.array([[0.0], [-0.9]])
        away = 1.0 - np.hypot(x, y)
        ends = sorted([away[x > 0].min(), away[x < 0].min()])
        np.testing.assert_allclose(found.gap, ends, rtol=0, atol=1e-9)
    on_end = at_walls(detector, Pose(np.array([[0.0, -0.5]]), np.array([[np.pi / 2]])))
    np.testing.assert_allclose(on_end.gap, [0.1], atol=1e-14)


def test_an_ellipse_rocks_in_the_dish_with_all_its_energy() -> None:
    scene = built(
        {"type": "ellipsoid", "semi_axes": [0.4, 0.05], "density": 3.0, "position": [0.0, -0.8]},
        fluid=DRY,
        contact={"law": "contact", "range": 0.02, "epsilon": "auto"},
        time={"end": 0.5, "step": 0.01},
        output={"every": 0.5},
    )
    simulation = Simulation(scene, None, False)
    simulation.go()
    state = simulation.state
    assert abs(state.pose.orientation[0, 0]) < 1e-9  # both ends hold it
    assert abs(state.pose.position[0, 0]) < 1e-9
    assert state.ledger.contact + state.ledger.kinetic == pytest.approx(state.ledger.gravity, rel=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_ellipsoids_meet_a_round_bump_as_they_meet_a_ball(dimension: int) -> None:
    rng = np.random.default_rng(1)
    for _ in range(10):
        body, post = ellipsoid(*rng.uniform(0.1, 0.5, dimension)), ball(0.4, dimension)
        away = rng.normal(size=dimension)
        turn = rng.normal(size=4)
        turns = [turn / np.linalg.norm(turn), [1.0, 0, 0, 0]] if dimension == 3 else [rng.uniform(0, 7, 1), [0.0]]
        pose = Pose(np.array([1.1 * away / np.linalg.norm(away), np.zeros(dimension)]), np.array(turns))
        both = EllipsoidDetector(PartOptions(), [body, post], []).detect(pose, None, np.inf)
        alone = Pose(pose.position[:1], pose.orientation[:1])
        found = at_walls(EllipsoidDetector(PartOptions(), [body], [Wall(1, "post", post)]), alone)
        np.testing.assert_allclose(found.gap, both.gap, rtol=0, atol=1e-14)
        np.testing.assert_allclose(found.normal, both.normal, rtol=0, atol=1e-7)
        assert found.radius_b[0] == 0.4


@pytest.mark.parametrize(
    ("boundary", "message"),
    [
        ({"on": "top", "type": "wall"}, r"boundary.0.on: found 'top'; allowed is all, rim\."),
        ({"on": "rim", "type": "wall", "velocity": [1.0, 0.0]}, ACROSS),
        (
            {"on": "rim", "type": "wall", "angular_velocity": 1.0, "centre": [0.1, 0.0]},
            r"0.angular_velocity: .* across",
        ),
        ({"on": "rim", "type": "slip", "angular_velocity": 1.0}, r"angular_velocity is valid only with type = 'wall'"),
        ({"on": "rim", "type": "wall", "centre": [0.1, 0.0]}, r"boundary.0.centre: a centre is read only with"),
    ],
)
def test_what_a_curved_wall_cannot_have_is_refused_by_name(boundary: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        built(DISK, boundary=[boundary])


def test_a_body_beyond_the_rim_is_refused() -> None:
    with pytest.raises(SceneError, match=r"overlaps surface 'rim' of the domain by 0.0900"):
        build_system(built(DISK | {"position": [0.8, 0.3], "radius": 0.2356}))


def test_keys_of_another_domain_are_refused() -> None:
    with pytest.raises(SceneError, match=r"domain.lower: found a key that nothing reads; allowed is radius, type"):
        built(DISK, domain={"type": "dish", "radius": 1.0, "lower": [0.0, 0.0]})


@pytest.mark.parametrize(
    ("dimension", "away", "angles", "sizes"),
    [(2, 0.77, np.arange(0.0, 0.4, 0.03), Sizes(0.25, 0.05)), (3, 0.6, [0.0, 0.1, 0.2], Sizes(0.5, 0.2, growth=0.4))],
)
def test_the_wall_stays_where_it_is_through_many_meshes(
    dimension: int, away: float, angles: Sequence[float], sizes: Sizes
) -> None:
    """A ball goes along the rim: the rim's facets only get finer, so that what they cut off never grows."""
    body, domain, walls = ball(0.2, dimension), dish(1.0, dimension), [rim(1, dimension=dimension)]
    path = [upright(away * np.array([np.sin(a), -np.cos(a), 0.0])[:dimension]) for a in angles]
    mesh, start = initial_mesh(FluidDomain([body], path[0], domain, walls), sizes), path[0]
    enclosed = [enclosed_by_the_rim(mesh)]
    for pose in path[1:]:
        moved = replace(mesh, points=MeshMotion(mesh, FluidDomain([body], start, domain, ())).move(pose))
        mesh, start = remesh(moved, FluidDomain([body], pose, domain, walls), sizes), pose
        check_mesh(mesh, quality=0.05)
        on_rim = mesh.points[np.unique(mesh.facets[mesh.markers == 1])]
        assert np.abs(np.linalg.norm(on_rim, axis=1) - 1.0).max() < 1e-14
        enclosed.append(enclosed_by_the_rim(mesh))
    assert np.all(np.diff(enclosed) >= -1e-14)
    assert enclosed[-1] < domain.volume
    if dimension == 2:
        assert enclosed[-1] > enclosed[0]


def test_vertices_of_a_slope_rest_while_the_mesh_moves_and_stay_on_it_when_it_is_made_anew() -> None:
    body, (floor, slope, _) = ball(0.1), wedge().pieces
    domain, walls, sizes = wedge(), surfaces_of(wedge(), 1), Sizes(0.2, 0.04)
    start, end = upright([0.6, 0.3]), upright([0.5, 0.5])
    mesh = initial_mesh(FluidDomain([body], start, domain, walls), sizes)
    points = MeshMotion(mesh, FluidDomain([body], start, domain, ())).move(end)
    on_slope, on_floor = (np.unique(mesh.facets[mesh.markers == number]) for number in (2, 1))
    assert np.array_equal(points[on_slope], mesh.points[on_slope])
    assert not np.array_equal(points[on_floor], mesh.points[on_floor])
    new = remesh(replace(mesh, points=points), FluidDomain([body], end, domain, walls), sizes)
    for number, piece in ((1, floor), (2, slope)):
        vertices = new.points[np.unique(new.facets[new.markers == number])]
        assert np.abs(piece.shape.signed_distance(vertices)).max() < 1e-14


def test_vertices_of_a_curved_wall_are_held() -> None:
    body, pose = ball(0.2), upright([0.3, 0.0])
    mesh = initial_mesh(FluidDomain([body], pose, dish(), [rim(1)]), Sizes(0.25, 0.05))
    held = held_components(mesh, 1, dish())
    assert held[np.unique(mesh.facets)].all()


@pytest.mark.long
def test_a_disk_bounces_in_a_dry_dish_and_keeps_its_energy() -> None:
    history = run(built(DISK, fluid=DRY, time={"end": 2.0, "step": 0.001}, output={"every": 2.0}))
    centres = np.column_stack([history.bodies["x"], history.bodies["y"]])
    assert inside(centres, 0.15)
    assert np.count_nonzero(np.diff(np.sign(history.bodies["vy"])) > 0) >= 3
    fallen, residual = history.energy["gravity"].max(), np.abs(history.energy["residual"])
    assert residual[-1] < 1e-4 * fallen
    assert residual.max() < 1e-3 * fallen  # within a contact


@pytest.mark.long
@pytest.mark.parametrize(
    ("body", "detector"),
    [(DISK, "auto"), (DISK, "narrow_band"), (ELLIPSE, "auto")],
    ids=["disk", "disk by its facets", "ellipse"],
)
def test_a_body_falls_in_a_dish_of_fluid_and_rolls_to_the_bottom(body: dict[str, Any], detector: str) -> None:
    contact = {"law": "contact", "range": 0.05, "epsilon": "auto", "detector": detector}
    history = run(built(body, contact=contact))
    centres = np.column_stack([history.bodies["x"], history.bodies["y"]])
    assert inside(centres, 0.1)
    assert history.summary["remeshes"] > 2
    assert history.summary["smallest_gap"] > 0.02
    assert abs(centres[-1, 0]) < 0.1
    assert centres[-1, 1] < -0.79
    energy = history.summary["energy"]
    assert energy["created"] < 0.005
    assert energy["lost"] < 0.005


def test_epsilon_of_walls_holds_at_curved_ones() -> None:
    keys = {"law": "contact", "range": 0.3, "epsilon": 1e-3, "epsilon_wall": 1e-5}
    system = build_system(built(DISK | {"position": [0.7, 0.0]}, contact=keys, fluid=DRY))
    found = system.detector.detect(system.pose, None, 0.3)
    assert isinstance(system.law, ContactPointLaw)
    np.testing.assert_array_equal(system.law.epsilon(found), [1e-5])


def test_the_film_in_a_hollow_is_that_of_the_radii_difference() -> None:
    """R = r_a r_b/(r_a + r_b) with r_b < 0: wider than at a flat wall."""
    keys = {"law": "lubrication", "range": 0.3, "viscosity": 1.0, "cutoff": 0.01}
    system = build_system(built(DISK | {"position": [0.7, 0.0]}, contact=keys, fluid=DRY))
    found = system.detector.detect(system.pose, None, 0.3)
    assert system.law is not None
    push = system.law.damping(found, Motion(found.normal, np.ones(1)))
    radius = 0.15 * 1.0 / (1.0 - 0.15)
    strength = 3.0 * np.sqrt(2.0) * np.pi * ((radius / 0.15) ** 1.5 - (radius / 0.3) ** 1.5)
    np.testing.assert_allclose(push, -strength * found.normal, rtol=1e-9)


def test_a_side_of_the_cad_shape_without_a_name_is_refused() -> None:
    nameless = dish()
    nameless.cad_shape = lambda unit: ball(1.0).cad_shape(unit)  # type: ignore[method-assign]
    with pytest.raises(PluginError, match=r"domain.type: found a side of the CAD shape named .* allowed is one of rim"):
        initial_mesh(FluidDomain([ball(0.2)], upright([0.0, 0.0]), nameless, [rim(1)]), Sizes(0.25, 0.05))


def test_a_contact_that_takes_a_wall_for_a_body_is_refused() -> None:
    system = build_system(built(DISK, fluid=DRY))
    found = system.detector.detect(system.pose, None, np.inf)
    lying = replace(found, at_wall=~found.at_wall)
    with pytest.raises(Wrong, match="surfaces that there are not"):
        refuse_odd(lying, system.pose, system.detector.bodies, system.detector.walls)


def test_the_domain_is_listed_and_in_the_schema() -> None:
    assert Registry.load().get(DOMAIN, "dish").__name__ == "Dish"
    schema = jsonschema.Draft7Validator(json_schema())
    assert not list(schema.iter_errors(in_a_dish(DISK)))
    assert list(schema.iter_errors(in_a_dish(DISK, domain={"type": "dish", "lower": [0.0, 0.0]})))


def test_the_check_knows_the_wall_below() -> None:
    report = check(built(DISK))
    rest = [finding for finding in report.findings if finding.question == "rest"]
    assert [finding.subject for finding in rest] == [("body0", "rim")]
