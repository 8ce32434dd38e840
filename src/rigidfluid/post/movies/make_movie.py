"""A movie made from a run's folder."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.disk import writing
from rigidfluid.core.output.results_folder import join_folder
from rigidfluid.core.output.run_files import ADDED, RUN
from rigidfluid.core.setup.model import Model
from rigidfluid.errors import OutputError
from rigidfluid.post.movies.picture import draw_bodies, flow_image, ground, inside_image, paint_flow
from rigidfluid.post.movies.shot import Shot, Window, shot_of
from rigidfluid.post.movies.small_gif import SmallGifWriter
from rigidfluid.post.reports.canvas import Canvas, body_shells
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.reports.scale import Quantity, Scale
from rigidfluid.post.reports.shared_scale import shared_scale
from rigidfluid.post.reports.style import SKY, STYLE, VERMILLION, new_figure
from rigidfluid.post.reports.view_plane import PlaneName

Progress = Callable[[int, int], None]

_LAYOUTS = 6
"""Number of drawings after which the layout no longer changes."""


@dataclass(frozen=True)
class Look:
    """Appearance of a movie.

    ``show``: quantity of the fluid. ``follow``: name of a body that the picture goes with. ``window``: left, lower,
    right and upper end of what is seen [length]; the whole domain if not given. ``longer``: points along the picture's
    longer side. ``rate``: pictures a second. ``plane``: plane of a 3D run, as `view_plane` takes it. ``every``: of so
    many output times one is shown.
    """

    show: Quantity = "speed"
    follow: str | None = None
    window: Window | None = None
    longer: int = 600
    rate: int = 15
    plane: PlaneName = "motion"
    every: int = 1


@dataclass(frozen=True)
class _Frame:
    """A state of the run, and the file of its fields, None without a fluid."""

    state: int
    path: Path | None


def movie(
    folder: Path,
    out: Path | None = None,
    look: Look | None = None,
    progress: Progress | None = None,
    model: Model | None = None,
) -> Path:
    """Make a movie from the results in a folder, of a complete run or not: a picture for each output time.

    A 3D flow is shown in a slice through the first body or the one followed; without a fluid all bodies are seen along
    the normal of that plane. The file ``out`` is .mp4 or .gif; without it movie.mp4 in the folder, movie.gif if nothing
    encodes MP4. ``progress`` is told how many pictures are done, of how many. A run of a model made in Python
    wants the ``model``. Raises OutputError for missing or unreadable results, another kind of file, or a disk that
    refuses; SceneError or PluginError if the run's scene cannot be built here, as without one of its plug-ins.
    """
    look, results = look or Look(), read_results(Path(folder), motion_only=True, model=model)
    path, writer = _writer(Path(out) if out else None, Path(folder), look.rate)
    shot, frames = shot_of(results, look.follow, look.window, look.plane), _frames(results, look.every)
    follow = None if look.follow is None else results.number_of(look.follow)
    scale = shared_scale(results, look.show, shot.plane, follow) if results.series else None
    if out is None:
        join_folder(Path(folder), RUN, ADDED)
    partial = path.with_name(f".{path.name}.part{path.suffix}")
    with matplotlib.rc_context(STYLE | _encoder()), writing(path):
        figure, axes, image = _stage(results, shot, look, scale)
        partial.unlink(missing_ok=True)  # a link there would be followed
        try:
            with writer.saving(figure, str(partial), dpi=100):
                for number, frame in enumerate(frames, start=1):
                    image.set_data(_picture(results, shot, frame, look, scale))
                    title = results.units.put_after_numbers(f"time {results.time[frame.state]:.4g} [time]")
                    _label(axes, shot, frame.state, title)
                    if number == 1:
                        _settle(figure)
                    writer.grab_frame()
                    if progress is not None:
                        progress(number, len(frames))
            partial.replace(path)
        finally:
            partial.unlink(missing_ok=True)
    return path


def _frames(results: Results, every: int) -> list[_Frame]:
    """One of ``every`` output times whose fields are there, or that have none."""
    outputs = [(time, path) for time, path in results.outputs if path is None or path.exists()]
    shown = [_Frame(results.state_at(time), path) for time, path in outputs[::every]]
    if len(shown) < 2:
        found = f"{len(outputs)} output times" + f", of which one in {every} is shown" * (every > 1)
        remedy = "Run on, or shorten output.every" + ", or show more of the times" * (every > 1) + "."
        raise OutputError("the run", found, "two or more pictures, for a movie", remedy)
    return shown


def _picture(results: Results, shot: Shot, frame: _Frame, look: Look, scale: Scale | None) -> FloatArray:
    grid = shot.grid(frame.state, look.longer)
    if frame.path is not None and scale is not None:
        inside = inside_image(results, frame.path, look.show, grid)
        known = np.isfinite(inside)
        image = flow_image(results.fields(frame.path), look.show, grid)
        picture = paint_flow(np.where(known, inside, image), scale)
        draw_bodies(picture, grid, results, frame.state, known)
        return picture
    picture = ground(results, grid)
    if results.system.dimension == 2:
        draw_bodies(picture, grid, results, frame.state)
    else:
        canvas = Canvas(picture, np.full(picture.shape[:2], -np.inf), grid)
        canvas.paint_bodies(body_shells(results), results, frame.state, SKY, VERMILLION)
    return picture


def _stage(results: Results, shot: Shot, look: Look, scale: Scale | None) -> tuple[Figure, Axes, AxesImage]:
    """A figure with an empty picture, and the colour bar next to it where there is a fluid."""
    size = shot.upper - shot.lower
    width, height = look.longer / 100.0 * size / size.max()
    figure = new_figure(max(width, 1.5) + (1.6 if results.series else 0.6), max(height, 1.0) + 0.8)
    axes = figure.add_subplot(xlabel=shot.plane.labels[0], ylabel=shot.plane.labels[1])
    axes.grid(visible=False)
    axes.locator_params(axis="x", nbins=1 if size[1] > 4.0 * size[0] else 4)
    axes.locator_params(axis="y", nbins=2 if size[0] > 4.0 * size[1] else 5)
    image = axes.imshow(np.ones((2, 2, 3)), origin="lower", interpolation="nearest")
    if scale is not None:
        scale.draw_bar(figure, [axes], results.system.dimension)
    return results.units.put_into_labels(figure), axes, image


def _label(axes: Axes, shot: Shot, state: int, title: str) -> None:
    """Set the title, and the axes to the place of the picture."""
    axes.images[0].set_extent(shot.extent(state))
    axes.set_title(title)


def _settle(figure: Figure) -> None:
    """Let the figure find its layout, and keep it: Matplotlib's comes nearer with each drawing, and in the first one
    labels may be cut off."""
    for _ in range(_LAYOUTS):
        figure.draw_without_rendering()
    figure.set_layout_engine("none")


def _writer(out: Path | None, folder: Path, rate: int) -> tuple[Path, AbstractMovieWriter]:
    """Path of the movie, and the writer of its format."""
    encoder = _encoder_path()
    path = out or folder / ("movie.mp4" if encoder else "movie.gif")
    if path.suffix == ".gif":
        return path, SmallGifWriter(fps=rate)
    if path.suffix != ".mp4":
        raise OutputError("--out", path.name, "a name that ends in .mp4 or .gif", "Choose one of both.")
    if encoder is None:
        remedy = "Install rigidfluid[movies], or ffmpeg, or write a .gif."
        raise OutputError("--out", path.name, "a .gif, since nothing here encodes MP4", remedy)
    even = "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white"
    return path, FFMpegWriter(fps=rate, codec="h264", extra_args=["-vf", even, "-pix_fmt", "yuv420p"])


def _encoder() -> dict[str, str]:
    """Matplotlib's settings for the encoder."""
    found = _encoder_path()
    return {} if found is None else {"animation.ffmpeg_path": found}


def _encoder_path() -> str | None:
    """The program that the package imageio-ffmpeg brings, or an installed one."""
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError:
        return shutil.which("ffmpeg")
    return str(get_ffmpeg_exe())
