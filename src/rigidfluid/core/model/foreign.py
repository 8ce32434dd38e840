"""Foreign code, as that of plug-ins: it may fail, and may not end the program."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from traceback import walk_tb

from rigidfluid.errors import PluginError


@contextmanager
def no_exit() -> Iterator[None]:
    """Turn an exit of the program into a PluginError that names the place; a run would seem to have succeeded."""
    try:
        yield
    except SystemExit as end:
        frame, line = list(walk_tb(end.__traceback__))[-1]
        raise PluginError(
            f"module {frame.f_globals.get('__name__')}, line {line}",
            f"an exit of the program, code {end.code}",
            "code that returns, or raises an error",
            "Mend it there.",
        ) from end
