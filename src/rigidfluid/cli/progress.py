"""Progress of a command, on the first process's terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from datetime import timedelta
from typing import TYPE_CHECKING

from rigidfluid.cli import console
from rigidfluid.cli.console import make_console, tell_aside

if TYPE_CHECKING:
    from rigidfluid.core.run.run import Progress
    from rigidfluid.core.scene.run_tables import TimeTable
    from rigidfluid.post.progress import RunsProgress

SECONDS_OF_A_LINE = 10.0
"""Seconds from one line of progress to the next."""


def compilation_told() -> AbstractContextManager[None]:
    """Say once why nothing seems to happen where loops are compiled; later runs load them from the disk."""
    from numba.core.event import Event, Listener, install_listener

    class FirstOne(Listener):
        told = False

        def on_start(self, event: Event) -> None:
            if not self.told:
                tell_aside("Compiling loops, which later runs load: some ten seconds.")
            self.told = True

        def on_end(self, event: Event) -> None:
            pass

    listening: AbstractContextManager[None] = install_listener("numba:compile", FirstOne())
    return listening


@contextmanager
def progress_bar(name: str, time: TimeTable) -> Iterator[Callable[[Progress], None]]:
    """Yield a function that shows in a bar how far a run is in its time, on the first process's terminal alone; in
    lines where that is none."""
    terminal = make_console(stderr=True)
    if console.LAUNCH.rank > 0:
        yield lambda _: None
        return
    if not terminal.is_terminal:
        yield progress_lines(name)
        return
    from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn(name),
        BarColumn(),
        TextColumn(
            "time {task.completed:.4g} of {task.total:.4g}, step {task.fields[step]:.3g}, gap {task.fields[gap]:.3g}"
            "{task.fields[warning]}"
        ),
        TimeRemainingColumn(),
        TextColumn("to go"),
    )
    with Bar(*columns, console=terminal) as bar:
        task = bar.add_task(name, total=time.end, step=time.step, gap=float("inf"), warning="")
        yield lambda now: bar.update(
            task, completed=now.time, step=now.step, gap=now.gap, warning=_mesh_failures(now.failed_remeshes)
        )


def progress_lines(name: str) -> Callable[[Progress], None]:
    """A function that tells every ten seconds how far a run is in its time, and how long the rest will take at the
    speed so far."""
    first: Progress | None = None
    told = 0.0

    def show(now: Progress) -> None:
        nonlocal first, told
        if first is None:
            first, told = now, now.elapsed
            return
        if now.elapsed - told < SECONDS_OF_A_LINE:
            return
        told = now.elapsed
        seconds = (now.elapsed - first.elapsed) * (now.end - now.time) / (now.time - first.time)
        tell_aside(
            f"{name}: time {now.time:.4g} of {now.end:.4g}, {now.time / now.end:.0%}, step {now.step:.3g}"
            f"{_mesh_failures(now.failed_remeshes)}, some {timedelta(seconds=round(seconds))} to go"
        )

    return show


def _mesh_failures(failed: int) -> str:
    """Words on failed re-meshes, for the progress bar; empty without any."""
    return f", {failed} failed re-meshes" if failed else ""


@contextmanager
def runs_bar(name: str) -> Iterator[Callable[[RunsProgress], None]]:
    """Yield a function that shows in a bar how many runs are done, out of how many, and a word on the present one; on a
    terminal alone."""
    terminal = make_console(stderr=True)
    if not terminal.is_terminal:
        yield lambda _: None
        return
    from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn(name),
        BarColumn(),
        TextColumn("{task.fields[now]}"),
        TimeRemainingColumn(),
        TextColumn("to go"),
    )
    with Bar(*columns, console=terminal) as bar:
        task = bar.add_task(name, total=None, now="")

        def show(now: RunsProgress) -> None:
            text = f"run {min(int(now.done) + 1, now.total)} of {now.total}: {now.about}"
            bar.update(task, total=now.total, completed=now.done, now=text)

        yield show


@contextmanager
def movie_bar() -> Iterator[Callable[[int, int], None]]:
    """Yield a function that shows in a bar how many pictures of a movie are done, out of how many; on a terminal
    alone."""
    terminal = make_console(stderr=True)
    if not terminal.is_terminal:
        yield lambda done, total: None
        return
    from rich.progress import Progress as Bar

    with Bar(console=terminal) as bar:
        task = bar.add_task("movie", total=None)
        yield lambda done, total: bar.update(task, total=total, completed=done)
