"""The command line; the only place that prints and exits."""

from __future__ import annotations

from rigidfluid.cli.quiet_start import quiet_start

with quiet_start():
    from rigidfluid.cli.commands import app

__all__ = ["app"]
