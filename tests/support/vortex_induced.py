"""A cylinder that its own vortices shake: published figures, and the same measured in a run.

D. Shiels, A. Leonard, A. Roshko, J. Fluids Struct. 15 (2001) 3, doi:10.1006/jfls.2000.0330, table 2: Re = UD/ν = 100,
free across the stream alone, without damper, m* = m/(½ρD²) = 5 and k* = k/(½ρU²). By a vortex method, in an unbounded
fluid. The figures are taken from works that quote them.
"""

from typing import NamedTuple

import numpy as np

from rigidfluid.core.output.history import History

LATE_PERIODS = 5


class Swing(NamedTuple):
    """Amplitude over D, frequency times D/U, amplitude of the lift coefficient and mean drag coefficient."""

    amplitude: float
    frequency: float
    lift: float
    drag: float


FIXED = Swing(0.0, 0.167, 0.30, 1.33)
PUBLISHED = {9.88: Swing(0.57, 0.198, 1.35, 2.23), 4.74: Swing(0.46, 0.156, 0.04, 1.70)}
"""By k*."""


def measured(history: History) -> Swing:
    """Over the last whole periods, for D = U = ρ = 1; the period is that of the lift."""
    bodies = history.bodies
    time, lift = bodies["time"], 2.0 * bodies["fy"]
    starts = _rises(time, lift)[-LATE_PERIODS - 1 :]
    late = (time >= starts[0]) & (time <= starts[-1])
    return Swing(
        amplitude=0.5 * float(np.ptp(bodies["y"][late])),
        frequency=(len(starts) - 1) / float(starts[-1] - starts[0]),
        lift=0.5 * float(np.ptp(lift[late])),
        drag=float(np.trapezoid(2.0 * bodies["fx"][late], time[late]) / np.ptp(time[late])),
    )


def growth(history: History) -> float:
    """By how much the amplitude changes, relatively, from the five periods before the last five [1]."""
    time, y = history.bodies["time"], history.bodies["y"]
    starts = _rises(time, 2.0 * history.bodies["fy"])[-2 * LATE_PERIODS - 1 :]
    before, after = (np.ptp(y[(time >= a) & (time <= b)]) for a, b in zip(starts[:-5:5], starts[5::5], strict=True))
    return float(after / before - 1.0)


def _rises(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """When they rise through zero."""
    before = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    share = values[before] / (values[before] - values[before + 1])
    return time[before] + share * (time[before + 1] - time[before])
