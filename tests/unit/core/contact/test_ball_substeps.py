"""Compiled substeps of balls against the same substeps one by one."""

import numpy as np
import pytest
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.contact.path import substep_path
from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.run.simulation import Simulation

LAWS = {
    "centre": {"law": "centre", "epsilon": 4e-6, "epsilon_wall": 2e-6},
    "normal": {"law": "normal", "epsilon": 4e-6},
    "contact": {"law": "contact", "epsilon": 1e-8},
    "dashpot": {"law": "spring-dashpot", "stiffness": 8e3, "restitution": 0.8, "friction": 0.3},
    "damped": {"law": "spring-dashpot", "stiffness": 8e3, "damping": 1.0, "friction": 0.1, "tangential_damping": 0.5},
}


def gas(law, dimension, side, substeps):
    """Balls of different sizes on a lattice, which fly and spin at random."""
    random = np.random.default_rng(7)
    places = np.stack(np.meshgrid(*[np.arange(side)] * dimension), axis=-1).reshape(-1, dimension) + 0.5
    bodies = [
        {
            "type": "sphere",
            "radius": random.uniform(0.35, 0.46),
            "density": random.uniform(1.0, 3.0),
            "position": place,
            "velocity": (0.5 * random.normal(size=dimension)).tolist(),
            "angular_velocity": random.normal(size=dimension).tolist() if dimension == 3 else float(random.normal()),
        }
        for place in places.tolist()
    ]
    fluid = {"backend": "dry", "gravity": [0.0] * (dimension - 1) + [-3.0]}
    domain = {"lower": [0.0] * dimension, "upper": [float(side)] * dimension}
    tables = dry_tables(*bodies, fluid=fluid, domain=domain, end=1.0, step=0.05)
    tables["contact"] = LAWS[law] | {"range": 0.05} | ({"substeps": substeps} if substeps else {})
    return scene_from_dict(tables)


def both_ways(scene, monkeypatch, steps):
    """The run after some steps in compiled substeps, and one by one."""
    runs = []
    for maker in (substep_path.ball_substeps, lambda *_: None):
        monkeypatch.setattr(substep_path, "ball_substeps", maker)
        run = Simulation(scene, None, False)
        paths = []
        for _ in range(steps):
            paths.append(scheme_of(run.system).follow(run.state, run.time, run.clock.size(0), None))
            run.step()
        runs.append((run.state, paths[-1]))
    return runs


@pytest.mark.parametrize("substeps", [40, None])
@pytest.mark.parametrize(("dimension", "side"), [(2, 3), (2, 7), (3, 4)])
@pytest.mark.parametrize("law", LAWS)
def test_they_are_those_one_by_one(law, dimension, side, substeps, monkeypatch):
    (state, path), (expected, slow) = both_ways(gas(law, dimension, side, substeps), monkeypatch, 3)
    assert path.substeps == slow.substeps > 1
    assert np.any(slow.impulse.force)
    pairs = [(getattr(getattr(path, one), two), getattr(getattr(slow, one), two)) for one, two in FIELDS]
    for found, other in [*pairs, (path.dissipated, slow.dissipated), (path.actuator_work, slow.actuator_work)]:
        np.testing.assert_allclose(found, other, rtol=0, atol=1e-11 * np.abs(other).max() + 1e-12)
    np.testing.assert_allclose(state.pose.position, expected.pose.position, rtol=0, atol=1e-11)


FIELDS = [
    *(("pose", field) for field in ("position", "orientation")),
    *(("twist", field) for field in ("velocity", "angular_velocity")),
    *(("impulse", field) for field in ("force", "torque")),
]
