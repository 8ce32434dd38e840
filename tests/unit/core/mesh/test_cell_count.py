"""Expected cells and facets, compared with those of meshes that are made, and of scenes whose meshes take long."""

from __future__ import annotations

import numpy as np
import pytest
from falling import SCENES, falling_disk

from rigidfluid.core.case.load import load_scene, scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import fluid_domain_at
from rigidfluid.core.mesh.generation.cell_count import Count, expected_count
from rigidfluid.core.run.mesh_keys import inserter_of, sizes_of
from rigidfluid.core.scene.scene import Scene

BOX = {"type": "box", "lower": [0.0, 0.0, 0.0], "upper": [4.0, 4.0, 4.0]}


def box_of(*bodies: dict[str, object], **mesh: object) -> Scene:
    """A box of 4 × 4 × 4 with bodies."""
    return scene_from_dict(
        {
            "scene": {"name": "box", "dimension": 3},
            "fluid": {"density": 1.0, "viscosity": 1.0},
            "domain": BOX,
            "body": [{"density": 2.0, "type": "sphere", **body} for body in bodies],
            "mesh": mesh,
            "time": {"end": 1.0, "step": 0.1},
            "output": {"every": 1.0},
        }
    )


def ball(radius: float, *position: float) -> dict[str, object]:
    return {"radius": radius, "position": list(position)}


OWN = {
    "three balls near each other": box_of(
        ball(0.5, 1.2, 2.0, 2.0), ball(0.5, 2.4, 2.0, 2.0), ball(0.3, 1.8, 2.8, 2.0), size=1.0, size_body=0.25
    ),
    "a ball at a wall": box_of(ball(0.6, 2.0, 2.0, 0.68), size=1.0, size_body=0.25, refinements=2),
    "eight coarse balls": box_of(
        *(ball(0.6, x, y, z) for x in (1.0, 2.7) for y in (1.0, 2.7) for z in (1.0, 2.7)), size=1.5, size_body=0.6
    ),
    "a ball and an ellipsoid, fast growth": box_of(
        ball(0.4, 1.0, 2.0, 2.0),
        {"type": "ellipsoid", "semi_axes": [0.8, 0.4, 0.3], "position": [2.8, 2.0, 2.0]},
        **{"size": 2.0, "size_body": 0.3, "growth": 0.8},
    ),
}
SHIPPED = [
    *("falling_disk", "falling_disk_window", "ellipse_xia", "wavy_channel"),
    *("stenosis", "three_swimmers", "vortex_induced", "periodic_channel", "several_laws", "hinged_pair"),
    *("dumbbell_in_shear", "swimmer_3d"),
]
SLOW = [  # cells and facets of first meshes that take 10 s and more
    ("hundred_spheres", 57_022, 13_438),
    ("many_bodies_3d", 19_800, 4_994),
    ("falling_ellipsoid", 16_756, 3_106),
    ("squeezed_film", 31_068, 3_192),
    ("ten_cate_e3", 90_469, 7_800),
    ("two_spheres", 52_115, 3_356),
    ("hundred_disks", 12_775, 2_439),
]


def expected(scene: Scene) -> Count:
    system = build_system(scene)
    assert scene.mesh is not None
    sizes = sizes_of(scene.mesh, system.domain)
    return expected_count(fluid_domain_at(system, system.pose), sizes)


def assert_as_made(scene: Scene) -> None:
    system = build_system(scene)
    assert scene.mesh is not None
    sizes = sizes_of(scene.mesh, system.domain)
    made = initial_mesh(fluid_domain_at(system, system.pose), sizes, inserter_of(scene.mesh))
    assert expected(scene).cells == pytest.approx(len(made.cells), rel=0.15)
    assert expected(scene).facets == pytest.approx(len(made.facets), rel=0.3)


@pytest.mark.long
@pytest.mark.parametrize("name", SHIPPED)
def test_scenes_have_the_cells_expected(name: str) -> None:
    assert_as_made(load_scene(SCENES / f"{name}.toml"))


@pytest.mark.long
@pytest.mark.parametrize("name", OWN)
def test_so_do_bodies_in_boxes(name: str) -> None:
    assert_as_made(OWN[name])


def test_so_does_a_narrow_gap_in_2d() -> None:
    assert_as_made(falling_disk(body={"position": [1.0, 0.14]}, mesh={"cells_per_gap": 4}))


@pytest.mark.parametrize(("name", "cells", "facets"), SLOW)
def test_large_scenes_have_the_cells_that_were_made(name: str, cells: int, facets: int) -> None:
    found = expected(load_scene(SCENES / f"{name}.toml"))
    assert found.cells == pytest.approx(cells, rel=0.15)
    assert found.facets == pytest.approx(facets, rel=0.3)


def test_no_cells_are_counted_in_bodies() -> None:
    """A disk as fine as the open domain takes its share of the cells away."""
    mesh = {"size": 0.05, "size_body": 0.05}
    found = expected(falling_disk(mesh=mesh))
    large = expected(falling_disk(body={"radius": 0.4}, mesh=mesh))
    assert large.cells - found.cells == pytest.approx(-2.42 * np.pi * (0.4**2 - 0.125**2) / 0.05**2, rel=0.3)
