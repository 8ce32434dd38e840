"""Viscosity of dilute suspensions in sheared cells, by the power of walls and by stresslets, beside Einstein's and the
next order, which images give."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

from pages._images_of_stresslets import image_strain

DILUTE = {2: 2.0, 3: 2.5}
"""Share's coefficient by dimension, (d + 2)/2."""

SIDES = {2: (30.0, 17.7245, 12.5, 10.0, 8.0, 6.5, 5.0), 3: (12.0, 8.0, 6.0, 5.0)}
SHAPES = ((20.0, 5.0), (14.0, 100.0 / 14.0), (10.0, 10.0), (100.0 / 14.0, 14.0), (5.0, 20.0))
"""Periods and distances of the walls of cells of one area."""

SIZES = {2: (1.0, 0.1), 3: (1.2, 0.3)}


@dataclass(frozen=True)
class Cell:
    """A cell with a disk or sphere of radius 1: its ``period`` and the ``distance`` of its walls."""

    dimension: int
    period: float
    distance: float

    @property
    def volume(self) -> float:
        """Volume of the cell."""
        return self.period ** (self.dimension - 1) * self.distance

    @property
    def share(self) -> float:
        """Share φ of the body."""
        return (np.pi if self.dimension == 2 else 4.0 / 3.0 * np.pi) / self.volume

    @property
    def coefficient(self) -> float:
        """Viscosity less 1 over the share, to the next order: of a body in the shear and in the flow of its images."""
        added = (self.dimension + 2) * image_strain(self.dimension, self.period, self.distance) * self.share
        return DILUTE[self.dimension] * (1.0 + added)

    @property
    def overrides(self) -> list[str]:
        """Settings of the scene: walls slide so that the rate of shear is 1."""
        d, (size, on_body) = self.dimension, SIZES[self.dimension]
        upper = [self.period, self.distance, self.period][:d]
        slide, across = 0.5 * self.distance, [0.0] * (d - 1)
        return [
            f"scene.dimension={d}",
            f"domain.lower={[0.0] * d}",
            f"domain.upper={upper}",
            f"boundary.1.velocity={[-slide, *across]}",
            f"boundary.2.velocity={[slide, *across]}",
            f"body.0.position={[0.5 * side for side in upper]}",
            f"mesh.size={size}",
            f"mesh.size_body={on_body}",
        ]


@dataclass(frozen=True)
class Found:
    """Viscosity less 1 by the ``walls`` and by the ``stresslet``, over the share, and the ``run``."""

    walls: float
    stresslet: float
    run: Run


def page(work: Work) -> Page:
    """Coefficients of cubes and squares of all sizes, and of cells of several shapes."""
    cells = [Cell(dimension, side, side) for dimension, sides in SIDES.items() for side in sides]
    shaped = [Cell(2, *shape) for shape in SHAPES]
    found = {cell: _found(work, cell) for cell in [*cells, *shaped]}
    apart = max(abs(each.walls / each.stresslet - 1.0) for each in found.values())
    lines = {dimension: _line(found, [cell for cell in cells if cell.dimension == dimension]) for dimension in SIDES}
    text = ABOUT.format(
        disks=_rows(found, [cell for cell in cells if cell.dimension == 2]),
        spheres=_rows(found, [cell for cell in cells if cell.dimension == 3]),
        shapes=table(
            ("period", "walls apart", "(μ/μ₀ - 1)/φ", "to the next order", "off that"),
            [(f"{cell.period:.4g}", f"{cell.distance:.4g}", *_beside_next_order(found, cell)) for cell in shaped],
        ),
        apart=f"{apart:.0e}",
        share=f"{shaped[0].share:.4f}",
        **{name: lines[dimension] for dimension, name in ((2, "disk"), (3, "sphere"))},
        predicted_disk=_predicted(2),
        predicted_sphere=_predicted(3),
    )
    return Page("Viscosity of dilute suspensions", text, {"": coefficients(found, cells)})


def coefficients(found: Mapping[Cell, Found], cells: list[Cell]) -> Figure:
    """Coefficients over the share."""
    figure = Figure(figsize=(7.0, 3.8), dpi=120, layout="constrained")
    axes = figure.subplots()
    for dimension, name in ((2, "disks"), (3, "spheres")):
        own = [cell for cell in cells if cell.dimension == dimension]
        shares = [cell.share for cell in own]
        colour = f"C{dimension - 2}"
        axes.plot(shares, [found[cell].stresslet for cell in own], "o-", color=colour, label=f"{name}, by stresslet")
        axes.plot(shares, [found[cell].walls for cell in own], "x", color="black", label=f"{name}, by walls")
        next_order = [cell.coefficient for cell in own]
        axes.plot([0.0, *shares], [DILUTE[dimension], *next_order], "--", color=colour, label=f"{name}, by images")
    axes.set(xlabel="share φ", ylabel="(μ/μ₀ - 1)/φ")
    axes.legend(fontsize=8)
    return figure


