"""Steps of bodies in a fluid without inertia."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.contact.body_step import BodyStep
from rigidfluid.core.coupling.coupled_dynamics import CoupledDynamics
from rigidfluid.core.coupling.fluid_scheme import FluidScheme, components, load_before
from rigidfluid.core.mechanics.motions import outer_load
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.reduced_model import Coupling, ReducedModel
from rigidfluid.core.model.state import State
from rigidfluid.core.model.types import Contacts, FloatArray, Step


class StokesScheme(FluidScheme):
    """`Scheme` of bodies in a fluid without inertia: it answers to the velocities of the moment, and remembers none."""

    def _expected_loads(self, state: State, model: ReducedModel) -> tuple[FloatArray, FloatArray]:
        """Force of the fluid on the bodies now, and what pulls them, unless more is known."""
        before = load_before(self._system, state, model)
        now = components(model, flat(outer_load(self._system, state)) + flat(state.motions.hydrodynamic))
        load = np.where(np.isnan(before), now, before)
        return load, load

    def _known_load(self, state: State, coupling: Coupling) -> FloatArray:
        """Weight and applied wrenches."""
        return components(coupling.model, flat(outer_load(self._system, state)))

    def _vary_load(self, motions: CoupledDynamics, bodies: BodyDynamics, near: Contacts, size: float) -> None:
        """Let Φ grow in any case."""
        motions.vary_load(size)

    def _with_friction(self, path: BodyStep) -> BodyStep:
        """The path's friction is known for certain."""
        return replace(path, friction=0.0, drag_loss=path.friction)

    def _convected(self, step: Step, state: State, path: BodyStep) -> Step:
        return step

    def _stirred(self, state: State, candidate: State, path: BodyStep) -> State:
        return replace(candidate, impact=None)

    def _correction(self, model: ReducedModel, step: Step, missed: FloatArray) -> FloatArray:
        """Force (d₀M + R) U of the velocities missed."""
        return np.asarray(step.derivative[0] * model.mass_times(missed) + model.friction_times(missed))

    def _response(self, model: ReducedModel, d0: float, force: FloatArray) -> FloatArray:
        """Response over the step: by its end friction has damped the response of the masses alone."""
        return model.answer(d0, force)
