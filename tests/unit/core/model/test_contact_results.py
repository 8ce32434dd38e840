"""Contacts that no run may go on with, and such as only look odd."""

import sys
from dataclasses import fields, replace

import numpy as np
import pytest
from facet_shapes import SQUARE, polygon
from mesh_tools import ball, box_walls, upright

from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.core.model import contact_results
from rigidfluid.core.model.contact_results import refuse_odd
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.errors import PluginError

COUNTS = pytest.mark.parametrize("count", [2, 12])


@pytest.fixture(autouse=True, params=["compiled", "without a compiler"])
def compiler(request, monkeypatch):
    """Few contacts are not worth one that is not loaded."""
    if request.param != "compiled":
        monkeypatch.setattr(contact_results, "_FEW", 100)
        monkeypatch.delitem(sys.modules, "numba")


def in_a_row(shape, count):
    """Bodies from the origin on, each .1 over that of the one before, one more than there are contacts."""
    return [shape] * (count + 1), upright(*(np.array([0.0, 1.1 * number]) for number in range(count + 1)))


def contacts(count, at=0.0):
    """Contacts of neighbours in the row, ``at`` from its line."""
    height = 1.1 * np.arange(count) + 0.5
    point_a = np.stack([np.full(count, at), height], axis=1)
    normal, infinite = np.tile([0.0, -1.0], (count, 1)), np.full(count, np.inf)
    return Contacts(
        body_a=np.arange(count),
        body_b=np.arange(count) + 1,
        point_a=point_a,
        point_b=point_a - 0.1 * normal,
        normal=normal,
        gap=np.full(count, 0.1),
        radius_a=infinite,
        radius_b=infinite,
        at_wall=np.zeros(count, dtype=bool),
    )


def changed(found, row, **values):
    known = {field.name: getattr(found, field.name) for field in fields(found)}
    columns = {name: column.copy() for name, column in known.items() if column is not None}
    for name, value in values.items():
        columns[name][row] = value
    return Contacts(**columns)


@COUNTS
@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"body_b": 99}, "surfaces that there are not, contact 1"),
        ({"gap": np.nan}, "gap nan"),
        ({"point_a": 1e200}, "too far away, contact 1"),
        ({"gap": 0.11}, "not a gap apart, contact 1"),
        ({"body_b": 0}, "out of order, contact 1"),
    ],
)
def test_what_is_odd_is_named(count, values, told):
    bodies, pose = in_a_row(ball(0.5), count)
    refuse_odd(contacts(count), pose, bodies, box_walls([-9.0] * 2, [9.0] * 2, count + 1))
    with pytest.raises(Wrong, match=told):
        refuse_odd(changed(contacts(count), 1, **values), pose, bodies, [])


@COUNTS
def test_only_corners_are_twice_in_a_place(count):
    """Those that face each other, as when they are a little beside each other; of the others one is too many."""
    doubled = select(contacts(count, at=0.5), np.repeat(np.arange(count), 2))
    bodies, pose = in_a_row(polygon(SQUARE), count)
    refuse_odd(doubled, pose, bodies, [])
    bodies[-1] = ball(0.5)
    with pytest.raises(Wrong, match=f"once more, contact {2 * count - 1} of surfaces {count - 1} and {count}"):
        refuse_odd(doubled, pose, bodies, [])


@COUNTS
def test_points_at_the_origin_are_as_accurate_as_bodies_are_large(count):
    bodies, pose = in_a_row(ball(0.5), count)
    middle = contacts(count)
    first = middle.point_a[0]
    pose.position[:] -= first
    rounded = changed(middle, slice(None), gap=0.0, point_a=middle.point_a - first, point_b=middle.point_a - first)
    rounded.point_b[0, 0] += 1e-15
    refuse_odd(rounded, pose, bodies, [])
    rounded.point_b[0, 0] += 1e-8
    with pytest.raises(Wrong, match="not a gap apart"):
        refuse_odd(rounded, pose, bodies, [])


class Signing(SphereDetector):
    """Gives all contacts one sign."""

    def detect(self, pose, mesh, reach):
        return replace(super().detect(pose, mesh, reach), sign=self.given)


@pytest.mark.parametrize(
    ("signed", "sign", "refused"), [(False, -1.0, True), (True, -1.0, False), (True, 0.5, True), (True, np.nan, True)]
)
def test_signs_are_those_that_a_detector_declares(signed, sign, refused):
    bodies, pose = in_a_row(ball(0.5), 1)
    detector = Signing(PartOptions(), bodies, [])
    detector.signed, detector.given = signed, np.array([sign])
    if not refused:
        assert detector.detect(pose, None, 0.2).sign == [sign]
        return
    with pytest.raises(PluginError, match="a sign of"):
        detector.detect(pose, None, 0.2)
