"""A law in contacts of both signs takes away in some what it gives in the others."""

from __future__ import annotations

from dataclasses import replace
from inspect import get_annotations

import numpy as np

from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.signed_law import SignedLaw
from rigidfluid.core.model.types import Contacts, Motion
from rigidfluid.forces.spring_dashpot import SpringDashpotLaw, SpringDashpotOptions


def test_contacts_of_both_signs_cancel_and_without_a_sign_all_is_as_before() -> None:
    options = SpringDashpotOptions(stiffness=3.0, restitution=0.5, friction=0.4, tangential_stiffness=2.0)
    law = SpringDashpotLaw(options, 0.2)
    point, normal = np.array([[0.3, 0.1]] * 2), np.array([[0.0, 1.0]] * 2)
    numbers, gap, flat = np.array([0, 0]), np.array([0.15, 0.15]), np.full(2, np.inf)
    contacts = Contacts(
        numbers, numbers + 1, point + gap[:, None] * normal, point, normal, gap, flat, flat, numbers > 0
    )
    motion = Motion(np.array([[0.2, -0.1]] * 2), np.ones(2))
    signed, both = SignedLaw(law), replace(contacts, sign=np.array([1.0, -1.0]))
    for ask in (
        lambda law, contacts: law.force(contacts),
        lambda law, contacts: law.energy(contacts),
        lambda law, contacts: law.stiffness(contacts),
        lambda law, contacts: law.damping(contacts, motion),
        lambda law, contacts: law.tangential_stiffness(contacts),
    ):
        expected, found = ask(law, contacts), ask(signed, both)
        np.testing.assert_array_equal(ask(signed, contacts), expected)
        assert np.any(found[0] != 0.0)
        np.testing.assert_array_equal(found[0], expected[0])
        np.testing.assert_array_equal(found[1], -expected[1])
    assert (signed.sticking, signed.dissipative, signed.friction, signed.ranges) == (True, True, 0.4, (0.2,))


def test_a_law_around_another_declares_all_that_this_one_does() -> None:
    law = SpringDashpotLaw(SpringDashpotOptions(stiffness=3.0), 0.2)
    declared: dict[str, object] = {
        "sign": "either",
        "overlap": "either",
        "acts_in": "walls",
        "round_option": "stiffness",
    }
    declared |= {"friction": 0.7, "range": 0.3, "loads": None, "conservative": False, "vanishes_at_range": False}
    declared |= dict.fromkeys(("film", "curved", "dissipative", "sticking", "rolling", "couples"), True)
    assert declared.keys() == {
        key for key, kind in get_annotations(ForceLaw).items() if not kind.startswith("ClassVar")
    }
    for name, value in declared.items():
        setattr(law, name, value)
    assert {name: getattr(SignedLaw(law), name) for name in declared} == declared
