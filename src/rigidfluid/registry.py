"""From names in a scene to classes: loads the plug-ins, checks what they offer, and hands it out by name.

The built-in parts come through the same entry points as everyone else's.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import metadata
from importlib.util import find_spec
from typing import Any, Generic, TypeVar, cast

import pluggy

from rigidfluid import hookspecs
from rigidfluid.core.geometry.value_types import refuse_other_types
from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.core.joints.joint import Joint
from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.mechanism import Mechanism
from rigidfluid.core.model.part import Part
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.entry_points import load, origin
from rigidfluid.error_text import error_text, shown
from rigidfluid.errors import PluginError

GROUP = "rigidfluid"
P = TypeVar("P", bound=Part)


@dataclass(frozen=True)
class Kind(Generic[P]):
    """One of the replaceable parts: the ``hook`` that offers it, its ``interface``, and the scene's ``field`` that
    names it."""

    hook: str
    interface: type[P]
    field: str

    @property
    def title(self) -> str:
        """Name of the kind."""
        return self.interface.kind

    @property
    def table(self) -> str:
        """Table of a scene that names it."""
        return self.field.rpartition(".")[0]

    @property
    def key(self) -> str:
        """Key of that table by which it does."""
        return self.field.rpartition(".")[2]


FLUID_BACKEND = Kind("rigidfluid_fluid_backends", FluidBackend, "fluid.backend")  # type: ignore[type-abstract]
DETECTOR = Kind("rigidfluid_detectors", Detector, "contact.detector")  # type: ignore[type-abstract]
FORCE_LAW = Kind("rigidfluid_force_laws", ForceLaw, "contact.law")  # type: ignore[type-abstract]
BODY = Kind("rigidfluid_bodies", Body, "body.type")  # type: ignore[type-abstract]
DOMAIN = Kind("rigidfluid_domains", Domain, "domain.type")  # type: ignore[type-abstract]
MECHANISM = Kind("rigidfluid_mechanisms", Mechanism, "mechanism.type")  # type: ignore[type-abstract]
JOINT = Kind("rigidfluid_joints", Joint, "joint.type")  # type: ignore[type-abstract]
SIZE_FIELD = Kind("rigidfluid_size_fields", SizeField, "mesh.field.type")  # type: ignore[type-abstract]
MATERIAL = Kind("rigidfluid_materials", GeneralisedNewtonian, "fluid.material.type")  # type: ignore[type-abstract]
KINDS: tuple[Kind[Any], ...] = (
    FLUID_BACKEND,
    DETECTOR,
    FORCE_LAW,
    BODY,
    DOMAIN,
    MECHANISM,
    JOINT,
    SIZE_FIELD,
    MATERIAL,
)


@dataclass(frozen=True)
class Entry:
    """One implementation: ``origin`` is the distribution it came with, ``hint`` what to do if it is not available."""

    kind: Kind[Any]
    name: str
    part: type[Part]
    origin: str
    available: bool
    hint: str


@dataclass(frozen=True)
class Unloaded:
    """A plug-in that could not be loaded, and why."""

    name: str
    origin: str
    reason: str


@dataclass(frozen=True)
class Registry:
    """The parts that are installed, and the plug-ins that could not be loaded."""

    entries: tuple[Entry, ...]
    unloaded: tuple[Unloaded, ...]

    @classmethod
    def load(cls) -> Registry:
        """Load and check every plug-in of the entry-point group.

        Returns
        -------
        Registry
            Available or not, every part that a plug-in offers. A plug-in that cannot be imported, misspells a hook,
            raises there, or offers what is no complete part, is unloaded, and breaks nothing else.

        Raises
        ------
        PluginError
            If two parts of a kind have one name.
        """
        manager = pluggy.PluginManager(GROUP)
        manager.add_hookspecs(hookspecs)
        entries, unloaded = list[Entry](), list[Unloaded]()
        for point in metadata.entry_points(group=GROUP):
            plugin = f"{point.name} of {origin(point)}"
            try:
                _register(manager, load(point, f"plug-in {plugin}"), plugin)
                entries += _entries(manager, plugin, origin(point))
            except (ImportError, PluginError) as error:
                remedy = _import_remedy(point, error) if isinstance(error, ImportError) else ""
                reason = error_text(error).removeprefix(f"plug-in {plugin}: ") + remedy
                unloaded.append(Unloaded(point.name, origin(point), reason))
        entries.sort(key=lambda entry: KINDS.index(entry.kind))
        _refuse_doubles(entries)
        return cls(tuple(entries), tuple(unloaded))

    def names(self, kind: Kind[Any]) -> list[str]:
        """Names of all parts of a kind, in the order they were found."""
        return [entry.name for entry in self.entries if entry.kind is kind]

    def installed(self, kind: Kind[P]) -> list[type[P]]:
        """Classes of a kind whose packages are all there, in the order they were found."""
        return [cast(type[P], entry.part) for entry in self.entries if entry.kind is kind and entry.available]

    def get(self, kind: Kind[P], name: str, subject: str | None = None) -> type[P]:
        """The class of this name.

        Parameters
        ----------
        kind : Kind
            Which of the kinds.
        name : str
            The name that the scene gives.
        subject : str, optional
            The scene's field that names it, for the message.

        Returns
        -------
        type
            A complete subclass of the kind's interface.

        Raises
        ------
        PluginError
            If there is no such part, or if a package that it needs is missing.
        """
        part = self.find(kind, name, subject)
        hint = missing_packages(part)
        if hint:
            found = f"{name!r}, which is not usable here"
            raise PluginError(subject or kind.field, found, self._available(kind), hint)
        return part

    def find(self, kind: Kind[P], name: str, subject: str | None = None) -> type[P]:
        """Part of that kind and name, as `get`, even if a package that it needs is missing; raises PluginError."""
        for entry in self.entries:
            if entry.kind is kind and entry.name == name:
                return cast(type[P], entry.part)
        raise PluginError(subject or kind.field, repr(name), self._available(kind), self._remedy(kind, name))

    def _available(self, kind: Kind[Any]) -> str:
        return "one of " + ", ".join(entry.name for entry in self.entries if entry.kind is kind and entry.available)

    def _remedy(self, kind: Kind[Any], name: str) -> str:
        unusable = [entry for entry in self.entries if entry.kind is kind and not entry.available]
        hints = "".join(f" {entry.name!r} is not usable here: {entry.hint}" for entry in unusable)
        failures = "".join(f" Plug-in {one.name} of {one.origin} did not load: {one.reason}" for one in self.unloaded)
        other = [entry.name for entry in self.entries if entry.kind is kind and name in entry.part.also_called]
        guess = f"Did you mean {other[0]!r}?" if other else suggestion(name, self.names(kind))
        return (guess or "`rigidfluid plugins` lists what is installed.") + hints + failures


def _import_remedy(point: metadata.EntryPoint, error: ImportError) -> str:
    if error.name == point.module:
        return ". Correct the entry point, or the name of the file."
    return ". Install what is missing, or mend the plug-in."


def _register(manager: pluggy.PluginManager, module: Any, plugin: str) -> None:
    try:
        manager.register(module, plugin)
    except (ValueError, pluggy.PluginValidationError) as error:
        raise PluginError(
            f"plug-in {plugin}", str(error), "hooks without arguments, each module named once", "Mend the plug-in."
        ) from error
    _check_hooks(manager, module, plugin)


def _check_hooks(manager: pluggy.PluginManager, module: Any, plugin: str) -> None:
    hooks = [kind.hook for kind in KINDS]
    found = manager.get_hookcallers(module) or []
    for hook in found:
        if not hook.has_spec():
            remedy = suggestion(hook.name, hooks) or "Rename it."
            raise PluginError(f"plug-in {plugin}", f"hook {hook.name!r}", ", ".join(hooks), remedy)
    if not found:
        raise PluginError(f"plug-in {plugin}", "no hook", ", ".join(hooks), "Mark its functions with @hookimpl.")


def _entries(manager: pluggy.PluginManager, plugin: str, origin: str) -> list[Entry]:
    """Parts that a plug-in offers; raises PluginError if that is no list of complete ones."""
    entries = []
    for kind in KINDS:
        caller: pluggy.HookCaller = getattr(manager.hook, kind.hook)
        for implementation in caller.get_hookimpls():
            if implementation.plugin_name == plugin:
                for part in _offered(kind, implementation.function, plugin):
                    _check_class(kind, part, plugin)
                    hint = missing_packages(part)
                    entries.append(Entry(kind, part.name, part, origin, not hint, hint))
    return entries


def _offered(kind: Kind[Any], function: Callable[[], Any], plugin: str) -> list[Any]:
    """The list that a hook gives; raises PluginError if it gives another thing, raises or exits."""
    subject, allowed = f"plug-in {plugin}", f"a list of subclasses of {kind.interface.__name__}"
    try:
        offered = function()
    except (Exception, SystemExit, GeneratorExit) as error:  # foreign code may raise anything
        found = f"{type(error).__name__}: {error_text(error)}, in {kind.hook}"
        raise PluginError(subject, found, allowed, "Mend the plug-in.") from error
    if not isinstance(offered, list | tuple):
        raise PluginError(subject, f"{shown(offered)} from {kind.hook}", allowed, "Return a list.")
    return list(offered)


def _check_class(kind: Kind[Any], part: Any, plugin: str) -> None:
    subject, interface = f"plug-in {plugin}", kind.interface.__name__
    if not _derives(part, kind.interface):
        raise PluginError(
            subject, f"{shown(part)} as a {kind.title}", f"a subclass of {interface}", "Derive it from there."
        )
    if part.__abstractmethods__:
        found = f"{part.__name__} without {', '.join(sorted(part.__abstractmethods__))}"
        raise PluginError(subject, found, f"a complete {interface}", "Write what is missing.")
    try:
        refuse_other_types(part, part)
    except Wrong as wrong:
        raise PluginError(subject, f"{part.__name__} with {wrong.found}", wrong.allowed, "Mend the class.") from None


def _derives(part: Any, parent: type[Any]) -> bool:
    return inspect.isclass(part) and issubclass(part, parent)


def missing_packages(part: type[Part]) -> str:
    """Tell how to get the packages that a part needs and this machine lacks; empty where it lacks none."""
    missing = [package for package in part.requires if find_spec(package.partition(".")[0]) is None]
    return " ".join(f"Package {package} is missing: install {part.requires[package]}." for package in missing)


def _refuse_doubles(entries: Sequence[Entry]) -> None:
    first: dict[tuple[str, str], Entry] = {}
    for entry in entries:
        other = first.setdefault((entry.kind.title, entry.name), entry)
        if other is not entry:
            raise PluginError(
                f"{entry.kind.title} {entry.name!r}",
                f"the name twice, in {other.origin} ({other.part.__module__}) and in {entry.origin} "
                f"({entry.part.__module__})",
                "one part of a name",
                "Uninstall one of them, or rename it.",
            )
