"""Schäfer & Turek's benchmark 2D-3: an inflow that rises and falls, on two meshes and with three steps."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

from rigidfluid.core.output.history import History

RUNS: dict[str, tuple[str, list[str]]] = {
    "step_4": ("step 0.01", ["time.step=0.01"]),
    "step_2": ("step 0.005", ["time.step=0.005"]),
    "as_shipped": ("step 0.0025", []),
    "fine": ("step 0.0025, size_body 0.00245", ["mesh.size_body=0.00245"]),
}
"""By folder: the heading, and what differs from the scene as shipped."""

JOHN_2004 = {
    "greatest drag coefficient": 2.950921575,
    "its time [s]": 3.93625,
    "greatest lift coefficient": 0.47795,
    "its time [s] ": 5.693125,
    "pressure difference at 8 s": -0.1116,
}


def page(work: Work) -> Page:
    """The coefficients over time, and their extremes against the reference."""
    runs = {label: work.run(name, "dfg_2d3.toml", overrides) for name, (label, overrides) in RUNS.items()}
    found = {label: figures(run.history) for label, run in runs.items()}
    rows = [("John 2004", *(f"{value:.10g}" for value in JOHN_2004.values()), "", "", "")]
    for label, run in runs.items():
        off = [
            f"{value:.6g} ({value / exact - 1.0:+.2%})"
            for value, exact in zip(found[label], JOHN_2004.values(), strict=True)
        ]
        cost = run.summary["unknowns"], run.summary["steps"], f"{run.cpu_seconds:.0f}"
        rows.append((label, *off, *map(str, cost)))
    text = table(("", *map(str.strip, JOHN_2004), "unknowns", "steps", "CPU s"), rows)
    return Page("DFG cylinder 2D-3", text + ABOUT.format(**judged(found)), {"": coefficients(runs)})


def coefficients(runs: dict[str, Run]) -> Figure:
    """Of drag and lift, over time."""
    figure = Figure(figsize=(7.0, 5.0), dpi=120, layout="constrained")
    drag, lift = figure.subplots(2, 1, sharex=True)
    drag.set(ylabel="drag coefficient")
    lift.set(xlabel="time [s]", ylabel="lift coefficient")
    for name, run in runs.items():
        time_of, (of_drag, of_lift, _) = run.history.bodies["time"], over_time(run.history)
        drag.plot(time_of[1:], of_drag[1:], label=name)
        lift.plot(time_of[1:], of_lift[1:])
    drag.plot(3.93625, 2.950921575, "k+", markersize=12, label="John 2004")
    lift.plot(5.693125, 0.47795, "k+", markersize=12)
    drag.legend()
    return figure


ABOUT = """

The inflow is 1.5 sin(πt/8) at its peak, with Reynolds numbers up to 100 and down to 0 again at 8 s
(`scenes/dfg_2d3.toml`). The inflow, and with it the Reynolds number, is greatest at 4 s; the drag is greatest at
{drag_time:.3f} s, {before} it. The lift is that of vortices which grow from small disturbances: from the longest
step to the shortest on the same mesh the greatest lift coefficient changes by {lift:.2%}, the greatest drag
coefficient by {drag:.2%}. References: V. John, Int. J. Numer. Methods Fluids 44 (2004) 777, doi:10.1002/fld.679.
"""


def judged(found: dict[str, tuple[float, ...]]) -> dict[str, object]:
    """What `ABOUT` says of the figures."""
    long, shipped = found["step 0.01"], found["step 0.0025"]
    return {
        "drag_time": shipped[1],
        "before": "before" if shipped[1] < 4.0 else "after",
        "drag": abs(long[0] / shipped[0] - 1.0),
        "lift": abs(long[2] / shipped[2] - 1.0),
    }


def over_time(history: History) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Over time, of a greatest mean inflow of 1 m/s: drag and lift coefficient, and the pressure difference."""
    front, back = (history.probes["pressure"][i::2] for i in (0, 1))
    return 20.0 * history.bodies["fx"], 20.0 * history.bodies["fy"], front - back


def figures(history: History) -> tuple[float, ...]:
    """Those of `JOHN_2004`."""
    time_of, (drag, lift, difference) = history.bodies["time"], over_time(history)
    strongest, highest = int(np.argmax(drag)), int(np.argmax(lift))
    return drag[strongest], time_of[strongest], lift[highest], time_of[highest], difference[-1]
