"""Energy of contacts between faces: it has no jump as bodies turn through flat and slide over edges, and forces are its
gradient."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path as File

import numpy as np
import pytest
from facet_shapes import BAR, CUBE, L_SHAPE, SQUARE, TRIANGLES, binary_stl, polygon, polyhedron

from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mechanics.rigid import rotate
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Pose
from rigidfluid.detectors.facets import FacetDetector
from rigidfluid.domains.arc import Arc

RANGE = 0.2
FLOOR = Wall(9, "floor", Plane(np.zeros(2), np.array([0.0, 1.0])))
BUMP = Wall(9, "bump", Arc(np.array([0.0, -0.2]), 0.6, Plane(np.zeros(2), np.array([0.0, 1.0]))))
INTERVALS, HALVINGS = 120, 14
OCTAGON = [[np.cos(angle), np.sin(angle)] for angle in np.arange(8) * np.pi / 4]

Row = tuple[float, float, float]
Path = Callable[[float], Sequence[Row]]


def hollow() -> Wall:
    """An octagonal room, as a wall of facets."""
    numbers = np.arange(8)
    whole = Facets(2.0 * np.array(OCTAGON), np.stack([np.roll(numbers, -1), numbers], axis=1), np.zeros(8, dtype=int))
    return Wall(9, "room", FacetSurface(whole))


def planar(rows: Sequence[Row]) -> Pose:
    return Pose(np.array([row[:2] for row in rows]), np.array([row[2:] for row in rows]))


def energy(contacts: Contacts) -> float:
    return 0.5 * float(np.sum(contacts.sign * np.maximum(RANGE - contacts.gap, 0.0) ** 2))


def greatest_jump(energy_at: Callable[[float], float]) -> tuple[float, float]:
    """The greatest change of energy over steps that are halved towards it from 0 to 1, and the greatest energy."""
    places = np.linspace(0.0, 1.0, INTERVALS + 1)
    values = [energy_at(place) for place in places]
    jump = 0.0
    for low, high, first, last in zip(places[:-1], places[1:], values[:-1], values[1:], strict=True):
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            value = energy_at(middle)
            if abs(value - first) > abs(last - value):
                high, last = middle, value
            else:
                low, first = middle, value
        jump = max(jump, abs(last - first))
    return jump, max(values)


MOTIONS: dict[str, tuple[list[list[list[float]]], list[Wall], Path]] = {
    "a square turns through flat on a floor": (
        [SQUARE],
        [FLOOR],
        lambda s: [(0.0, 0.55 + 0.21 * abs(np.sin(4.0 * s - 2.0)), 2.0 * s - 1.0)],
    ),
    "a bar thinner than the range turns over on a floor": (
        [[[x, 0.5 * y] for x, y in BAR]],
        [FLOOR],
        lambda s: [(0.0, 0.1 + abs(np.sin(np.pi * s)), np.pi * s)],
    ),
    "a square turns through flat on a square": (
        [SQUARE, SQUARE],
        [],
        lambda s: [(0.3, 1.15, 0.4 * s - 0.2), (0.0, 0.0, 0.0)],
    ),
    "a square slides over a square": ([SQUARE, SQUARE], [], lambda s: [(2.6 * s - 1.3, 1.05, 0.0), (0.0, 0.0, 0.0)]),
    "a tilted square slides over a square": (
        [SQUARE, SQUARE],
        [],
        lambda s: [(2.6 * s - 1.3, 1.08, 0.03), (0.0, 0.0, 0.0)],
    ),
    "a square goes down beside an L": ([SQUARE, L_SHAPE], [], lambda s: [(1.4, 1.4 - 0.8 * s, 0.02), (0.0, 0.0, 0.0)]),
    "a square rolls over a bump": ([SQUARE], [BUMP], lambda s: [(1.2 * s - 0.6, 0.95, 1.6 - 3.0 * s)]),
    "a corner goes past the edge of an octagonal room": (
        [SQUARE],
        [hollow()],
        lambda s: [(1.88 - np.sqrt(0.5), 0.2 * s - 0.1, 0.2 - np.pi / 4)],
    ),
}


@pytest.mark.parametrize("motion", MOTIONS)
def test_the_energy_has_no_jump(motion: str) -> None:
    shapes, walls, path = MOTIONS[motion]
    detector = FacetDetector(PartOptions(), [polygon(shape) for shape in shapes], walls)
    jump, greatest = greatest_jump(lambda s: energy(detector.detect(planar(path(s)), None, RANGE)))
    assert greatest > 1e-3
    assert jump < 1e-3 * greatest


@pytest.mark.parametrize("motion", MOTIONS)
def test_forces_are_the_gradient_of_the_energy(motion: str) -> None:
    shapes, walls, path = MOTIONS[motion]
    detector = FacetDetector(PartOptions(), [polygon(shape) for shape in shapes], walls)
    step, checked = 1e-6, 0
    for s in np.linspace(0.013, 0.987, 41):
        pose = planar(path(s))
        contacts = detector.detect(pose, None, RANGE)
        force = np.maximum(RANGE - contacts.gap, 0.0)[:, None] * contacts.normal
        arm = contacts.point_a - pose.position[0]
        total = np.array([*force.sum(axis=0), np.sum(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])])
        for number, expected in enumerate(total.tolist()):
            ends = []
            for sign in (1.0, -1.0):
                rows = np.column_stack([pose.position, pose.orientation])
                rows[0, number] += sign * step
                ends.append(energy(detector.detect(planar([tuple(row) for row in rows.tolist()]), None, RANGE)))
            assert (ends[1] - ends[0]) / (2.0 * step) == pytest.approx(expected, abs=2e-6)
        checked += len(contacts) > 0
    assert checked > 5


CUBES: dict[str, Callable[[float], tuple[list[float], list[float]]]] = {
    "slides along": lambda s: ([2.6 * s - 1.3, 0.2, 1.05], [0.0, 0.0, 0.0]),
    "slides aslant": lambda s: ([2.6 * s - 1.3, 0.2, 1.08], [0.03, 0.02, 0.5]),
    "turns in its place": lambda s: ([0.0, 0.0, 1.05], [0.0, 0.0, 0.4 * s - 0.2]),
    "turns beside": lambda s: ([1.0, 0.0, 1.05], [0.0, 0.0, 0.4 * s - 0.2]),
    "tilts through flat": lambda s: ([0.2, 0.1, 1.12], [0.4 * s - 0.2, 0.0, 0.0]),
    "tilts through flat, turned": lambda s: ([0.2, 0.1, 1.12], [0.4 * s - 0.2, 0.0, 0.5]),
}


@pytest.fixture
def two_cubes(tmp_path: File) -> FacetDetector:
    cube = polyhedron(binary_stl(tmp_path / "cube.stl", CUBE, TRIANGLES))
    return FacetDetector(PartOptions(), [cube, cube], [])


def cubes(place: list[float], turn: list[float]) -> Pose:
    """A cube at a place, turned by a rotation vector, and one at the origin."""
    upright = np.eye(1, 4)
    return Pose(np.array([place, [0.0] * 3]), np.vstack([rotate(upright, np.array([turn])), upright]))


@pytest.mark.parametrize("motion", CUBES)
def test_the_energy_of_two_cubes_has_no_jump(motion: str, two_cubes: FacetDetector) -> None:
    """Edges that pass each other come and go with a contact of the sign -1 at the end where they do."""
    jump, greatest = greatest_jump(lambda s: energy(two_cubes.detect(cubes(*CUBES[motion](s)), None, RANGE)))
    assert greatest > 1e-3
    assert jump < 1e-3 * greatest


@pytest.mark.parametrize("motion", ["slides aslant", "tilts through flat, turned"])
def test_forces_of_cubes_are_the_gradient_of_the_energy(motion: str, two_cubes: FacetDetector) -> None:
    step = 1e-6
    for s in np.linspace(0.013, 0.987, 21):
        place, turn = CUBES[motion](s)
        contacts = two_cubes.detect(cubes(place, turn), None, RANGE)
        size = contacts.sign * np.maximum(RANGE - contacts.gap, 0.0)
        force = np.sum(size[:, None] * contacts.normal, axis=0)
        for axis in range(3):
            ends = []
            for sign in (1.0, -1.0):
                moved = list(place)
                moved[axis] += sign * step
                ends.append(energy(two_cubes.detect(cubes(moved, turn), None, RANGE)))
            assert (ends[1] - ends[0]) / (2.0 * step) == pytest.approx(force[axis], abs=2e-6)
