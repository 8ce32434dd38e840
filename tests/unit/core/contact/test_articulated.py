"""Parts of one articulated body: each has its own contacts, and none with the other parts."""

import numpy as np
import pytest

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.pairs.proximity import detect_contacts_and_gaps
from rigidfluid.core.model.contacts import select
from rigidfluid.errors import SceneError


def chain(*wholes, x=(0.2, 0.41, 0.62), mesh=False, **contact):
    """Balls of radius .1 in a row .01 apart, the first .1 from the left wall; ``wholes`` names what each is part of."""
    bodies = [
        {"type": "sphere", "radius": 0.1, "density": 1.0, "position": [position, 0.5]}
        | ({} if whole is None else {"part_of": whole})
        for position, whole in zip(x, wholes, strict=True)
    ]
    fluid = {"density": 1.0, "viscosity": 0.1} if mesh else {"backend": "dry"}
    return scene_from_dict(
        {
            "scene": {"name": "chain", "dimension": 2},
            "fluid": fluid,
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]},
            "body": bodies,
            "contact": {"law": "centre", "range": 0.02, "epsilon": 1e-3} | contact,
            "mesh": {"size": 0.1, "size_body": 0.03},
            "time": {"end": 0.02, "step": 0.002},
            "output": {"every": 0.02},
        }
    )


def pairs(scene):
    system = build_system(scene)
    contacts, gaps = detect_contacts_and_gaps(system, system.pose, None)
    contacts = select(contacts, contacts.gap <= system.law.range)
    return list(zip(contacts.body_a.tolist(), contacts.body_b.tolist(), strict=True)), gaps


def test_parts_of_one_body_do_not_repel_and_yet_their_gap_is_measured():
    found, gaps = pairs(chain("snake", "snake", None))
    assert found == [(1, 2)]
    np.testing.assert_allclose(gaps, 0.01)


def test_parts_of_two_bodies_repel_each_other():
    scene = chain("one", "one", "two", "two", x=(0.15, 0.36, 0.57, 0.78))
    assert pairs(scene)[0] == [(1, 2)]


def test_a_part_has_its_own_contact_with_a_wall():
    found, _ = pairs(chain("snake", "snake", "snake", x=(0.11, 0.32, 0.53)))
    assert found == [(0, 3)]


@pytest.mark.parametrize(
    "detector",
    [
        "sphere",
        *(pytest.param(name, marks=pytest.mark.long) for name in ("brute_force", "narrow_band", "fast_marching")),
    ],
)
def test_every_detector_leaves_them_out_of_the_forces(detector):
    assert_parts_do_not_repel(chain("snake", "snake", None, mesh=True, detector=detector))


def test_they_are_left_out_without_a_fluid_too():
    assert_parts_do_not_repel(chain("snake", "snake", None))


def assert_parts_do_not_repel(scene):
    """Two parts side by side stay at rest; the third, no part of it, is pushed off the second and pushes it back."""
    forces = rigidfluid.run(scene).bodies["cfx"].reshape(-1, 3)[1:]
    np.testing.assert_array_equal(forces[:, 0], 0.0)
    assert np.all(forces[:, 1] < 0)
    assert np.all(forces[:, 2] > 0)


def test_a_name_given_once_is_refused_with_what_may_be_meant():
    with pytest.raises(SceneError, match=r"body.2.part_of.*'snale'.*Did you mean 'snake'"):
        chain("snake", "snake", "snale")
