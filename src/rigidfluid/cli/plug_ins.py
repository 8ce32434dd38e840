"""Group of commands: the built-in ones, and those of plug-ins after them."""

from __future__ import annotations

from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command

from rigidfluid.cli.console import refusal, reported, streams_told
from rigidfluid.plugin_commands import PluginCommand, missing_package, plugin_commands


class PluginTyperCommand(TyperCommand):
    """A command of a plug-in: help lists it by its package's summary, and it is imported when it is called."""

    def __init__(self, command: PluginCommand) -> None:
        super().__init__(command.name, help=command.summary)
        self._command = command

    def make_context(self, *args: Any, **kwargs: Any) -> Any:
        """Context of the command that the function makes, which takes the place of this one."""
        with reported():
            function = self._command.load()
        alone = typer.Typer(add_completion=False)
        alone.command(self._command.name)(reported()(function))
        return get_command(alone).make_context(*args, **kwargs)


class Commands(TyperGroup):
    """The commands below, and those of plug-ins after them."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command line."""
        with streams_told():
            return super().main(*args, **kwargs)

    def list_commands(self, ctx: Any) -> list[str]:
        """Names, each once."""
        return list(dict.fromkeys([*super().list_commands(ctx), *plugin_commands()]))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Command of that name: one below, else one of a plug-in, else None."""
        if built_in := super().get_command(ctx, cmd_name):
            return built_in
        if command := plugin_commands().get(cmd_name):
            return PluginTyperCommand(command)
        if missing := missing_package(cmd_name):
            raise refusal(missing)
        return None
