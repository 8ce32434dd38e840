"""A sphere settles on a floor in a viscous fluid, as in ten Cate et al. (2002), from a smaller height and coarsely."""

import numpy as np
import pytest
from falling import SCENES

import rigidfluid

pytestmark = pytest.mark.validation

NEAR = ["mesh.size=2.0", "mesh.size_body=0.3", "time.step=0.02", "body.0.position=[0.0, 0.0, 3.0]", "time.end=0.8"]


def test_a_sphere_comes_to_rest_on_its_film_without_a_rebound():
    scene = rigidfluid.load_scene(SCENES / "ten_cate_e3.toml", [*NEAR, "output.every=0.4"])
    history = rigidfluid.run(scene)
    radius, bodies = scene.body[0].radius, history.bodies
    gap, velocity = bodies["z"] - radius, bodies["vz"]
    stopped = int(np.flatnonzero((velocity >= 0.0) & (gap < 0.1 * radius))[0])
    assert velocity.min() < -5.0
    assert gap.min() > 0.0
    assert gap[stopped:].max() - gap[stopped] < 0.01 * radius
    assert np.abs(velocity[-5:]).max() < 0.05
    assert history.summary["energy"]["created"] < 0.01
