"""Every built-in joint satisfies the contract, and joints that no run could trust do not."""

import numpy as np
import pytest
from linked_bodies import AXIS

from rigidfluid.api import Angle, CoordinateSpring, Displacement, Joint, OnAxis, SameOrientation, SamePoint
from rigidfluid.core.scene.validation import read_table
from rigidfluid.joints.ball import Ball
from rigidfluid.joints.hinge import Hinge
from rigidfluid.joints.rod import Rod
from rigidfluid.joints.slider import Slider
from rigidfluid.testing import JointContract

WAVE = {"smooth": [[0.0, 0.0], [0.3, 0.4], [0.7, -0.2], [1.0, 0.0]]}
CORNERED = {"piecewise": [[0.0, 0.0], [0.2, 0.4], [0.5, -0.2], [1.0, 0.0]]}


def built(part, dimension, **keys):
    return part(read_table(part.Options, keys), dimension)


def axis(part, dimension):
    return {"axis": (2.0 * AXIS[:dimension]).tolist()} if part is Slider or dimension == 3 else {}


def options(rest):
    """Free, with spring and damper, and driven."""
    spring = {"stiffness": 2.0, "damping": 0.3}
    return [{}, spring, spring | {rest: 0.3}, {"drive": WAVE}, {"drive": CORNERED}]


@pytest.mark.parametrize("dimension", [2, 3])
class TestRod(JointContract):
    @pytest.fixture
    def joint(self, dimension):
        return built(Rod, dimension)


@pytest.mark.parametrize("dimension", [2, 3])
class TestHinge(JointContract):
    @pytest.fixture(params=options("rest_angle"), ids=["free", "spring", "rest", "driven", "jumps"])
    def joint(self, request, dimension):
        return built(Hinge, dimension, **axis(Hinge, dimension), **request.param)


@pytest.mark.parametrize("dimension", [2, 3])
class TestSlider(JointContract):
    @pytest.fixture(params=options("rest_length"), ids=["free", "spring", "rest", "driven", "jumps"])
    def joint(self, request, dimension):
        return built(Slider, dimension, **axis(Slider, dimension), **request.param)


class TestBall(JointContract):
    @pytest.fixture(params=[{}, {"damping": 0.4}], ids=["free", "damped"])
    def joint(self, request):
        return built(Ball, 3, **request.param)


class _PointsOfMarkers(OnAxis):
    """It forgets that the axis turns with the second body."""

    def levers(self, at):
        return at.levers


class _StiffAxis(Slider):
    def held(self, name, markers):
        return [_PointsOfMarkers(name, markers), SameOrientation(name, markers)]


class _Displacement(Displacement):
    """Its rate is twice as fast as it is."""

    def directions(self, at):
        along, about = super().directions(at)
        return 2.0 * along, about


class _FastCoordinate(Slider):
    coordinate = _Displacement()


class _PushingSpring(CoordinateSpring):
    def add_wrench(self, pose, wrench):
        super().add_wrench(pose, wrench)
        wrench.force[:] *= -1.0


class _Pushed(Slider):
    def springs(self, markers):
        return [_PushingSpring(markers, self.coordinate, 2.0, 0.0)]


class _HardSpring(CoordinateSpring):
    def stretch(self, pose):
        return 2.0 * super().stretch(pose)


class _Hard(Slider):
    def springs(self, markers):
        return [_HardSpring(markers, self.coordinate, 2.0, 0.0)]


class _OneBodySpring(CoordinateSpring):
    def add_wrench(self, pose, wrench):
        super().add_wrench(pose, wrench)
        wrench.force[1], wrench.torque[1] = 0.0, 0.0


class _OneSided(Slider):
    def springs(self, markers):
        return [_OneBodySpring(markers, self.coordinate, 2.0, 0.0)]


class _Late(Slider):
    """Its drive is faster than it says."""

    def __init__(self, options, dimension):
        super().__init__(options.model_copy(update={"drive": None}), dimension)
        self.drive = built(Slider, dimension, axis=list(options.axis), drive=WAVE).drive
        self.drive.rate = lambda time: 0.5


class _Welded(Joint):
    """It says that it leaves an angle, and holds all."""

    name = "welded"
    coordinate = Angle()

    def constraints(self, name, markers):
        return [SamePoint(name, markers, np.eye(self.dimension)), SameOrientation(name, markers)]


class _Skewed(_Welded):
    coordinate = None

    @property
    def axes(self):
        return np.eye(self.dimension)[:, ::-1]


class _Offset(_Welded):
    """It does not fit where it starts."""

    coordinate = None

    def constraints(self, name, markers):
        return [_Beside(name, markers, np.eye(self.dimension))]


class _Beside(SamePoint):
    def misfit(self, at, time):
        return super().misfit(at, time) + 0.1


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(
    ("kind", "found", "passed"),
    [
        (_StiffAxis, "test_rows_are_the_rates_of_the_misfit", "test_it_fits_where_bodies_start"),
        (_StiffAxis, "test_forces_are_equal_and_opposite", "test_rows_have_their_shapes"),
        (
            _FastCoordinate,
            "test_the_coordinate_starts_at_zero_and_has_the_rate_of_its_directions",
            "test_rows_are_the_rates_of_the_misfit",
        ),
        (_Pushed, "test_springs_pull_down_the_slope_of_their_energy", "test_rows_are_the_rates_of_the_misfit"),
        (_Hard, "test_springs_are_as_stiff_as_they_say", "test_springs_pull_down_the_slope_of_their_energy"),
        (_OneSided, "test_forces_are_equal_and_opposite", "test_springs_are_as_stiff_as_they_say"),
        (_Late, "test_rows_are_the_rates_of_the_misfit", "test_the_coordinate_is_free_unless_driven"),
        (_Welded, "test_the_coordinate_is_free_unless_driven", "test_rows_are_the_rates_of_the_misfit"),
        (_Skewed, "test_axes_are_right_handed_and_of_length_one", "test_it_fits_where_bodies_start"),
        (_Offset, "test_it_fits_where_bodies_start", "test_rows_have_their_shapes"),
    ],
)
def test_the_contract_refuses(kind, found, passed, dimension):
    keys = axis(Slider, dimension) if issubclass(kind, Slider) else {}
    joint, contract = built(kind, dimension, **keys), JointContract()
    getattr(contract, passed)(joint)
    with pytest.raises(AssertionError):
        getattr(contract, found)(joint)
