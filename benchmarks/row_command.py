"""Command line of benchmarks that measure rows: each is printed as soon as it is there, all go to a file in the end."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigidfluid.commands import write_json
from rigidfluid.errors import RigidfluidError

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Number = Callable[[str], float]


def row_parser(description: str | None) -> argparse.ArgumentParser:
    """A parser that takes a file for all rows."""
    assert description is not None
    shown = argparse.ArgumentDefaultsHelpFormatter
    parser = argparse.ArgumentParser(description=description.splitlines()[0], formatter_class=shown)
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the rows there")
    return parser


def at_least(least: float, kind: Number = int) -> Number:
    """A number of a kind that an argument may be, from the least on."""

    def number(text: str) -> float:
        value = kind(text)
        if value < least:
            raise argparse.ArgumentTypeError(f"found {text}; allowed is {least} or more")
        return value

    return number


def show_rows(rows: Iterable[DataclassInstance], file: Path | None) -> None:
    """Print a line for each row, and write all; an error that rigidfluid explains ends the program, exit code 2."""
    made: list[dict[str, Any]] = []
    try:
        for row in rows:
            made.append(asdict(row))
            if len(made) == 1:
                print("  ".join(made[0]))
            print("  ".join(f"{_cell(value):>{len(name)}}" for name, value in made[-1].items()), flush=True)
        if file is not None:
            write_json(made, file)
    except RigidfluidError as error:
        print(f"Error: {error}", file=sys.stderr)
        sys.exit(2)


def _cell(value: float | str | None) -> str:
    """A count, a name, or a number to four digits."""
    if value is None:
        return "none"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
