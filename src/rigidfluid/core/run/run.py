"""Runs a scene from its start, or from a checkpoint, to its end."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from contextlib import closing, suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rigidfluid.core.case.scene_model import Case
from rigidfluid.core.model.foreign import no_exit
from rigidfluid.core.output.history import History
from rigidfluid.core.run.caller_input import require_function
from rigidfluid.core.run.process import give_back_memory, remembered_interrupt
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.run.summary import warnings_of
from rigidfluid.errors import OutputError, RigidfluidError, RunWarning, SharedInterrupt

__all__ = ["Progress", "run", "simulate"]


def run(
    case: Case,
    out: Path | None = None,
    *,
    resume: bool = False,
    progress: Callable[[Progress], None] | None = None,
    processes: int | None = None,
) -> History:
    """Run a scene or a model to its end, and warn of what its summary warns of.

    Parameters
    ----------
    case : Scene or Model
        A scene from `load_scene` or `scene_from_dict`, or a model made of objects.
    out : Path or None
        Folder for the results; None keeps them in memory alone.
    resume : bool
        Go on from the checkpoint in ``out``; the result equals that of an uninterrupted run to the last bit, unless
        several processes share the run and its backend's factors depend on the order of their messages.
    progress : callable or None
        Called after each accepted step with a `Progress`; `NotebookProgress` shows it in a notebook.
    processes : int or None
        How many processes were started to share the run, each calling this; a backend that cannot share it among so
        many is refused. None takes the backend's word.

    Returns
    -------
    History
        Tables and summary, the same that ``out`` holds, and read from there when they are asked for; also where the run
        is shared, on all ranks.

    Raises
    ------
    SceneError, PluginError, MeshError
        Before anything is written; PluginError also where a part gives what cannot be, or exits.
    OutputError
        Where the disk refuses, there is nothing to resume, or ``out`` is another run's or not a run's.
    StepError
        Where even the shortest step fails, or memory does not suffice; what was computed stays, and can be resumed.

    Any other error, as that of a plug-in, leaves a summary too. A RunWarning tells of energy created or lost, of meshes
    that could not be made and of what else throws doubt on the results.
    """
    history = simulate(case, out, resume=resume, progress=progress, processes=processes)
    for text in warnings_of(history.summary):
        warnings.warn(text, RunWarning, stacklevel=2)
    return history


def simulate(
    case: Case,
    out: Path | None = None,
    *,
    resume: bool = False,
    progress: Callable[[Progress], None] | None = None,
    processes: int | None = None,
    finished: Callable[[History], None] = lambda _: None,
) -> History:
    """Run a scene or a model to its end, as `run` does without its warnings; ``finished`` is called with the results
    once they are summed up, also where the run then raises what stopped it."""
    with no_exit(), closing(Simulation(case, out, resume, processes)) as simulation:
        if progress is not None:
            require_function("progress", progress, "a function of a Progress, or None")
            simulation.observe(lambda now: progress(_progress(now)))
        try:
            with no_exit(), remembered_interrupt(simulation.system.backend.ranks) as interrupt_if_lost:
                simulation.observe(lambda _: interrupt_if_lost())
                simulation.go()
        except BaseException as error:
            # others need not reach all ranks
            if simulation.alone or isinstance(error, (RigidfluidError, SharedInterrupt)):
                with suppress(OutputError):  # a full disk has been reported once
                    simulation.finish(status=_status(error))
                    finished(simulation.history)
            raise
        simulation.finish(status="complete")
        finished(simulation.history)
        simulation.system.backend.forget()  # much memory, which the next run in this process may want
        give_back_memory()
    return simulation.history


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of a run: ``time`` of ``end`` [time], latest ``step`` [time], smallest ``gap`` [length], wall seconds,
    how many new meshes could not be made, and the tables so far."""

    time: float
    end: float
    step: float
    gap: float
    elapsed: float
    failed_remeshes: int
    history: History


def _progress(now: Simulation) -> Progress:
    step, gap = now.clock.size(now.state.level or 0), float(now.state.gaps.min(initial=np.inf))
    return Progress(now.time, now.clock.end, step, gap, now.elapsed, now.counts.failed_remeshes, now.history)


def _status(error: BaseException) -> str:
    if isinstance(error, KeyboardInterrupt):
        return "interrupted"
    kind = "" if isinstance(error, RigidfluidError) else f"{type(error).__name__}: "
    return f"stopped: {kind}{error}"
