"""Checks of what fluid backends give."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rigidfluid.core.geometry.answers import refuse_no_number, refuse_other_rows, refuse_other_shape, refuse_others
from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.core.model.boundary_forces import BoundaryForces
from rigidfluid.core.model.flow_error import Refinement
from rigidfluid.core.model.scalar_account import ScalarAccount
from rigidfluid.core.model.types import Advance, Fields, InsideFields, Response, Step, Twist, Wrench

_POWERS = ("boundary_power", "spurious_flux", "grad_div", "source_power")
_ENERGIES = ("kinetic_energy", "dissipation", "dissipation_midway", *_POWERS)


def state(answer: Any, *_: Any, **__: Any) -> None:
    """Refuse what is no mapping of names to arrays of finite numbers, which a checkpoint is checked for."""
    refuse_others(answer, Mapping)
    for name, values in answer.items():
        refuse_others(name, str, "name")
        if not (type(values) is np.ndarray and values.dtype.kind in "fiub"):
            raise Wrong(f"{name} {describe(values)}", "arrays of numbers")
        if not np.isfinite(values).all():
            raise Wrong(f"{name} {values[~np.isfinite(values)].flat[0]}", "finite numbers")


def state_and_energy(answer: Any, *_: Any, **__: Any) -> None:
    """Refuse what is no state and a kinetic energy."""
    _refuse_other_length(answer, 2)
    state(answer[0])
    refuse_no_number(answer[1], "energy", shorter=True)


def state_and_kinetic(answer: Any, *_: Any, **__: Any) -> None:
    """Refuse what is no state and a kinetic energy that a flow may have."""
    state_and_energy(answer)
    _refuse_negative(answer[1], "kinetic energy")


def struck(answer: Any, part: Any, mesh: Any, pose: Any, twist: Twist, step: Step) -> None:
    """Refuse what is no state, kinetic energy and twist of all motions."""
    _refuse_other_length(answer, 3)
    state_and_kinetic(answer[:2])
    _refuse_other_twist(answer[2], step)


def advance(answer: Any, part: Any, fluid: Any, mesh: Any, step: Step) -> None:
    """Refuse what is no result of a step."""
    refuse_others(answer, Advance)
    state(answer.fluid)
    _refuse_other_twist(answer.twist, step)
    _refuse_other_wrench(answer.hydrodynamic_wrench, step)
    refuse_other_rows(answer.link_force, step.links.rate.shape, "link_force", shorter=True)
    for name in _ENERGIES:
        refuse_no_number(getattr(answer, name), name, shorter=True)
    _refuse_negative(answer.kinetic_energy, "kinetic_energy")
    if step.stresslets and part.stresslets:
        count, d = step.pose.position.shape
        refuse_other_rows(answer.stresslet, (count, d, d), "stresslet", shorter=True)
    if step.boundary_forces and part.boundary_forces:
        _boundary_forces(answer.boundary_forces, len(part.problem.conditions), step.pose.position.shape[1])
    if step.cell_errors and part.cell_errors and not step.provisional:
        refuse_other_rows(answer.cell_errors, (len(mesh.cells),), "cell_errors", shorter=True)
    if answer.stress_power is not None:
        refuse_no_number(answer.stress_power, "stress_power", shorter=True)
    if part.scalars and part.problem.scalar is not None and not step.provisional:
        _scalar_account(answer.scalar, len(part.problem.scalar.conditions))


def _boundary_forces(answer: Any, pieces: int, dimension: int) -> None:
    """Refuse what are no forces on so many ``pieces``."""
    refuse_others(answer, BoundaryForces, "boundary_forces")
    refuse_other_rows(answer.force, (pieces, dimension), "boundary_forces.force", shorter=True)
    refuse_other_rows(answer.area, (pieces,), "boundary_forces.area", shorter=True)


def _scalar_account(answer: Any, surfaces: int) -> None:
    """Refuse what is no account of a scalar with so many ``surfaces``."""
    refuse_others(answer, ScalarAccount, "scalar")
    for name in ("content", "rate", "source", "imbalance", "least", "greatest", "remeshing"):
        refuse_no_number(getattr(answer, name), f"scalar.{name}", shorter=True)
    for name in ("flux", "value", "inside"):
        refuse_other_rows(getattr(answer, name), (surfaces,), f"scalar.{name}", shorter=True)


def refinement(answer: Any, part: Any, flow: Any, step: Step, *_: Any) -> None:
    """Refuse what is no difference of all twists, wrenches and velocities."""
    refuse_others(answer, Refinement)
    _refuse_other_twist(answer.twist, step)
    _refuse_other_wrench(answer.wrench, step)
    refuse_other_rows(answer.velocity, np.shape(answer.velocity), "velocity", shorter=True)


def force_errors(answer: Any, part: Any, flow: Any, step: Step) -> None:
    """Refuse what are no parts of all cells."""
    refuse_other_rows(answer, (len(flow.mesh.cells),), "force_errors")


def response(answer: Any, part: Any, fluid: Any, mesh: Any, step: Step, impulses: Any) -> None:
    """Refuse what are no responses to all impulses."""
    refuse_others(answer, Response)
    for name in ("inviscid", "viscous"):
        refuse_other_rows(getattr(answer, name), impulses.shape, name, shorter=True)


def fields(answer: Any, *_: Any) -> None:
    """Refuse what are no fields for output."""
    refuse_others(answer, Fields)
    count = len(answer.points)
    for name in ("points", "velocity", "pressure"):
        refuse_other_rows(
            getattr(answer, name), (count, *np.shape(answer.points)[1:])[: 1 + (name != "pressure")], name
        )
    if answer.scalar is not None:
        refuse_other_rows(answer.scalar, (count,), "scalar")
    refuse_other_shape(answer.cells, np.shape(answer.cells), "cells", "iu")


def insides(answer: Any, *_: Any) -> None:
    """Refuse what is neither None nor a scalar inside bodies."""
    if answer is None:
        return
    refuse_others(answer, InsideFields)
    refuse_other_rows(answer.points, np.shape(answer.points), "points")
    refuse_other_rows(answer.scalar, (len(answer.points),), "scalar")
    for name, shape in (("cells", np.shape(answer.cells)), ("body", (len(answer.points),))):
        refuse_other_shape(getattr(answer, name), shape, name, "iu")


def probes(answer: Any, part: Any, fluid: Any, mesh: Any, points: Any) -> None:
    """Refuse what is no velocity and pressure at each point."""
    _refuse_other_length(answer, 2)
    refuse_other_rows(answer[0], points.shape, "velocity", shorter=True)
    refuse_other_rows(answer[1], points.shape[:1], "pressure", shorter=True)


def driving(answer: Any, part: Any, fluid: Any, mesh: Any) -> None:
    """Refuse what are no flux and drop of pressure of each periodic pair."""
    pairs = [condition for condition in part.problem.conditions if condition.image is not None]
    refuse_other_rows(answer, (len(pairs) if part.held_fluxes else 0, 2), shorter=True)


def _refuse_negative(energy: float, name: str) -> None:
    if energy < 0.0:
        raise Wrong(f"{name} {energy}", "an energy of 0 or more")


def _refuse_other_length(answer: Any, length: int) -> None:
    if not (isinstance(answer, tuple) and len(answer) == length):
        raise Wrong(describe(answer), f"a tuple of {length}")


def _refuse_other_twist(twist: Any, step: Step) -> None:
    refuse_others(twist, Twist, "twist")
    count, d = len(step.prescribed), step.pose.position.shape[1]
    refuse_other_rows(twist.velocity, (count, d), "velocity", shorter=True)
    refuse_other_rows(twist.angular_velocity, (count, step.mass_matrix.shape[1] - d), "angular velocity", shorter=True)


def _refuse_other_wrench(wrench: Any, step: Step) -> None:
    refuse_others(wrench, Wrench, "wrench")
    (count, d), k = step.pose.position.shape, step.mass_matrix.shape[1] - step.pose.position.shape[1]
    refuse_other_rows(wrench.force, (count, d), "force", shorter=True)
    refuse_other_rows(wrench.torque, (count, k), "torque", shorter=True)
