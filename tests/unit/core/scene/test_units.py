"""A scene means the same in all units of length, mass and time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn import bent_tube, plate, written
from mesh_files import write_by_meshio
from mesh_tools import nobody, upright
from other_units import Table, Units, in_units

from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.inserter import Inserter
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.reduced_model import Evaluation, reduced_model
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.run.run import run
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.domains.cad import Cad, CadOptions
from rigidfluid.domains.mesh import MeshDomain, MeshOptions

pytestmark = pytest.mark.long

NANO, GIGA, MICRO = Units(length=1e-9), Units(length=1e9), Units(length=1e-6, mass=1e-3, time=1e-3)
BINARY = Units(length=2.0**-30, mass=2.0**-10, time=2.0**-5)
NAMES = {NANO: "1e-9", GIGA: "1e9", MICRO: "micrometres", BINARY: "powers of two"}

DISK: Table = {"type": "sphere", "radius": 0.125, "density": 3.0}
PAIR = (
    DISK | {"name": "a", "position": [0.3, 0.5], "velocity": [8.0, 0.0]},
    DISK | {"name": "b", "position": [0.62, 0.52], "velocity": [-8.0, 0.0]},
)
MEETING: Table = {
    "scene": {"name": "meeting", "dimension": 2},
    "fluid": {"density": 1.0, "viscosity": 0.1, "gravity": [0.0, -100.0]},
    "domain": {"type": "box", "lower": [0.0, 0.0], "upper": [1.0, 1.0]},
    "body": list(PAIR),
    "contact": {"law": "centre", "range": 0.04, "epsilon": 1e-9},
    "mesh": {"size": 0.25, "size_body": 0.1, "refinements": 1, "remesh_every": 0.003},
    "time": {"end": 0.008, "step": 0.001},
    "output": {"every": 0.008},
}
"""Two disks run into each other in a box of fluid, whose mesh is regenerated twice."""

ELLIPSES = [
    PAIR[0] | {"type": "ellipsoid", "semi_axes": [0.14, 0.09], "angle": 0.3, "angular_velocity": 10.0},
    PAIR[1] | {"type": "ellipsoid", "semi_axes": [0.1, 0.12], "position": [0.65, 0.53]},
]
POLYGONS = [
    PAIR[0] | {"type": "polygon", "points": [[0.0, 0.0], [0.25, 0.0], [0.25, 0.2], [0.0, 0.2]], "angle": 0.3},
    PAIR[1] | {"type": "polygon", "points": [[0.0, 0.0], [0.25, 0.0], [0.12, 0.2]], "position": [0.64, 0.53]},
]
BALLS = [
    PAIR[0] | {"position": [0.31, 0.5, 0.5], "velocity": [8.0, 0.0, 0.0]},
    PAIR[1] | {"position": [0.6, 0.52, 0.5], "velocity": [-8.0, 0.0, 0.0]},
]
BY_GAP = {"law": "normal", "range": 0.04, "epsilon": 1e-7}


def changed(**tables: Any) -> Table:
    """The meeting with other tables, or other keys in them."""
    return MEETING | {
        name: MEETING[name] | table if isinstance(table, dict) else table for name, table in tables.items()
    }


def without_radius(bodies: list[Table]) -> list[Table]:
    return [{key: value for key, value in body.items() if key != "radius"} for body in bodies]


CUBE = {"lower": [0.0, 0.0, 0.0], "upper": [1.0, 1.0, 1.0]}
SCENES = {
    "disks": MEETING,
    "ellipses": changed(body=without_radius(ELLIPSES), contact=BY_GAP),
    "polygons": changed(body=without_radius(POLYGONS), contact=BY_GAP, time={"end": 0.004}),
    "computed strength": changed(contact={"epsilon": "auto", "impact_speed": 8.0, "restitution": 0.5}),
    "balls": changed(
        scene={"dimension": 3},
        fluid={"gravity": [0.0, 0.0, -100.0]},
        domain=CUBE,
        body=BALLS,
        mesh={"size": 0.5, "size_body": 0.2, "remesh_every": 0.0002},
        time={"end": 0.0003, "step": 0.0001},
    ),
}


def paths(scene: Table, units: Units) -> FloatArray:
    """Of all bodies at all times, in the units of the meeting."""
    bodies = run(scene_from_dict(in_units(scene, units))).bodies
    return np.stack([bodies[axis] for axis in "xyz"[: scene["scene"]["dimension"]]]) / units.length


@pytest.fixture(scope="module")
def known() -> dict[str, FloatArray]:
    """What has been computed in the units of the meeting."""
    return {}


@pytest.mark.parametrize(
    ("name", "units"),
    [
        *(("disks", units) for units in (BINARY, NANO, GIGA, MICRO)),
        *(("ellipses", units) for units in (NANO, GIGA)),
        ("polygons", NANO),
        ("computed strength", MICRO),
        ("balls", NANO),
    ],
    ids=lambda value: value if isinstance(value, str) else NAMES[value],
)
def test_bodies_that_meet_in_a_fluid_go_the_same_way(name: str, units: Units, known: dict[str, FloatArray]) -> None:
    scene = SCENES[name]
    if name not in known:
        known[name] = paths(scene, Units())
    found = paths(scene, Units(units.length, units.mass, units.time, scene["scene"]["dimension"]))
    assert found.shape == known[name].shape
    np.testing.assert_allclose(found, known[name], rtol=0, atol=0.0 if units is BINARY else 1e-7)


def test_bodies_of_the_meeting_are_pushed() -> None:
    """Otherwise the others would show nothing of contacts."""
    summary = run(scene_from_dict(MEETING)).summary
    assert summary["remeshes"] >= 2
    assert summary["smallest_gap"] < 0.95 * MEETING["contact"]["range"]


def around_a_ball(domain: Any, scale: float, inserter: Inserter) -> Mesh:
    d = domain.dimension
    centre = scale * np.array({2: [2.7, 1.1], 3: [0.1, 0.0, 2.0]}[d])
    body, pose = Sphere(SphereOptions(radius=0.3 * scale), d), upright(centre)
    sizes = Sizes(1.0 * scale, 0.5 * scale)
    return initial_mesh(FluidDomain([body], pose, domain, surfaces_of(domain, 1)), sizes, inserter)


DRAWN = {2: plate, 3: bent_tube}


@pytest.mark.parametrize("scale", [1e-9, 1e9])
@pytest.mark.parametrize("way", ["cad", "fill"])
def test_meshes_in_drawn_domains_are_the_same(scale: float, way: Any, tmp_path: Path) -> None:
    file = written(plate(), tmp_path)
    first, other = (around_a_ball(Cad(CadOptions(file=file, scale=by), 2), by, Inserter(way)) for by in (1.0, scale))
    np.testing.assert_array_equal(other.cells, first.cells)
    np.testing.assert_array_equal(other.markers, first.markers)
    np.testing.assert_allclose(other.points / scale, first.points, rtol=0, atol=1e-9)


def test_a_mesh_in_a_bent_tube_is_the_same(tmp_path: Path) -> None:
    file, scale = written(bent_tube(), tmp_path), 1e-9
    first, other = (around_a_ball(Cad(CadOptions(file=file, scale=by), 3), by, Inserter()) for by in (1.0, scale))
    np.testing.assert_array_equal(other.cells, first.cells)
    np.testing.assert_allclose(other.points / scale, first.points, rtol=0, atol=1e-9)


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_a_mesh_in_a_domain_of_facets_is_the_same(scale: float, tmp_path: Path) -> None:
    box, sizes = Box(BoxOptions(lower=(0.0, 0.0), upper=(4.0, 2.0)), 2), Sizes(0.6, 0.25)
    write_by_meshio(tmp_path / "box.msh", initial_mesh(FluidDomain([], nobody(2), box, []), sizes), list(box.names))
    options = {by: MeshOptions(file=str(tmp_path / "box.msh"), scale=by) for by in (1.0, scale)}
    first, other = (around_a_ball(MeshDomain(given, 2), by, Inserter()) for by, given in options.items())
    np.testing.assert_array_equal(other.cells, first.cells)
    np.testing.assert_allclose(other.points / scale, first.points, rtol=0, atol=1e-9)


def test_responses_of_turning_and_of_moving_may_have_any_sizes() -> None:
    """1/(mass · length²) next to 1/mass, in metres of a body of a nanometre."""
    arm = np.diag([1.0, 1.0, 1e9])
    inviscid = arm @ np.array([[2.0, 0.1, 0.4], [0.1, 2.0, 0.3], [0.4, 0.3, 4.0]]) @ arm
    model = reduced_model(np.arange(3), inviscid, inviscid / 3.0, 2.0, Evaluation(np.ones(3), np.ones(3)), shared=False)
    np.testing.assert_allclose(model.inverse_mass, inviscid, rtol=1e-12)
