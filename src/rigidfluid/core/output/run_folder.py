"""The folder of a run: one run at a time writes there, and nothing is removed that no run has written."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

from rigidfluid.errors import OutputError

MARK = "run.lock"
"""Locked while a run writes; its presence says that a folder is a run's."""

PICTURES = (
    *("speed_field", "streamlines", "vorticity", "pressure", "whole_mesh", "mesh", "smallest_gap", "space", "position"),
    *("mechanisms", "speed", "gap", "rotation", "torque", "force", "coefficients", "contacts", "joints", "energy"),
    "step",
)
"""Names of the pictures in the report of a run, each a PNG or SVG file."""

_OWN = {
    ".": re.compile(
        r"(bodies|contacts|energy|probes)\.csv|fields\.pvd|summary\.json|report\.html|state(\.\d+)?\.h5(\.part)?"
    ),
    "fields": re.compile(r"\d{6,}(\.\d+)?\.p?vtu"),
    "report": re.compile(rf"({'|'.join(PICTURES)})\.(png|svg)"),
}


def refuse_foreign(out: Path) -> None:
    """Raise OutputError where a run would replace or remove files in a folder that is not a run's."""
    foreign = next(_own_files(out), None)
    if foreign is not None and not (out / MARK).exists():
        raise OutputError(
            str(foreign),
            f"a file of this name in a folder that is not a run's, as it has no {MARK}",
            "a new or empty folder, or one that a run has written",
            "Choose another --out, or move the files away.",
        )


def locked(out: Path) -> TextIO:
    """Lock the mark of a folder until it is closed or this process ends, however it ends; raises OutputError if another
    run is writing there."""
    file = (out / MARK).open("a+", encoding="ascii")
    if not _lock(file):
        file.seek(0)
        found = f"a run in progress, of process {file.read().strip() or 'unknown'}"
        file.close()
        raise OutputError(
            str(out), found, "a folder that no run is writing to", "Wait for it, or choose another --out."
        )
    file.truncate(0)
    file.write(f"{os.getpid()}\n")
    file.flush()
    return file


def clear(out: Path) -> None:
    """Remove an earlier run's files, so that two runs never mix; tables are left, as they are started anew in place."""
    for file in list(_own_files(out)):
        if file.suffix != ".csv":
            file.unlink()


def _own_files(out: Path) -> Iterator[Path]:
    """Files that runs and their reports write, by name."""
    for folder, names in _OWN.items():
        if (out / folder).is_dir():
            yield from (file for file in sorted((out / folder).iterdir()) if names.fullmatch(file.name))


def _lock(file: TextIO) -> bool:
    """Whether nobody else holds it; true also where there are no such locks: on Windows, and on some network disks."""
    if sys.platform == "win32":
        return True
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True
