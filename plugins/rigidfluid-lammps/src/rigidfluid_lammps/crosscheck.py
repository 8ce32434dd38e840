"""Runs a scene in both programs."""

from __future__ import annotations

from rigidfluid.api import Scene, build_system
from rigidfluid_lammps.comparison import Comparison, compared
from rigidfluid_lammps.ours import run_ours
from rigidfluid_lammps.refusals import refuse_foreign
from rigidfluid_lammps.theirs import run_theirs
from rigidfluid_lammps.timing import Timing

SAMPLES = 200
"""Times at which positions and energies are compared, if there are as many steps."""


def crosscheck(scene: Scene, steps: int = 3, samples: int = SAMPLES) -> Comparison:
    """Run a dry scene of balls here and in LAMMPS, with the same velocity Verlet steps, and compare.

    It runs with as many ``steps`` lengths, from ``time.step`` over ``contact.substeps``, each half of the one before; a
    row for each, the longest first. Raises CrosscheckError if LAMMPS is missing, fails, or has no exact counterpart of
    something in the scene, StepError if bodies overlap.
    """
    system = build_system(scene)
    refuse_foreign(scene, system)
    timings = [Timing.choose(scene, samples).divided(2**halvings) for halvings in range(steps)]
    # LAMMPS first: if it is missing, nothing has been computed in vain.
    pairs = [(run_theirs(system, timing), run_ours(scene, timing)) for timing in timings]
    return compared(system, [timing.step for timing in timings], [(ours, theirs) for theirs, ours in pairs])
