"""Steps of bodies in a fluid without inertia."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.coupling.expected_load import load_before
from rigidfluid.core.coupling.fluid_scheme import FluidScheme
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mechanics.motions import outer_load
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.reduced_model import Coupling, ReducedModel
from rigidfluid.core.model.state import State
from rigidfluid.core.model.types import Contacts, Step


class StokesScheme(FluidScheme):
    """`Scheme` of bodies in a fluid without inertia: its drag follows from the present velocities alone."""

    def restarted(self, state: State, first_level: int) -> State:
        """The state, and a short step next."""
        return replace(state, level=max(state.level or 0, first_level))

    def _expected_loads(self, state: State, model: ReducedModel, size: float) -> tuple[FloatArray, FloatArray]:
        """Load at the start, for both ends; where that is unknown, the fluid's present wrench and all outer ones."""
        before = load_before(self._system, state, model)
        now = model.components(flat(outer_load(self._system, state)) + flat(state.motions.hydrodynamic))
        load = np.where(np.isnan(before), now, before)
        return load, load

    def _known_load(self, state: State, coupling: Coupling) -> FloatArray:
        """Weight and applied wrenches."""
        return coupling.model.components(flat(outer_load(self._system, state)))

    def _varying(self, state: State, bodies: BodyDynamics, near: Contacts, size: float) -> BoolArray:
        """All, in all steps."""
        return np.ones_like(flat(state.motions.contact), dtype=bool)

    def _with_friction(self, path: BodyStep) -> BodyStep:
        """The path with its friction as ``drag_loss``: it is known for certain."""
        return replace(path, friction=0.0, drag_loss=path.friction)

    def _with_turning(self, step: Step, state: State, path: BodyStep) -> Step:
        return step

    def _with_impact(self, state: State, candidate: State, path: BodyStep) -> State:
        return replace(candidate, impact=None)

    def _correction(self, model: ReducedModel, step: Step, missed: FloatArray) -> FloatArray:
        """Load (d₀M + R) U of velocities U missed: the solution takes the force at the end, not that in the mean."""
        return np.asarray(step.derivative[0] * model.mass_times(missed) + model.friction_times(missed))

    def _response(self, model: ReducedModel, d0: float, impulse: FloatArray) -> FloatArray:
        """Response d₀ (d₀M + R)⁻¹ J: by the end of the step drag has damped that of the masses alone."""
        return model.response(d0, impulse)
