"""Checks of what constraints and coordinates of joints give."""

from __future__ import annotations

from typing import Any

import numpy as np

from rigidfluid.core.geometry.answers import refuse_other_rows, refuse_others
from rigidfluid.core.geometry.wrong import Wrong


def directions(answer: Any, part: Any, at: Any) -> None:
    """Refuse what are no matrices E (r, d) and A (r, k), of the relative velocity and of the relative rotation."""
    refuse_others(answer, tuple)
    if len(answer) != 2:
        raise Wrong(f"{len(answer)} matrices", "two, of velocities and of rotations")
    count = len(answer[0]) if isinstance(answer[0], np.ndarray) and answer[0].ndim else 1
    for name, matrix, width in zip(("E", "A"), answer, at.levers.shape[1:], strict=True):
        refuse_other_rows(matrix, (count, width), name)


def misfit(answer: Any, part: Any, at: Any, time: float) -> None:
    """Refuse what are no rows of a violation; dampers have none."""
    refuse_other_rows(answer, part.compliance.shape if np.size(answer) else (0,))


def column(answer: Any, part: Any) -> None:
    """Refuse what is no compliance, zero or above for each row."""
    refuse_other_rows(answer, (np.size(answer),))
    if not np.all(answer >= 0.0):
        raise Wrong(f"{np.min(answer)}", "numbers from 0 on")


def levers(answer: Any, part: Any, at: Any) -> None:
    """Refuse what are no levers about both centres of mass."""
    refuse_other_rows(answer, at.levers.shape)
