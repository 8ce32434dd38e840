"""The command line; the only place that prints and exits."""

from __future__ import annotations

import json
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command

from rigidfluid import __version__
from rigidfluid.commands import Assignments, JsonFile, SceneFile, write_json
from rigidfluid.core.run.process import Launch, no_collection
from rigidfluid.errors import RigidfluidError, SharedInterrupt
from rigidfluid.plugin_commands import PluginCommand, missing_package, plugin_commands

if TYPE_CHECKING:
    from rigidfluid.checks import Report
    from rigidfluid.core.output.history import History
    from rigidfluid.core.run.run import Progress
    from rigidfluid.core.scene.scene import Scene
    from rigidfluid.post.comparison.comparison import Comparison
    from rigidfluid.post.insertion.figures import Figures as InsertionFigures
    from rigidfluid.post.progress import RunsProgress
    from rigidfluid.post.studies.results import Results

FOUND_ERRORS = 1
BAD_INPUT = 2
INTERRUPTED = 130

MOST_BODIES = 20
"""Largest number of bodies or surfaces that a table shows."""

Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Folder that a run has written.")]
OutFolder = Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Where to write; default out/<name>.")]
CompareFolder = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Where to write; default out/<name>_compare.")
]
MeshFolder = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Where to write; default out/<name>_mesh.")
]
Resume = Annotated[bool, typer.Option("--resume", help="Go on from the last checkpoint in DIR.")]
StudyFile = Annotated[Path, typer.Argument(metavar="STUDY", help="Study file (TOML).")]
Continue = Annotated[
    bool, typer.Option("--resume/--fresh", help="Keep the runs that DIR holds already, or run everything anew.")
]
Backends = Annotated[
    list[str] | None, typer.Option("--backend", metavar="NAME", help="A fluid backend; name two or more.")
]
Version = Annotated[bool, typer.Option("--version", help="Print the version and exit.")]

MovieFile = Annotated[
    Path | None, typer.Option("--out", metavar="FILE", help="An .mp4 or .gif file; default DIR/movie.mp4.")
]
Shown = Annotated[
    Literal["speed", "vorticity", "pressure"], typer.Option("--show", help="Which quantity of the fluid.")
]
Follow = Annotated[str | None, typer.Option("--follow", metavar="BODY", help="A body that the picture goes with.")]
Looked = Annotated[
    str | None, typer.Option("--follow", metavar="BODY", help="The body to look at; else the one that came nearest.")
]
Plane = Annotated[
    Literal["motion", "xy", "xz", "yz"],
    typer.Option("--plane", help="Which plane of a 3D run; motion: that of gravity and of the bodies' motion."),
]
View = Annotated[
    tuple[float, float, float, float] | None,
    typer.Option("--view", help="Left, lower, right, upper end of what is seen; from the body's centre with --follow."),
]
MovieSize = Annotated[int, typer.Option("--size", help="Points along the longer side.", min=50, max=4000)]
FramesPerSecond = Annotated[int, typer.Option("--fps", help="Pictures a second.", min=1, max=100)]

LAUNCH = Launch.read()
"""This process among those that share a run; the first one speaks for all."""


class PluginTyperCommand(TyperCommand):
    """A command of a plug-in: help lists it by its package's summary, and it is imported when it is called."""

    def __init__(self, command: PluginCommand) -> None:
        super().__init__(command.name, help=command.summary)
        self._command = command

    def make_context(self, *args: Any, **kwargs: Any) -> Any:
        """Context of the command that the function makes, which takes the place of this one."""
        with _reported():
            function = self._command.load()
        alone = typer.Typer(add_completion=False)
        alone.command(self._command.name)(_reported()(function))
        return get_command(alone).make_context(*args, **kwargs)


