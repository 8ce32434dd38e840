"""Forces on spheres in narrow gaps in Stokes flow, at a wall and in pairs, beside the exact ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table
from published import brenner, drag_of_approach
from two_spheres import drag_across

SPEED, REQUIRED, ALLOWED = 1e-4, (0.5, 0.2, 0.1), 0.02
GAPS = (*REQUIRED, 0.05, 0.02)
MESHES = {"": ("size_body .25", []), "_coarse": ("size_body .4", ["mesh.size_body=0.4"])}
WIDE = {
    "squeezed_film.toml": ["domain.lower=[-30.0, -30.0, 0.0]", "domain.upper=[30.0, 30.0, 60.0]", "mesh.size=12.0"],
    "two_spheres.toml": ["domain.lower=[-30.0, -30.0, -30.0]", "domain.upper=[30.0, 30.0, 30.0]", "mesh.size=12.0"],
}
"""A box twice as wide."""


@dataclass(frozen=True)
class Case:
    """A motion: its scene and overrides at a gap, the axis of its force, and the exact one over 6πμrV."""

    scene: str
    placed: Callable[[float], list[str]]
    axis: str
    exact: Callable[[float], float]


def _across(gap: float) -> list[str]:
    return [
        *_pair(gap),
        f"body.0.prescribed.velocity=[{SPEED}, 0.0, 0.0]",
        f"body.1.prescribed.velocity=[{-SPEED}, 0.0, 0.0]",
    ]


def _pair(gap: float) -> list[str]:
    return [f"body.{number}.position=[0.0, 0.0, {sign * (1.0 + 0.5 * gap)}]" for number, sign in enumerate((-1, 1))]


CASES = {
    "wall": Case("squeezed_film.toml", lambda gap: [f"body.0.position=[0.0, 0.0, {1.0 + gap}]"], "fz", brenner),
    "along": Case("two_spheres.toml", _pair, "fz", drag_of_approach),
    "across": Case("two_spheres.toml", _across, "fx", drag_across),
}
HEADINGS = {"wall": "onto a wall", "along": "two, onto each other", "across": "two, past each other"}


def page(work: Work) -> Page:
    """Forces at all gaps by two meshes, and in a wider box."""
    found = {
        (name, mesh, gap): _measure(work, case, f"{name}{mesh}_{gap:g}", gap, overrides)
        for name, case in CASES.items()
        for mesh, (_, overrides) in MESHES.items()
        for gap in GAPS
    }
    wide = {
        name: _measure(work, case, f"{name}_wide_{REQUIRED[0]:g}", REQUIRED[0], WIDE[case.scene])
        for name, case in CASES.items()
    }
    worst = max(abs(found[name, "", gap][0] / CASES[name].exact(gap) - 1.0) for name in CASES for gap in REQUIRED)
    text = ABOUT.format(
        tables="\n\n".join(_table(name, found) for name in CASES),
        wide=table(
            ("motion", "as shipped", "twice as wide"),
            [
                (HEADINGS[name], *(f"{each / case.exact(REQUIRED[0]) - 1.0:+.2%}" for each in pair))
                for name, case in CASES.items()
                for pair in [(found[name, "", REQUIRED[0]][0], wide[name][0])]
            ],
        ),
        worst=f"{worst:.2%}",
        judged="within" if worst <= ALLOWED else "not within",
        allowed=f"{ALLOWED:.0%}",
    )
    return Page("Resistances of narrow gaps", text, {"": errors(found)})


def errors(found: dict[tuple[str, str, float], tuple[float, Run]]) -> Figure:
    """Relative differences over the gap."""
    figure = Figure(figsize=(7.0, 4.0), dpi=120, layout="constrained")
    axes = figure.subplots()
    for number, (name, case) in enumerate(CASES.items()):
        for mesh, (heading, _) in MESHES.items():
            off = [100.0 * (found[name, mesh, gap][0] / case.exact(gap) - 1.0) for gap in GAPS]
            style = {"color": f"C{number}", "linestyle": "--" if mesh else "-", "marker": "o"}
            axes.plot(GAPS, off, label=f"{HEADINGS[name]}, {heading}", **style)
    axes.axhline(0.0, color="grey", linewidth=0.6)
    axes.set(xscale="log", xlabel="gap over radius", ylabel="force, off the exact one [%]")
    axes.legend(fontsize=8)
    return figure


def _measure(work: Work, case: Case, label: str, gap: float, overrides: list[str]) -> tuple[float, Run]:
    """The force over 6πμrV, and the run."""
    run = work.run(label, case.scene, [*case.placed(gap), *overrides])
    force = run.history.bodies[case.axis]
    return float(np.abs(force[run.history.bodies["time"] > 0.0]).mean() / (6.0 * np.pi * SPEED)), run


def _table(name: str, found: dict[tuple[str, str, float], tuple[float, Run]]) -> str:
    exact = CASES[name].exact
    rows = []
    for gap in GAPS:
        row = [f"{gap:g}", f"{exact(gap):.4f}"]
        for mesh in MESHES:
            force, run = found[name, mesh, gap]
            row.append(
                f"{force:.4f} ({force / exact(gap) - 1.0:+.2%}), {run.summary['unknowns']}, {run.cpu_seconds:.0f} s"
            )
        rows.append(row)
    return f"**{HEADINGS[name].capitalize()}**\n\n" + table(
        ("gap over radius", "exact", *(heading for heading, _ in MESHES.values())), rows
    )


ABOUT = """`scenes/squeezed_film.toml` and `scenes/two_spheres.toml`: spheres of radius 1 that move slowly in Stokes
flow, by one step in a box 15 radii to each side. The force over 6πμrV is exact in an unbounded fluid: Brenner's series
at a wall and at the plane half-way between two spheres that approach (Chem. Eng. Sci. 16 (1961) 242), and Lamb's
solution about two spheres that pass each other without turning; these are X₁₁ - X₁₂ and Y₁₁ - Y₁₂ of Jeffrey and Onishi
(J. Fluid Mech. 139 (1984) 261). Beside each force: how far it is from the exact one, the unknowns, and the CPU time of
the whole run.

{tables}

At the gaps of .5, .2 and .1 radii the worst is {worst} off, {judged} {allowed}. The mesh has two cells across each
gap, whatever its width. Part of what is off at wide gaps is the box:

{wide}"""
