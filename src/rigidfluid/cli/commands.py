"""Commands of the command line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import typer
from rich.table import Table

from rigidfluid import __version__
from rigidfluid.cli import console
from rigidfluid.cli.console import (
    FOUND_ERRORS,
    complain,
    make_console,
    refusal,
    reported,
    tell,
    tell_aside,
)
from rigidfluid.cli.options import (
    Across,
    Backends,
    CompareFolder,
    Continue,
    Folder,
    Follow,
    FramesPerSecond,
    Jobs,
    Looked,
    MeshFolder,
    MovieFile,
    MovieSize,
    OutFolder,
    Plane,
    Resume,
    Shown,
    ShownEvery,
    Since,
    StudyFile,
    Until,
    Version,
    View,
)
from rigidfluid.cli.plug_ins import Commands
from rigidfluid.cli.progress import compilation_told, movie_bar, progress_bar, runs_bar
from rigidfluid.cli.start import examples, new
from rigidfluid.cli.tables import (
    print_backends,
    print_bodies,
    print_domain,
    print_end,
    print_features,
    print_insertion,
    print_notes,
    print_pairs,
    print_statistics,
    print_study,
    print_verdict,
)
from rigidfluid.commands import Assignments, JsonFile, SceneFile, write_json
from rigidfluid.core.run.process import no_collection
from rigidfluid.plugin_commands import plugin_commands

if TYPE_CHECKING:
    from rigidfluid.core.output.history import History

app = typer.Typer(cls=Commands, pretty_exceptions_enable=False)

app.command()(new)
app.command()(examples)


@app.callback(invoke_without_command=True)
def main(context: typer.Context, version: Version = False) -> None:
    """Rigid bodies that move and collide in a Newtonian fluid."""
    console.show_all_text()
    if version:
        tell(f"rigidfluid {__version__}")
    elif context.invoked_subcommand is None:
        tell(context.get_help())
    elif console.LAUNCH.size > 1 and context.invoked_subcommand != "run":
        raise refusal(
            f"rigidfluid {context.invoked_subcommand}: found {console.LAUNCH.size} processes; allowed is one. "
            "Start it without mpirun; only `rigidfluid run` can be shared."
        )


@app.command()
def run(scene: SceneFile, out: OutFolder = None, assignments: Assignments = None, resume: Resume = False) -> None:
    """Simulate a scene and write the results."""
    with reported("The same command with --resume goes on from the last checkpoint."):
        with no_collection():
            from rigidfluid.core.case.load import load_scene
            from rigidfluid.core.run.run import simulate
            from rigidfluid.core.scene.places import told_in_file

            compiling = compilation_told()
        with compiling:
            with no_collection():
                loaded = load_scene(scene, assignments or ())
            folder = out or Path("out") / loaded.name
            ends: list[History] = []
            try:
                told = told_in_file(scene, assignments or ())
                with told, progress_bar(loaded.name, loaded.time) as show:
                    processes = console.LAUNCH.size
                    simulate(loaded, folder, resume=resume, progress=show, processes=processes, finished=ends.append)
            finally:
                for history in ends:
                    print_end(history, folder)


@app.command()
def check(scene: SceneFile, assignments: Assignments = None, json_file: JsonFile = None) -> None:
    """Say what a scene switches on and off, and whether its contacts can hold; exit code 1 if they cannot."""
    with reported():
        from rigidfluid.checks import check as ask
        from rigidfluid.core.case.load import load_scene
        from rigidfluid.core.scene.places import told_in_file

        with compilation_told(), told_in_file(scene, assignments or ()):
            report = ask(load_scene(scene, assignments or ()))
        if json_file is not None:
            write_json(report.to_dict(), json_file)
        print_verdict(report)
        print_domain(report)
        print_features(report)
        print_bodies(report)
        print_pairs(report)
        print_notes(report)
    if report.count("error"):
        raise typer.Exit(FOUND_ERRORS)


@app.command()
def insert(scene: SceneFile, assignments: Assignments = None, out: MeshFolder = None) -> None:
    """Make a scene's first mesh, write it for other programs, and say how well the bodies came into it."""
    with reported():
        from rigidfluid.core.case.load import load_scene
        from rigidfluid.core.scene.places import told_in_file
        from rigidfluid.post.insertion import insert as make_mesh

        loaded = load_scene(scene, assignments or ())
        with told_in_file(scene, assignments or ()):
            figures, written = make_mesh(loaded, out, lambda phase: tell_aside(f"{loaded.name}: {phase}"))
        print_insertion(figures)
        tell(f"wrote to {written[0].parent}: {', '.join(path.name for path in written)}")


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
    with reported("The same command goes on."):
        from rigidfluid.post.comparison import compare as compare_backends

        with runs_bar("compare") as show:
            comparison, written = compare_backends(
                scene, backends or [], assignments or [], out, fresh=not resume, progress=show
            )
        if json_file is not None:
            write_json(comparison.to_dict(), json_file)
        print_backends(comparison)
        tell(f"wrote to {written[0].parent}: {', '.join(path.name for path in written)}")
    if comparison.failed:
        raise typer.Exit(FOUND_ERRORS)


@app.command()
def plugins(context: typer.Context) -> None:
    """List the parts and commands that are installed, those of plug-ins too."""
    with reported():
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
        make_console().print(table)


@app.command()
def report(folder: Folder, plane: Plane = "motion", follow: Looked = None) -> None:
    """Make plots and a page from the results in a folder."""
    with reported():
        from rigidfluid.post.reports import report as make_report
        from rigidfluid.post.statistics import section

        for path in make_report(folder, plane, follow, sections=(section,)):
            tell(f"wrote {path}")


@app.command()
def statistics(
    folder: Folder, since: Since = None, until: Until = None, across: Across = "y", json_file: JsonFile = None
) -> None:
    """Measure structure, motion and contacts of the bodies in a folder's results, as means with their errors."""
    with reported():
        from rigidfluid.post.statistics import statistics as measure

        found, written = measure(folder, since, until, across)
        if json_file is not None:
            write_json(found.to_dict(), json_file)
        print_statistics(found)
        tell(f"wrote to {folder}: {', '.join(path.name for path in written)}")


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
    every: ShownEvery = 1,
) -> None:
    """Make a movie from the results in a folder."""
    with reported(), movie_bar() as progress:
        from rigidfluid.post.movies import Look
        from rigidfluid.post.movies import movie as make_movie

        path = make_movie(folder, out, Look(show, follow, view, size, fps, plane, every), progress)
    tell(f"wrote {path}")


@app.command()
def study(study: StudyFile, out: OutFolder = None, resume: Continue = True, jobs: Jobs = 1) -> None:
    """Run a scene or a kernel with many settings; plot the error against the run time, or figures over parameters; exit
    code 1 if all runs fail."""
    with reported("The same command goes on with the runs that are not done."):
        from rigidfluid.post.studies import load_study, run_study

        loaded = load_study(study)
        folder = out or Path("out") / loaded.name
        with runs_bar(loaded.name) as show:
            results, written = run_study(loaded, folder, fresh=not resume, jobs=jobs, progress=show)
        print_study(results)
        tell(f"wrote to {folder}: {', '.join(path.name for path in written)}")
    if results.first_failure:
        complain(f"the first failed run, {results.first_failure} {written[0]} has the reasons of all.")
    if not results.outcomes:
        raise typer.Exit(FOUND_ERRORS)


@app.command()
def schema() -> None:
    """Print the JSON Schema of scene files, with the keys of every installed part."""
    with reported():
        from rigidfluid.core.case.schema import json_schema

        tell(json.dumps(json_schema(), indent=2, ensure_ascii=False))
