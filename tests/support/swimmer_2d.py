"""The three-sphere swimmer in 2D: steps, meshes, boxes, angles, orders of strokes and the fluid's inertia."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import rigidfluid
from rigidfluid.core.output.history import History
from rigidfluid.core.scene.scene import Scene

SCENE = Path(__file__).parents[2] / "scenes" / "swimmer.toml"
ADVANCE = 0.2910
"""Displacement in a cycle over the radius, by quasi-static resistances with facets of .3 (.29089) and .15 (.29104)."""


def _square(half: float, *others: str) -> list[str]:
    """Overrides for a square box around the swimmer."""
    return [f"domain.lower=[{-half}, {-half}]", f"domain.upper=[{half}, {half}]", *others]


_REVERSED = 'mechanism.0.order=["right in", "left in", "right out", "left out"]'
_NEWTON = "fluid.model=navier-stokes"
SWIMS: dict[str, list[str]] = {
    "as shipped": [],
    "step 0.2": ["time.step=0.2"],
    "step 0.05": ["time.step=0.05"],
    "step 0.025": ["time.step=0.025"],
    "facets 0.15, cells 2": ["mesh.size_body=0.15", "mesh.size=2.0"],
    "facets 0.15, cells 2, step 0.025": ["mesh.size_body=0.15", "mesh.size=2.0", "time.step=0.025"],
    "bodies of density 0.001": ["mechanism.0.density=0.001"],
    "strokes in reversed order": [_REVERSED],
    "box 100 x 100": _square(50.0),
    "box 100 x 100, turned by 90°": _square(50.0, "mechanism.0.angle=1.5707963267948966"),
    "box 200 x 200": _square(100.0),
    "box 200 x 200, turned by 90°": _square(100.0, "mechanism.0.angle=1.5707963267948966"),
    "box 200 x 200, turned by 30°": _square(100.0, "mechanism.0.angle=0.5235987755982988"),
    "Navier–Stokes, Re 8": [_NEWTON],
    "Navier–Stokes, step 0.05": [_NEWTON, "time.step=0.05"],
    "Navier–Stokes, step 0.025": [_NEWTON, "time.step=0.025"],
    "Navier–Stokes, step 0.0125": [_NEWTON, "time.step=0.0125"],
}


def scene(overrides: list[str]) -> Scene:
    """Two cycles."""
    return rigidfluid.load_scene(SCENE, ["time.end=8.0", *overrides])


def swim_figures(history: History) -> dict[str, str]:
    """What the page tells of one run; along and across the swimmer's axis; ``off`` in the channel alone."""
    summary, found = history.summary, history.summary["cycles"]["swimmer"]
    angle = float(summary["scene"]["mechanism"][0].get("angle", 0.0))
    axis = np.array([np.cos(angle), np.sin(angle)])
    first, second = np.array(found["displacement"])
    comparable = summary["scene"]["domain"]["upper"] == [50.0, 20.0] and summary["scene"]["fluid"]["model"] == "stokes"
    return {
        "first cycle [r]": f"{first @ axis:+.4f}",
        "advance [r]": f"{second @ axis:+.5f}",
        "off": f"{abs(second @ axis) / ADVANCE - 1:+.2%}" if comparable else "",
        "across [r]": f"{second @ [-axis[1], axis[0]]:+.1e}",
        "turned [rad]": f"{found['rotation'][1]:+.1e}",
        "energy not accounted for": f"{summary['energy']['relative_residual']:+.2%}",
        "steps": f"{summary['steps']}",
        "cells": f"{summary['cells']}",
        "CPU [s]": f"{summary['cpu_time']:.0f}",
    }
