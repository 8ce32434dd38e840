"""Plug-ins found on the path: those that work, and those that are refused by name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from rigidfluid.errors import PluginError
from rigidfluid.registry import BODY, DETECTOR, FLUID_BACKEND, FORCE_LAW, Registry

Install = Callable[..., Path]


def refusal() -> str:
    with pytest.raises(PluginError) as caught:
        Registry.load()
    return str(caught.value)


def test_built_in_parts_are_there() -> None:
    registry = Registry.load()
    assert registry.unloaded == ()
    assert {"dry", "scikit-fem"} <= set(registry.names(FLUID_BACKEND))
    assert {"sphere", "ellipsoid", "brute_force"} <= set(registry.names(DETECTOR))
    assert {"centre"} <= set(registry.names(FORCE_LAW))
    assert {"sphere", "ellipsoid"} <= set(registry.names(BODY))


def test_plugin_is_found(install: Install, law: str) -> None:
    install(law)
    registry = Registry.load()
    entry = next(entry for entry in registry.entries if entry.name == "springy")
    assert (entry.kind, entry.origin, entry.available) == (FORCE_LAW, "springy 1.2", True)
    assert registry.get(FORCE_LAW, "springy") is entry.part


def test_misspelt_hook_is_refused(install: Install, law: str) -> None:
    install(law.replace("rigidfluid_force_laws", "rigidfluid_force_lews"))
    message = refusal()
    assert "plug-in springy of springy 1.2: found hook 'rigidfluid_force_lews'" in message
    assert "Did you mean 'rigidfluid_force_laws'?" in message


def test_hook_with_an_argument_is_refused(install: Install, law: str) -> None:
    install(law.replace("rigidfluid_force_laws()", "rigidfluid_force_laws(scene)"))
    assert "plug-in springy of springy 1.2" in refusal()


def test_plugin_without_hook_is_refused(install: Install, law: str) -> None:
    install(law.replace("@hookimpl", ""))
    message = refusal()
    assert "plug-in springy of springy 1.2: found no hook" in message
    assert "@hookimpl" in message


def test_double_name_names_both(install: Install, law: str) -> None:
    install(law)
    install(law, name="bouncy", module="bouncy_plugin")
    message = refusal()
    assert "force law 'springy'" in message
    assert "springy 1.2 (springy_plugin)" in message
    assert "bouncy 1.2 (bouncy_plugin)" in message


def test_missing_methods_are_named(install: Install, law: str) -> None:
    install(law.replace("def force", "def farce").replace("def energy", "def synergy"))
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
def test_wrong_class_is_refused(install: Install, law: str, old: str, new: str, text: str) -> None:
    install(law.replace(old, new))
    message = refusal()
    assert "plug-in springy of springy 1.2" in message
    assert text in message


def test_plugin_that_cannot_be_imported_breaks_nothing_else(install: Install, law: str) -> None:
    install(law.replace("numpy", "no_such_package"))
    registry = Registry.load()
    assert [(one.name, one.origin) for one in registry.unloaded] == [("springy", "springy 1.2")]
    assert "no_such_package" in registry.unloaded[0].reason
    registry.get(FORCE_LAW, "centre")
    with pytest.raises(PluginError, match=r"Plug-in springy of springy 1\.2 did not load: .*no_such_package"):
        registry.get(FORCE_LAW, "springy")


def test_missing_package_makes_unavailable(install: Install, law: str) -> None:
    hint = "no-such-package of version 3"
    install(law.replace('name = "springy"', f'name = "springy"; requires = {{"no_such_package.core": "{hint}"}}'))
    registry = Registry.load()
    entry = next(entry for entry in registry.entries if entry.name == "springy")
    assert not entry.available
    registry.get(FORCE_LAW, "centre")
    with pytest.raises(PluginError) as caught:
        registry.get(FORCE_LAW, "springy")
    assert caught.value.subject == "contact.law"
    assert "Package no_such_package.core is missing: install no-such-package of version 3." in caught.value.remedy
    assert "springy" not in caught.value.allowed
