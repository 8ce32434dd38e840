"""Directive `{api}`: names of `rigidfluid.api` by the modules that they come from, each with its docstring."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import Directive
from pydantic import BaseModel
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util import logging

import rigidfluid.api

LOGGER = logging.getLogger(__name__)
ALIASES = {
    "BoolArray": "Array of truth values, of any shape.",
    "ConditionMaker": "Class of a boundary condition, or a function that is called in the same way and makes one.",
    "FloatArray": "Array of floating-point numbers, of the shape that the description says.",
    "FluidState": "Arrays of a fluid's state by name, as its backend writes them.",
    "IntArray": "Array of integers, of the shape that the description says.",
    "Positive": "A number above zero, in tables of options.",
    "Vector": "A list of d numbers, in tables of options.",
    "hookimpl": "Marks a function of a plug-in as one of the hooks.",
}
"""Names that have no docstring of their own."""


class Api(Directive):
    """Names whose modules begin with one of the prefixes in the content, in the order of the prefixes."""

    has_content: ClassVar[bool] = True
    option_spec: ClassVar[dict[str, Any]] = {"brief": bool}

    def run(self) -> list[nodes.Node]:
        """Have autodoc document each name."""
        names = [name for prefix in self.content for name in names_of(prefix)]
        if not names:
            raise self.error(f"no name of rigidfluid.api comes from {', '.join(self.content)}")
        lines = [line for name in names for line in documented(name, "brief" in self.options)]
        node = nodes.Element()
        self.state.nested_parse(type(self.content)(["```{eval-rst}", *lines, "```"], self.content.source(0)), 0, node)
        return node.children


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directive, and the check that no name is left out."""
    app.add_directive("api", Api)
    app.connect("env-check-consistency", refuse_forgotten)
    return {"parallel_read_safe": True}


def refuse_forgotten(_: Sphinx, env: BuildEnvironment) -> None:
    """Warn, which ends a strict build, of public names that no page has; Sphinx warns of those on several."""
    described = env.get_domain("py").data["objects"]
    for name in rigidfluid.api.__all__:
        if f"rigidfluid.api.{name}" not in described:
            LOGGER.warning("rigidfluid.api.%s is on no page of the API reference", name)


def names_of(prefix: str) -> list[str]:
    """Public names whose home begins with a prefix, classes of options after those that they belong to."""
    return [name for name in rigidfluid.api.__all__ if f"{home(name)}.".startswith(f"{prefix}.")]


def home(name: str) -> str:
    """Module of a public name without `rigidfluid.`; aliases and constants come from `aliases` and `kinds`."""
    thing = getattr(rigidfluid.api, name)
    if name in ALIASES:
        return "aliases"
    return "kinds" if name.isupper() else str(thing.__module__).removeprefix("rigidfluid.")


def documented(name: str, brief: bool) -> Iterator[str]:
    """Lines of reStructuredText that describe a public name."""
    thing = getattr(rigidfluid.api, name)
    if name in ALIASES:
        yield from [f".. py:data:: rigidfluid.api.{name}", "", f"   {ALIASES[name]}", ""]
        return
    kind = "class" if inspect.isclass(thing) else "function" if inspect.isfunction(thing) else "data"
    is_table = kind == "class" and issubclass(thing, BaseModel)
    yield f".. auto{kind}:: rigidfluid.api.{name}{'(**keys)' if is_table else ''}"
    if kind == "class":
        # A member called `type` is what the type `type` of any parameter would lead to.
        yield "   :no-members:" if brief or is_table else "   :exclude-members: type"
        yield from ["   :show-inheritance:"] if thing.__bases__ != (object,) else []
    yield ""
    if is_table:
        for key, field in thing.model_fields.items():
            yield f"   * ``{field.alias or key}``: {field.description or 'a table'}"
        yield ""
