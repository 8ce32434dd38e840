"""A transported scalar: natural convection in a cavity, a hot cylinder in a stream, and bodies that conduct."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Work, table
from page_tools.places import SCENES
from two_layers import (
    BALL,
    DIFFUSIVITY,
    WALL,
    error_outside,
    exact_outside,
    gradient_found,
    gradient_inside,
    in_linear_field,
    left_of_mode,
    node_points,
    slowest_mode,
    values_at,
)

import rigidfluid
from rigidfluid import Scene
from rigidfluid.api import Simulation
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.reports.scale import HOT_COLOURMAP

PRANDTL = 0.71
CAVITY = {1e3: 1.118, 1e4: 2.243, 1e5: 4.519}
CAVITY_CELLS = (0.16, 0.08)
STREAM = (10.0, 20.0, 40.0)
CELLS = (0.06, 0.03)
GRID = 41
"""Points along each side at which temperatures of a picture are."""
RADII = 26
CONDUCTIVITIES = (0.1, 1.0, 10.0)
LAYER_CELLS = (0.2, 0.1, 0.05)
MODES = ((0.2, 0.5), (5.0, 2.0))
"""Conductivity and capacity of the body over the fluid's."""
FALL_CAPACITY = 2.0
MODE_STEPS, DECAY = (4, 8, 16, 32), 0.8
FALLS = (0.5, 10.0, 1e4, None)
"""Conductivities of a disk that falls; None for one with one value."""


def page(work: Work) -> Page:
    """Nusselt numbers against published ones, and isotherms."""
    rows = work.rows(measured)
    cases = ("cavity", "stream", "field", "mode", "fall")
    cavity, stream, field, mode, fall = ([row for row in rows if row["case"] == case] for case in cases)
    head = ("Ra", "cells", "Nu hot", "Nu cold", "de Vahl Davis", "difference", "residual", "s")
    text = ABOUT + table(head, map(_cavity_row, cavity))
    head = ("Re", "cells at the cylinder", "Nu", "Lange et al.", "difference", "residual", "s")
    text += ABOUT_STREAM + table(head, map(_stream_row, stream))
    head = ("conductivity", "cells", "gradient inside", "exact", "difference", "error outside")
    text += ABOUT_FIELD + table(head, map(_field_row, field))
    head = ("conductivity", "capacity", "steps", "rate", "exact", "difference")
    text += ABOUT_MODE + table(head, map(_mode_row, mode))
    head = ("conductivity", "new meshes", "mean inside", "on its surface", "greatest", "change of content")
    text += ABOUT_FALL + table(head, map(_fall_row, fall))
    pictures = {
        "": _picture([row for row in cavity if "field" in row]),
        "_bodies": _picture_of_fields([row for row in field if "field" in row]),
    }
    return Page("Heat and buoyancy", text + "\n", pictures)


def measured() -> Iterator[dict[str, Any]]:
    """A row for each run of cavity and cylinder."""
    for rayleigh in CAVITY:
        for cells in CAVITY_CELLS:
            row, temperature = _cavity(rayleigh, cells)
            field = {"field": np.round(temperature, 4).tolist()} if cells == CAVITY_CELLS[-1] else {}
            yield {"case": "cavity", **row, **field}
    for reynolds in STREAM:
        for cells in CELLS:
            yield {"case": "stream", **_stream(reynolds, cells)}

    for conductivity in CONDUCTIVITIES:
        for cells in LAYER_CELLS:
            yield {"case": "field", **_field(conductivity, cells)}
    for conductivity, capacity in MODES:
        for steps in MODE_STEPS:
            yield {"case": "mode", **_mode(conductivity, capacity, steps)}
    for conductivity in FALLS:
        yield {"case": "fall", **_fall(conductivity)}


def _field(conductivity: float, cells: float) -> dict[str, Any]:
    """The gradient in a disk in a linear field, and the error of the fluid; on the finest mesh values on a grid."""
    flow = in_linear_field(conductivity, cells)
    error = error_outside(flow, exact_outside(conductivity, node_points(flow)))
    row = {"conductivity": conductivity, "cells": cells, "gradient": gradient_found(flow), "error": error}
    if cells != LAYER_CELLS[-1]:
        return row
    grid = _round_grid()
    return row | {"field": np.round(values_at(flow, grid.reshape(-1, 2)).reshape(grid.shape[:2]), 4).tolist()}


