"""Two disks are driven through a throat that lets only one pass at a time (case 7 of arXiv:2402.19093)."""

import numpy as np
import pytest
from falling import SCENES

import rigidfluid

pytestmark = pytest.mark.long

LATE = ("mesh.size_body=2e-4", "time.step=8e-5", "time.end=0.002", "output.every=0.01")
"""From half the way to the throat, on the paper's paths, but for one disk that is d/50 farther out."""
INNER, OUTER = 0.00115, 0.001167


@pytest.mark.parametrize("first", ["lower", pytest.param("upper", marks=pytest.mark.validation)])
def test_the_disk_farther_from_the_middle_goes_back_and_lets_the_other_pass(first):
    """Published is the order alone: Li et al., Phys. Rev. E 69 (2004) 031919."""
    second, up, down = ("upper", OUTER, INNER) if first == "lower" else ("lower", INNER, OUTER)
    starts = f"body.0.position=[-0.0034, {up}]", f"body.1.position=[-0.0034, {-down}]"
    history = rigidfluid.run(rigidfluid.load_scene(SCENES / "stenosis.toml", [*LATE, *starts]))
    bodies = history.bodies
    x, back = bodies["x"][bodies["body"] == first], bodies["vx"][bodies["body"] == second]
    assert x[-1] > 0.0 > bodies["x"][bodies["body"] == second][-1]
    assert np.min(back) < 0.0
    assert history.summary["energy"]["created"] < 0.01
    assert history.summary["energy"]["lost"] < 0.01
