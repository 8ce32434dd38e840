"""Rows of dominoes that fall without a fluid, against a published theory of their speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from domino_waves import front_speeds, measured_speeds
from flat_bodies import DOMINO_SHELL, GAP, GRAVITY, ON_THE_FLOOR, THICKNESS, domino_row
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

import rigidfluid

COUNT, END, SETTLED = 18, 3.2, 3
"""Dominoes in a row, the end of runs [√(length/gravity) · √10], and how many dominoes at its end give the speed."""


@dataclass(frozen=True)
class Row:
    """A row: gap of the dominoes [heights], friction on each other [1], steps over the default ones [1], friction on
    the floor [1], and damping of springs along surfaces [1]."""

    gap: float
    friction: float
    step: float = 1.0
    floor: float = ON_THE_FLOOR
    damping: float = 0.0

    def made(self, work: Work, label: str) -> Run:
        """Its run."""
        row = domino_row(COUNT, END, friction=self.friction, gap=self.gap, floor=self.floor, damping=self.damping)
        scene = row.to_dict()
        scene["time"]["step"] *= self.step
        scene["output"]["every"] = 0.4
        return work.run(label, rigidfluid.scene_from_dict(scene))

    def expected(self) -> np.ndarray:
        """Speeds by the theory from the second domino on, (COUNT - 2,) [√(g h)]."""
        return front_speeds(THICKNESS, self.gap, self.friction, COUNT - 1)[1:]


ROWS = {
    "smooth": Row(GAP, 0.0),
    "rough_1": Row(GAP, 0.1),
    "rough_3": Row(GAP, 0.3),
    "rough_3_half": Row(GAP, 0.3, step=0.5),
    "far_2": Row(0.5, 0.2),
    "sliding": Row(GAP, 0.3, floor=0.3),
    "damped_1": Row(GAP, 0.1, damping=1.0),
    "damped_3": Row(GAP, 0.3, damping=1.0),
}
"""By folder."""
HEAD = ("gap [h]", "friction", "on the floor", "damping", "steps", f"speed of the last {SETTLED} [√(gh)]")
HEAD += ("by the theory", "off", "created, lost [%]", "CPU time [s]")


@dataclass(frozen=True)
class Fallen:
    """A row and its run."""

    row: Row
    run: Run

    @property
    def speeds(self) -> np.ndarray:
        """Speeds from domino to domino, from the second one on (COUNT - 2,) [√(g h)]."""
        bodies = self.run.history.bodies
        lean = -np.asarray(bodies["angle"]).reshape(-1, COUNT)
        time = np.asarray(bodies["time"]).reshape(-1, COUNT)[:, 0]
        return measured_speeds(time, lean, self.row.gap + THICKNESS, GRAVITY)

    @property
    def figures(self) -> tuple[float, float]:
        """Mean speed of the last ones, and that of the theory there [√(g h)]."""
        return tuple(float(some[-SETTLED:].mean()) for some in (self.speeds, self.row.expected()))

    @property
    def line(self) -> tuple[str, ...]:
        """Line of the table."""
        found, expected = self.figures
        energy = self.run.summary["energy"]
        return (
            f"{self.row.gap:g}",
            f"{self.row.friction:g}",
            f"{self.row.floor:g}",
            f"{self.row.damping:g}",
            f"{self.row.step:g}",
            f"{found:.4f}",
            f"{expected:.4f}",
            f"{found / expected - 1.0:+.2%}",
            f"{100.0 * energy['created']:.2f}, {100.0 * energy['lost']:.2f}",
            f"{self.run.cpu_seconds:.0f}",
        )


def page(work: Work) -> Page:
    """Speeds beside those of the theory."""
    found = {label: Fallen(row, row.made(work, label)) for label, row in ROWS.items()}
    off = {label: one.figures[0] / one.figures[1] - 1.0 for label, one in found.items()}
    text = ABOUT.format(
        figures=table(HEAD, [one.line for one in found.values()]),
        worst=f"{max(abs(part) for label, part in off.items() if label != 'sliding'):.2%}",
        sliding=f"{off['sliding']:+.1%}",
        damped=f"{max(abs(part) for label, part in off.items() if label.startswith('damped')):.2%}",
        created=f"{100.0 * max(float(one.run.summary['energy']['created']) for one in found.values()):.2f}",
        count=COUNT,
        settled=SETTLED,
        thickness=f"{THICKNESS:g}",
        shell=f"{DOMINO_SHELL:g}",
        floor=f"{ON_THE_FLOOR:g}",
    )
    return Page("Rows of dominoes", text, {"": picture(found)})


def picture(found: dict[str, Fallen]) -> Figure:
    """Speed over the number of the domino."""
    figure = Figure(figsize=(7.0, 4.5), dpi=120, layout="constrained")
    axes = figure.add_subplot(xlabel="domino", ylabel="speed of the front [√(gh)]")
    shown = [
        one
        for one in found.values()
        if one.row.step == 1.0 and one.row.floor == ON_THE_FLOOR and one.row.damping == 0.0
    ]
    for colour, one in enumerate(shown):
        label = f"gap {one.row.gap:g} h, friction {one.row.friction:g}"
        axes.plot(np.arange(2, COUNT), one.speeds, "o", ms=4.0, color=f"C{colour}", label=label)
        axes.plot(np.arange(2, COUNT), one.row.expected(), color=f"C{colour}", lw=1.0)
    axes.plot([], [], "k-", lw=1.0, label="van Leeuwen (2010)")
    axes.set(xlim=(0.0, COUNT), ylim=(0.0, 2.0), xticks=range(0, COUNT + 1, 4))
    axes.legend(fontsize=8)
    return figure


ABOUT = """Rows of {count} dominoes of height h, {thickness} h thick, stand on a floor. The first one leans over and
falls on the second. The front then becomes faster from one domino to the next until it has a speed that only gap and
friction set. The theory is that of van Leeuwen, Am. J. Phys. 78 (2010) 721, doi:10.1119/1.3406154: dominoes turn about
their lower edges, which do not slide, impacts are inelastic, and all that have been hit lean on each other with
friction.

In these runs nothing of that is imposed. Dominoes are free polygons with a `spring-dashpot` between flat sides, of
range {shell} h and restitution .3. The friction of dominoes on each other is that of the table, and on the floor
{floor}, so that edges stay in place there. Both are in the scene as two `[[interaction]]` tables.

{figures}

Speeds are means over the last {settled} dominoes. Where edges stay in place, they are at most {worst} off. The first
dominoes differ from the theory's, as it starts with another angular velocity. With a friction of .3 on the floor edges
slide, which the theory does not know of, and the front is {sliding} off.

Impacts are inelastic in the theory. Springs along the surfaces without a dashpot give back what they store when edges
are hit, and the front is a little fast. With a dashpot, the `tangential_damping` of the table, speeds are within
{damped} of the theory. The energy created is at most {created} % in all rows.
"""
