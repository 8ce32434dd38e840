"""The checkpoint to resume, of the same scene, by as many processes as wrote it or by another number."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from rigidfluid.core.case.population import Population, assemble_present
from rigidfluid.core.mesh.distribution import joined, partition, parts_of, shared
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh
from rigidfluid.core.output.checkpoint import Checkpoint
from rigidfluid.core.output.writer import checkpoint_name, earlier_parts, earlier_run, ranks_of_run
from rigidfluid.core.run.checkpoint_fit import require_fit, require_fluid
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.scene.earlier import tables_now
from rigidfluid.core.scene.fluid_table import FluidTable
from rigidfluid.core.setup.model import Model
from rigidfluid.errors import OutputError, PluginError
from rigidfluid.registry import FLUID_BACKEND, Registry


class Earlier(NamedTuple):
    """A run to go on with: its ``checkpoint``, and the ``model`` and ``system`` of its bodies then."""

    checkpoint: Checkpoint
    model: Model
    system: System


def earlier_of(model: Model, out: Path | None, system: System, clock: Clock, files: Mapping[str, str]) -> Earlier:
    """Read the checkpoint to resume; its scene must be this one, but for names of units, the end of time and a backend
    of one format.

    Raises OutputError where it is not, a file that the scene names has another digest than it has in ``files``, the
    state is not one of the ``system``, or the run is past the clock's end.
    """
    if out is None:
        raise OutputError("resume", "no folder", "the folder of an earlier run", "Name it with --out.")
    backend = system.backend
    checkpoint = checkpoint_for(backend, out)
    given = dict(model.document)
    stored = tables_now(json.loads(checkpoint.scene))
    stored |= {name: {} for name in ("time", "scene", "fluid") if not isinstance(stored.get(name), dict)}
    stored["time"]["end"] = given["time"]["end"]
    stored["scene"], given["scene"] = (tables["scene"] | {"units": None} for tables in (stored, given))
    if _is_of_another(backend, stored["fluid"].get("backend")):
        stored["fluid"], given["fluid"] = (_common_keys(tables["fluid"]) for tables in (stored, given))
        checkpoint = replace(checkpoint, memory={})
    if stored != given:
        changed = sorted(table for table in stored.keys() | given.keys() if stored.get(table) != given.get(table))
        raise OutputError(
            str(out),
            f"a run of another scene (other: {', '.join(changed)})",
            "a run of the same scene; only time.end, names of units, and the backend among those of P2–P1 may differ",
            "Give the same scene and the same --set, or run without --resume.",
        )
    _refuse_changed_files(checkpoint, files)
    path = out / checkpoint_name(backend.ranks.rank)
    population = Population.from_dict(json.loads(checkpoint.population))
    if population:
        origin, model = model, population.model(model)
        system = assemble_present(origin, model, population)
    with backend.ranks.raise_on_all():
        require_fit(path, checkpoint, system, clock)
        require_fluid(path, checkpoint.state, backend)
    if checkpoint.state.tick > clock.last_tick:
        found = f"an end at {clock.end:g}, before the checkpoint's time {clock.time(checkpoint.state.tick):g}"
        raise OutputError(str(out), found, "a later one", "Move time.end; the tables hold what was before it.")
    return Earlier(checkpoint, model, system)


def recall_memory(out: Path, earlier: Checkpoint, backend: FluidBackend) -> None:
    """Let the backend go on from its memory in a checkpoint; raises OutputError where it cannot, StepError where memory
    does not suffice."""
    try:
        backend.recall(earlier.memory, earlier.state.mesh)
    except PluginError as error:
        path = out / checkpoint_name(backend.ranks.rank)
        found = f"what {error.subject} cannot take up ({error.found})"
        raise OutputError(f"{path}, memory", found, "what the backend gave", "Run without --resume.") from error


def _refuse_changed_files(checkpoint: Checkpoint, now: Mapping[str, str]) -> None:
    """Raise OutputError where a file that the scene names is not as it was when the run of the checkpoint began."""
    before = json.loads(checkpoint.files)
    changed = sorted(name for name in before.keys() & now.keys() if before[name] != now[name])
    if changed:
        remedy = "Restore it, or run without --resume."
        raise OutputError(changed[0], "a file that has changed since the checkpoint", "the same content", remedy)


def _is_of_another(backend: FluidBackend, name: object) -> bool:
    """Tell whether a backend of this name is another one that writes the same states."""
    if name == backend.name or backend.state_format is None or not isinstance(name, str):
        return False
    before = Registry.load().find(FLUID_BACKEND, name)
    return (before.state_format, before.curved_cells) == (backend.state_format, backend.curved_cells)


def _common_keys(fluid: Mapping[str, Any]) -> dict[str, Any]:
    """Keys of ``[fluid]`` that are the same for all backends, with their values."""
    return {key: value for key, value in fluid.items() if key in FluidTable.model_fields and key != "backend"}


def checkpoint_for(backend: FluidBackend, out: Path) -> Checkpoint:
    """Read this process' checkpoint of the run in a folder; called by all that share the ``backend`` together.

    If another number of processes wrote it, the root puts the mesh and the fluid's state together and partitions them
    again; what the backend has kept besides is of the old parts and left behind. Raises OutputError where there is
    none, it cannot be read, or the backend cannot cut its state for this number of processes.
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
            parts = earlier_parts(out, written)
            for rank, part in enumerate(parts):
                require_fluid(out / checkpoint_name(rank), part.state, backend)
            pieces = _redistributed(backend, parts)
    own = ranks.scatter(pieces)
    reference = own.state.reference
    mesh = shared(reference.mesh, ranks)
    state = replace(own.state, reference=replace(reference, mesh=mesh), mesh=mesh.moved_to(own.state.mesh.geometry))
    return replace(own, state=state)


def _redistributed(backend: FluidBackend, parts: list[Checkpoint]) -> list[Checkpoint]:
    """Checkpoint for each process of the ``backend``; what is the same for all is the first's."""
    states = _cut(backend, _joined(backend, [part.state for part in parts]))
    sizes = [part.sizes for part in parts] + [np.zeros_like(parts[0].sizes)] * len(states)
    return [
        replace(parts[0], state=state, memory={}, sizes=own, ranks=len(states))
        for state, own in zip(states, sizes, strict=False)
    ]


def _joined(backend: FluidBackend, parts: list[State]) -> State:
    """The whole, from all parts in the order of ranks."""
    if len(parts) == 1:
        return parts[0]
    first, meshes = parts[0], [_meshes(part) for part in parts]
    references, present = ([pair[i] for pair in meshes] for i in range(2))
    reference = joined(references)
    mesh = reference.moved_to(joined(present).geometry)
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
