"""Derivatives of a run's states along values of its scene, by two neighbours of it for each value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, NamedTuple

import numpy as np

from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_between
from rigidfluid.core.model.state import Reference, State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.output.records import Row
from rigidfluid.core.run.initial_state import initial_state
from rigidfluid.core.run.neighbour_systems import SystemPair, system_pairs
from rigidfluid.core.run.neighbours import Neighbour, Pair, followed
from rigidfluid.core.run.step import Tools
from rigidfluid.core.run.stepper import Stepper
from rigidfluid.core.run.sudden_start import faces_start_at_once
from rigidfluid.errors import StepRejected

_PARTS = {
    "twist": ("velocity", "angular_velocity"),
    "hydrodynamic_wrench": ("force", "torque"),
    "contact_wrench": ("force", "torque"),
}
"""Parts of a state that are told, besides poses."""


class SavedNeighbours(NamedTuple):
    """Neighbours of a run in its ``latest`` state, and why there are no more from there on."""

    latest: State
    pairs: list[Pair]
    ended: str | None


class Sensitivities:
    """Derivatives dS/dp of a run's states S along values p of its scene, named by their ``keys``, from its start.

    Two neighbours with p ± h go along: (S₊ - S₋)/2h. In a fluid without contacts both are beside the run's own solution
    y by half the difference of their residuals, K δ = ½ (r₊(y) - r₋(y)), with K and the factors of its own step; near
    contacts they take its steps with factors of their own. They end where the run leaves the steps that have such a
    derivative; ``ended`` says why, None until then.
    """

    def __init__(self, document: Mapping[str, Any], tools: Tools, state: State, keys: Sequence[str]) -> None:
        self._tools, self._latest = tools, state
        self._systems = system_pairs(document, tools.system, keys)
        self._pairs = [self._begun(pair) for pair in self._systems]
        self.ended: str | None = None

    def follow(self, system: System, before: State, after: State) -> None:
        """Go along with a step that a run has taken; ``system`` is its present one."""
        if self.ended is not None:
            return
        self.ended = self._reason_to_end(system, before, after)
        if self.ended is None:
            try:
                self._pairs = followed(self._tools, before, after, self._pairs)
                self._latest = after
            except StepRejected as error:
                self.ended = f"a neighbour of the run has failed: {error}"

    def save(self) -> SavedNeighbours:
        """Keep the neighbours as they are now."""
        return SavedNeighbours(self._latest, self._pairs, self.ended)

    def go_back(self, saved: SavedNeighbours) -> None:
        """Go on from where they were saved."""
        self._latest, self._pairs, self.ended = saved

    def rows(self, stamp: Row) -> Iterator[Row]:
        """A row for each value and body, none after the end."""
        if self.ended is None:
            names = self._tools.system.surfaces
            for pair, (plus, minus) in zip(self._systems, self._pairs, strict=True):
                change = _change(plus.state, minus.state) / (2.0 * pair.half)
                for name, row in zip(names, change.tolist(), strict=False):
                    yield (*stamp, pair.key, name, *row)

    def _reason_to_end(self, system: System, before: State, after: State) -> str | None:
        if system is not self._tools.system or not _is_same(before, self._latest):
            return "the run was changed from outside"
        if after.reference is not before.reference:
            return "the domain was re-meshed"
        return None

    def _begun(self, pair: SystemPair) -> Pair:
        return self._neighbour(pair.plus), self._neighbour(pair.minus)

    def _neighbour(self, system: System) -> Neighbour:
        """Neighbour in the run's first state, with the run's backend."""
        tools, state = self._tools, self._latest
        if not _starts_at_rest(system, state):
            state = initial_state(system, _SameMesh(state), tools.clock)
        shared = replace(system, make_backend=tools.system.make_backend)
        stepper = Stepper(system, tools.clock, tools.mesh_updater, tools.watch)
        return Neighbour(replace(tools, system=shared, scheme=scheme_of(shared)), stepper, state)


def _is_same(state: State, other: State) -> bool:
    """Tell whether two states are one, whatever is known of their errors."""
    names = (each.name for each in fields(State) if each.name != "flow_error")
    return all(getattr(state, name) is getattr(other, name) for name in names)


class _SameMesh:
    """Mesh of a run's first ``state``, for its neighbours."""

    def __init__(self, state: State) -> None:
        self._state = state

    def first_mesh(self) -> Mesh:
        """The run's own."""
        return self._state.mesh

    def first_reference(self, mesh: Mesh, gaps: FloatArray) -> Reference:
        """The run's own."""
        return self._state.reference


def _starts_at_rest(system: System, state: State) -> bool:
    """Tell whether there is a fluid in which nothing moves at the start, whatever values it has."""
    problem, moves = system.fluid, system.twist.velocity.any() or system.twist.angular_velocity.any()
    if problem is None or problem.initial != "rest" or moves:
        return False
    return not faces_start_at_once(problem, state.mesh)


def _change(plus: State, minus: State) -> FloatArray:
    """Difference of two states in poses, twists and wrenches of the bodies, a row for each."""
    turned = rotation_between(minus.pose.orientation, plus.pose.orientation)
    columns = [plus.pose.position - minus.pose.position, turned]
    for name, parts in _PARTS.items():
        one, other = getattr(plus, name), getattr(minus, name)
        columns += [getattr(one, part) - getattr(other, part) for part in parts]
    return np.concatenate(columns, axis=1)