class Commands(TyperGroup):
    """The commands below, and those of plug-ins after them."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Names, each once."""
        return list(dict.fromkeys([*super().list_commands(ctx), *plugin_commands()]))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Command of that name: one below, else one of a plug-in, else None."""
        if built_in := super().get_command(ctx, cmd_name):
            return built_in
        if command := plugin_commands().get(cmd_name):
            return PluginTyperCommand(command)
        if missing := missing_package(cmd_name):
            raise _refusal(missing)
        return None


app = typer.Typer(cls=Commands, add_completion=False, pretty_exceptions_enable=False)


@app.callback(invoke_without_command=True)
def main(context: typer.Context, version: Version = False) -> None:
    """Rigid bodies that move and collide in a Newtonian fluid."""
    if version:
        _print(f"rigidfluid {__version__}")
    elif context.invoked_subcommand is None:
        _print(context.get_help())
    elif LAUNCH.size > 1 and context.invoked_subcommand != "run":
        raise _refusal(
            f"rigidfluid {context.invoked_subcommand}: found {LAUNCH.size} processes; allowed is one. "
            "Start it without mpirun; only `rigidfluid run` can be shared."
        )


@app.command()
def run(scene: SceneFile, out: OutFolder = None, assignments: Assignments = None, resume: Resume = False) -> None:
    """Simulate a scene and write the results."""
    with _reported("The same command with --resume goes on from the last checkpoint."):
        with no_collection():
            from rigidfluid.core.case.load import load_scene
            from rigidfluid.core.run.run import run as simulate

            loaded = load_scene(scene, assignments or ())
        folder = out or Path("out") / loaded.name
        ends: list[History] = []
        try:
            with _compilation_told(), _progress_bar(loaded) as show:
                simulate(loaded, folder, resume=resume, progress=show, processes=LAUNCH.size, finished=ends.append)
        finally:
            for history in ends:
                _print_end(history, folder)


@app.command()
def check(scene: SceneFile, assignments: Assignments = None, json_file: JsonFile = None) -> None:
    """Say what a scene switches on and off, and whether its contacts can hold; exit code 1 if they cannot."""
    with _reported():
        from rigidfluid.checks import check as ask
        from rigidfluid.core.case.load import load_scene

        report = ask(load_scene(scene, assignments or ()))
        if json_file is not None:
            write_json(report.to_dict(), json_file)
        _print_domain(report)
        _print_features(report)
        _print_bodies(report)
        _print_findings(report)
    if report.count("error"):
        raise typer.Exit(FOUND_ERRORS)


@app.command()
def insert(scene: SceneFile, assignments: Assignments = None, out: MeshFolder = None) -> None:
    """Make a scene's first mesh, write it for other programs, and say how well the bodies came into it."""
    with _reported():
        from rigidfluid.core.case.load import load_scene
        from rigidfluid.post.insertion import insert as make_mesh

        loaded = load_scene(scene, assignments or ())
        figures, written = make_mesh(loaded, out, lambda phase: _print_aside(f"{loaded.name}: {phase}"))
        _print_insertion(figures)
        _print(f"wrote to {written[0].parent}: {', '.join(path.name for path in written)}")


@app.command()
def compare(
    scene: SceneFile,
    backends: Backends = None,
    assignments: Assignments = None,
    out: CompareFolder = None,
    json_file: JsonFile = None,
    resume: Continue = True,
) -> None:
    """Run a scene with several fluid backends, and say how far the results are apart; exit code 1 if one fails."""
    with _reported("The same command goes on."):
        from rigidfluid.post.comparison import compare as compare_backends

        with _runs_bar("compare") as show:
            comparison, written = compare_backends(
                scene, backends or [], assignments or [], out, fresh=not resume, progress=show
            )
        if json_file is not None:
            write_json(comparison.to_dict(), json_file)
        _print_backends(comparison)
        _print(f"wrote to {written[0].parent}: {', '.join(path.name for path in written)}")
    if comparison.failed:
        raise typer.Exit(FOUND_ERRORS)


@app.command()
def plugins(context: typer.Context) -> None:
    """List the parts and commands that are installed, those of plug-ins too."""
    with _reported():
        from rigidfluid.registry import Registry

        registry = Registry.load()
        table = Table("kind", "name", "origin", "available")
        for entry in registry.entries:
            table.add_row(entry.kind.title, entry.name, entry.origin, "yes" if entry.available else f"no: {entry.hint}")
        for plugin in registry.unloaded:
            table.add_row("plug-in", plugin.name, plugin.origin, f"no: {plugin.reason}")
        group = context.find_root().command
        assert isinstance(group, Commands)
        for name, command in plugin_commands().items():
            hindrance = command.hindrance(group.commands)
            table.add_row("command", name, command.origin, f"no: {hindrance}" if hindrance else "yes")
        _console().print(table)


@app.command()
def report(folder: Folder, plane: Plane = "motion", follow: Looked = None) -> None:
    """Make plots and a page from the results in a folder."""
    with _reported():
        from rigidfluid.post.reports import report as make_report

        for path in make_report(folder, plane, follow):
            _print(f"wrote {path}")


