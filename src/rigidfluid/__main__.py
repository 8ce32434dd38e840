"""`python -m rigidfluid` is the command `rigidfluid`."""

from rigidfluid.cli import app

app()
