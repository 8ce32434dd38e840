"""Two disks are driven through a throat that lets only one pass at a time (case 7 of arXiv:2402.19093)."""

import functools

import numpy as np
import pytest
from falling import SCENES

import rigidfluid

COARSE = ("mesh.size_body=2.4e-4", "mesh.size=8e-4", "time.step=8e-5", "time.end=0.0076", "output.every=0.01")
MIRRORED = ("body.0.position=[-0.0068, 0.0017]", "body.1.position=[-0.0068, -0.0017002125]")


@functools.cache
def run(*overrides):
    return rigidfluid.run(rigidfluid.load_scene(SCENES / "stenosis.toml", [*COARSE, *overrides]))


def way(history, name):
    """Time, place and velocity along the channel."""
    own = history.bodies["body"] == name
    return (history.bodies[column][own] for column in ("time", "x", "vx"))


@pytest.mark.parametrize(("overrides", "first", "second"), [((), "lower", "upper"), (MIRRORED, "upper", "lower")])
def test_the_disk_farther_from_the_middle_yields_and_follows(overrides, first, second):
    """Published is the order alone: Li et al., Phys. Rev. E 69 (2004) 031919."""
    history = run(*overrides)
    (time, x, _), (_, y, back) = way(history, first), way(history, second)
    assert x[-1] > y[-1] > 0.0
    assert np.interp(0.0, y, time) > np.interp(0.0, x, time)
    assert back.min() < 0.0
