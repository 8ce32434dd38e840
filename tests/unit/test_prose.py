"""One rule for prose: each name and each sentence has a subject, and only public names have sections."""

from __future__ import annotations

import functools
import inspect
from pathlib import Path

import pytest
from prose import docstrings, has_sections, has_subject, names, subjectless_sentences

import rigidfluid
import rigidfluid.api

SOURCE = Path(rigidfluid.__file__).parent
MODULES = sorted(SOURCE.rglob("*.py"))
PUBLIC_ROOMS = {"testing", "taylor_hood"}


def room(path: Path) -> str:
    """First folders of a module below the package."""
    parts = path.relative_to(SOURCE).parts[:-1]
    return ".".join(parts[:2]) or "rigidfluid"


ROOMS = sorted({room(path) for path in MODULES})


@functools.cache
def exported() -> set[tuple[str, str]]:
    """File and name of each function and class that `rigidfluid.api` exports."""
    members = [getattr(rigidfluid.api, name) for name in rigidfluid.api.__all__]
    named = [member for member in members if inspect.isclass(member) or inspect.isfunction(member)]
    return {(inspect.getfile(member), member.__name__) for member in named}


def is_public(path: Path, name: str) -> bool:
    """Whether users and plug-ins read the docstring ``name``, which the module's name begins."""
    _, *members = name.split(".")
    if any(member.startswith("_") and not member.startswith("__") for member in members):
        return False
    return room(path).split(".")[0] in PUBLIC_ROOMS or (str(path), members[0] if members else "") in exported()


@pytest.mark.parametrize("where", ROOMS)
def test_no_names_and_sentences_are_without_a_subject(where: str) -> None:
    modules = [path for path in MODULES if room(path) == where]
    bare = {f"{path.name}: {name}" for path in modules for name in names(path) if not has_subject(name)}
    sentences = {
        f"{path.name}: {name}: {sentence}"
        for path in modules
        for name, text in docstrings(path)
        for sentence in subjectless_sentences(text)
    }
    assert not bare | sentences


@pytest.mark.parametrize("where", ROOMS)
def test_no_sections_are_on_private_names(where: str) -> None:
    inside = {
        f"{path.name}: {name}"
        for path in MODULES
        if room(path) == where
        for name, text in docstrings(path)
        if has_sections(text) and not is_public(path, name)
    }
    assert not inside


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("Speed of a body [length/time].", []),
        ("Of a body, its speed.", ["Of a body, its speed."]),
        ("Speed. Where there is none, zero.", ["Where there is none, zero."]),
        ("Speed.\n\nWhat else there is.", ["What else there is."]),
        ("Offset of the first, e.g. that of a wall.", []),
    ],
)
def test_a_sentence_without_a_subject_is_found(text: str, found: list[str]) -> None:
    assert subjectless_sentences(text) == found


@pytest.mark.parametrize(("name", "has_one"), [("_of_body", False), ("speed_of", True), ("at", False)])
def test_a_name_without_a_subject_is_found(name: str, has_one: bool) -> None:
    assert has_subject(name) == has_one