@app.command()
def movie(
    folder: Folder,
    out: MovieFile = None,
    show: Shown = "speed",
    follow: Follow = None,
    plane: Plane = "motion",
    view: View = None,
    size: MovieSize = 600,
    fps: FramesPerSecond = 15,
) -> None:
    """Make a movie from the results in a folder."""
    with _reported(), _movie_bar() as progress:
        from rigidfluid.post.movies import Look
        from rigidfluid.post.movies import movie as make_movie

        path = make_movie(folder, out, Look(show, follow, view, size, fps, plane), progress)
    _print(f"wrote {path}")


@app.command()
def study(study: StudyFile, out: OutFolder = None, resume: Continue = True) -> None:
    """Run a scene or a kernel with many settings, and plot the error against the run time."""
    with _reported("The same command goes on with the runs that are not done."):
        from rigidfluid.post.studies import load_study, run_study

        loaded = load_study(study)
        folder = out or Path("out") / loaded.name
        with _runs_bar(loaded.name) as show:
            results, written = run_study(loaded, folder, fresh=not resume, progress=show)
        _print_study(results)
        _print(f"wrote to {folder}: {', '.join(path.name for path in written)}")


@app.command()
def schema() -> None:
    """Print the JSON Schema of scene files, with the keys of every installed part."""
    with _reported():
        from rigidfluid.core.case.schema import json_schema

        _print(json.dumps(json_schema(), indent=2, ensure_ascii=False))


@contextmanager
def _reported(on_interrupt: str = "") -> Iterator[None]:
    """Turn an expected error into one paragraph on stderr and an exit code.

    Expected errors are raised on all processes of a run, and so is a SharedInterrupt. Any other interrupt or error may
    be that of one process alone, which then ends the others.
    """
    try:
        yield
    except RigidfluidError as error:
        raise _refusal(error) from None
    except (typer.Exit, typer.Abort, typer.BadParameter):
        raise
    except KeyboardInterrupt as interrupt:
        _complain(f"Interrupted. {on_interrupt}")
        if isinstance(interrupt, SharedInterrupt):
            LAUNCH.meet()
        else:
            LAUNCH.end()
        raise typer.Exit(INTERRUPTED) from None
    except Exception:
        _complain(f"A fault in rigidfluid or in a plug-in. {on_interrupt}")
        if LAUNCH.size > 1:
            _console(stderr=True).print(Text(traceback.format_exc()), soft_wrap=True)
            LAUNCH.end()
        raise


@contextmanager
def _compilation_told() -> Iterator[None]:
    """Say once why nothing seems to happen where loops are compiled; later runs load them from the disk."""
    from numba.core.event import Event, Listener, install_listener

    class FirstOne(Listener):
        told = False

        def on_start(self, event: Event) -> None:
            if not self.told:
                _print_aside("Compiling loops, once after each installation: some ten seconds.")
            self.told = True

        def on_end(self, event: Event) -> None:
            pass

    with install_listener("numba:compile", FirstOne()):
        yield


@contextmanager
def _progress_bar(scene: Scene) -> Iterator[Callable[[Progress], None]]:
    """Yield a function that shows the progress of a run in a bar, on the first process's terminal alone."""
    console = _console(stderr=True)
    if LAUNCH.rank > 0 or not console.is_terminal:
        yield lambda _: None
        return
    from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn(scene.name),
        BarColumn(),
        TextColumn(
            "time {task.completed:.4g} of {task.total:.4g}, step {task.fields[step]:.3g}, gap {task.fields[gap]:.3g}"
            "{task.fields[warning]}"
        ),
        TimeRemainingColumn(),
        TextColumn("to go"),
    )
    with Bar(*columns, console=console) as bar:
        task = bar.add_task(scene.name, total=scene.time.end, step=scene.time.step, gap=float("inf"), warning="")
        yield lambda now: bar.update(
            task, completed=now.time, step=now.step, gap=now.gap, warning=_mesh_failures(now.failed_remeshes)
        )


def _mesh_failures(failed: int) -> str:
    """Words on failed re-meshes, for the progress bar; empty without any."""
    return f", {failed} failed re-meshes" if failed else ""