def _round_grid() -> FloatArray:
    """Points on circles in the round wall (radii, angles, 2)."""
    radius, angle = np.linspace(0.0, WALL, RADII)[:, None], np.linspace(0.0, 2.0 * np.pi, 2 * GRID)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=2)


def _mode(conductivity: float, capacity: float, steps: int) -> dict[str, Any]:
    """The rate at which a mode of two layers decays, and that of theory."""
    left = left_of_mode(conductivity, capacity, DECAY, steps, LAYER_CELLS[-1])
    exact, _ = slowest_mode(conductivity, capacity)
    found = -np.log(left) / DECAY * exact
    return {"conductivity": conductivity, "capacity": capacity, "steps": steps, "rate": found, "exact": exact}


def fall(conductivity: float | None) -> Scene:
    """A warm disk that falls and turns in a closed box; nothing goes through the walls."""
    conducts = {} if conductivity is None else {"conductivity": conductivity}
    disk = {"type": "sphere", "radius": 0.15, "density": 1.2, "position": [0.5, 2.4], "angular_velocity": 20.0}
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "fall", "dimension": 2},
            "fluid": {"density": 1.0, "viscosity": 0.05, "gravity": [0.0, -9.81]},
            "scalar": {
                "diffusivity": 0.02,
                "body": [{"on": "disk", "value": 1.0, "capacity": FALL_CAPACITY, **conducts}],
            },
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 3.0]},
            "body": [{"name": "disk", **disk}],
            "mesh": {"size": 0.2, "size_body": 0.05, "remesh_every": 0.2},
            "time": {"end": 1.0, "step": 0.02},
            "output": {"every": 1.0},
        }
    )


def _fall(conductivity: float | None) -> dict[str, Any]:
    """What a disk has in the end, and by how much the content of disk and fluid has changed on the way."""
    history = rigidfluid.run(fall(conductivity))
    fluxes = history.scalar_fluxes
    disk = fluxes["surface"] == "disk"
    whole = history.scalar["content"] + FALL_CAPACITY * np.pi * 0.15**2 * fluxes["inside"][disk]
    return {
        **{"conductivity": conductivity, "meshes": int(history.steps["remeshes"][-1])},
        **{name: float(fluxes[name][disk][-1]) for name in ("inside", "value")},
        **{"greatest": float(history.scalar["greatest"][-1]), "change": float(np.ptp(whole) / whole[0])},
    }


def _cavity(rayleigh: float, cells: float) -> tuple[dict[str, Any], FloatArray]:
    """Nusselt numbers of the hot and the cold side, and temperatures on a grid."""
    changed = [f"fluid.gravity=[0, {-rayleigh * PRANDTL}]", f"mesh.size={cells}", f"mesh.size_body={cells}"]
    scene = rigidfluid.load_scene(SCENES / "hot_cavity.toml", [*changed, "time.step=0.005", "time.end=1"])
    began, run = time.process_time(), Simulation(scene)
    run.go()
    account = run.state.scalar
    assert account is not None
    hot, cold, *_ = account.flux.tolist()
    worst = float(np.abs(run.history.scalar["imbalance"]).max())
    spent = time.process_time() - began
    grid = np.stack(np.meshgrid(*[np.linspace(0.0, 1.0, GRID)] * 2), axis=2).reshape(-1, 2)
    temperature = run.system.backend.probe_scalar(run.state.fluid, run.state.mesh, run.state.pose, grid)
    row = {"Ra": rayleigh, "cells": cells, "hot": hot, "cold": -cold, "residual": worst / hot, "s": spent}
    return row, temperature.reshape(GRID, GRID)


