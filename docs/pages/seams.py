"""Disks are driven round a periodic channel, from two places of it, and along one of three periods."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Work, table

import rigidfluid
from rigidfluid import Scene
from rigidfluid.api import Simulation

PERIOD, RADIUS, HEIGHT, DROP, VISCOSITY = 2.0, 0.12, 0.3, 6.0, 0.5
CELLS = (0.06, 0.03)
END, THROWN = 14.0, 1.0
COLOURS = ("#2b83ba", "#d7191c")


def page(work: Work) -> Page:
    """Paths of a disk, and the momentum of a doubly periodic box."""
    rows = work.rows(measured)
    paths = [row for row in rows if "path" in row]
    head = ("cells at the disk", "crossings", "half a period on", "three periods long", "new meshes", "residual", "s")
    text = ABOUT + table(head, map(_told, paths))
    head = ("cells at the disk", "step", "change of momentum", "residual", "s")
    text += MOMENTUM + table(head, map(_momentum_row, [row for row in rows if "momentum" in row])) + "\n"
    return Page("Disks that cross periodic surfaces", text, {"": _figure(paths)})


def channel(cells: float, start: float, periods: int = 1) -> Scene:
    """A channel of so many periods, each with a disk."""
    body = {"type": "sphere", "radius": RADIUS, "density": 1.0}
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "seams", "dimension": 2},
            "fluid": {"density": 1.0, "viscosity": VISCOSITY},
            "domain": {"lower": [0.0, 0.0], "upper": [PERIOD * periods, 1.0]},
            "boundary": [
                {"on": "left", "type": "periodic", "pressure_drop": DROP * periods},
                {"on": "right", "type": "periodic"},
            ],
            "body": [
                body | {"name": f"disk{number}", "position": [start + PERIOD * number, HEIGHT]}
                for number in range(periods)
            ],
            "mesh": {"size": 2.5 * cells, "size_body": cells},
            "time": {"end": END, "step": 0.05},
            "output": {"every": END},
        }
    )


def box(cells: float, step: float) -> Scene:
    """A fluid that is periodic in both directions, with a disk that is thrown through it."""
    sides = [{"on": side, "type": "periodic"} for side in ("left", "right", "bottom", "top")]
    disk = {"type": "sphere", "radius": RADIUS, "density": 2.0, "position": [0.5, 0.5], "velocity": [THROWN, 0.6]}
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "box", "dimension": 2},
            "fluid": {"density": 1.0, "viscosity": 0.01},
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0]},
            "boundary": sides,
            "body": [disk],
            "mesh": {"size": 2.5 * cells, "size_body": cells, "order": 1},
            "time": {"end": 2.0, "step": step},
            "output": {"every": 2.0},
        }
    )


def measured() -> Iterator[dict[str, Any]]:
    """A row for each size of cells."""
    for cells in CELLS:
        began = time.process_time()
        here, there, long = (_run(channel(cells, *given)) for given in ((0.5,), (0.5 + 0.5 * PERIOD,), (0.5, 3)))
        place = np.array([_path(run, start) for run, start in ((here, 0.5), (there, 0.5 + 0.5 * PERIOD), (long, 0.5))])
        ledger = here.state.ledger
        yield {
            "cells": cells,
            "path": place[:, 0].tolist(),
            "times": here.history.steps["time"].tolist(),
            "crossings": int((0.5 + place[0, 0, -1]) // PERIOD),
            "on": float(np.abs(place[1] - place[0]).max() / PERIOD),
            "long": float(np.abs(place[2] - place[0]).max() / PERIOD),
            "remeshes": [run.counts.remeshes for run in (here, there, long)],
            "residual": ledger.residual / ledger.boundary,
            "s": time.process_time() - began,
        }
    for cells, step in ((CELLS[0], 0.02), (CELLS[0], 0.01), (CELLS[1], 0.02)):
        began, run = time.process_time(), Simulation(box(cells, step))
        start = _momentum(run)
        run.go()
        lost = float(np.linalg.norm(_momentum(run) - start) / np.linalg.norm(start))
        ledger = run.state.ledger
        share = ledger.residual / ledger.initial
        yield {"cells": cells, "step": step, "momentum": lost, "residual": share, "s": time.process_time() - began}


def _run(scene: Scene) -> Simulation:
    run = Simulation(scene)
    run.go()
    return run


def _path(run: Simulation, start: float) -> list[list[float]]:
    """Displacement along the channel and height of the first disk after each step."""
    bodies = run.history.bodies
    mine = bodies["body"] == "disk0"
    return [(bodies["x"][mine][1:] - start).tolist(), bodies["y"][mine][1:].tolist()]


def _momentum(run: Simulation) -> np.ndarray:
    """Momentum of fluid and disk (2,), by the nodes of curved elements of degree 2."""
    fields, state = run.fields(), run.state
    corners = fields.points[fields.cells[:, :3]]
    sides = corners[:, 1:] - corners[:, :1]
    area = 0.5 * np.abs(np.linalg.det(sides))
    middles = fields.velocity[fields.cells[:, 3:]].mean(axis=1)  # exact for quadratic velocities in straight cells
    mass = run.system.mass[0]
    return np.asarray(area @ middles + mass * state.twist.velocity[0])


def _told(row: dict[str, Any]) -> Iterator[str]:
    yield from (f"{row['cells']:g}", str(row["crossings"]), f"{row['on']:.1e}", f"{row['long']:.1e}")
    yield from (", ".join(map(str, row["remeshes"])), f"{100.0 * row['residual']:+.4f} %", f"{row['s']:.0f}")


def _momentum_row(row: dict[str, Any]) -> Iterator[str]:
    yield from (f"{row['cells']:g}", f"{row['step']:g}", f"{row['momentum']:.1e}")
    yield from (f"{100.0 * row['residual']:+.3f} %", f"{row['s']:.0f}")


def _figure(rows: list[dict[str, Any]]) -> Figure:
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    for row, colour in zip(rows, COLOURS, strict=True):
        here, there, long = (np.array(path) for path in row["path"])
        left.plot(row["times"], here / PERIOD, color=colour, label=f"cells of {row['cells']:g}")
        right.plot(row["times"], (there - here) / PERIOD, color=colour, label="half a period on")
        right.plot(row["times"], (long - here) / PERIOD, "--", color=colour, label="three periods long")
    left.set(xlabel="time", ylabel="way over the period")
    right.set(xlabel="time", ylabel="difference over the period")
    for axes in (left, right):
        axes.legend(frameon=False)
    return figure


ABOUT = """A disk of the fluid's density is driven along a channel, which is periodic, by a drop of pressure. It
crosses the ends several times, and the mesh is cut open where the disk is not. The path is compared with that of the
same disk from half a period further on, and with that in a channel three periods long with three disks: the greatest
difference, over the period. Numbers of new meshes are in this order. The residual is over the work of the drop.

"""

MOMENTUM = """

A disk is thrown through a fluid that is periodic in both directions. Nothing acts from outside, so the momentum of
fluid and disk stays. The discrete convection by itself keeps energy alone; each step gives all one velocity more that
keeps momentum too. The change of momentum is over that at the start.

"""
