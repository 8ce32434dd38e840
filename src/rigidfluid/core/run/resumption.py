"""The checkpoint to resume, by as many processes as wrote it or by another number."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from rigidfluid.core.mesh.distribution import joined, partition, parts_of, shared
from rigidfluid.core.model.interfaces import FluidBackend
from rigidfluid.core.model.state import State
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.output.checkpoint import Checkpoint
from rigidfluid.core.output.writer import earlier_parts, earlier_run, ranks_of_run
from rigidfluid.errors import OutputError


def checkpoint_for(backend: FluidBackend, out: Path) -> Checkpoint:
    """Read this process' checkpoint of the run in a folder; called by all that share the ``backend`` together.

    If another number of processes wrote it, the root puts the mesh and the fluid's state together and cuts them anew;
    what the backend has kept beside them is of the old parts and left behind. Raises OutputError where there is none,
    it cannot be read, or the backend cannot cut its state for this number of processes.
    """
    ranks, written = backend.ranks, 0
    with ranks.raise_on_all():
        if ranks.is_root:
            written = ranks_of_run(out)
            _refuse_fixed(backend, out, written)
    if ranks.bcast(written) == ranks.size:
        return earlier_run(out, ranks)
    pieces = None
    with ranks.raise_on_all():
        if ranks.is_root:
            pieces = _redistributed(backend, earlier_parts(out, written))
    own = ranks.scatter(pieces)
    reference = own.state.reference
    mesh = shared(reference.mesh, ranks)
    state = replace(own.state, reference=replace(reference, mesh=mesh), mesh=mesh.at(own.state.mesh.geometry))
    return replace(own, state=state)


def _redistributed(backend: FluidBackend, parts: list[Checkpoint]) -> list[Checkpoint]:
    """Checkpoint for each process of the ``backend``; what is the same for all is the first's."""
    states = _cut(backend, _joined(backend, [part.state for part in parts]))
    return [replace(parts[0], state=state, memory={}, ranks=len(states)) for state in states]


def _joined(backend: FluidBackend, parts: list[State]) -> State:
    """The whole, from all parts in the order of ranks."""
    if len(parts) == 1:
        return parts[0]
    first, meshes = parts[0], [_meshes(part) for part in parts]
    references, present = ([pair[i] for pair in meshes] for i in range(2))
    reference = joined(references)
    mesh = reference.at(joined(present).geometry)
    fluid = backend.joined([part.fluid for part in parts], present, mesh)
    return replace(first, reference=replace(first.reference, mesh=reference), mesh=mesh, fluid=fluid)


def _cut(backend: FluidBackend, whole: State) -> list[State]:
    """A part for each process of the ``backend``: cells are shared out as they were when the mesh was made."""
    reference, mesh = _meshes(whole)
    owner = partition(reference, backend.ranks.size)
    references, present = parts_of(reference, owner), parts_of(mesh, owner)
    fluids = backend.cut(whole.fluid, mesh, present)
    return [
        replace(whole, reference=replace(whole.reference, mesh=at_first), mesh=now, fluid=fluid)
        for at_first, now, fluid in zip(references, present, fluids, strict=True)
    ]


def _meshes(state: State) -> tuple[Mesh, Mesh]:
    """The mesh when it was made, and now."""
    return state.reference.mesh, state.mesh


def _refuse_fixed(backend: FluidBackend, out: Path, written: int) -> None:
    now = backend.ranks.size
    if written != now and backend.state_format is None:
        raise OutputError(
            str(out),
            f"a run of {written} {'process' if written == 1 else 'processes'}",
            f"a run of {now}, as many as there are now, with backend {backend.name!r}",
            f"Resume it with {written}, or run without --resume.",
        )
