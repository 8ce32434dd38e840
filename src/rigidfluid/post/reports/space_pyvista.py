"""A view of a 3D run drawn by PyVista, in a process of its own: without a screen or drivers it may crash.

The module run as a program reads a file of arrays and writes one image for each moment in it.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from dataclasses import fields
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.model.types import FloatArray
from rigidfluid.post.reports.space import Camera, Space, box_edges
from rigidfluid.post.reports.style import BLACK, SOLID, VERMILLION
from rigidfluid.post.reports.view_plane import ViewPlane

_PATIENCE = 120.0
"""Seconds after which the process is stopped."""
_THREAD = 2e-3
"""The radius of paths over the diagonal of the box."""


def pyvista_images(shown: Sequence[Space], plane: ViewPlane, longer: int) -> list[NDArray[np.uint8]] | None:
    """An image (rows, columns, 3) for each moment, of the camera's size, with ``longer`` points along its longer side;
    None where PyVista is not installed or cannot draw here."""
    if find_spec("pyvista") is None:
        return None
    with TemporaryDirectory() as folder:
        path = Path(folder) / "space.npz"
        arrays = {f"{field.name}{i}": getattr(one, field.name) for i, one in enumerate(shown) for field in fields(one)}
        np.savez(path, across=plane.right, up=plane.up, longer=longer, **arrays)
        command = [sys.executable, "-m", __name__, str(path)]
        try:
            subprocess.run(command, capture_output=True, check=True, timeout=_PATIENCE)
            with np.load(path.with_name("images.npz")) as images:
                return [images[f"image{i}"] for i in range(len(shown))]
        except (OSError, subprocess.SubprocessError, KeyError):
            return None


def main(path: Path) -> None:
    """Draw what is in a file."""
    with np.load(path) as arrays:
        plane = ViewPlane(arrays["across"], arrays["up"])
        names = [field.name for field in fields(Space)]
        count = sum(name.startswith(names[0]) for name in arrays)
        shown = [Space(**{name: arrays[f"{name}{i}"] for name in names}) for i in range(count)]
        longer = int(arrays["longer"])
    images: dict[str, Any] = {f"image{i}": _image(one, plane, longer) for i, one in enumerate(shown)}
    np.savez(path.with_name("images.npz"), **images)


def _image(shown: Space, plane: ViewPlane, longer: int) -> NDArray[np.uint8]:
    import pyvista

    camera = Camera.place(plane)
    size = camera.size(shown.box)
    plotter = pyvista.Plotter(off_screen=True, window_size=[int(n) for n in longer * size / size.max()])
    plotter.set_background("white")
    plotter.add_mesh(_surface(shown.bodies).clean().compute_normals(), color=SOLID, smooth_shading=True)
    if len(shown.slice_points):
        seen = _surface(shown.slice_points)
        seen.point_data["colours"] = (255.0 * shown.slice_colours).astype(np.uint8).reshape(-1, 3)
        plotter.add_mesh(seen, scalars="colours", rgb=True, lighting=False)
    for edge in box_edges(shown.box):
        plotter.add_mesh(pyvista.Line(*edge), color=BLACK, line_width=1)
    middle, diagonal = shown.box.mean(axis=0), float(np.linalg.norm(np.diff(shown.box, axis=0)))
    for path in shown.paths:
        if np.ptp(path, axis=0).any():
            plotter.add_mesh(pyvista.lines_from_points(path).tube(radius=_THREAD * diagonal), color=VERMILLION)
    plotter.camera_position = [middle + 10.0 * diagonal * camera.to, middle, camera.up]
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = 0.5 * float(size[1])
    plotter.reset_camera_clipping_range()
    plotter.enable_anti_aliasing("ssaa")
    return np.asarray(plotter.screenshot(return_img=True), dtype=np.uint8)


def _surface(triangles: FloatArray) -> Any:
    import pyvista

    numbers = np.arange(3 * len(triangles)).reshape(-1, 3)
    return pyvista.PolyData.from_regular_faces(triangles.reshape(-1, 3), numbers)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
