"""A transported scalar: natural convection in a cavity, and a hot cylinder in a stream."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Work, table
from page_tools.places import SCENES

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


def page(work: Work) -> Page:
    """Nusselt numbers against published ones, and isotherms."""
    rows = work.rows(measured)
    cavity, stream = ([row for row in rows if row["case"] == case] for case in ("cavity", "stream"))
    head = ("Ra", "cells", "Nu hot", "Nu cold", "de Vahl Davis", "difference", "residual", "s")
    text = ABOUT + table(head, map(_cavity_row, cavity))
    head = ("Re", "cells at the cylinder", "Nu", "Lange et al.", "difference", "residual", "s")
    text += ABOUT_STREAM + table(head, map(_stream_row, stream))
    return Page("Heat and buoyancy", text + "\n", {"": _picture([row for row in cavity if "field" in row])})


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
    temperature = run.system.backend.probe_scalar(run.state.fluid, run.state.mesh, grid)
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
