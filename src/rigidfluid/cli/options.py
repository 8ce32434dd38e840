"""Arguments and options of commands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from rigidfluid.commands import named_path


def _backend_names() -> list[str]:
    """Names of all fluid backends, for the shell's completion."""
    from rigidfluid.registry import FLUID_BACKEND, Registry

    return Registry.load().names(FLUID_BACKEND)


Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Folder that a run has written.")]
Since = Annotated[
    float | None, typer.Option("--since", help="First time of the statistics; a third of the run if not given.")
]
Until = Annotated[float | None, typer.Option("--until", help="Last time of the statistics; the end if not given.")]
Across = Annotated[str, typer.Option("--across", metavar="AXIS", help="Axis across which there are profiles.")]
OutFolder = Annotated[
    Path | None, typer.Option("--out", parser=named_path, metavar="DIR", help="Where to write; default out/<name>.")
]
CompareFolder = Annotated[
    Path | None,
    typer.Option("--out", parser=named_path, metavar="DIR", help="Where to write; default out/<name>_compare."),
]
MeshFolder = Annotated[
    Path | None,
    typer.Option("--out", parser=named_path, metavar="DIR", help="Where to write; default out/<name>_mesh."),
]
Resume = Annotated[bool, typer.Option("--resume", help="Go on from the last checkpoint in DIR.")]
StudyFile = Annotated[Path, typer.Argument(metavar="STUDY", help="Study file (TOML).")]
Continue = Annotated[
    bool, typer.Option("--resume/--fresh", help="Keep the runs that DIR holds already, or run everything again.")
]
Jobs = Annotated[
    int,
    typer.Option("-j", "--jobs", metavar="N", help="N runs at a time, each in a process of its own with one thread."),
]
Backends = Annotated[
    list[str] | None,
    typer.Option("--backend", metavar="NAME", help="A fluid backend; name two or more.", autocompletion=_backend_names),
]
Version = Annotated[bool, typer.Option("--version", help="Print the version and exit.")]
MovieFile = Annotated[
    Path | None,
    typer.Option("--out", parser=named_path, metavar="FILE", help="An .mp4 or .gif file; default DIR/movie.mp4."),
]
Shown = Annotated[
    Literal["speed", "vorticity", "pressure", "scalar", "viscosity"],
    typer.Option("--show", help="Which quantity of the fluid."),
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
ShownEvery = Annotated[int, typer.Option("--every", help="Show one of so many output times.", min=1)]
FramesPerSecond = Annotated[int, typer.Option("--fps", help="Pictures a second.", min=1, max=100)]
