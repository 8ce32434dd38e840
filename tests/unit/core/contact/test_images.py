"""Bodies that cross periodic surfaces without a fluid meet the images of others as they meet the others themselves."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ended_runs import run_to_end
from facet_shapes import CUBE, TRIANGLES, binary_stl
from scenes import dry_tables

import rigidfluid
from rigidfluid.checks.report import check
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.pairs.extrapolated_contacts import ExtrapolatedContacts
from rigidfluid.core.contact.pairs.image_detection import ImageDetection
from rigidfluid.core.contact.pairs.proximity import detect, detect_contacts_and_gaps
from rigidfluid.core.contact.pairs.tracked_pairs import TrackedPairs
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.state import State
from rigidfluid.core.model.types import Pose
from rigidfluid.core.output.checkpoint import read_checkpoint
from rigidfluid.core.scene.scene import Scene
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.errors import SceneError, StepError, StepRejected

Table = dict[str, Any]

SIDES = (("left", "right"), ("bottom", "top"), ("back", "front"))
ELASTIC = {"law": "spring-dashpot", "range": 0.01, "stiffness": 400.0}
STICKING = ELASTIC | {"damping": 0.4, "friction": 0.5, "tangential_stiffness": 300.0}
SHAPES: dict[str, tuple[Table, Table]] = {
    "balls": ({"type": "sphere", "radius": 0.1}, {"type": "sphere", "radius": 0.07}),
    "ellipses": ({"type": "ellipsoid", "semi_axes": [0.1, 0.06]}, {"type": "ellipsoid", "semi_axes": [0.05, 0.09]}),
    "ellipsoids": (
        {"type": "ellipsoid", "semi_axes": [0.1, 0.06, 0.08]},
        {"type": "ellipsoid", "semi_axes": [0.05, 0.09, 0.07]},
    ),
    "polygons": (
        {"type": "polygon", "points": [[-0.1, -0.06], [0.1, -0.06], [0.05, 0.08]]},
        {"type": "polygon", "points": [[-0.08, -0.08], [0.08, -0.08], [0.08, 0.08], [-0.08, 0.08]], "angle": 0.3},
    ),
}
CASES = [
    ("balls", 2),
    ("balls", 3),
    ("ellipses", 2),
    ("ellipsoids", 3),
    ("polygons", 2),
    pytest.param("polyhedra", 3, marks=pytest.mark.long),
]


def periodic(*axes: int) -> list[dict[str, str]]:
    return [{"on": side, "type": "periodic"} for axis in axes for side in SIDES[axis]]


def boxed(bodies: list[Table], contact: Table, axes: tuple[int, ...], **keys: Any) -> Scene:
    return scene_from_dict(dry_tables(*bodies, contact=contact, boundary=periodic(*axes), **keys))


def placed(shapes: tuple[Table, Table], places: FloatArray) -> list[Table]:
    """Two bodies at ``places`` (2, d) that meet along the first axis."""
    velocity = np.zeros_like(places)
    velocity[:, 0] = 0.5, -0.4
    rows = zip(shapes, places.tolist(), velocity.tolist(), strict=True)
    return [shape | {"density": 1.0, "position": place, "velocity": own} for shape, place, own in rows]


def shapes_of(name: str, folder: Path) -> tuple[Table, Table]:
    if name != "polyhedra":
        return SHAPES[name]
    cube = {"type": "stl", "file": str(binary_stl(folder / "cube.stl", 0.14 * CUBE, TRIANGLES))}
    return cube, cube | {"orientation": [0.9, 0.1, -0.2, 0.3]}


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
@pytest.mark.parametrize(("name", "dimension"), CASES)
def test_bodies_that_meet_across_seams_go_as_others_do(name, dimension, stepping, tmp_path):
    """A little beside each other, with dashpots and with springs along the surfaces, whose memory crosses with them; in
    space they are across two seams."""
    shapes, axes = shapes_of(name, tmp_path), (0,) if dimension == 2 else (0, 2)
    places = np.full((2, dimension), 0.5)
    places[:, 0], places[:, 1], places[:, -1] = (0.35, 0.62), (0.5, 0.52), (0.5, 0.54)
    away = np.zeros_like(places)
    away[:, 0] = 0.5, -0.5
    if dimension == 3:
        away[:, 2] = -0.52, 0.48  # one is at the very end of the domain
    runs = [
        run_to_end(boxed(placed(shapes, each), STICKING | {"stepping": stepping}, axes, end=0.4, step=0.01))
        for each in (places, places + away)
    ]
    here, there = runs
    assert np.abs(here.twist.angular_velocity).max(axis=1).min() > 0.01  # they have met
    if stepping == "substeps":
        assert here.ledger.contact_loss > 1e-5
    np.testing.assert_allclose(there.pose.position - away, here.pose.position, rtol=0, atol=1e-12)
    np.testing.assert_allclose(there.pose.orientation, here.pose.orientation, rtol=0, atol=1e-11)
    np.testing.assert_allclose(there.twist.velocity, here.twist.velocity, rtol=0, atol=1e-11)


def gas(dimension: int, number: int = 20) -> list[Table]:
    """Balls in a lattice, somewhat moved out of it, with random velocities."""
    random, cells = np.random.default_rng(2), 5 if dimension == 2 else 3
    grid = np.stack(np.meshgrid(*[np.arange(cells)] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    places = grid[random.permutation(len(grid))[:number]] / cells + random.uniform(0.0, 0.02, (number, dimension))
    velocities = random.normal(size=places.shape)
    return [
        {"type": "sphere", "radius": 0.07, "density": 1.0 + index % 2, "position": place, "velocity": velocity}
        for index, (place, velocity) in enumerate(zip(places.tolist(), velocities.tolist(), strict=True))
    ]


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_gas_between_periodic_surfaces_keeps_momentum_and_energy(dimension):
    scene = boxed(gas(dimension), STICKING | {"stiffness": 2e4}, tuple(range(dimension)), end=0.3, step=2e-3)
    system, state = build_system(scene), run_to_end(scene)
    before, after = (system.mass @ velocity for velocity in (system.twist.velocity, state.twist.velocity))
    assert state.ledger.contact_loss > 0.01 * state.ledger.initial
    assert np.any(np.abs(state.pose.position - 0.5) > 0.6)
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-13)
    assert abs(state.ledger.residual) < 1e-3 * state.ledger.initial


def test_a_run_that_cannot_go_on_blames_no_surface_that_bodies_cross():
    with pytest.raises(StepError, match="from the nearest surface"):
        run_to_end(boxed(gas(2), ELASTIC, (0, 1), end=0.3, step=2e-3))


def test_a_body_goes_round_four_times_before_it_hits():
    """As in a domain five times as long, without seams; the other body sinks into its way meanwhile."""
    runner = {"type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.25, 0.52], "velocity": [1.0, 0.0]}
    sinking = {"type": "sphere", "radius": 0.1, "density": 1.0, "velocity": [0.0, -0.3]}
    near, far = ([0.75, 1.8], [4.75, 1.8])
    domains = ({"lower": [0.0, 0.0], "upper": [1.0, 3.0]}, {"lower": [0.0, 0.0], "upper": [9.0, 3.0]})
    ends = [
        run_to_end(scene_from_dict(dry_tables(runner, sinking | {"position": place}, **tables, end=4.8, step=0.01)))
        for place, tables in (
            (near, {"domain": domains[0], "contact": STICKING, "boundary": periodic(0)}),
            (far, {"domain": domains[1], "contact": STICKING}),
        )
    ]
    round_, straight = ends
    assert straight.pose.position[0, 0] > 4.4
    assert straight.twist.velocity[1, 0] > 0.1
    np.testing.assert_allclose(round_.pose.position + [[0.0, 0.0], [4.0, 0.0]], straight.pose.position, atol=1e-10)
    np.testing.assert_allclose(round_.pose.orientation, straight.pose.orientation, rtol=0, atol=1e-9)
    inside = build_system(scene_from_dict(dry_tables(runner, boundary=periodic(0)))).domain
    wrapped = inside.wrapped(round_.pose.position)
    assert np.all((wrapped[:, 0] >= 0.0) & (wrapped[:, 0] < 1.0))
    np.testing.assert_allclose(wrapped[0], straight.pose.position[0] - [4.0, 0.0], rtol=0, atol=1e-10)


def test_a_run_is_resumed_while_bodies_touch_across_a_seam(tmp_path):
    places = np.array([[0.85, 0.5], [0.12, 0.55]])

    def scene(end: float) -> Scene:
        return boxed(placed(SHAPES["balls"], places), STICKING, (0,), end=end, step=0.01, output={"every": 0.04})

    rigidfluid.run(scene(0.4), tmp_path / "whole")
    rigidfluid.run(scene(0.12), tmp_path / "resumed")
    between = read_checkpoint(tmp_path / "resumed" / "state.h5").state
    assert np.any((between.contacts.gap < 0.01) & (between.contacts.shift[:, 0] == 1.0))
    assert len(between.springs) == 1
    rigidfluid.run(scene(0.4), tmp_path / "resumed", resume=True)
    whole, resumed = (read_checkpoint(tmp_path / name / "state.h5").state for name in ("whole", "resumed"))
    for record in ("pose", "twist", "contacts"):
        for name in getattr(whole, record).__slots__:
            np.testing.assert_array_equal(*(getattr(getattr(each, record), name) for each in (whole, resumed)))
    assert whole.ledger == resumed.ledger


@pytest.mark.parametrize("dimension", [2, 3])
def test_all_images_are_found_and_no_memory_shows(dimension):
    """Those of a naive search of copies, also where a body meets several images of another; and kept images find to the
    last bit what new ones do."""
    random, count = np.random.default_rng(4), 12
    bodies = build_system(boxed(gas(dimension, count), ELASTIC, tuple(range(dimension)))).bodies
    lattice = Lattice(np.diag([1.0, 0.6, 0.8][:dimension])[:2], np.full(dimension, 0.1))
    kept = ImageDetection(lambda *shapes: SphereDetector(PartOptions(), *shapes), bodies, (), lattice)
    position, velocity = random.uniform(-2.0, 2.0, (count, dimension)), random.normal(size=(count, dimension))
    made = set()
    for _ in range(40):
        position = position + 0.01 * velocity
        pose = Pose(position, np.zeros((count, 1 if dimension == 2 else 4)))
        found = kept.detect(pose, 0.5)
        made.add(id(kept._lists[0]))
        fresh = ImageDetection(kept._make, bodies, (), lattice).detect(pose, 0.5)
        for name in type(found).__slots__:
            np.testing.assert_array_equal(getattr(found, name), getattr(fresh, name))
    assert 2 < len(made) < 40
    cells = random.integers(-2, 3, (count, 2))
    moved = position + lattice.displacement(cells) + 0.37  # other bodies are near the seams then
    elsewhere = kept.detect(Pose(moved, pose.orientation), 0.5)
    for name in ("body_a", "body_b"):
        np.testing.assert_array_equal(getattr(elsewhere, name), getattr(found, name))
    np.testing.assert_allclose(elsewhere.gap, found.gap, rtol=0, atol=1e-13)  # in the same order
    apart = lattice.displacement(cells[found.body_a] - cells[found.body_b])
    np.testing.assert_allclose(elsewhere.shift, found.shift + apart, rtol=0, atol=1e-12)
    pairs = naive_pairs(position, lattice, 0.5 + 0.14)
    shown = {(a, b, *np.round(away, 9)) for a, b, away in zip(found.body_a, found.body_b, found.shift, strict=True)}
    assert shown == pairs
    assert len(found) == len(pairs)
    assert len({pair[:2] for pair in pairs}) < len(pairs)
    other = position[found.body_b] + found.shift
    np.testing.assert_allclose(np.linalg.norm(position[found.body_a] - other, axis=1) - 0.14, found.gap, atol=1e-12)
    np.testing.assert_allclose(found.point_b, other + 0.07 * found.normal, rtol=0, atol=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_contacts_that_are_carried_along_stay_with_their_image(dimension):
    balls, moved = gas(dimension), np.random.default_rng(1).uniform(-0.01, 0.01, (20, dimension))
    system = build_system(boxed(balls, ELASTIC, tuple(range(dimension))))
    found = detect(system, system.pose, None, 0.2)
    assert np.count_nonzero(found.shift.any(axis=1)) > 5
    there = replace(system.pose, position=system.pose.position + moved)
    carried, expected = ExtrapolatedContacts(found, system.pose).extrapolate(there), detect(system, there, None, 0.3)
    pairs, others = (
        np.rint(each.shift @ [1.0, 10.0, 100.0][:dimension] + 1e4 * each.body_a + 1e6 * each.body_b)
        for each in (carried, expected)
    )
    expected = select(expected, np.isin(others, pairs))
    for name in ("gap", "point_a", "point_b", "normal", "shift"):
        np.testing.assert_allclose(getattr(carried, name), getattr(expected, name), rtol=0, atol=1e-12)


def large_disks() -> list[Table]:
    """Two, .05 apart, and .15 across a seam."""
    places = {"one": [0.3, 0.5], "other": [0.75, 0.5]}
    return [
        {"type": "sphere", "radius": 0.2, "density": 1.0, "name": name, "position": places[name]} for name in places
    ]


def test_an_image_that_was_not_foreseen_is_told_from_one_that_was():
    system = build_system(boxed(large_disks(), ELASTIC, (0,)))
    tracked = TrackedPairs(system, system.pose, 0.1)
    at_pair = tracked.start.gap[~tracked.start.at_wall]
    assert at_pair == pytest.approx([0.05])
    there = replace(system.pose, position=system.pose.position + [[0.0, 0.0], [0.145, 0.0]])
    with pytest.raises(StepRejected, match="not foreseen"):
        tracked.extrapolate(there)


def test_joined_bodies_meet_images_of_each_other_alone():
    hinge = {"type": "hinge", "between": ["one", "other"], "at": [0.52, 0.5]}
    system = build_system(boxed(large_disks(), ELASTIC, (0,), joint=[hinge]))
    contacts, gaps = detect_contacts_and_gaps(system, system.pose, None)
    np.testing.assert_array_equal(contacts.shift[~contacts.at_wall], [[-1.0, 0.0]])
    assert contacts.gap[~contacts.at_wall] == pytest.approx([0.15])
    assert gaps == pytest.approx([0.05, 0.05])


def naive_pairs(position: FloatArray, lattice: Lattice, distance: float) -> set[tuple[Any, ...]]:
    """Pairs a < b and the displacements of b at which their centres are so near."""
    cells = np.array(list(product(range(-9, 10), repeat=2)))
    away = lattice.displacement(cells)
    return {
        (a, b, *np.round(shift, 9))
        for b in range(len(position))
        for a in range(b)
        for shift in away[np.linalg.norm(position[b] + away - position[a], axis=1) <= distance]
    }


LONG = {"type": "ellipsoid", "semi_axes": [0.499, 0.1], "density": 1.0, "position": [0.5, 0.5]}
DISK = {"type": "sphere", "radius": 0.1, "density": 1.0, "velocity": [0.0, 0.0]}


@pytest.mark.parametrize(
    ("bodies", "keys", "told"),
    [
        ([LONG], {"boundary": periodic(0)}, "its own image"),
        ([DISK | {"position": [0.05, 0.5]}, DISK | {"position": [0.93, 0.5]}], {"boundary": periodic(0)}, "overlaps"),
        ([DISK | {"position": [0.5, 0.05]}], {"boundary": periodic(0)}, "overlaps surface 'bottom'"),
        (
            [DISK | {"position": [0.5, 0.5, 0.5], "velocity": [0.0, 0.0, 0.0]}],
            {"boundary": [*periodic(0), {"on": "top", "type": "wall", "angular_velocity": [0.0, 1.0, 0.0]}]},
            "slides otherwise",
        ),
        (
            [DISK | {"position": [0.5, 0.2]}],
            {
                "boundary": periodic(0),
                "domain": {
                    "type": "channel",
                    "lower": [0.0, 0.0],
                    "upper": [1.0, 1.0],
                    "obstacle": [{"name": "post", "type": "sphere", "radius": 0.1, "position": [0.5, 0.7]}],
                },
            },
            "neither flat nor",
        ),
    ],
)
def test_what_has_no_images_is_refused(bodies, keys, told):
    with pytest.raises(SceneError, match=told):
        build_system(scene_from_dict(dry_tables(*bodies, contact=ELASTIC, **keys)))


def test_a_check_tells_of_a_gap_across_a_seam():
    """Bodies may lie across it at the start."""
    scene = boxed(
        [DISK | {"name": "one", "position": [0.05, 0.5]}, DISK | {"name": "two", "position": [0.83, 0.5]}],
        ELASTIC | {"range": 0.05},
        (0,),
    )
    told = {row.name: row for row in check(scene).bodies}
    assert told["one"].smallest_gap == pytest.approx(0.02)
    assert told["one"].nearest == "two"


def test_prescribed_joined_and_composed_bodies_cross_seams():
    """As in the middle of the domain: a driven disk pushes a hinged pair, which pushes a mechanism of two disks."""

    def end(shift: float) -> State:
        def at(x: float, y: float, **keys: Any) -> Table:
            return {"type": "sphere", "radius": 0.06, "density": 1.0, "position": [x + shift, y]} | keys

        driven = at(0.2, 0.5, radius=0.05, prescribed={"velocity": [0.5, 0.0]})
        pair = at(0.35, 0.52, name="one"), at(0.5, 0.5, name="other")
        hinge = {"type": "hinge", "between": ["one", "other"], "at": [0.425 + shift, 0.51]}
        parts = [at(-shift, 0.0, name="left"), at(0.13 - shift, 0.0, name="right")]
        both = {"type": "articulated", "name": "both", "position": [0.72 + shift, 0.5], "component": parts}
        tables = dry_tables(*(driven, *pair), contact=ELASTIC, boundary=periodic(0), joint=[hinge], end=0.6, step=0.01)
        return run_to_end(scene_from_dict(tables | {"mechanism": [both]}))

    middle, across = end(0.0), end(0.4)
    assert np.all(np.linalg.norm(middle.twist.velocity, axis=1) > 0.05)
    np.testing.assert_allclose(across.pose.position - [0.4, 0.0], middle.pose.position, rtol=0, atol=1e-11)
    np.testing.assert_allclose(across.pose.orientation, middle.pose.orientation, rtol=0, atol=1e-10)


def test_without_a_fluid_no_pressure_drops() -> None:
    sides = [{"on": "left", "type": "periodic", "pressure_drop": 1.0}, {"on": "right", "type": "periodic"}]
    ball = {"type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.5, 0.5]}
    with pytest.raises(SceneError, match="pressure_drop"):
        scene_from_dict(dry_tables(ball, boundary=sides))
