"""Errors of the bodies' velocities and of the fluid's wrenches: by the mesh, and by the steps."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.memory import told_memory
from rigidfluid.core.model.state import State
from rigidfluid.core.output.records import Row, moving
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.process import one_openblas_thread
from rigidfluid.core.run.refinement_error import moving_rows, refinement_error
from rigidfluid.core.scene.run_tables import OutputTable
from rigidfluid.errors import MeshError, RigidfluidError, StepError, StepRejected

if TYPE_CHECKING:
    from rigidfluid.core.run.simulation import Simulation

LOOSEST = 0.1
"""Largest tolerance of a step's error that scenes may ask for [1]."""

LONGER = 2
"""How many times longer the steps of the run beside are; a tolerance is the square of that looser."""


class ErrorBars:
    """Estimates of a run's errors at its outputs, as corrections: added to what the run has, they give what it should
    have.

    The error by the steps is a third of the difference from a run beside it in twice as long ones, that by the mesh
    is `refinement_error`. Not a number where nothing is known.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._beside = _with_longer_steps(simulation)
        self._own = {simulation.time: _values(simulation)}
        self._other = {self._beside.time: _values(self._beside)}
        self._beside.observe(self._keep)

    def note(self, simulation: Simulation) -> None:
        """Keep the values of a state, and of the one before it, which the run beside may have reached too."""
        self._own = {**dict([*self._own.items()][-1:]), simulation.time: _values(simulation)}

    def go_back(self, simulation: Simulation) -> None:
        """Take up a run that has gone back; the one beside it has been there, or gets there."""
        self._own = {simulation.time: _values(simulation)}

    def estimate(self, simulation: Simulation) -> tuple[list[Row], State]:
        """A row for each body and mechanism in the present state, and that state, which knows its error; no rows at the
        start."""
        state = simulation.state
        if state.past is None:
            return [], state
        names, stamp = moving(simulation.system), (simulation.time, state.count)
        by_mesh, state = _mesh_errors(simulation)
        errors = np.stack([by_mesh, self._step_errors(simulation)], axis=-1)
        return [(*stamp, name, *row.ravel().tolist()) for name, row in zip(names, errors, strict=True)], state

    def _keep(self, beside: Simulation) -> None:
        """Keep the values of a state of the run beside, and none of its rows, which nobody reads."""
        self._other[beside.time] = _values(beside)
        beside.history.cut({})

    def _step_errors(self, simulation: Simulation) -> FloatArray:
        state, unknown = simulation.state, np.full_like(_values(simulation), np.nan)
        others = moving(self._beside.system) != moving(simulation.system)
        if others or state.prescription is not None or state.applied is not None:
            return unknown  # the run beside knows nothing of it
        try:
            self._beside.go(simulation.time)
        except StepError:
            return unknown
        common = [time for time in self._own.keys() & self._other.keys() if 0.0 < time <= simulation.time]
        if not common:
            return unknown
        latest = max(common)
        if simulation.recorder.folder is not None:  # a run that writes there does not go back
            self._other = {time: values for time, values in self._other.items() if time >= latest}
        return (self._own[latest] - self._other[latest]) / (LONGER**2 - 1)


def _mesh_errors(simulation: Simulation) -> tuple[FloatArray, State]:
    """Errors (r, 2(d+k)) by the mesh, no numbers where they are unknown, and the present state, which knows them.

    Raises StepError where memory does not suffice.
    """
    state = simulation.state
    try:
        with told_memory(), one_openblas_thread():
            errors, flow_error = refinement_error(
                simulation.system, state, simulation.time, simulation.mesh_updater.deform
            )
    except (StepRejected, MeshError):
        return np.full_like(_values(simulation), np.nan), state
    except StepError as error:
        raise error.renamed(lambda subject: f"output.error_bars, with halved edges: {subject}") from error
    return errors, replace(state, flow_error=flow_error)


def _with_longer_steps(simulation: Simulation) -> Simulation:
    """The same run in memory, from its start, in whole steps of twice the length; raises the errors of these."""
    model = simulation.model
    time = model.time
    step, shortest = LONGER * time.step, LONGER * time.shortest
    tolerance = None if time.tolerance is None else min(LONGER**2 * time.tolerance, LOOSEST)
    end = step * Clock(step, 0, time.end).last_tick
    changed = {"step": step, "shortest": shortest, "tolerance": tolerance, "end": end}
    output = OutputTable(every=max(model.output.every, step))
    try:
        return type(simulation)(replace(model, time=time.model_copy(update=changed), output=output))
    except RigidfluidError as error:
        raise error.renamed(lambda subject: f"output.error_bars, with steps of {step:g}: {subject}") from error


def _values(simulation: Simulation) -> FloatArray:
    """Twist and wrench of each body and mechanism, (r, 2(d+k))."""
    state = simulation.state
    bodies = np.concatenate([flat(state.twist), flat(state.hydrodynamic_wrench)], axis=1)
    motions = np.concatenate([flat(state.motions.twist), flat(state.motions.hydrodynamic)], axis=1)
    return moving_rows(simulation.system, bodies, motions)
