"""Runs the falling disk and makes docs/falling_disk.png, the picture of the README."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import rigidfluid
from rigidfluid.core.output.history import History
from rigidfluid.core.output.vtu import read_pvd, read_vtu
from rigidfluid.post.reports.plane import corner_triangles, fine_triangles
from rigidfluid.post.reports.scale import COLOURMAP
from rigidfluid.post.reports.style import BLACK, BODY, ORANGE, STYLE, VERMILLION, new_figure

HERE = Path(__file__).parent
sys.path.append(str(HERE.parent / "tests" / "support"))

from published import KOBLITZ_2017  # noqa: E402

SCENE = HERE.parent / "scenes" / "falling_disk.toml"
PATH = HERE / "falling_disk.png"
OVERRIDES = ("mesh.size_body=0.025", "time.step=0.004")
MOMENTS = (0.24, 0.5, 0.76)
FASTEST = 5.7  # cm/s


def picture(history: History, folder: Path) -> Figure:
    """Speed at three moments, the mesh at the last, and the velocity against the published points."""
    figure = new_figure(10.0, 4.6)
    left, right = figure.subfigures(1, 2, width_ratios=(5, 4))
    series = dict(read_pvd(folder / "fields.pvd"))
    panels = left.subplots(1, 4, width_ratios=(1, 1, 1, 1.8))
    for axes, moment in zip(panels, MOMENTS, strict=False):
        colours = draw(axes, series, moment)
        axes.set(xlim=(0, 2), ylim=(0, 6), title=f"{moment:g} s", xticks=[], yticks=[])
    draw(panels[3], series, MOMENTS[-1])
    panels[3].triplot(corner_triangles(read_vtu(nearest(series, MOMENTS[-1]))), color="white", linewidth=0.25)
    panels[3].set(xlim=(0.5, 1.5), ylim=(0, 1.6667), title=f"mesh at {MOMENTS[-1]:g} s", xticks=[], yticks=[])
    left.colorbar(colours, ax=panels, location="bottom", label="speed [cm/s]", shrink=0.6, aspect=40, pad=0.03)
    compare(right.subplots(), history)
    return figure


def nearest(series: dict[float, Path], moment: float) -> Path:
    """The file whose time is nearest to a moment."""
    return series[min(series, key=lambda time: abs(time - moment))]


def draw(axes: Axes, series: dict[float, Path], moment: float) -> object:
    """Colour the fluid by its speed; solids stay grey."""
    fields = read_vtu(nearest(series, moment))
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_facecolor(BODY)
    speed = np.linalg.norm(fields.velocity, axis=1)
    return axes.tripcolor(fine_triangles(fields), speed, shading="gouraud", cmap=COLOURMAP, vmin=0, vmax=FASTEST)


def compare(axes: Axes, history: History) -> None:
    """Vertical velocity over time, computed and published."""
    bodies = history.bodies
    axes.plot(
        bodies["time"],
        bodies["vy"],
        color=VERMILLION,
        label=f"rigidfluid, {history.summary['steps']} steps,\n{history.summary['unknowns']} unknowns",
    )
    axes.plot(*KOBLITZ_2017.T, "o", color=BLACK, fillstyle="none", label="Koblitz et al. 2017")
    touch = bodies["time"][np.argmax(bodies["gap"] < 0.015)]
    axes.axvline(touch, color=ORANGE, linestyle="--", label="contact force sets in")
    axes.set(xlabel="time [s]", ylabel="vertical velocity [cm/s]", xlim=(0, 1))
    axes.legend(loc="center", bbox_to_anchor=(0.45, 0.62))


def main() -> None:
    """Run, draw, save."""
    with tempfile.TemporaryDirectory() as folder, matplotlib.rc_context(STYLE):
        history = rigidfluid.run(rigidfluid.load_scene(SCENE, OVERRIDES), Path(folder))
        picture(history, Path(folder)).savefig(PATH, dpi=100, metadata={"Software": None})


if __name__ == "__main__":
    main()
