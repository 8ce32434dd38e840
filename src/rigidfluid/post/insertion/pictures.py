"""Pictures of a mesh: in the plane all of it, in space its boundary and a slice, and cells over their quality."""

from __future__ import annotations

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh
from rigidfluid.post.insertion.figures import BINS, Figures
from rigidfluid.post.reports.scale import COLOURMAP
from rigidfluid.post.reports.slice import WHOLE, Slice, cut_faces
from rigidfluid.post.reports.style import BLACK, BLUE, BODY, PALETTE, new_figure

_FINE = 0.25
"""Width of the lines of cells [point]."""


def plane_picture(mesh: Mesh, system: System) -> Figure:
    """All cells, bodies filled, each piece of the domain's boundary in a colour."""
    lower, upper = system.meshed(system.pose).extent
    width, height = upper - lower
    figure = new_figure(10.0, float(np.clip(10.0 * height / width, 2.5, 12.0)))
    axes = figure.add_subplot(aspect="equal", xlim=(lower[0], upper[0]), ylim=(lower[1], upper[1]))
    axes.axis("off")
    axes.add_collection(
        PolyCollection(list(mesh.points[mesh.cells]), facecolors="white", edgecolors=BLUE, linewidths=_FINE)
    )
    for number in range(len(system.surfaces)):
        edges = mesh.points[mesh.facets[mesh.markers == number]]
        wall = number - len(system.bodies)
        colour, name = (BLACK, None) if wall < 0 else (PALETTE[1 + wall % (len(PALETTE) - 1)], system.surfaces[number])
        axes.add_collection(LineCollection(edges, colors=colour, linewidths=0.6 if wall < 0 else 1.6, label=name))
    axes.margins(0.02)
    axes.autoscale()
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=6)
    return figure


def space_picture(mesh: Mesh, system: System) -> Figure:
    """The boundary, bodies in full and walls as a veil; next to it the cells that a plane cuts, by their quality."""
    figure = new_figure(12.0, 5.6)
    axes = figure.add_subplot(1, 2, 1, projection="3d")
    bodies = mesh.markers < len(system.bodies)
    wall = Poly3DCollection(mesh.points[mesh.facets[~bodies]], facecolors=(0.4, 0.6, 0.9, 0.06), linewidths=0.1)
    wall.set_edgecolor((0.2, 0.3, 0.5, 0.25))
    axes.add_collection3d(wall)
    axes.add_collection3d(
        Poly3DCollection(mesh.points[mesh.facets[bodies]], facecolors=BODY, edgecolors=BLACK, linewidths=0.1)
    )
    lower, upper = system.meshed(system.pose).extent
    axes.set(xlim=(lower[0], upper[0]), ylim=(lower[1], upper[1]), zlim=(lower[2], upper[2]))
    axes.set_box_aspect(upper - lower)
    axes.set_axis_off()
    _add_slice(figure, mesh, system)
    return figure


def _add_slice(figure: Figure, mesh: Mesh, system: System) -> None:
    """Add a slice across the domain's shortest side, through the middle of the bodies."""
    lower, upper = system.meshed(system.pose).extent
    axis = int(np.argmin(upper - lower))
    centres = system.pose.position if len(system.bodies) else 0.5 * (lower + upper)[None]
    across, through = np.eye(3)[axis], np.median(centres, axis=0)
    cut = Slice.cut(((mesh.points - through) @ across)[mesh.cells], WHOLE)
    kept = np.delete(np.arange(3), axis)
    axes = figure.add_subplot(1, 2, 2, aspect="equal")
    triangles = cut.values(mesh.points[mesh.cells])[..., kept]
    quality = cell_quality(mesh.points, mesh.cells[cut.cell])
    drawn = PolyCollection(list(triangles), cmap=COLOURMAP, antialiaseds=False, array=quality, clim=(0.0, 1.0))
    axes.add_collection(drawn)
    edges = cut_faces(mesh.points, mesh.cells, across, through)[..., kept]
    axes.add_collection(LineCollection(list(edges), colors=BLACK, linewidths=0.2))
    axes.autoscale()
    axes.set(xlabel=f"{'xyz'[kept[0]]} [length]", ylabel=f"{'xyz'[kept[1]]} [length]")
    figure.colorbar(drawn, ax=axes, label="quality [1]", shrink=0.7)


def histogram(figures: Figures) -> Figure:
    """Cells over their quality."""
    figure = new_figure(6.0, 2.8)
    axes = figure.add_subplot(xlabel="quality [1]", ylabel="cells", yscale="log", xlim=(0.0, 1.0))
    edges = np.linspace(0.0, 1.0, BINS + 1)
    axes.bar(edges[:-1], figures.quality_histogram, width=1.0 / BINS, align="edge", color=BLUE, edgecolor="white")
    axes.axvline(figures.worst_quality, color=BLACK, linestyle=":", label=f"worst cell {figures.worst_quality:.3f}")
    axes.legend()
    return figure
