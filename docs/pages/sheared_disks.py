"""200 disks in a sheared cell that is periodic along its walls: steps, seconds and memory."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from page_tools import Page, Work, table

import rigidfluid
from pages._measured_steps import figure, figures, measured
from rigidfluid import Scene

DISK = {"type": "sphere", "radius": 0.25}
CELL = {"lower": [0.0, 0.0], "upper": [20.0, 10.0]}
"""In which the disks are at first, none across its ends."""


def page(work: Work) -> Page:
    """What a step costs, by stages, and memory after each step."""
    (row,) = work.rows(rows)
    text = ABOUT.format(figures=table(("figure", "value"), figures(row)))
    return Page("200 disks in a sheared cell", text, {"": figure(row)})


def disks() -> Scene:
    """200 disks between walls that slide past each other."""
    walls = [{"on": side, "type": "wall", "velocity": [speed, 0.0]} for side, speed in (("bottom", -5), ("top", 5))]
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "sheared_disks", "dimension": 2, "seed": 1},
            "fluid": {"density": 1.0, "viscosity": 1.0, "initial": ["y - 5", "0"]},
            "domain": CELL,
            "boundary": [{"on": "all", "type": "periodic"}, *walls],
            "swarm": [
                {
                    "name": "disk",
                    "number": 200,
                    "density": 1.0,
                    "gap": 0.06,
                    "shape": [DISK],
                    "region": {"type": "box", **CELL},
                }
            ],
            "contact": {"law": "normal", "range": 0.05, "epsilon": "auto", "impact_speed": 0.25},
            "mesh": {"size": 0.5, "size_body": 0.16, "growth": 0.3, "cells_per_gap": 1, "refinements": 1},
            "time": {"end": 1.0, "step": 0.04},
            "output": {"every": 1.0},
        }
    )


def rows() -> Iterator[dict[str, Any]]:
    """The run as a row."""
    yield measured(disks())


ABOUT = """The scene of this page, `docs/pages/sheared_disks.py`, is for cost and memory on a coarse mesh: 200 disks of
the fluid's density, a fifth of the area, seeded by `[[swarm]]`, are sheared at a rate of 1 between walls that slide.
The cell is periodic along them.

{figures}

Seconds are CPU time of one core; the start is loading, seeding and the first mesh. Memory is that of the process after
each step; it changes with the mesh."""
