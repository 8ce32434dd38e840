"""Models that differ from others in one of their objects."""

from __future__ import annotations

from dataclasses import replace

from rigidfluid.api import Fluid, FluidBackend, Model, Selected


def with_backend(model: Model, backend: type[FluidBackend]) -> Model:
    """The same model on another backend, with the options that it has by default."""
    assert isinstance(model.fluid, Fluid)
    return replace(model, fluid=replace(model.fluid, backend=Selected(backend, backend.Options())))
