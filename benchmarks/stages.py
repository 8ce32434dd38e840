"""Where the time of a step goes: by the run's own stopwatch, and by hooks on the parts of a fluid solve."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import reduce, wraps
from typing import Any
from unittest.mock import patch

from disk_under_way import OUTPUT_EVERY

from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.run.stopwatch import Stopwatch

WATCHED = {
    "mesh": "adapt mesh",
    "transfer": "transfer",
    "contact": "bodies through contacts",
    "move mesh": "move mesh",
    "detect": "detect",
    "response": "reduced model",
}
"""Stage of the run's stopwatch → what it does."""

FACTORISE, ITERATE, RESPOND = "factorise", "iterate", "impulse responses"
SELDOM = FACTORISE, RESPOND
"""Stages that a step may do without."""

HOOKS = (
    ("assemble matrix", "rigidfluid.backends.scikit_fem.assembly", "CompiledAssembly.matrix"),
    ("assemble matrix", "rigidfluid.backends.dolfinx.forms", "Forms.assemble"),
    ("assemble matrix", "rigidfluid_ngsolve.assembly", "FormAssembly.matrix"),
    ("assemble load", "rigidfluid.taylor_hood.linear_solver.sparse", "SparseDiscretisation.mass_times"),
    ("assemble load", "rigidfluid.backends.dolfinx.discretisation", "PetscDiscretisation.mass_times"),
    ("fill P", "rigidfluid.taylor_hood.system.constraint", "Constraint.place"),
    ("fill P", "rigidfluid.backends.dolfinx.constraint", "DistributedConstraint.matrix"),
    (FACTORISE, "rigidfluid.taylor_hood.linear_solver.lagged_solver", "LaggedSolver._renew"),
    (ITERATE, "rigidfluid.taylor_hood.linear_solver.lagged_solver", "LaggedSolver.solve"),
    (RESPOND, "rigidfluid.taylor_hood.linear_solver.lagged_solver", "LaggedSolver.solve_columns"),
    ("energies", "rigidfluid.taylor_hood.stepping.advance", "kinetic_energy"),
    ("energies", "rigidfluid.taylor_hood.stepping.advance", "dissipation"),
)
"""Stage, module and function of each part of a fluid solve."""

STAGES = (*WATCHED.values(), *dict.fromkeys(stage for stage, _, _ in HOOKS), "the rest")


class Hooks:
    """Calls of the functions of `HOOKS` that are loaded, and Krylov iterations and columns of impulse responses in
    them; their time goes to the run's ``watch``, and not to the stage around them."""

    def __init__(self, watch: Stopwatch) -> None:
        self.calls: Counter[str] = Counter()
        self.iterations = self.columns = 0
        self._watch = watch

    @contextmanager
    def placed(self) -> Iterator[None]:
        """With the hooks in place."""
        with ExitStack() as patches:
            for stage, module, name in HOOKS:
                if module in sys.modules:
                    *owners, last = name.split(".")
                    owner = reduce(getattr, owners, sys.modules[module])
                    patches.enter_context(patch.object(owner, last, self._timed(stage, getattr(owner, last))))
            yield

    def _timed(self, stage: str, call: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(call)
        def timed(*args: Any, **named: Any) -> Any:
            with self._watch(stage):
                result = call(*args, **named)
            self.calls[stage] += 1
            self.iterations += result[1] if stage == ITERATE else 0
            self.columns += result.shape[1] if stage == RESPOND else 0
            return result

        return timed


def measured(run: Simulation, steps: int) -> dict[str, Any]:
    """Mean seconds a step of a ``run`` under way, and of its stages; fluid solves, their Krylov iterations and columns
    of impulse responses a step; all factorisations and re-meshes.

    With several processes the means over them, as each waits for the others in some stage.
    """
    hooks, watch, ranks = Hooks(run.watch), run.watch, run.system.backend.ranks
    before, remeshes = Counter(watch.seconds), run.counts.remeshes
    with hooks.placed():
        start = time.perf_counter()
        for step in range(steps):
            if step % OUTPUT_EVERY == 0:
                run.system.backend.memory()
            run.step()
        seconds = (time.perf_counter() - start) / steps
    # factors may outlive all these steps
    if run.system.has_fluid and (unseen := sorted({stage for stage, _, _ in HOOKS} - hooks.calls.keys() - {*SELDOM})):
        raise RuntimeError(f"no function of {', '.join(unseen)} was called: bring HOOKS up to date")
    spent = Counter({WATCHED.get(key, key): taken - before[key] for key, taken in watch.seconds.items()})
    stages = {stage: spent[stage] / steps for stage in STAGES}
    stages["the rest"] = seconds - sum(stages.values())
    return {
        "seconds": ranks.sum(seconds) / ranks.size,
        "stages": {stage: ranks.sum(value) / ranks.size for stage, value in stages.items()},
        "solves": hooks.calls[ITERATE] / steps,
        "iterations": hooks.iterations / steps,
        "columns": hooks.columns / steps,
        "factorisations": hooks.calls[FACTORISE],
        "remeshes": run.counts.remeshes - remeshes,
    }
