"""The command line; the only place that prints and exits."""

from __future__ import annotations

from rigidfluid.cli.commands import app

__all__ = ["app"]
