"""A view of a 3D run on Matplotlib's axes, drawn or as an image."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from rigidfluid.core.model.types import FloatArray
from rigidfluid.post.reports.space import Camera, Space, box_edges
from rigidfluid.post.reports.style import BLACK, SOLID, VERMILLION
from rigidfluid.post.reports.view_plane import ViewPlane

_LIGHT = np.array([-0.4, 0.5, 0.77])
"""Direction of the light: to the observer's right, up, and to the observer."""
_LONG = 0.3
"""Length of an edge with room for more than its name, over the larger half side of the picture."""
_AMBIENT = 0.4
"""Brightness of surfaces that are turned away from the light."""


def draw_space(axes: Axes, shown: Space, plane: ViewPlane) -> None:
    """Draw triangles from behind to the front, then the edges of the box and the paths."""
    camera = Camera.place(plane)
    colours = np.concatenate([_lit(shown.bodies, plane), shown.slice_colours.mean(axis=1)])
    triangles = np.concatenate([shown.bodies, shown.slice_points])
    order = np.argsort(triangles.mean(axis=1) @ camera.to)
    seen, colours = camera.seen(triangles[order], shown.box), colours[order]
    surfaces = PolyCollection(list(seen), facecolors=colours, edgecolors=colours, linewidths=0.3, zorder=1)
    surfaces.set_antialiased(False)
    axes.add_collection(surfaces)
    edges, paths = camera.seen(box_edges(shown.box), shown.box), camera.seen(shown.paths, shown.box)
    axes.add_collection(LineCollection(list(edges), colors=BLACK, linewidths=0.5, zorder=0))
    axes.add_collection(LineCollection(list(paths), colors=VERMILLION, linewidths=0.8, zorder=2))
    _frame(axes, shown.box, camera)


def draw_image(axes: Axes, image: NDArray[np.uint8], box: FloatArray, plane: ViewPlane) -> None:
    """Show an image of the box (2, 3)."""
    camera = Camera.place(plane)
    width, height = 0.5 * camera.size(box)
    axes.imshow(image, extent=(-width, width, -height, height))
    _frame(axes, box, camera)


def _frame(axes: Axes, box: FloatArray, camera: Camera) -> None:
    """Write at three edges of the box (2, 3) along which axis they are, and from where to where at long ones."""
    width, height = 0.5 * camera.size(box)
    axes.set(xlim=(-width, width), ylim=(-height, height), aspect="equal")
    axes.set_axis_off()
    edges = box_edges(box)
    seen = camera.seen(edges, box)
    for axis in range(3):
        mine = np.flatnonzero(np.ptp(edges, axis=1)[:, axis] > 0.0)
        step = np.diff(seen[mine[0]], axis=0)[0]
        rises = step[0] * step[1] > 0.0
        side = (-1.0, 0.0) if abs(step[1]) > 2.0 * abs(step[0]) else (0.5 if rises else -0.5, -1.0)
        edge = mine[np.argmax(seen[mine].mean(axis=1) @ side)]
        angle = np.degrees(np.arctan2(*step[::-1]))
        text = "xyz"[axis]
        if np.linalg.norm(step) > _LONG * max(width, height):
            text += f" [length], {edges[edge, 0, axis]:.4g} to {edges[edge, 1, axis]:.4g}"
        place, away = seen[edge].mean(axis=0), (9.0 * side[0], 9.0 * side[1])
        axes.annotate(text, place, away, textcoords="offset points", rotation=(angle + 89.0) % 180.0 - 89.0,
                      rotation_mode="anchor", ha="center", va="center", fontsize=8)  # fmt: skip


def _lit(triangles: FloatArray, plane: ViewPlane) -> FloatArray:
    """The colours (T, 3) of flat triangles."""
    camera = Camera.place(plane)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    size = np.linalg.norm(normal, axis=1)
    light = _LIGHT @ np.stack([camera.right, camera.up, camera.to])
    towards = normal @ light / (np.where(size > 0.0, size, 1.0) * np.linalg.norm(light))
    return np.asarray((_AMBIENT + (1.0 - _AMBIENT) * np.maximum(towards, 0.0))[:, None] * to_rgb(SOLID))
