"""Entry points, by which installed plug-ins are found."""

from __future__ import annotations

from importlib.metadata import EntryPoint
from typing import Any

from rigidfluid.error_text import error_text
from rigidfluid.errors import PluginError


def origin(point: EntryPoint) -> str:
    """Name and version of the distribution that an entry point came with."""
    # An entry point made by hand has no distribution; those that Python finds have one.
    return f"{point.dist.name} {point.dist.version}" if point.dist else "unknown"


def load(point: EntryPoint, subject: str) -> Any:
    """Import what an entry point names; raises ImportError if a module is missing, PluginError with this ``subject`` if
    the import fails otherwise."""
    try:
        return point.load()
    except ImportError:
        raise
    except (Exception, SystemExit, GeneratorExit) as error:  # foreign code may raise anything
        found = f"{type(error).__name__}: {error_text(error)}"
        raise PluginError(subject, found, "a module that can be imported", "Mend the plug-in.") from error
