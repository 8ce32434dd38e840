"""Pictures of a 3D run from a point of view: bodies, paths, the domain's box, and a slice of the speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from rigidfluid.post.reports.moment import Moment
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.space import Camera, Space, space
from rigidfluid.post.reports.space_matplotlib import draw_image, draw_space
from rigidfluid.post.reports.space_pyvista import pyvista_images
from rigidfluid.post.reports.style import COLOURMAP, new_figure
from rigidfluid.post.reports.view_plane import ViewPlane

_PIXELS = 900
"""Number of pixels of PyVista's images along the longer side."""


def flow_space_picture(results: Results, shown: Sequence[Moment], plane: ViewPlane) -> Figure:
    """Draw the run with slices of the speed."""
    fastest = max(float(moment.section.speed.max()) for moment in shown) or 1.0
    scale = ScalarMappable(Normalize(0.0, fastest), COLOURMAP)
    spaces = []
    for moment in shown:
        section = moment.section
        speed = section.triangles(section.speed)[1].reshape(-1, 3)
        colours = np.asarray(colormaps[COLOURMAP](speed / fastest))[..., :3]
        spaces.append(space(results, results.state_at(moment.time), section.slice_points, colours))
    return _panels(spaces, [moment.time for moment in shown], plane, scale)


def dry_space_picture(results: Results, times: Sequence[float], plane: ViewPlane) -> Figure:
    """Draw a run without a fluid."""
    nothing = np.zeros((0, 3, 3))
    spaces = [space(results, results.state_at(time), nothing, nothing) for time in times]
    return _panels(spaces, times, plane, None)


def _panels(spaces: list[Space], times: Sequence[float], plane: ViewPlane, scale: ScalarMappable | None) -> Figure:
    """Draw a panel for each time, by PyVista if it works here, else by Matplotlib."""
    images = pyvista_images(spaces, plane, _PIXELS)
    width, height = Camera.place(plane).size(spaces[0].box)
    columns = min(len(spaces), 4 if height > 1.5 * width else 2)
    rows = -(-len(spaces) // columns)
    across = min(3.6, 5.5 * width / height + 0.8)
    figure = new_figure(columns * across + 1.5, rows * (across * height / width + 0.4))
    panels: list[Axes] = []
    for k, (one, time) in enumerate(zip(spaces, times, strict=True), start=1):
        axes = figure.add_subplot(rows, columns, k)
        if images is None:
            draw_space(axes, one, plane)
        else:
            draw_image(axes, images[k - 1], one.box, plane)
        axes.set_title(f"time {time:.4g}")
        panels.append(axes)
    if scale is not None:
        figure.colorbar(scale, ax=panels, label="speed [length/time]", shrink=0.8)
    return figure
