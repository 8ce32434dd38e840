"""Case 1 of arXiv:2402.19093 at two resolutions."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from published import GLOWINSKI_2001, HIGHEST_REYNOLDS, KOBLITZ_2017, TERMINAL_SPEED

FALLS = {
    "fine": ("size_body 0.01, step 0.001", []),
    "coarse": ("size_body 0.025, step 0.004", ["mesh.size_body=0.025", "time.step=0.004"]),
}
"""By folder: the heading, and what differs from the scene as shipped."""

REFERENCES = {
    "highest Re, density of the solid": f"{HIGHEST_REYNOLDS} ± 1 %",
    "passes y = 2 cm at [s]": "0.434 ± 0.01",
    "passes y = 1 cm at [s]": "0.613 ± 0.01",
    "passes y = 0.5 cm at [s]": "0.703 ± 0.01",
    "off Koblitz et al. 2017, largest": "< 3 %",
    "off Glowinski et al. 2001, root mean square": "< 3 %",
    "off Glowinski et al. 2001, largest after 0.15 s": "< 3 %",
    "drift sideways before contact [cm]": "< 0.001",
    "smallest gap [cm]": "> 0",
    "energy unaccounted for": "< 2 %",
    "unknowns at the end": "",
    "remeshes": "",
    "CPU time of one thread [s]": "",
}


def page(work: Work) -> Page:
    """Velocities beside published ones, and the figures."""
    runs = {label: work.run(name, "falling_disk.toml", overrides) for name, (label, overrides) in FALLS.items()}
    columns = [figures(run) for run in runs.values()]
    rows = [(name, reference, *(column[name] for column in columns)) for name, reference in REFERENCES.items()]
    return Page("Falling disk", table(("figure", "reference", *runs), rows), {"": velocities(runs)})


def velocities(runs: dict[str, Run]) -> Figure:
    """Over time, with the published points."""
    figure = Figure(figsize=(7.0, 4.2), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="time [s]", ylabel="velocity of the disk [cm/s]")
    for (label, run), style in zip(runs.items(), ("-", "--"), strict=True):
        bodies = run.history.bodies
        axes.plot(bodies["time"], bodies["vy"], style, label=f"rigidfluid, {label}")
    axes.plot(*KOBLITZ_2017.T, "s", mfc="none", label="Koblitz et al. 2017")
    axes.plot(*GLOWINSKI_2001.T, "x", label="Glowinski et al. 2001")
    axes.legend()
    return figure


def figures(run: Run) -> dict[str, str]:
    """Those of REFERENCES, measured; velocities over the terminal speed."""
    bodies, summary = run.history.bodies, run.summary

    def off(curve: np.ndarray) -> np.ndarray:
        return (np.interp(curve[:, 0], bodies["time"], bodies["vy"]) - curve[:, 1]) / TERMINAL_SPEED

    def passes(height: float) -> str:
        return f"{np.interp(-height, -bodies['y'], bodies['time']):.4f}"

    glowinski = off(GLOWINSKI_2001)
    values = (
        f"{summary['reynolds_solid_density']:.3f}",
        *(passes(height) for height in (2.0, 1.0, 0.5)),
        f"{np.abs(off(KOBLITZ_2017)).max():.2%}",
        f"{np.sqrt(np.mean(glowinski**2)):.2%}",
        f"{np.abs(glowinski[GLOWINSKI_2001[:, 0] > 0.15]).max():.2%}",
        f"{np.abs(bodies['x'] - 1.0)[bodies['gap'] > 0.015].max():.1e}",
        f"{summary['smallest_gap']:.5f}",
        f"{summary['energy']['relative_residual']:.1e}",
        f"{summary['unknowns']}",
        f"{summary['remeshes']}",
        f"{run.cpu_seconds:.0f}",
    )
    return dict(zip(REFERENCES, values, strict=True))
