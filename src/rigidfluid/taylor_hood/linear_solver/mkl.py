"""Path of MKL's library, so that nobody has to search the disk for it."""

from __future__ import annotations

from importlib import metadata
from pathlib import Path

_LIBRARY = "mkl_rt"
"""Part that the names of the file have in common: libmkl_rt.so.3, mkl_rt.2.dll."""


def installed_mkl() -> Path | None:
    """The library of the installed package ``mkl``, as its own list of files has it; None where there is none."""
    try:
        files = metadata.files("mkl") or []
    except metadata.PackageNotFoundError:
        return None
    return next((path for file in files if _LIBRARY in file.name and (path := Path(file.locate())).is_file()), None)
