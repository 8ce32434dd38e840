"""Check that a checkpoint is one of this model: as many bodies, motions and links, its surfaces, times and tables."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.output.checkpoint import Checkpoint, misfit_error
from rigidfluid.core.output.records import columns
from rigidfluid.core.output.stored_records import Misfit
from rigidfluid.core.run.clock import Clock


def require_fit(path: Path, checkpoint: Checkpoint, system: System, clock: Clock) -> None:
    """Raise OutputError where a checkpoint, read from ``path``, is of another system or clock."""
    for misfit in _misfits(checkpoint, system, clock):
        raise misfit_error(path, misfit)


def require_fluid(path: Path, state: State, backend: FluidBackend) -> None:
    """Raise OutputError where the fluid's arrays in a checkpoint, read from ``path``, are not those of its mesh."""
    shapes = backend.state_shapes(state.mesh, state.pose)
    if shapes is None:
        return
    for name in shapes.keys() | state.fluid.keys():
        found, wanted = state.fluid.get(name), shapes.get(name)
        if found is None or found.shape != wanted or found.dtype != np.float64:
            told = "nothing" if found is None else describe(found)
            allowed = "nothing" if wanted is None else f"numbers of shape {wanted}, by the mesh"
            raise misfit_error(path, Misfit(f"state/fluid/{name}", told, allowed))


def _misfits(checkpoint: Checkpoint, system: System, clock: Clock) -> Iterator[Misfit]:
    state = checkpoint.state
    shapes = {
        "pose/position": (state.pose.position.shape, system.pose.position.shape),
        "motions/pose/position": (state.motions.pose.position.shape, system.motions.pose.position.shape),
        "link/force": (state.link.force.shape, system.joints.unloaded(system.motions.pose).force.shape),
    }
    for name, (found, wanted) in shapes.items():
        if found != wanted:
            yield Misfit(f"state/{name}", f"an array of shape {found}", f"one of {wanted}, as in the scene")
    count = len(system.surfaces)
    for name, numbers in (
        ("contacts/body_b", state.contacts.body_b),
        ("mesh/markers", state.mesh.markers),
        ("reference/mesh/markers", state.reference.mesh.markers),
    ):
        if np.any(numbers >= count):
            yield Misfit(f"state/{name}", f"{np.max(numbers)}", f"numbers below {count}, that of the surfaces")
    if checkpoint.times[-1] != clock.time(state.tick):
        allowed = f"that of the latest output, {checkpoint.times[-1]:g}"
        yield Misfit("state/tick", f"{state.tick}, time {clock.time(state.tick):g}", allowed)
    if state.level is not None and state.level > clock.levels:
        yield Misfit("state/level", f"{state.level}", f"numbers until {clock.levels}, by time.shortest")
    if system.backend.ranks.is_root and checkpoint.tables.keys() != columns(2).keys():
        yield Misfit("tables", f"{', '.join(checkpoint.tables)}", ", ".join(columns(2)))
