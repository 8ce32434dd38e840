"""A view of a 3D run on Matplotlib's axes."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from numpy.typing import NDArray

from rigidfluid.core.model.types import FloatArray
from rigidfluid.reports.space import Camera, Space, box_edges
from rigidfluid.reports.style import BLACK, SOLID, VERMILLION
from rigidfluid.reports.view_plane import ViewPlane, direction_label

_LIGHT = np.array([-0.4, 0.5, 0.77])
"""To the light: to the observer's right, up and to the observer."""
_LONG = 0.3
"""Of the larger half of a picture: an edge that has room for more than its name."""
_AMBIENT = 0.4
"""The light on what is turned away from it."""


def draw_space(axes: Any, shown: Space, plane: ViewPlane) -> None:
    """Draw on 3D axes, along which there are the plane's right, the direction across it, and its up."""
    normal = plane.normal
    towards = bool(normal[np.argmax(np.abs(normal))] > 0.0)
    across = normal if towards else -normal
    frame = np.stack([plane.right, across, plane.up], axis=1)
    colours = np.concatenate([_lit(shown.bodies, plane), shown.slice_colours.mean(axis=1)])
    triangles = np.concatenate([shown.bodies, shown.slice_points]) @ frame
    axes.computed_zorder = False
    surfaces = Poly3DCollection(triangles, facecolors=colours, edgecolors=colours, linewidths=0.3, zorder=1)
    surfaces.set_antialiased(False)
    axes.add_collection3d(surfaces)
    axes.add_collection3d(Line3DCollection(box_edges(shown.box) @ frame, colors=BLACK, linewidths=0.5, zorder=0))
    axes.add_collection3d(Line3DCollection(shown.paths @ frame, colors=VERMILLION, linewidths=0.8, zorder=2))
    corners = box_edges(shown.box).reshape(-1, 3) @ frame
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    axes.set_xlim(lower[0], upper[0])
    axes.set_ylim(*((upper[1], lower[1]) if towards else (lower[1], upper[1])))
    axes.set_zlim(lower[2], upper[2])
    axes.set_xlabel(plane.labels[0])
    axes.set_ylabel(direction_label(across))
    axes.set_zlabel(plane.labels[1])
    axes.set_box_aspect(upper - lower)
    axes.set_proj_type("ortho")
    axes.locator_params(nbins=4)
    to = Camera.of(plane).to
    azimuth = np.arctan2(-to @ normal, to @ plane.right)
    axes.view_init(elev=np.degrees(np.arcsin(to @ plane.up)), azim=np.degrees(azimuth))


def draw_image(axes: Axes, image: NDArray[np.uint8], box: FloatArray, plane: ViewPlane) -> None:
    """Show an image of the box (2, 3), and write at three of its edges along which axis they are, and from where to
    where at long ones."""
    camera = Camera.of(plane)
    width, height = 0.5 * camera.size(box)
    axes.imshow(image, extent=(-width, width, -height, height))
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
    camera = Camera.of(plane)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    size = np.linalg.norm(normal, axis=1)
    light = _LIGHT @ np.stack([camera.right, camera.up, camera.to])
    towards = normal @ light / (np.where(size > 0.0, size, 1.0) * np.linalg.norm(light))
    return np.asarray((_AMBIENT + (1.0 - _AMBIENT) * np.maximum(towards, 0.0))[:, None] * to_rgb(SOLID))