def _found(work: Work, cell: Cell) -> Found:
    label = f"{cell.dimension}d_{cell.period:.4g}_{cell.distance:.4g}"
    run = work.run(label, "sheared_cell.toml", cell.overrides)
    energy, stresslets = run.history.energy, run.history.stresslets
    power = (energy["boundary"][-1] - energy["boundary"][0]) / (energy["time"][-1] - energy["time"][0])
    by_walls, by_stresslet = power / cell.volume - 1.0, stresslets["sxy"][-1] / cell.volume
    return Found(float(by_walls / cell.share), float(by_stresslet / cell.share), run)


def _line(found: Mapping[Cell, Found], cells: list[Cell]) -> str:
    """Line over the share through the three largest cells."""
    shares, values = np.array([(cell.share, found[cell].stresslet) for cell in cells[:3]]).T
    slope, intercept = np.polyfit(shares, values, 1)
    return f"{intercept:.3f} + {slope:.2f} φ"


def _predicted(dimension: int) -> str:
    """Line over the share of squares or cubes, by their images."""
    slope = DILUTE[dimension] * (dimension + 2) * image_strain(dimension, 1.0, 1.0)
    return f"{DILUTE[dimension]:g} + {slope:.2f} φ"


def _beside_next_order(found: Mapping[Cell, Found], cell: Cell) -> tuple[str, str, str]:
    """Coefficient by the stresslet, that to the next order, and how far the first is off it."""
    each, known = found[cell].stresslet, cell.coefficient
    return f"{each:.4f}", f"{known:.4f}", f"{each / known - 1.0:+.2%}"


def _rows(found: Mapping[Cell, Found], cells: list[Cell]) -> str:
    rows = []
    for cell in cells:
        each, dilute = found[cell], DILUTE[cell.dimension]
        off = f"{each.stresslet / dilute - 1.0:+.2%}"
        row = (f"{cell.distance:g}", f"{cell.share:.4f}", f"{each.walls:.4f}", *_beside_next_order(found, cell), off)
        rows.append((*row, f"{each.run.summary['unknowns']}", f"{each.run.cpu_seconds:.0f} s"))
    compared = ("by stresslet", "to the next order", "off that", "off the dilute one")
    head = ("side of the cell", "φ", "by walls", *compared, "unknowns", "CPU time")
    return table(head, rows)


ABOUT = """`scenes/sheared_cell.toml`: a free disk or sphere of radius 1 in the middle of a cell, in Stokes flow
between walls that slide past each other at a rate of 1; the cell is periodic along the walls. Its viscosity over
that of the fluid, μ/μ₀, is the power of the walls over the volume. By the stresslet S of the body it is 1 + S_xy/V
(Batchelor, J. Fluid Mech. 41 (1970) 545). Both are {apart} of their excess over 1 apart at most. The excess over
the share φ is (d + 2)/2 in a dilute suspension: 2.5 for spheres (Einstein, Ann. Phys. 19 (1906) 289, and 34 (1911)
591), 2 for disks (Brady, Int. J. Multiphase Flow 10 (1984) 113).

**Disks in squares**, (μ/μ₀ - 1)/φ

{disks}

**Spheres in cubes**, (μ/μ₀ - 1)/φ

{spheres}

**The next order.** The flow of a body's stresslet is taken away by the walls, and its images at each period have
their own. Both strain the fluid at the body, by e = c S/(μV), so that its stresslet grows by (d + 2) c φ: to the
next order the coefficient is (d + 2)/2 (1 + (d + 2) c φ). c follows from the shape of the cell alone, without finite
elements: lattice sums for images, and for each wave along the walls the flow in a strip that cancels that of the
stresslets. For squares that is {predicted_disk}, for cubes {predicted_sphere}. Lines through the three most dilute
cells are {disk} and {sphere}; what is left are higher orders, φ² more for disks and φ^(5/3) for spheres, and the mesh.

These are slopes of cells, of one layer of bodies between walls. Batchelor and Green (J. Fluid Mech. 56 (1972) 401)
have 5.2 φ² for spheres at random places far from walls, which no cell of one body has: walls and images matter as
much. Cells with a disk that have the same share {share}, with other periods and distances of the walls, show it:

{shapes}"""