@contextmanager
def _runs_bar(name: str) -> Iterator[Callable[[RunsProgress], None]]:
    """Yield a function that shows in a bar how many runs are done, out of how many, and a word on the present one."""
    from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn(name),
        BarColumn(),
        TextColumn("{task.fields[now]}"),
        TimeRemainingColumn(),
        TextColumn("to go"),
    )
    console = _console(stderr=True)
    with Bar(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task(name, total=None, now="")

        def show(now: RunsProgress) -> None:
            text = f"run {min(int(now.done) + 1, now.total)} of {now.total}: {now.about}"
            bar.update(task, total=now.total, completed=now.done, now=text)

        yield show


@contextmanager
def _movie_bar() -> Iterator[Callable[[int, int], None]]:
    """Yield a function that shows in a bar how many pictures of a movie are done, out of how many."""
    from rich.progress import Progress as Bar

    console = _console(stderr=True)
    with Bar(console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task("movie", total=None)
        yield lambda done, total: bar.update(task, total=total, completed=done)


def _print_insertion(figures: InsertionFigures) -> None:
    table = Table("surface", "shape", "facets", "given vertices kept", "vertices off", "middles off", box=SIMPLE_HEAD)
    for row in figures.surfaces[:MOST_BODIES]:
        kept = "" if row.given_corners is None else f"{row.kept_corners} of {row.given_corners}"
        off = f"{row.vertices_off:.1e}", f"{row.middles_off:.1e}"
        table.add_row(Text(row.name), row.kind, str(row.facets), kept, *off)
    _console().print(table)
    if len(figures.surfaces) > MOST_BODIES:
        _print(f"and {len(figures.surfaces) - MOST_BODIES} more surfaces, in the report")
    seconds = ", ".join(f"{phase} {_figure(value)} s" for phase, value in figures.seconds.items())
    _print(f"{figures.cells} cells, {figures.vertices} vertices, worst quality {_figure(figures.worst_quality)}")
    _print(f"volume of the fluid: {figures.volume:.8g} of {figures.exact_volume:.8g}; {seconds}")


def _print_study(results: Results) -> None:
    failed = len(results.plan) - sum(key in results.outcomes for key in results.prints)
    _print(f"{len(results.plan)} runs, {failed} failed; reference {_figure(results.reference)}")
    for settings, key in zip(results.plan, results.prints, strict=True):
        if key in results.front:
            seconds, error = results.points[key]
            knobs = ", ".join(f"{knob} {value}" for knob, value in settings.items())
            _print(f"on the Pareto front: {knobs}: error {_figure(error)} in {_figure(seconds)} s")


def _print_end(history: History, folder: Path) -> None:
    """Print the figures of a run, complete or not, and where it has written."""
    summary = history.summary
    if summary["reynolds"]:
        solid, fluid = _figure(summary["reynolds_solid_density"]), _figure(summary["reynolds"])
        _print(f"highest Reynolds number: {solid} with the density of the solid, {fluid} with that of the fluid")
    if summary["smallest_gap"] is not None:
        _print(f"smallest gap: {_figure(summary['smallest_gap'])}")
    _print_positions(summary["rest_position"])
    if summary["failed_remeshes"]:
        _print(
            f"warning: a new mesh could not be made {summary['failed_remeshes']} times; the one before served on. "
            f"The latest failure, {summary['latest_failed_remesh']}",
            "yellow",
        )
    _print_energy(summary["energy"])
    for remark in summary["remarks"]:
        style = "yellow" if remark["grade"] == "warning" else ""
        _print(f"{remark['grade']}: {remark['text']}. {remark['remedy']}", style)
    if summary["unknowns"]:
        _print(_stage_costs(summary["wall_time_per_stage"], summary["wall_time"]))
    _print(f"wrote to {folder}: {', '.join(Path(file).name for file in summary['files'])}")


def _print_positions(position: Mapping[str, Sequence[float]]) -> None:
    shown = dict(islice(position.items(), MOST_BODIES))
    more = len(position) - len(shown)
    _print(f"position at the end: {_figure(shown)}" + (f", and {more} more in bodies.csv" if more else ""))


def _stage_costs(seconds: Mapping[str, float], total: float) -> str:
    """Words on the wall time of a run, of its meshes and its linear systems [s]."""
    made, moved, carried, solved, answered = (
        seconds.get(stage, 0.0) for stage in ("mesh", "move mesh", "transfer", "advance", "response")
    )
    meshes = (
        f"meshes {made + moved + carried:.1f} s (made {made:.1f}, moved {moved:.1f}, fluid carried over {carried:.1f})"
    )
    return f"time: {total:.1f} s, of it {meshes}, solving {solved + answered:.1f} s"


def _print_energy(energy: Mapping[str, Any]) -> None:
    """Print energy created, lost and unaccounted for at the end, and warnings with their causes."""
    from rigidfluid.core.output.energy_account import per_cent

    put_in, friction = energy["put_in"], ""
    if energy["path_friction"] and put_in:
        friction = f", friction of impacts {per_cent(energy['path_friction'] / put_in)} at most"
    stabilised = f", {per_cent(energy['grad_div'])} by stabilisation" if energy["grad_div"] else ""
    _print(
        f"energy: {per_cent(energy['created'])} created, {per_cent(energy['lost'])} lost{friction}{stabilised}, "
        f"{per_cent(energy['unaccounted'])} unaccounted for at the end, of {_figure(put_in)} put in"
    )
    for warning in energy["warnings"]:
        grade, style = ("serious warning", "red") if warning["serious"] else ("warning", "yellow")
        _print(f"{grade}: {warning['text']}. {warning['remedy']}", style)


def _print_features(report: Report) -> None:
    table = Table("part", "", "why")
    for feature in report.features:
        table.add_row(feature.name, "on" if feature.on else "off", feature.why)
    _console().print(table)


def _print_domain(report: Report) -> None:
    domain = report.domain
    _print(f"domain: {domain.type}" + (f", from {domain.file}" if domain.file else ""))
    _print(f"from {_figure(domain.lower)} to {_figure(domain.upper)}, of size {_figure(domain.volume)}")
    table = Table("surface", "shape", "area", "condition")
    for surface in domain.surfaces[:MOST_BODIES]:
        table.add_row(surface.name, surface.shape, _figure(surface.area), surface.condition)
    _console().print(table)
    if len(domain.surfaces) > MOST_BODIES:
        _print(f"and {len(domain.surfaces) - MOST_BODIES} more surfaces")
    for remark in domain.remarks:
        _print(f"{remark}.")


def _print_bodies(report: Report) -> None:
    """Print a table of the bodies; of many, those nearest to another surface."""
    nearest = sorted(report.bodies, key=lambda body: float("inf") if body.smallest_gap is None else body.smallest_gap)
    shown = nearest[:MOST_BODIES]
    table = Table("body", "type", "mass", "submerged weight", "impact speed", "smallest gap", "to")
    for body in report.bodies if len(report.bodies) <= MOST_BODIES else shown:
        figures = body.mass, body.submerged_weight, body.impact_speed, body.smallest_gap
        table.add_row(body.name, body.type, *map(_figure, figures), body.nearest)
    _console().print(table)
    if len(report.bodies) > len(shown):
        _print(f"and {len(report.bodies) - len(shown)} bodies that are further from anything")


def _print_findings(report: Report) -> None:
    for finding in report.findings:
        style = {"error": "red", "warning": "yellow"}.get(finding.grade, "")
        text = f"{finding.grade}: {finding.text}." + (f" {finding.remedy}" if finding.remedy else "")
        _console().print(Text(text, style=style), soft_wrap=True)
    _print(f"{report.count('error')} errors, {report.count('warning')} warnings")


def _print_backends(comparison: Comparison) -> None:
    from rigidfluid.post.comparison.tables import HEADER, cost_rows, difference_rows, meaning

    for pair in comparison.pairs:
        # without vertical lines it fits into 80 columns
        title = f"{pair.other} beside {pair.reference}"
        table = Table(*HEADER, title=title, box=SIMPLE_HEAD, padding=0)
        for row in difference_rows(comparison, pair):
            table.add_row(*map(Text, row))
        _console().print(table)
        _print(meaning(pair))
    costs = Table("", *(run.backend for run in comparison.runs))
    for row in cost_rows(comparison):
        costs.add_row(*map(Text, row))
    _console().print(costs)
    for run in comparison.failed:
        _complain(f"{run.backend} failed: {run.error}")


def _figure(value: Any) -> str:
    """Format a number, or a list or table of them, to four digits."""
    if value is None:
        return "none"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_figure(part)}" for key, part in value.items())
    if hasattr(value, "__iter__"):
        return f"({', '.join(map(_figure, value))})"
    return f"{value:.4g}"


def _refusal(reason: object) -> typer.Exit:
    """Print the reason once, wait for all processes, and return the exit to raise."""
    _complain(f"Error: {reason}")
    LAUNCH.meet()
    return typer.Exit(BAD_INPUT)


def _print(text: str, style: str = "") -> None:
    """Print on the first process."""
    if LAUNCH.rank == 0:
        _console().print(Text(text, style=style), soft_wrap=True)


def _complain(text: str) -> None:
    """Print in red on stderr."""
    _print_aside(text, "red")


def _print_aside(text: str, style: str = "") -> None:
    """Print on stderr what is no result."""
    if LAUNCH.rank == 0:
        _console(stderr=True).print(Text(text, style=style), soft_wrap=True)


def _console(stderr: bool = False) -> Console:
    """Console that shows names and values as they are: brackets in them are no markup."""
    return Console(stderr=stderr, markup=False)
