"""Steel spheres hit a wall obliquely in a liquid: the angle of rebound over that of incidence, for two surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

import rigidfluid
from rigidfluid.core.scene.scene import Scene

RADIUS, STEEL, DRY, SPEED = 0.635, 7.78, 0.97, 20.0
"""Radius [cm], density [g/cm³], dry restitution and speed towards the wall at the start [cm/s]."""
LIQUID = {"density": 1.091, "viscosity": 0.03}
"""Glycerol and water, 37 % [g, cm, s]."""
RANGE, END = 0.1 * RADIUS, 0.045
"""Range of the law [cm] and end of the runs [s]."""


@dataclass(frozen=True)
class Surface:
    """Sphere and wall: their ``roughness`` [cm] and coefficient of ``friction`` in the liquid."""

    roughness: float
    friction: float


SURFACES = {"smooth": Surface(24e-7, 0.02), "rough": Surface(272e-7, 0.11)}
ANGLES = (0.1, 0.3, 0.7, 1.4, 3.0)
"""Speed along the wall over that towards it, at the start."""


def scene(label: str) -> Scene:
    """The sphere a radius from the wall; ``label`` names surface and angle, and ``_dry`` a run without a liquid."""
    name, angle, *dry = label.split("_")
    surface, ratio = SURFACES[name], float(angle)
    speed = SPEED * np.hypot(1.0, ratio)
    contact = {"law": "normal", "range": RANGE, "epsilon": "auto", "impact_speed": SPEED, "restitution": DRY}
    contact |= {"friction": surface.friction}
    wet = {
        "fluid": LIQUID,
        "boundary": [{"on": side, "type": "slip"} for side in ("left", "right", "front", "back")],
        "mesh": {"size": 5.0 * RADIUS, "size_body": 0.4 * RADIUS},
    }
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "oblique", "dimension": 3, "units": {"length": "cm", "time": "s", "mass": "g"}},
            "domain": {
                "lower": [-8.0 * RADIUS, 0.0, -6.0 * RADIUS],
                "upper": [8.0 * RADIUS, 12.0 * RADIUS, 6.0 * RADIUS],
            },
            "body": [
                {
                    "name": "sphere",
                    "type": "sphere",
                    "radius": RADIUS,
                    "density": STEEL,
                    "position": [-ratio * RADIUS, 2.0 * RADIUS, 0.0],
                    "velocity": [SPEED * ratio, -SPEED, 0.0],
                }
            ],
            "contact": contact | ({} if dry else {"roughness": surface.roughness}),
            "time": {"end": END, "step": float(f"{RADIUS / (12.0 * speed):.3g}")},
            "output": {"every": END},
            **({"fluid": {"backend": "dry"}} if dry else wet),
        }
    )
