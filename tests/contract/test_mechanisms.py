"""Every built-in mechanism satisfies the contract."""

import pytest

from rigidfluid.core.scene.validation import read_table
from rigidfluid.mechanisms.articulated import Articulated, ArticulatedOptions
from rigidfluid.mechanisms.three_sphere_swimmer import ThreeSphereSwimmer, ThreeSphereSwimmerOptions
from rigidfluid.testing import MechanismContract


def component(name, *position, **keys):
    return {"name": name, "type": "ellipsoid", "density": 1.0, "position": list(position)} | keys


def chain(dimension, strokes=True):
    """A trunk with an arm of two links and a head: joints that turn, one carried by the other, and a translation."""
    axes, rest = ([0.4, 0.2], [0.0] * (dimension - 1)) if dimension == 2 else ([0.4, 0.2, 0.3], [0.0] * 2)
    parts = [
        component("trunk", 0.0, *rest, type="sphere", radius=0.3),
        component("upper", 1.0, *rest, semi_axes=axes),
        component("lower", 2.0, *rest, semi_axes=axes, density=3.0),
        component("head", -1.0, *rest, semi_axes=axes),
    ]
    shoulder, elbow = [0.5, *rest], [1.5, *rest]
    if dimension == 3:
        parts[1]["orientation"], shoulder_axis, elbow_axis = [1.0, 0.2, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, 1.0, 1.0]
    else:
        parts[3]["angle"] = 0.3
    moves = [
        {"moves": ["upper", "lower"], "about": shoulder, "smooth": [[0, 0.0], [0.3, 0.5], [1.0, -0.4], [1.2, 0.0]]},
        {"moves": ["lower"], "about": elbow, "smooth": [[0, 0.1], [0.4, -0.6], [0.6, 0.1]]},
        {"moves": ["head"], "along": [-1.0, *rest], "smooth": [[0, 0.0], [0.2, 0.4], [0.4, 0.0]], "period": 0.6},
    ]
    if dimension == 3:
        moves[0]["axis"], moves[1]["axis"] = shoulder_axis, elbow_axis
    table = {"component": parts, "stroke": moves if strokes else []}
    return Articulated(read_table(ArticulatedOptions, table, "mechanism"), dimension)


def swimmer(dimension, **keys):
    table = {"radius": 1.0, "arms": [10.0, 8.0], "amplitude": 4.0, "speed": 16.0, "density": 0.5} | keys
    return ThreeSphereSwimmer(read_table(ThreeSphereSwimmerOptions, table, "mechanism"), dimension)


@pytest.mark.parametrize("dimension", [2, 3])
class TestArticulated(MechanismContract):
    times = (0.05, 0.13, 0.5, 1.7)  # at rows the second derivative jumps

    @pytest.fixture(params=[True, False], ids=["driven", "rigid"])
    def mechanism(self, request, dimension):
        return chain(dimension, request.param)


@pytest.mark.parametrize("dimension", [2, 3])
class TestThreeSphereSwimmer(MechanismContract):
    times = (0.1, 0.3, 0.55, 0.8, 2.9)

    @pytest.fixture(params=[["left in", "right in", "left out", "right out"], None], ids=["in first", "out first"])
    def mechanism(self, request, dimension):
        return swimmer(dimension, order=request.param or ["left out", "right in", "left in", "right out"])
