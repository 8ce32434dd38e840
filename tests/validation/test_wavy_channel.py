"""A domain from a file with ten bodies of three shapes, from the scene to contacts at its curved wall."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rigidfluid
from rigidfluid.bodies.polygon import Polygon, PolygonOptions

pytestmark = pytest.mark.long

SCENE = Path(__file__).parents[2] / "scenes" / "wavy_channel.toml"


@pytest.fixture(scope="module")
def history():
    """Of a hundred steps."""
    return rigidfluid.run(rigidfluid.load_scene(SCENE, ["time.end=0.5"]))


def test_bodies_meet_the_wall_and_never_overlap(history) -> None:
    assert history.summary["status"] == "complete"
    assert len(history.energy["time"]) == 101
    contacts = history.contacts
    assert {b for b in contacts["b"] if not b.startswith(("disk", "ellipse", "corner"))} == {"wall"}
    assert len(set(contacts["a"])) >= 3
    assert 0.01 < history.summary["smallest_gap"] < 0.05


def test_corners_of_polygons_stay_above_the_floor_of_the_file(history) -> None:
    """y = 0.35 (cos(2πx/3) - 1), of which the file's polygon is off by 1e-4 at most."""
    bodies = history.bodies
    points = rigidfluid.load_scene(SCENE).body[2].options["points"]
    away = Polygon(PolygonOptions(points=points), 2).facets.points
    for name in ("corner1", "corner2", "corner3"):
        own = bodies["body"] == name
        x, y, angle = (bodies[key][own][:, None] for key in ("x", "y", "angle"))
        right = x + away[:, 0] * np.cos(angle) - away[:, 1] * np.sin(angle)
        height = y + away[:, 0] * np.sin(angle) + away[:, 1] * np.cos(angle)
        assert np.all(height > 0.35 * (np.cos(2.0 * np.pi * right / 3.0) - 1.0))


def test_energy_is_accounted_for(history) -> None:
    account = history.summary["energy"]
    assert account["created"] < 0.001
    assert account["lost"] < 0.01
