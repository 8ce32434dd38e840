"""Plug-ins found on the path: those that work, and those that are refused by name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from rigidfluid.errors import PluginError
from rigidfluid.registry import BODY, DETECTOR, FLUID_BACKEND, FORCE_LAW, Registry

Install = Callable[..., Path]


def refusal() -> str:
    """Why the one plug-in did not load; it breaks nothing else."""
    registry = Registry.load()
    registry.get(FORCE_LAW, "centre")
    (plugin,) = registry.unloaded
    assert (plugin.name, plugin.origin) == ("springy", "springy 1.2")
    with pytest.raises(PluginError) as told:
        registry.get(FORCE_LAW, "springy")
    assert f"Plug-in springy of springy 1.2 did not load: {plugin.reason}" in told.value.remedy
    return plugin.reason


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
    assert "found hook 'rigidfluid_force_lews'" in message
    assert "Did you mean 'rigidfluid_force_laws'?" in message


def test_hook_with_an_argument_is_refused(install: Install, law: str) -> None:
    install(law.replace("rigidfluid_force_laws()", "rigidfluid_force_laws(scene)"))
    assert "allowed is hooks without arguments" in refusal()


def test_plugin_without_hook_is_refused(install: Install, law: str) -> None:
    install(law.replace("@hookimpl", ""))
    message = refusal()
    assert "found no hook" in message
    assert "@hookimpl" in message


def test_double_name_names_both(install: Install, law: str) -> None:
    install(law)
    install(law, name="bouncy", module="bouncy_plugin")
    with pytest.raises(PluginError) as caught:
        Registry.load()
    message = str(caught.value)
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
        ('name = "springy"', "", "Springy with nothing as name; allowed is str"),
        ('name = "springy"', 'name = "springy"; requires = ["numpy"]', "Springy with list ['numpy'] as requires"),
        ('name = "springy"', 'name = "springy"; requires = {"numpy": 1}', "as requires; allowed is"),
        ('name = "springy"', 'name = "springy"; balls_only = "no"', "str 'no' as balls_only; allowed is bool"),
        (
            "return [Springy]",
            "return Springy",
            "from rigidfluid_force_laws; allowed is a list",
        ),
        ("return [Springy]", "return None", "found None from rigidfluid_force_laws"),
        ("return [Springy]", "return Springy()", "TypeError"),
        ("return [Springy]", "raise KeyError('lost')", "found KeyError: 'lost', in rigidfluid_force_laws"),
        ("return [Springy]", "raise SystemExit(0)", "found SystemExit: 0, in rigidfluid_force_laws"),
        ("import numpy as np", "raise SystemExit(3)", "found SystemExit: 3"),
        (
            'name = "springy"',
            'name = "springy"; Options = dict',
            "Springy with type <class 'dict'> as Options; allowed is type[",
        ),
        ("import numpy as np", "1 / 0", "found ZeroDivisionError: division by zero"),
    ],
)
def test_wrong_class_is_refused(install: Install, law: str, old: str, new: str, text: str) -> None:
    install(law.replace(old, new))
    assert text in refusal()


def test_plugin_that_cannot_be_imported_breaks_nothing_else(install: Install, law: str) -> None:
    install(law.replace("numpy", "no_such_package"))
    registry = Registry.load()
    assert [(one.name, one.origin) for one in registry.unloaded] == [("springy", "springy 1.2")]
    assert "no_such_package" in registry.unloaded[0].reason
    assert registry.unloaded[0].reason.endswith("Install what is missing, or mend the plug-in.")
    registry.get(FORCE_LAW, "centre")
    with pytest.raises(PluginError, match=r"Plug-in springy of springy 1\.2 did not load: .*no_such_package"):
        registry.get(FORCE_LAW, "springy")


def test_a_module_that_is_missing_is_told_with_its_remedy(install: Install, law: str) -> None:
    install(law, entry_points="[rigidfluid]\nspringy = springy_plugn\n")
    assert refusal() == "No module named 'springy_plugn'. Correct the entry point, or the name of the file."


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
