"""Words on the console: results, complaints, and the exit of a command that is refused."""

from __future__ import annotations

import io
import os
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO, Any

import typer
from rich.console import Console
from rich.text import Text

from rigidfluid.core.run.process import Launch, plain_interrupts
from rigidfluid.errors import OutputError, RigidfluidError, SharedInterrupt

FOUND_ERRORS = 1
BAD_INPUT = 2
INTERRUPTED = 130

LAUNCH = Launch.read()
"""This process among those that share a run; the first one speaks for all."""


@contextmanager
def reported(on_interrupt: str = "") -> Iterator[None]:
    """Turn an expected error into one paragraph on stderr and an exit code.

    Expected errors are raised on all processes of a run, and so is a SharedInterrupt. Any other interrupt or error may
    be that of one process alone, which then ends the others.
    """
    try:
        with plain_interrupts():
            yield
    except RigidfluidError as error:
        raise refusal(error) from None
    except (typer.Exit, typer.Abort, typer.BadParameter):
        raise
    except KeyboardInterrupt as interrupt:
        complain(f"Interrupted. {on_interrupt}")
        if isinstance(interrupt, SharedInterrupt):
            LAUNCH.meet()
        else:
            LAUNCH.end()
        raise typer.Exit(INTERRUPTED) from None
    except Exception:
        complain(f"A fault in rigidfluid or in a plug-in. {on_interrupt}")
        if LAUNCH.size > 1:
            make_console(stderr=True).print(Text(traceback.format_exc()), soft_wrap=True)
            LAUNCH.end()
        raise


def refusal(reason: object) -> typer.Exit:
    """Print the reason once, wait for all processes, and return the exit to raise."""
    complain(f"Error: {reason}")
    LAUNCH.meet()
    return typer.Exit(BAD_INPUT)


def tell(text: str, style: str = "") -> None:
    """Print on the first process."""
    if LAUNCH.rank == 0:
        make_console().print(Text(text, style=style), soft_wrap=True)


def complain(text: str) -> None:
    """Print in red on stderr."""
    tell_aside(text, "red")


def tell_aside(text: str, style: str = "") -> None:
    """Print on stderr what is no result."""
    if LAUNCH.rank == 0:
        make_console(stderr=True).print(Text(text, style=style), soft_wrap=True)


def make_console(stderr: bool = False) -> Console:
    """Console that shows names and values as they are: brackets in them are no markup."""
    return _Output(stderr=stderr, markup=False)


def show_all_text() -> None:
    """Write characters that the streams' encoding lacks by their numbers."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


@contextmanager
def streams_told() -> Iterator[None]:
    """End in one paragraph where standard output refuses the words of Typer, as helps are, or of a start."""
    try:
        yield
    except OutputError as error:
        sys.exit(refusal(error).exit_code)
    except OSError:
        try:
            sys.stdout.write("\n")  # refused too, if the stream was the reason
            sys.stdout.flush()
        except OSError as error:
            sys.exit(refusal(_refused(error, sys.stdout)).exit_code)
        raise


def _refused(error: OSError, stream: IO[str]) -> OutputError:
    """Give up a stream that refuses, and say so."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())  # what is left would fail again at exit
    remedy = "Results are where they were to be written."
    return OutputError("standard output", error.strerror, "a stream that can be written to", remedy)


class _Output(Console):
    """A console whose stream may be full or closed."""

    def print(self, *objects: Any, **options: Any) -> None:
        """Print; raises OutputError where the stream refuses, and ends where nobody reads it any more."""
        try:
            super().print(*objects, **options)
        except OSError as error:
            refused = _refused(error, self.file)
            if isinstance(error, BrokenPipeError):
                raise typer.Exit(FOUND_ERRORS) from None
            raise refused from None
