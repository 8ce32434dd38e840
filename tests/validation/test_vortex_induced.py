"""A cylinder on a spring across a stream, in resonance with its vortices, on a coarse mesh with long steps.

docs/validation/vortex_induced.md has the finer runs.
"""

import pytest
from falling import SCENES
from vortex_induced import PUBLISHED, growth, measured

import rigidfluid

pytestmark = pytest.mark.long

COARSE = ["mesh.size_body=0.1", "mesh.growth=0.2", "mesh.refine.0.size=0.4", "time.step=0.1", "time.end=80.0"]


@pytest.mark.validation
def test_amplitude_and_frequency_in_lock_in():
    softer = [*COARSE, "body.0.spring.stiffness=[0.0,2.37]"]
    history = rigidfluid.run(rigidfluid.load_scene(SCENES / "vortex_induced.toml", softer))
    found, published = measured(history), PUBLISHED[4.74]
    assert abs(growth(history)) < 0.01
    assert found.amplitude == pytest.approx(published.amplitude, rel=0.04)
    assert found.frequency == pytest.approx(published.frequency, rel=0.03)
    assert found.drag == pytest.approx(published.drag, rel=0.03)
    assert abs(history.bodies["x"]).max() < 1e-9
