"""Case 1 of arXiv:2402.19093 at four resolutions, beside other programs, and what each setting costs and gives."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from published import GLOWINSKI_2001, HIGHEST_REYNOLDS, KOBLITZ_2017, TERMINAL_SPEED
from scipy.interpolate import CubicHermiteSpline

from pages._one_knob import OneKnob

SCENE = "falling_disk.toml"
PAPER = "contact.epsilon_wall=5e-6"
"""The law at walls as in the paper, of all runs; the scene as shipped has one that holds the disk."""

RUNS = {
    "finest": ("size_body 0.005, step 0.0005", [PAPER, "mesh.size_body=0.005", "time.step=0.0005"]),
    "fine": ("size_body 0.01, step 0.001", [PAPER]),
    "coarse": ("size_body 0.025, step 0.004", [PAPER, "mesh.size_body=0.025", "time.step=0.004"]),
    "coarsest": ("size_body 0.05, step 0.008", [PAPER, "mesh.size_body=0.05", "time.step=0.008"]),
}
"""By folder: the heading, and what differs from the scene as shipped."""

PASSED = {2.0: 0.434, 1.0: 0.613, 0.5: 0.703}
"""When the disk passes a height [s], by height [cm]."""

REFERENCES = {
    "highest Re, density of the solid": f"{HIGHEST_REYNOLDS} ± 1 %",
    **{f"passes y = {height:g} cm at [s]": f"{time} ± 0.01" for height, time in PASSED.items()},
    "off Koblitz et al. 2017, largest": "< 3 %",
    "off Glowinski et al. 2001, root mean square": "< 3 %",
    "off Glowinski et al. 2001, largest after 0.15 s": "< 3 %",
    "drift sideways before contact [cm]": "< 0.001",
    "smallest gap [cm]": "> 0",
    "energy unaccounted for": "< 2 %",
    "unknowns at the end": "",
    "new meshes": "",
    "CPU time of one thread [s]": "",
}

LOWEST = min(PASSED)
STUDY = OneKnob(
    SCENE,
    name=f"time at which the disk passes {LOWEST:g} cm [s]",
    common=[PAPER, "time.end=0.712", "output.every=0.1"],
    finest=["mesh.size=0.1", "mesh.size_body=0.005", "mesh.growth=0.15", "time.step=0.0005"],
    values={
        "mesh.size_body": (0.1, 0.05, 0.025, 0.005),
        "mesh.size": (0.4, 0.08),
        "time.step": (0.016, 0.008, 0.004, 0.002, 0.0005),
        "mesh.order": (1,),
        "mesh.remesh_every": (0.1, 0.02),
        "mesh.quality": (0.1, 0.4),
    },
    figure=lambda run: passes(run, LOWEST),
)

PROGRAMS = """\
## Beside other programs

The largest error of the three passing times, over the last of them, against CPU seconds: this program, an NGSolve
script for this one scene, and OpenFOAM with overset meshes. The settings, what the others leave out, and when each was
measured are on [a page of its own](work_precision.md), made by `python benchmarks/work_precision.py`.

![Error against CPU seconds](work_precision.png)"""


def page(work: Work) -> Page:
    """Velocities beside published ones, the figures, other programs, the study."""
    runs = {label: work.run(name, SCENE, overrides) for name, (label, overrides) in RUNS.items()}
    study = STUDY.measure(work)
    columns = [figures(run) for run in runs.values()]
    rows = [(name, reference, *(column[name] for column in columns)) for name, reference in REFERENCES.items()]
    parts = (table(("figure", "reference", *runs), rows), PROGRAMS, study.section("falling_disk"))
    return Page("Falling disk", "\n\n".join(parts), {"": velocities(runs), "_study": study.plot()})


def velocities(runs: dict[str, Run]) -> Figure:
    """Over time, with the published points."""
    figure = Figure(figsize=(7.0, 4.2), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="time [s]", ylabel="velocity of the disk [cm/s]")
    for (label, run), style in zip(runs.items(), ("-", "--", "-.", ":"), strict=True):
        bodies = run.history.bodies
        axes.plot(bodies["time"], bodies["vy"], style, label=f"rigidfluid, {label}")
    axes.plot(*KOBLITZ_2017.T, "s", mfc="none", label="Koblitz et al. 2017")
    axes.plot(*GLOWINSKI_2001.T, "x", label="Glowinski et al. 2001")
    axes.legend()
    return figure


def passes(run: Run, height: float) -> float:
    """When the disk's centre passes a height, by cubics through positions and velocities of each step [s]."""
    bodies = run.history.bodies
    way = CubicHermiteSpline(bodies["time"], bodies["y"], bodies["vy"])
    return float(way.solve(height, extrapolate=False)[0])


def figures(run: Run) -> dict[str, str]:
    """Those of REFERENCES, measured; velocities over the terminal speed."""
    bodies, summary = run.history.bodies, run.summary

    def off(curve: np.ndarray) -> np.ndarray:
        return (np.interp(curve[:, 0], bodies["time"], bodies["vy"]) - curve[:, 1]) / TERMINAL_SPEED

    glowinski = off(GLOWINSKI_2001)
    values = (
        f"{summary['reynolds_solid_density']:.3f}",
        *(f"{passes(run, height):.5f}" for height in PASSED),
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