def stream(reynolds: float, cells: float) -> Scene:
    """A cylinder of diameter 1 held at 1 in a stream of speed 1 and value 0, which is steady from the start."""
    inlet = {"type": "velocity", "velocity": [1.0, 0.0]}
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "stream", "dimension": 2},
            "fluid": {"density": 1.0, "viscosity": 1.0 / reynolds, "initial": "steady"},
            "scalar": {
                "diffusivity": 1.0 / (reynolds * PRANDTL),
                "boundary": [{"on": "left", "value": 0.0}],
                "body": [{"on": "cylinder", "value": 1.0}],
            },
            "domain": {"lower": [-30.0, -30.0], "upper": [50.0, 30.0]},
            "boundary": [
                {"on": "left", **inlet},
                {"on": "right", "type": "pressure", "pressure": 0.0},
                {"on": "bottom", "type": "slip"},
                {"on": "top", "type": "slip"},
            ],
            "body": [
                {
                    "name": "cylinder",
                    "type": "sphere",
                    "radius": 0.5,
                    "density": 1.0,
                    "position": [0.0, 0.0],
                    "fixed": True,
                }
            ],
            "mesh": {"size": 3.0, "size_body": cells, "growth": 0.15},
            "time": {"end": 120.0, "step": 2.0},
            "output": {"every": 120.0},
        }
    )


def _stream(reynolds: float, cells: float) -> dict[str, Any]:
    """Nusselt number of a hot cylinder."""
    began, run = time.process_time(), Simulation(stream(reynolds, cells))
    run.go()
    account = run.state.scalar
    assert account is not None
    flux, worst = float(account.flux[0]), float(np.abs(run.history.scalar["imbalance"]).max())
    spent = time.process_time() - began
    return {
        **{"Re": reynolds, "cells": cells, "Nu": flux * reynolds * PRANDTL / np.pi},
        **{"residual": worst / flux, "s": spent},
    }


def lange(reynolds: float) -> float:
    """Nusselt number of a cylinder in air by the fit of Lange, Durst and Breuer (1998)."""
    return float(0.082 * reynolds**0.5 + 0.734 * reynolds ** (0.05 + 0.226 * reynolds**0.085))


def _cavity_row(row: dict[str, Any]) -> Iterator[str]:
    wanted = CAVITY[row["Ra"]]
    yield from (
        f"{row['Ra']:.0e}",
        f"{row['cells']:g}",
        f"{row['hot']:.4f}",
        f"{row['cold']:.4f}",
    )
    yield from (f"{wanted:.3f}", f"{100.0 * (row['hot'] / wanted - 1.0):+.2f} %", f"{row['residual']:.0e}")
    yield f"{row['s']:.0f}"


def _stream_row(row: dict[str, Any]) -> Iterator[str]:
    wanted = lange(row["Re"])
    yield from (f"{row['Re']:.0f}", f"{row['cells']:g}", f"{row['Nu']:.3f}", f"{wanted:.3f}")
    yield from (f"{100.0 * (row['Nu'] / wanted - 1.0):+.1f} %", f"{row['residual']:.0e}", f"{row['s']:.0f}")


def _field_row(row: dict[str, Any]) -> Iterator[str]:
    exact = gradient_inside(row["conductivity"], 2)
    yield from (f"{row['conductivity']:g}", f"{row['cells']:g}", f"{row['gradient']:.6f}", f"{exact:.6f}")
    yield from (f"{row['gradient'] / exact - 1.0:+.1e}", f"{row['error']:.1e}")


def _mode_row(row: dict[str, Any]) -> Iterator[str]:
    yield from (f"{row['conductivity']:g}", f"{row['capacity']:g}", f"{row['steps']}")
    yield from (f"{row['rate']:.5f}", f"{row['exact']:.5f}", f"{row['rate'] / row['exact'] - 1.0:+.1e}")


def _fall_row(row: dict[str, Any]) -> Iterator[str]:
    given = row["conductivity"]
    yield from ("one value" if given is None else f"{given:g}", f"{row['meshes']}")
    yield from (f"{row[name]:.5f}" for name in ("inside", "value", "greatest"))
    yield f"{row['change']:.0e}"


