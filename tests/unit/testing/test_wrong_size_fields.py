"""Size fields that no mesh could be made by, and what the contract says of them."""

import numpy as np
import pytest

from rigidfluid.api import AtRest, PartOptions, SizeField
from rigidfluid.errors import PluginError
from rigidfluid.size_fields.vorticity import Vorticity, VorticityOptions
from rigidfluid.testing import SizeFieldContract
from rigidfluid.testing.size_field import Whirl


class Distance(SizeField):
    """Edges as long as a point is far from the nearest body, and a little longer."""

    name = "distance"

    def edge_length(self, points, around, flow):
        return 0.1 + np.maximum(around.body_distances(points).min(axis=0), 0.0)


class Nowhere(Distance):
    def edge_length(self, points, around, flow):
        return super().edge_length(points, around, flow) - 0.1


class NoNumber(Distance):
    def edge_length(self, points, around, flow):
        return 0.1 * flow.speed / np.linalg.norm(flow.vorticity(points), axis=1)


class Column(Distance):
    def edge_length(self, points, around, flow):
        return super().edge_length(points, around, flow)[:, None]


class One(Distance):
    """It takes for granted that there is a point."""

    def edge_length(self, points, around, flow):
        return np.full(max(len(points), 1), 0.1)


class Mover(Distance):
    def edge_length(self, points, around, flow):
        points -= around.pose.position[0]
        return 0.1 + np.linalg.norm(points, axis=1)


class Stopper(Distance):
    def edge_length(self, points, around, flow):
        flow.twist.velocity[:] = 7.0
        return super().edge_length(points, around, flow)


class Ranked(Distance):
    """The share of points that are nearer, and so of all others."""

    def edge_length(self, points, around, flow):
        far = super().edge_length(points, around, flow)
        return 0.1 + np.mean(far[None, :] < far[:, None], axis=1)


class InTurn(Distance):
    def edge_length(self, points, around, flow):
        return 0.1 + np.arange(len(points))


class Remembering(Distance):
    asked = 0

    def edge_length(self, points, around, flow):
        self.asked += 1
        return np.full(len(points), 0.1 * self.asked)


def arguments(field, turning):
    """Those of the contract's tests: the field, the domain around a ball, a flow, and points."""
    contract = SizeFieldContract()
    around = SizeFieldContract.around.__wrapped__(contract, field)
    at_rest = AtRest(1, field.dimension)
    flow = Whirl(at_rest.twist) if turning else at_rest
    return contract, (field, around, flow, SizeFieldContract.points.__wrapped__(contract, around))


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(
    ("kind", "found", "passed"),
    [
        (Mover, "test_its_arguments_stay_as_they_are", "test_lengths_are_positive_and_finite"),
        (Stopper, "test_its_arguments_stay_as_they_are", "test_lengths_are_positive_and_finite"),
        (Ranked, "test_each_length_is_of_its_point_alone", "test_it_remembers_nothing"),
        (InTurn, "test_each_length_is_of_its_point_alone", "test_it_remembers_nothing"),
        (Remembering, "test_it_remembers_nothing", "test_lengths_are_positive_and_finite"),
    ],
)
def test_each_flaw_is_found(kind, found, passed, dimension):
    contract, given = arguments(kind(PartOptions(), dimension), turning=False)
    with pytest.raises(AssertionError):
        getattr(contract, found)(*given)
    getattr(contract, passed)(*arguments(kind(PartOptions(), dimension), turning=False)[1])


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(
    ("kind", "found", "told"),
    [
        (Nowhere, "test_lengths_are_positive_and_finite", "found 0.0; allowed is numbers above 0"),
        (NoNumber, "test_lengths_are_positive_and_finite", "found nan; allowed is finite numbers"),
        (Column, "test_lengths_are_positive_and_finite", r"found .* shape \(45, 1\); allowed is .* shape \(45,\)"),
        (One, "test_no_points_have_no_lengths", r"found .* of shape \(1,\); allowed is .* of shape \(0,\)"),
    ],
)
@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
def test_what_no_field_may_give_is_named(kind, found, told, dimension):
    contract, given = arguments(kind(PartOptions(), dimension), turning=False)
    with pytest.raises(PluginError, match=f"size field 'distance', edge_length: {told}"):
        getattr(contract, found)(*given)


def test_a_field_that_takes_points_for_granted_passes_with_points():
    contract, given = arguments(One(PartOptions(), 2), turning=False)
    contract.test_lengths_are_positive_and_finite(*given)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("turning", [True, False])
@pytest.mark.parametrize("kind", [Distance, Vorticity])
def test_the_right_ones_pass_them_all(kind, turning, dimension):
    options = VorticityOptions(size=0.05) if kind is Vorticity else PartOptions()
    contract, given = arguments(kind(options, dimension), turning)
    for name in dir(contract):
        if name.startswith("test_"):
            getattr(contract, name)(*given)
