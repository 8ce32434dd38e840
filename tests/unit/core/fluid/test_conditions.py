"""Conditions of the boundary, also of classes that no table names."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest

from rigidfluid.api import BoundaryCondition, FloatArray, NoSlip, Periodic, PrescribedPressure, PrescribedVelocity, Slip
from rigidfluid.backends.scikit_fem.backend import ScikitFem
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.testing.fluid.boxes import box, nobody, samples
from rigidfluid.testing.fluid.exact import problem
from rigidfluid.testing.fluid.flow import Flow

DRIFT = np.array([1.0, 0.4])


@dataclass(frozen=True)
class Outflow(BoundaryCondition):
    """An end that holds nothing: fluid leaves it in any direction."""

    prescribes_normal = False
    prescribes_tangential = False
    passes = True


def uniform(_time: float, points: FloatArray) -> FloatArray:
    return np.tile(DRIFT, (len(points), 1))


@pytest.mark.parametrize(("end", "held"), [(Outflow, False), (PrescribedPressure, True)])
def test_a_condition_of_ones_own_needs_neither_a_name_nor_a_table(end: type[BoundaryCondition], held: bool) -> None:
    """A slanted flow leaves by an end that holds nothing as it came, without pressure; one that holds what goes along
    it turns the flow."""
    given = partial(PrescribedVelocity, value=uniform)
    posed = problem(2, {"x0": given, "y0": given, "y1": given, "x1": end})
    flow = Flow.start(ScikitFem(ScikitFem.Options(tolerance=1e-12), posed), box(2, 3), nobody(2)).after(None)
    for _ in range(3):
        flow = flow.after(0.1)
    velocity, pressure = flow.probe(samples(2))
    off = max(np.abs(velocity - DRIFT).max(), np.abs(pressure).max())
    assert off > 0.1 if held else off < 1e-9


def test_a_class_must_say_what_it_holds() -> None:
    class Undecided(BoundaryCondition):
        prescribes_normal = prescribes_tangential = True

    with pytest.raises(TypeError, match="passes"):
        Undecided(0, "left", None)  # type: ignore[abstract]


@pytest.mark.parametrize(
    ("kind", "answers"),
    [
        (NoSlip, "holds_all is_wall rests"),
        (partial(NoSlip, sliding=partial(uniform, 0.0)), "holds_all is_wall"),
        (partial(PrescribedVelocity, value=uniform), "holds_all"),
        (PrescribedPressure, "holds_part is_open"),
        (Slip, "holds_part slips"),
        (Periodic, ""),
        (Outflow, "is_open"),
    ],
)
def test_what_backends_ask_follows_from_what_a_class_holds(kind: type[BoundaryCondition], answers: str) -> None:
    condition = kind(0, "left", None)
    questions = ("holds_all", "holds_part", "slips", "is_open", "is_wall", "rests")
    assert [name for name in questions if getattr(condition, name)] == [name for name in questions if name in answers]
    points = np.zeros((3, 2))
    assert condition.velocity(0.0, points).shape == (3, 2)
    assert condition.pressure(0.0, points).shape == (3,)


def test_at_a_corner_walls_hold_the_fluid_and_those_at_rest_before_others() -> None:
    """In from the left at 1, along the top at 2, and at rest below."""
    left = PrescribedVelocity(0, "left", np.array([1.0, 0.0]), lambda _, at: np.full_like(at, 1.0))
    top = NoSlip(3, "top", np.array([0.0, -1.0]), lambda at: np.full_like(at, 2.0))
    right, bottom = NoSlip(1, "right", np.array([-1.0, 0.0])), NoSlip(2, "bottom", np.array([0.0, 1.0]))
    mesh = box(2, 2)
    numbering = Numbering.from_mesh(mesh)
    surfaces = Surfaces(numbering, mesh, [left, right, bottom, top], ())
    nothing = np.empty((0, 3))
    surfaces.enclosed = False  # nothing is scaled
    points = numbering.node_points(mesh.geometry)
    found = surfaces.prescribed_velocity(0.0, points, nothing[:, :2], nothing, np.empty(0, dtype=bool))
    at = {tuple(point): float(velocity[0]) for point, velocity in zip(points, found, strict=True)}
    corners = (0.0, 0.5), (0.0, 1.0), (0.5, 1.0), (1.0, 1.0), (0.0, 0.0)
    assert [at[corner] for corner in corners] == [1.0, 2.0, 2.0, 0.0, 0.0]
