"""Scenes whose detector reads the mesh, from start to end."""

import numpy as np
import pytest
from mesh_tools import ball, box, ellipsoid
from unknown_shapes import Cross

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.path.detector_choice import choose_detector
from rigidfluid.core.run.run import run
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import SceneError
from rigidfluid.registry import Registry

ELLIPSE = {"type": "ellipsoid", "semi_axes": [0.1, 0.05], "angle": 0.5, "density": 1.25, "position": [0.3, 0.16]}
DISK = {"type": "sphere", "radius": 0.08, "density": 1.25, "position": [0.3, 0.105]}
BOX = box([0.0, 0.0], [0.6, 0.8])
COARSE = {"size_body": 0.06, "quality": 0.01, "cells_per_gap": 1}
LAW = {"law": "centre", "range": 0.03, "epsilon": 5e-6}


def scene(body, contact, backend="scikit-fem", **more):
    return scene_from_dict(
        {
            "scene": {"name": "fall", "dimension": 2},
            "fluid": {"backend": backend, "density": 1.0, "viscosity": 0.1, "gravity": [0.0, -981.0]},
            "domain": {"lower": [0.0, 0.0], "upper": [0.6, 0.8]},
            "body": [body, *more.get("others", [])],
            "contact": contact,
            "mesh": {"size": 0.08, "size_body": 0.02} | more.get("mesh", {}),
            "time": {"end": 0.02, "step": 0.002},
            "output": {"every": 0.02},
        }
    )


@pytest.mark.long
@pytest.mark.parametrize("detector", ["narrow_band", "fast_marching"])
def test_a_disk_is_held_off_a_wall_as_by_the_closed_form(detector):
    marched = run(scene(DISK, {"detector": detector, **LAW}))
    closed = run(scene(DISK, {"detector": "sphere", **LAW}))
    assert marched.summary["smallest_gap"] == pytest.approx(closed.summary["smallest_gap"], rel=0.02)
    assert marched.summary["rejected_steps"] == closed.summary["rejected_steps"]


def test_forces_on_balls_pass_through_their_centres_however_coarse_the_mesh():
    """On a mesh a disk is a polygon, whose lowest corner is beside its centre: a force there would turn the disk."""
    other = DISK | {"position": [0.431, 0.2]}
    run = Simulation(scene(DISK, {"detector": "narrow_band", **LAW}, others=[other], mesh=COARSE), None, False)
    contacts, centre = run.state.contacts, run.state.pose.position
    assert contacts.body_b.tolist() == [1, 4]
    arm = contacts.point_a - centre[contacts.body_a]
    np.testing.assert_allclose(arm, -0.08 * contacts.normal, atol=1e-15)
    np.testing.assert_allclose(contacts.normal[1], [0.0, 1.0], atol=1e-15)
    away = np.linalg.norm(centre[1] - centre[0])
    np.testing.assert_allclose(contacts.gap, [away - 0.16, 0.025], atol=1e-15)
    np.testing.assert_allclose(contacts.point_b, contacts.point_a - contacts.gap[:, None] * contacts.normal, atol=1e-15)


def test_an_ellipse_falls_and_its_gap_is_recorded_within_the_band():
    history = run(scene(ELLIPSE, {"detector": "narrow_band", "band_width": 0.12}))
    true = run(scene(ELLIPSE, {"detector": "brute_force"}))
    assert history.summary["smallest_gap"] == pytest.approx(true.summary["smallest_gap"], abs=2e-3)
    exact = run(scene(ELLIPSE, {"detector": "ellipsoid"}))
    assert exact.summary["smallest_gap"] == pytest.approx(true.summary["smallest_gap"], abs=1e-10)


def test_without_a_law_or_a_band_nothing_is_measured():
    assert build_system(scene(ELLIPSE, {"detector": "narrow_band"})).reach == 0.0


def test_auto_takes_the_cheapest_detector_that_is_exact():
    assert build_system(scene(DISK, LAW)).detector.name == "sphere"
    chosen = build_system(scene(ELLIPSE, {}))
    assert (chosen.detector.name, chosen.detector_why) == ("ellipsoid", "chosen as all bodies are balls or ellipsoids")
    bodies = [ellipsoid(0.1, 0.05), ball(0.1)]
    assert chosen_names(bodies) == ["ellipsoid", "ellipsoid"]

    bodies.append(Cross(Cross.Options(radius=0.1), 2))
    assert chosen_names(bodies) == ["narrow_band", "brute_force"]


def chosen_names(bodies):
    """Detectors that ``auto`` takes with a mesh and without."""
    return [choose_detector(bodies, BOX.pieces, mesh, Registry.load())[0].name for mesh in (True, False)]


ELLIPSES = """
from rigidfluid.api import hookimpl
from rigidfluid.detectors.ellipsoid import EllipsoidDetector


class Ellipses(EllipsoidDetector):
    name = "ellipses"
    cost = 0.5 * EllipsoidDetector.cost

    @classmethod
    def exact_for(cls, bodies, pieces):
        plane = all(body.semi_axes is not None and len(body.semi_axes) == 2 for body in bodies)
        return "all bodies are ellipses" if plane else None


@hookimpl
def rigidfluid_detectors():
    return [Ellipses]
"""


def test_auto_takes_a_cheaper_detector_of_a_plugin(install):
    install(ELLIPSES, "ellipses", "ellipses_plugin")
    assert chosen_names([ellipsoid(0.1, 0.05)]) == ["ellipses", "ellipses"]
    assert chosen_names([ellipsoid(0.1, 0.05, 0.07)]) == ["ellipsoid", "ellipsoid"]
    assert build_system(scene(ELLIPSE, {})).detector_why == "chosen as all bodies are ellipses"


def test_a_detector_that_needs_a_mesh_is_refused_without_one():
    with pytest.raises(SceneError, match=r"contact.detector: found 'narrow_band' without a mesh.*auto"):
        scene(DISK, {"detector": "narrow_band"}, backend="dry")


def test_a_band_narrower_than_the_range_is_refused_at_the_start():
    with pytest.raises(SceneError, match=r"contact.band_width"):
        build_system(scene(DISK, {"detector": "narrow_band", "band_width": 0.01, **LAW}))
