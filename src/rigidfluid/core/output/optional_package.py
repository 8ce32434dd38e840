"""Packages that rigidfluid does not need, and that turn its results into other programs' objects."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from rigidfluid.errors import OutputError


def optional_package(name: str, extra: str) -> Any:
    """Import a package that an extra of rigidfluid brings; raises OutputError where it is not installed."""
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        remedy = f"Install it: `pip install {name}`, or `pip install 'rigidfluid[{extra}]'`."
        raise OutputError(name, "the package is not installed", None, remedy) from None