def _picture_of_fields(rows: list[dict[str, Any]]) -> Figure:
    """Isotherms in and around disks that conduct less than, as and more than the fluid."""
    figure = Figure(figsize=(8.0, 2.9), dpi=120, layout="constrained")
    (x, y), around = np.moveaxis(_round_grid(), 2, 0), np.linspace(0.0, 2.0 * np.pi, 200)
    for axes, row in zip(figure.subplots(1, len(rows)), rows, strict=True):
        values = np.array(row["field"])
        levels = axes.contourf(x, y, values, np.linspace(-1.0, 1.0, 21), cmap=HOT_COLOURMAP)
        axes.contour(x, y, values, np.linspace(-0.9, 0.9, 19), colors="white", linewidths=0.5, linestyles="solid")
        axes.plot(BALL * np.cos(around), BALL * np.sin(around), color="black", linewidth=1.0)
        axes.set(title=f"conductivity {row['conductivity']:g}", aspect="equal")
        axes.set_axis_off()
    figure.colorbar(levels, ax=figure.axes, label="temperature", ticks=[-1.0, 0.0, 1.0])
    return figure


def _picture(rows: list[dict[str, Any]]) -> Figure:
    """Isotherms of the cavities on the finer mesh."""
    figure = Figure(figsize=(8.0, 2.9), dpi=120, layout="constrained")
    side = np.linspace(0.0, 1.0, GRID)
    for axes, row in zip(figure.subplots(1, len(rows)), rows, strict=True):
        levels = axes.contourf(side, side, np.array(row["field"]), np.linspace(0.0, 1.0, 21), cmap=HOT_COLOURMAP)
        axes.contour(side, side, np.array(row["field"]), np.linspace(0.1, 0.9, 9), colors="white", linewidths=0.5)
        axes.set(title=f"Ra = {row['Ra']:.0e}", aspect="equal", xticks=[], yticks=[])
    figure.colorbar(levels, ax=figure.axes, label="temperature", ticks=[0.0, 0.5, 1.0])
    return figure


ABOUT = """A scalar goes with the fluid, `[scalar]`: it is convected and diffuses, and the fluid's weight changes by it.

## A heated cavity

A square cavity is held at 1 on its left and at 0 on its right; nothing goes through bottom and top. The flow is
driven by buoyancy alone, at Pr = 0.71 (de Vahl Davis, Int. J. Numer. Methods Fluids 3, 1983). The scene
[hot_cavity.toml](../../scenes/hot_cavity.toml), which has no body, takes 200 steps of 0.005 L²/κ here. `cells`: their
size over the side. `Nu`: the flux through the hot and the cold side, read from the residuals of the held nodes, over
that by conduction. `residual`: the greatest of any step's balance, over the flux.

"""
ABOUT_STREAM = """

## A hot cylinder in a stream

A cylinder of diameter 1 is held at 1 in a stream of 0 at Pr = 0.71, in a domain of 80 × 60 diameters with slip at the
sides. The flow is steady from the start, the temperature after 60 steps of 2. The figures are those of a fit, Nu =
0.082 Re^½ + 0.734 Re^x, x = 0.05 + 0.226 Re^0.085, to their computations (Lange, Durst and Breuer, Int.
J. Heat Mass Transfer 41, 1998).

"""
ABOUT_FIELD = f"""

## A disk that conducts

A disk of radius {BALL:g} in the middle of a round wall of radius {WALL:g} conducts inside, `conductivity` times as well
as the fluid, which is at rest. The wall holds T = x. Theory has T = A x inside and (B + C/r²) x outside, with
A = 2/(1 + k + (1 - k) a²/R²). The mesh inside is turned, so that it matches the fluid's nowhere. `gradient inside`:
mean over the disk. `error outside`: root of the mean square. `cells`: their size everywhere.

![Temperature in and around disks that conduct](heat_bodies.png)

"""
ABOUT_MODE = f"""

## How fast two layers cool

The same disk and fluid start with the slowest mode round the axis, of Bessel functions, while the wall is held at 0.
Its rate is the root of the equation that both layers and the wall make, at a diffusivity of {DIFFUSIVITY:g} of the
fluid. `rate`: that of the disk's mean over a time of {DECAY:g} over the exact rate, with cells of {LAYER_CELLS[-1]:g}.
It is of second order in the step.

"""
ABOUT_FALL = """

## A warm disk falls

A disk with twice the capacity of the fluid starts at 1 in a fluid of 0; nothing goes through the walls. It falls, turns
and cools through several new meshes of the fluid, while its own one stays. `greatest` value in disk and fluid in the
end. `change of content`: the greatest of that of disk and fluid together, over it. With a high conductivity it is the
disk of one value, without anything inside.

"""
