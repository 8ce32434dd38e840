"""Where the time of a step goes: by the run's own stopwatch, and inside its stage "advance" by hooks on functions."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable
from functools import wraps
from typing import Any

from disk_under_way import OUTPUT_EVERY

from rigidfluid.core.run.simulation import Simulation

# A stage of the run's stopwatch → what it does.
WATCHED = {"mesh": "adapt mesh", "contact": "bodies through contacts", "move mesh": "move mesh", "detect": "detect"}
FACTORISE, ITERATE = "factorise", "iterate"
# Stage, module, function. A function within another one belongs to the outer one's stage.
HOOKS = (
    ("assemble matrix", "rigidfluid.backends.scikit_fem.assembly", "CompiledAssembly.matrix"),
    ("assemble matrix", "rigidfluid.backends.dolfinx.forms", "Forms.assemble"),
    ("assemble matrix", "rigidfluid_ngsolve.assembly", "FormAssembly.matrix"),
    ("assemble load", "rigidfluid.taylor_hood.sparse", "SparseDiscretisation.mass_times"),
    ("assemble load", "rigidfluid.backends.dolfinx.discretisation", "PetscDiscretisation.mass_times"),
    ("fill P", "rigidfluid.taylor_hood.constraint", "Constraint.place"),
    ("fill P", "rigidfluid.backends.dolfinx.constraint", "DistributedConstraint.matrix"),
    (FACTORISE, "rigidfluid.taylor_hood.lagged_solver", "LaggedSolver._renew"),
    (ITERATE, "rigidfluid.taylor_hood.lagged_factors", "LaggedFactors.iterate"),
    (ITERATE, "rigidfluid.backends.dolfinx.krylov", "Krylov.iterate"),
    ("energies", "rigidfluid.taylor_hood.advance", "kinetic_energy"),
    ("energies", "rigidfluid.taylor_hood.advance", "dissipation"),
)
STAGES = (*WATCHED.values(), *dict.fromkeys(stage for stage, _, _ in HOOKS), "the rest")


class Hooks:
    """Seconds and calls of each stage in the functions of `HOOKS` that are loaded, and Krylov iterations in them."""

    def __init__(self) -> None:
        self.seconds: Counter[str] = Counter()
        self.calls: Counter[str] = Counter()
        self.iterations = 0
        self._inside = False
        for stage, module, name in HOOKS:
            if module in sys.modules:
                *owners, last = name.split(".")
                owner = sys.modules[module]
                for each in owners:
                    owner = getattr(owner, each)
                setattr(owner, last, self._timed(stage, getattr(owner, last)))

    def _timed(self, stage: str, call: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(call)
        def timed(*args: Any, **named: Any) -> Any:
            if self._inside:
                return call(*args, **named)
            self._inside, start = True, time.perf_counter()
            try:
                result = call(*args, **named)
            finally:
                self._inside = False
                self.seconds[stage] += time.perf_counter() - start
                self.calls[stage] += 1
            if stage == ITERATE:
                self.iterations += result[1]
            return result

        return timed


def measured(run: Simulation, steps: int) -> dict[str, Any]:
    """Of a run under way: mean seconds a step and of its stages, Krylov iterations a step, factorisations in all.

    With several processes the means over them, as each waits for the others in some stage.
    """
    hooks, ranks = Hooks(), run.system.backend.ranks
    before = Counter(run.watch.seconds)
    start = time.perf_counter()
    for step in range(steps):
        if step % OUTPUT_EVERY == 0:
            run.system.backend.memory()
        run.step()
    seconds = (time.perf_counter() - start) / steps
    watched = {stage: (run.watch.seconds[key] - before[key]) / steps for key, stage in WATCHED.items()}
    hooked = {stage: hooks.seconds[stage] / steps for stage, _, _ in HOOKS}
    # factors may outlive all these steps
    if unseen := sorted({stage for stage, _, _ in HOOKS} - hooks.calls.keys() - {FACTORISE}):
        raise RuntimeError(f"no function of {', '.join(unseen)} was called: bring HOOKS up to date")
    stages = {stage: (watched | hooked).get(stage, 0.0) for stage in STAGES}
    stages["the rest"] = seconds - sum(stages.values())
    return {
        "seconds": ranks.sum(seconds) / ranks.size,
        "stages": {stage: ranks.sum(value) / ranks.size for stage, value in stages.items()},
        "iterations": hooks.iterations / steps,
        "factorisations": hooks.calls[FACTORISE],
        "remeshes": run.counts.remeshes,
    }
