"""Commands with which a user starts: scenes to copy, and one of the user's own."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from rigidfluid.cli.console import make_console, reported, tell
from rigidfluid.commands import named_path
from rigidfluid.start.wishes import CHOICES, Fluid, Shape, Units, Wishes


def _names() -> list[str]:
    """Names of the shipped scenes, for the shell's completion."""
    from rigidfluid.start.examples import example_names

    return example_names()


NewFile = Annotated[Path, typer.Argument(parser=named_path, metavar="FILE", help="Scene file to write.")]
Dimension = Annotated[int | None, typer.Option(min=2, max=3, help="Number of space dimensions; 2 if not given.")]
Bodies = Annotated[int | None, typer.Option(min=1, max=200, help="Number of bodies; 1 if not given.")]
ShapeName = Annotated[Shape | None, typer.Option(help="Of the bodies; sphere if not given: in 2D a disk.")]
Size = Annotated[float | None, typer.Option(help="Width of the box in the units; 2 cm if not given.")]
FluidName = Annotated[Fluid | None, typer.Option(help="In the box; oil if not given.")]
Gravity = Annotated[float | None, typer.Option(help="Downwards, in the units; the Earth's if not given.")]
UnitsName = Annotated[Units | None, typer.Option(help="Of lengths, with s and g, kg or mg.")]
ExampleName = Annotated[
    str | None,
    typer.Argument(metavar="NAME", help="Scene to copy here; all are listed without.", autocompletion=_names),
]


def examples(name: ExampleName = None) -> None:
    """List the scenes that come with rigidfluid, or copy one here with the files that it names."""
    with reported():
        from rigidfluid.start.examples import command_for, copy_example

        if name is None:
            _print_examples()
            return
        scene, *others = copy_example(name, Path())
        tell(f"wrote {', '.join(map(str, (scene, *others)))}")
        tell(f"next: rigidfluid {command_for(name)} {scene}")


def new(
    file: NewFile = Path("scene.toml"),
    dimension: Dimension = None,
    bodies: Bodies = None,
    shape: ShapeName = None,
    size: Size = None,
    fluid: FluidName = None,
    gravity: Gravity = None,
    units: UnitsName = None,
) -> None:
    """Write a scene of one's own, of bodies in a box, that passes `check`; on a terminal asks for what is not given."""
    with reported():
        from rigidfluid.start.new_file import require_new, write_new
        from rigidfluid.start.new_scene import new_scene

        require_new(file)
        given = {"units": units, "dimension": dimension, "bodies": bodies, "shape": shape, "fluid": fluid, "size": size}
        wishes = Wishes(**_asked(given), gravity=gravity)
        text, report = new_scene(wishes, re.sub(r"[^\w.-]", "_", file.stem))
        write_new({file: text.encode()})
        tell(f"wrote {file}")
        for finding in report.findings:
            if finding.question == "time":
                tell(finding.text)
        tell(f"next: rigidfluid run {file}")


def _asked(given: dict[str, Any]) -> dict[str, Any]:
    """The values given and, on a terminal, the answers of who sits there in place of the others."""
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        return {key: value for key, value in given.items() if value is not None}
    from rich.prompt import FloatPrompt, IntPrompt, Prompt

    prompts: dict[type, Any] = {str: Prompt, int: IntPrompt, float: FloatPrompt}
    answers: dict[str, Any] = {}
    for key, value in given.items():
        default = Wishes(**answers).width if key == "size" else getattr(Wishes, key)
        ask = prompts[type(default)].ask
        found = (
            ask(key, choices=CHOICES.get(key), default=default, console=make_console(True)) if value is None else value
        )
        answers[key] = found
    return answers


def _print_examples() -> None:
    from rigidfluid.checks.run_time import time_in_words
    from rigidfluid.start.examples import examples

    table = Table("name", "what it shows", "CPU time", box=SIMPLE_HEAD, padding=(0, 1))
    for one in examples():
        errors = f" `rigidfluid check`: {one.errors} error{'s' * (one.errors > 1)}." if one.errors else ""
        table.add_row(Text(one.name), Text(one.shows + errors), time_in_words(one.least, one.most))
    make_console().print(table)
    tell("`rigidfluid examples NAME` copies one here. CPU times are what `rigidfluid check` foretells for one core.")
