"""Ten bodies enter a closed box of fluid one after the other, sink, and leave above its bottom."""

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

STEPS = (0.04, 0.02, 0.01, 0.005)
NUMBER, DENSITY = 10, 1.5
BALL = {"type": "sphere"}
COLOURS = ("#2b83ba", "#1a9641", "#fdae61", "#d7191c")


def page(work: Work) -> Page:
    """The account over four steps, and the bodies' heights."""
    rows = work.rows(measured)
    head = (
        "step",
        "entered",
        "left",
        "there",
        "exchange",
        "of it the bodies'",
        "by gravity",
        "dissipated",
        "residual",
        "of gravity's work",
        "greatest in a step after an exchange",
        "mass in - out - there",
        "s",
    )
    return Page("Bodies that enter and leave", ABOUT + table(head, map(_told, rows)) + AFTER, {"": _figure(rows)})


def scene(step: float) -> Scene:
    """A box of 1 × 2 with a source below its top and a sink above its bottom."""
    return rigidfluid.scene_from_dict(
        {
            "scene": {"name": "enter_and_leave", "dimension": 2, "seed": 1},
            "fluid": {"density": 1.0, "viscosity": 0.02, "gravity": [0.0, -30.0]},
            "domain": {"lower": [0.0, 0.0], "upper": [1.0, 2.0]},
            "body": [BALL | {"name": "post", "radius": 0.1, "density": 1.0, "position": [0.15, 0.5], "fixed": True}],
            "source": [
                {
                    "name": "grain",
                    "shape": [
                        BALL | {"radius": 0.08},
                        {"type": "ellipsoid", "semi_axes": [0.1, 0.06]},
                    ],
                    "density": DENSITY,
                    "every": 0.6,
                    "number": NUMBER,
                    "gap": 0.04,
                    "velocity": [0.0, -0.2],
                    "region": {"type": "box", "lower": [0.1, 1.5], "upper": [0.9, 1.95]},
                }
            ],
            "sink": [{"on": "bottom", "gap": 0.08}],
            "contact": {"law": "normal", "range": 0.03, "epsilon": "auto"},
            "mesh": {"size": 0.12, "size_body": 0.04},
            "time": {"end": 8.0, "step": step},
            "output": {"every": 8.0},
        }
    )


def measured() -> Iterator[dict[str, Any]]:
    """A row for each step."""
    for step in STEPS:
        began, run = time.process_time(), Simulation(scene(step))
        after, exchange = [], 0.0
        while not run.ended:
            residual = run.state.ledger.residual
            run.step()
            if run.state.ledger.exchange != exchange:
                exchange = run.state.ledger.exchange
                after.append(run.state.ledger.residual - residual)
        run.finish("complete")
        ledger, account, bodies = run.state.ledger, run.history.summary["exchanges"], run.history.bodies
        yield {
            "step": step,
            "entered": account["entered"]["bodies"],
            "left": account["gone"]["bodies"],
            "there": len(run.bodies) - 1,
            "exchange": ledger.exchange,
            "own": account["energy"]["bodies"],
            "gravity": ledger.gravity,
            "dissipation": ledger.dissipation,
            "residual": ledger.residual,
            "after": max(after, key=abs),
            "mass": account["mass"]["residual"],
            "s": time.process_time() - began,
            "time": bodies["time"].tolist(),
            "body": bodies["body"].tolist(),
            "y": bodies["y"].tolist(),
            "energy": {name: run.history.energy[name].tolist() for name in ("time", "exchange", "residual", "gravity")},
        }


def _told(row: dict[str, Any]) -> Iterator[str]:
    yield from (f"{row['step']:g}", str(row["entered"]), str(row["left"]), str(row["there"]))
    yield from (
        f"{row['exchange']:.5f}",
        f"{row['own']:.5f}",
        f"{row['gravity']:.5f}",
        f"{row['dissipation']:.5f}",
        f"{row['residual']:+.6f}",
    )
    yield f"{100.0 * row['residual'] / row['gravity']:+.3f} %"
    yield from (f"{row['after']:+.1e}", f"{row['mass']:.1e}", f"{row['s']:.0f}")


def _figure(rows: list[dict[str, Any]]) -> Figure:
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    for row, colour in zip(rows, COLOURS, strict=True):
        when, body, height = (np.array(row[name]) for name in ("time", "body", "y"))
        for number in range(NUMBER):
            mine = body == f"grain{number}"
            left.plot(when[mine], height[mine], color=colour, lw=0.8)
        energy = row["energy"]
        right.plot(energy["time"], energy["residual"], color=colour, label=f"residual, step {row['step']:g}")
    right.plot(rows[-1]["energy"]["time"], rows[-1]["energy"]["exchange"], "k:", label="exchange")
    left.set(xlabel="time", ylabel="height of the centre", title="each body, with four steps")
    right.set(xlabel="time", ylabel="energy", title="account")
    right.legend(frameon=False)
    return figure


ABOUT = """A [`[[source]]`](../howto/enter-and-leave.md) lets a body enter near the top of a closed box every .6, disks
and ellipses of one density at random places. They sink past a fixed post, and a `[[sink]]` takes them out above the
bottom. *Exchange* is the energy that came with them, less what they took. Part of it is their own kinetic energy, by
[exchanges.csv](../results.md#exchangescsv), the rest that of the fluid around them and of contacts. The *residual* is
what the account of energies does not know of at the end. The greatest residual in a step after an exchange shows what
the new mesh, the transferred flow and the short first step leave.

"""

AFTER = """

The residual is signed: energy that came from nowhere is negative. *Mass in - out - there* is the mass of the start and
of who entered, less that of who left and of who is there at the end.
"""
