"""64 spheres that settle in a cell that is periodic in all directions: steps, seconds and memory."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from page_tools import Page, Work, table

import rigidfluid
from pages._measured_steps import figure, figures, measured
from rigidfluid import Scene

SIDES = ("left", "bottom", "back")
SPHERE = {"type": "sphere", "radius": 0.72}
CELL = {"lower": [0.0, 0.0, 0.0], "upper": [10.0, 10.0, 10.0]}
"""In which the spheres are at first, none across its sides."""


def page(work: Work) -> Page:
    """What a step costs, by stages, and memory after each step."""
    (row,) = work.rows(rows)
    text = ABOUT.format(figures=table(("figure", "value"), figures(row)))
    return Page("64 spheres in a periodic cell", text, {"": figure(row)})


def spheres() -> Scene:
    """64 spheres of twice the fluid's density, through which on the whole no fluid goes."""
    held = [{"on": side, "type": "periodic", "flux": 0.0} for side in SIDES]
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "spheres_in_cell", "dimension": 3, "seed": 1},
            "fluid": {"density": 1.0, "viscosity": 0.1, "gravity": [0.0, 0.0, -1.0]},
            "domain": CELL,
            "boundary": [{"on": "all", "type": "periodic"}, *held],
            "swarm": [
                {
                    "name": "sphere",
                    "number": 64,
                    "density": 2.0,
                    "gap": 0.2,
                    "shape": [SPHERE],
                    "region": {"type": "box", **CELL},
                }
            ],
            "contact": {"law": "normal", "range": 0.05, "epsilon": "auto", "impact_speed": 0.5},
            "mesh": {"size": 1.0, "size_body": 0.5, "growth": 0.3, "cells_per_gap": 1, "refinements": 0},
            "time": {"end": 3.0, "step": 0.1},
            "output": {"every": 1.0},
        }
    )


def rows() -> Iterator[dict[str, Any]]:
    """The run as a row."""
    yield measured(spheres())


ABOUT = """The scene of this page, `docs/pages/spheres_in_cell.py`, is for cost and memory on a coarse mesh: 64 spheres
of twice the fluid's density, a tenth of the volume, seeded by `[[swarm]]`, start from rest and settle in a cell that is
periodic in all directions. The flux through its sides is held at zero. In this time none comes into the range of
another one's law, and the first mesh serves.

{figures}

Seconds are CPU time of one core; the start is loading, seeding and the first mesh. Memory is that of the process after
each step; it changes with the mesh."""
