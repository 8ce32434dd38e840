"""Objects of a model that move: how they are given their start."""

from __future__ import annotations

from dataclasses import fields
from inspect import signature

import pytest

from rigidfluid.api import ArgumentError, PlacedMechanism, RigidBody, Sphere, SphereOptions
from rigidfluid.core.setup.rigid_body import Start

START = ("position", "angle", "orientation", "velocity", "angular_velocity")
BALL = Sphere(SphereOptions(radius=0.1), 2)


def test_bodies_and_mechanisms_are_given_their_start_in_the_same_order() -> None:
    body, mechanism = tuple(signature(RigidBody).parameters), tuple(signature(PlacedMechanism).parameters)
    assert body == ("name", "shape", "density", *START, "part_of", "fixed", "prescribed", "free", "spring")
    assert mechanism == ("name", "mechanism", *START)


def test_the_start_has_one_home() -> None:
    assert tuple(field.name for field in fields(Start)) == START
    for kind in (RigidBody, PlacedMechanism):
        assert issubclass(kind, Start)
        assert not set(START) & set(kind.__annotations__)


def test_values_without_names_are_taken_in_this_order() -> None:
    body = RigidBody("ball", BALL, 2.0, (0.5, 0.7), 0.1, None, (1.0, 0.0), (3.0,), "whole")
    assert (body.density, body.position, body.angle, body.angular_velocity) == (2.0, (0.5, 0.7), 0.1, (3.0,))
    assert body.part_of == "whole"


def test_in_the_plane_an_angular_velocity_is_a_number_too() -> None:
    assert RigidBody("ball", BALL, 2.0, (0.5, 0.7), angular_velocity=3.0).angular_velocity == (3.0,)


def test_a_value_of_the_start_is_refused_by_the_name_of_its_class() -> None:
    with pytest.raises(ArgumentError, match=r"^RigidBody\.position: found 'here'"):
        RigidBody("ball", BALL, 2.0, "here")
    with pytest.raises(ArgumentError, match=r"^RigidBody\.position: found nothing"):
        RigidBody("ball", BALL, 2.0)  # type: ignore[call-arg]
    with pytest.raises(ArgumentError, match=r"^RigidBody\.13: found an argument that is not there"):
        RigidBody("ball", BALL, 2.0, (0.5, 0.7), *[None] * 5, False, *[None] * 3, "one more")  # type: ignore
