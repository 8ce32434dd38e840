"""Commands with which a user starts: scenes to copy, and one of the user's own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from rigidfluid.cli.console import make_console, reported, tell


def _names() -> list[str]:
    """Names of the shipped scenes, for the shell's completion."""
    from rigidfluid.start.examples import example_names

    return example_names()


ExampleName = Annotated[
    str | None, typer.Argument(metavar="NAME", help="Scene to copy here; all are listed without.", autocompletion=_names)
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


def _print_examples() -> None:
    from rigidfluid.checks.run_time import time_in_words
    from rigidfluid.start.examples import examples

    table = Table("name", "what it shows", "CPU time", box=SIMPLE_HEAD, padding=(0, 1))
    for one in examples():
        table.add_row(Text(one.name), Text(one.shows), time_in_words(one.least, one.most))
    make_console().print(table)
    tell("`rigidfluid examples NAME` copies one here. CPU times are what `rigidfluid check` foretells for one core.")
