"""Speed of this machine's solver, relative to the machine on which steps were timed."""

from __future__ import annotations

import time

_POINTS = 96
_REFERENCE = 0.025
"""CPU seconds of the factors below on the machine of the fits in `taylor_hood.linear_solver.predicted_cost`."""
_REPEATS = 3


def machine_speed() -> float:
    """Speed of one core for sparse factors, 1 on the machine of reference; the best of a few trials, in .2 s."""
    return _REFERENCE / min(_trial() for _ in range(_REPEATS))


def _trial() -> float:
    """CPU seconds of SuperLU's factors of the five-point Laplacian on a square grid."""
    from scipy.sparse import diags_array, eye_array, kron
    from scipy.sparse.linalg import splu

    line = diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(_POINTS, _POINTS))
    matrix = (kron(line, eye_array(_POINTS)) + kron(eye_array(_POINTS), line)).tocsc()
    begun = time.thread_time()
    splu(matrix)
    return time.thread_time() - begun
