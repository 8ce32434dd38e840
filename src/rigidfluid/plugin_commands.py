"""Commands of plug-ins: known by their entry points, and imported when they are called."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points

from rigidfluid.entry_points import load, origin
from rigidfluid.errors import PluginError

GROUP = "rigidfluid.commands"

PACKAGES = {"crosscheck": "rigidfluid-lammps"}
"""Packages in rigidfluid's repository, each by the command that it brings."""


@dataclass(frozen=True)
class PluginCommand:
    """A ``name`` on the command line, and the entry ``points`` of that name, each of which names a function."""

    name: str
    points: tuple[EntryPoint, ...]

    @property
    def origin(self) -> str:
        """Name and version of the distribution that it came with, or of several."""
        return " and ".join(map(origin, self.points))

    @property
    def summary(self) -> str:
        """Line in which its distribution describes itself."""
        distribution = self.points[0].dist
        said = distribution.metadata.get_all("Summary") if distribution else None
        return said[0] if said else f"A command of {self.origin}."

    def load(self) -> Callable[..., None]:
        """Import the function; raises PluginError if that fails, it is none, or there are several."""
        subject = f"command {self.name!r} of {self.origin}"
        if len(self.points) > 1:
            raise PluginError(subject, "the name more than once", "one command of a name", "Uninstall one of them.")
        try:
            function = load(self.points[0], subject)
        except ImportError as error:
            package = self.origin.partition(" ")[0]
            remedy = f"`pip install {package}` adds what it lacks."
            raise PluginError(subject, str(error), "a command whose modules are all there", remedy) from error
        if not callable(function):
            raise PluginError(subject, repr(function), "a function", "Mend the plug-in's entry point.")
        return function  # type: ignore[no-any-return]

    def hindrance(self, taken: Collection[str]) -> str:
        """Why it cannot be called, where rigidfluid's own commands have the names ``taken``; empty if it can."""
        if self.name in taken:
            return "rigidfluid has a command of that name"
        try:
            self.load()
        except PluginError as error:
            return f"{error.found}. {error.remedy}"
        return ""


def plugin_commands() -> dict[str, PluginCommand]:
    """Commands that installed plug-ins offer, by their names."""
    points = entry_points(group=GROUP)
    names = sorted(points.names)
    return {name: PluginCommand(name, tuple(point for point in points if point.name == name)) for name in names}


def missing_package(name: str) -> str:
    """Sentence that says how to get a command of a package in rigidfluid's repository; empty for any other name."""
    if name not in PACKAGES:
        return ""
    package = PACKAGES[name]
    return (
        f"`rigidfluid {name}` comes with the package {package}, "
        f"which `pip install ./plugins/{package}` installs from rigidfluid's repository."
    )
