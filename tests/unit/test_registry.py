"""Plug-ins found on the path: those that work, and those that are refused by name."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from textwrap import dedent

import pytest

from rigidfluid.errors import PluginError
from rigidfluid.registry import BODY, DETECTOR, FLUID_BACKEND, FORCE_LAW, Registry

LAW = """
    import numpy as np
    from rigidfluid.core.interfaces import ForceLaw
    from rigidfluid.hookspecs import hookimpl

    class Springy(ForceLaw):
        name = "springy"

        def force(self, contacts):
            return (self.range - contacts.gap)[:, None] * contacts.normal

        def energy(self, contacts):
            return (self.range - contacts.gap) ** 2 / 2

    @hookimpl
    def rigidfluid_force_laws():
        return [Springy]
"""
Install = Callable[..., None]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Install:
    """Puts a distribution with one module and its entry point on the path."""

    def install(code: str, name: str = "springy", module: str = "springy_plugin") -> None:
        folder = tmp_path / name
        info = folder / f"{name}-1.2.dist-info"
        info.mkdir(parents=True)
        (folder / f"{module}.py").write_text(dedent(code))
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.2\n")
        (info / "entry_points.txt").write_text(f"[rigidfluid]\n{name} = {module}\n")
        monkeypatch.syspath_prepend(str(folder))
        monkeypatch.delitem(sys.modules, module, raising=False)

    return install


def refusal() -> str:
    with pytest.raises(PluginError) as caught:
        Registry.load()
    return str(caught.value)


def test_built_in_parts_are_there() -> None:
    registry = Registry.load()
    assert registry.unloaded == ()
    assert {"dry", "scikit-fem"} <= set(registry.names(FLUID_BACKEND))
    assert {"sphere", "brute_force"} <= set(registry.names(DETECTOR))
    assert {"centre"} <= set(registry.names(FORCE_LAW))
    assert {"sphere", "ellipsoid"} <= set(registry.names(BODY))


def test_plugin_is_found(install: Install) -> None:
    install(LAW)
    registry = Registry.load()
    entry = next(entry for entry in registry.entries if entry.name == "springy")
    assert (entry.kind, entry.origin, entry.available) == (FORCE_LAW, "springy 1.2", True)
    assert registry.get(FORCE_LAW, "springy") is entry.part


def test_misspelt_hook_is_refused(install: Install) -> None:
    install(LAW.replace("rigidfluid_force_laws", "rigidfluid_force_lews"))
    message = refusal()
    assert "plug-in springy of springy 1.2: found hook 'rigidfluid_force_lews'" in message
    assert "Did you mean 'rigidfluid_force_laws'?" in message


def test_hook_with_an_argument_is_refused(install: Install) -> None:
    install(LAW.replace("rigidfluid_force_laws()", "rigidfluid_force_laws(scene)"))
    assert "plug-in springy of springy 1.2" in refusal()


def test_plugin_without_hook_is_refused(install: Install) -> None:
    install(LAW.replace("@hookimpl", ""))
    message = refusal()
    assert "plug-in springy of springy 1.2: found no hook" in message
    assert "@hookimpl" in message


def test_double_name_names_both(install: Install) -> None:
    install(LAW)
    install(LAW, name="bouncy", module="bouncy_plugin")
    message = refusal()
    assert "force law 'springy'" in message
    assert "springy 1.2 (springy_plugin)" in message
    assert "bouncy 1.2 (bouncy_plugin)" in message


def test_missing_methods_are_named(install: Install) -> None:
    install(LAW.replace("def force", "def farce").replace("def energy", "def synergy"))
    assert "Springy without energy, force" in refusal()


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("return [Springy]", "return [1]", "1 as a force law; allowed is a subclass of ForceLaw"),
        ("(ForceLaw)", "", "as a force law; allowed is a subclass of ForceLaw"),
        ('name = "springy"', "", "Springy without a name"),
        (
            'name = "springy"',
            'name = "springy"; Options = dict',
            "Springy.Options; allowed is a subclass of PartOptions",
        ),
        ("import numpy as np", "1 / 0", "found ZeroDivisionError: division by zero"),
    ],
)
def test_wrong_class_is_refused(install: Install, old: str, new: str, text: str) -> None:
    install(LAW.replace(old, new))
    message = refusal()
    assert "plug-in springy of springy 1.2" in message
    assert text in message


def test_plugin_that_cannot_be_imported_breaks_nothing_else(install: Install) -> None:
    install(LAW.replace("numpy", "no_such_package"))
    registry = Registry.load()
    assert [(one.name, one.origin) for one in registry.unloaded] == [("springy", "springy 1.2")]
    assert "no_such_package" in registry.unloaded[0].reason
    registry.get(FORCE_LAW, "centre")
    with pytest.raises(PluginError, match=r"Plug-in springy of springy 1\.2 did not load: .*no_such_package"):
        registry.get(FORCE_LAW, "springy")


def test_missing_package_makes_unavailable(install: Install) -> None:
    hint = "no-such-package of version 3"
    install(LAW.replace('name = "springy"', f'name = "springy"; requires = {{"no_such_package.core": "{hint}"}}'))
    registry = Registry.load()
    entry = next(entry for entry in registry.entries if entry.name == "springy")
    assert not entry.available
    registry.get(FORCE_LAW, "centre")
    with pytest.raises(PluginError) as caught:
        registry.get(FORCE_LAW, "springy")
    assert caught.value.subject == "contact.law"
    assert "Package no_such_package.core is missing: install no-such-package of version 3." in caught.value.remedy
    assert "springy" not in caught.value.allowed
