"""Steps of bodies in a fluid with inertia."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.contact.path.contact_load import contact_load
from rigidfluid.core.contact.path.substep_path import SubstepPath
from rigidfluid.core.coupling.convection import turning
from rigidfluid.core.coupling.expected_load import expected_load, load_before
from rigidfluid.core.coupling.fluid_scheme import FluidScheme, near_motions
from rigidfluid.core.coupling.stirring import impact_tick
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.dynamics import BodyDynamics
from rigidfluid.core.model.reduced_model import Coupling, ReducedModel
from rigidfluid.core.model.state import State
from rigidfluid.core.model.types import Contacts, Step

RESOLVED = 8.0
"""Largest number of substeps with which a step resolves its contacts: Φ then varies linearly in it."""

SLOW = 0.1
"""Largest relative change of a contact force from its mean in the step before, in contacts that press slowly: Φ then
varies linearly too, however stiff they are."""


class NavierStokesScheme(FluidScheme):
    """`Scheme` of bodies in a fluid with inertia: added mass acts in contacts at once, and the flow remembers them."""

    def restarted(self, state: State, first_level: int) -> State:
        """The state as after a start at once, and a short step next."""
        level, ledger = max(state.level or 0, first_level), replace(state.ledger, since_start=0.0)
        return replace(state, level=level, ledger=ledger)

    def _expected_loads(self, state: State, model: ReducedModel, size: float) -> tuple[FloatArray, FloatArray]:
        before = load_before(self._system, state, model)
        return before, expected_load(self._system, state, model, before, size)

    def _known_load(self, state: State, coupling: Coupling) -> None:
        return None

    def _varying(self, state: State, bodies: BodyDynamics, near: Contacts, size: float) -> BoolArray:
        """All where the step resolves its contacts, and those of motions whose contacts press slowly."""
        system, law, shape = self._system, self._system.law, flat(state.motions.contact).shape
        if law is None:
            return np.ones(shape, dtype=bool)
        force = np.zeros_like(state.motions.contact.force)
        load = contact_load(system, law, state.contacts, bodies, state.springs)
        np.add.at(force, system.motions.carrier, load.wrench.force)
        change = np.linalg.norm(force - state.motions.contact.force, axis=1)
        slow = change < SLOW * np.linalg.norm(force, axis=1)
        read = near_motions(system, near) | system.joints.linked
        if slow[read].all() or size > RESOLVED * SubstepPath(system, law, bodies, size).planned(near, size).substep:
            return np.broadcast_to(slow[:, None], shape)
        return np.ones(shape, dtype=bool)

    def _with_friction(self, path: BodyStep) -> BodyStep:
        return path

    def _with_turning(self, step: Step, state: State, path: BodyStep) -> Step:
        return replace(step, turning=turning(self._system, state, path, step))

    def _with_impact(self, state: State, candidate: State, path: BodyStep) -> State:
        return replace(candidate, impact=impact_tick(state, path, candidate))

    def _correction(self, model: ReducedModel, step: Step, missed: FloatArray) -> FloatArray:
        """Zero: a fluid with inertia takes the impulse of the path as it is."""
        return np.zeros_like(missed)

    def _response(self, model: ReducedModel, d0: float, impulse: FloatArray) -> FloatArray:
        """Response M⁻¹ J by the masses alone."""
        return np.asarray(model.inverse_mass @ impulse)
